//! Predicts what a flight will tell: the Cramer-Rao bound of a model's parameters for an input, before anyone flies it.

use phugoid_identification::model_file::ModelFile;
use phugoid_identification::output::Output;
use serde::Serialize;

use super::fit::Fitted;
use super::{DesignError, Kind};
use phugoid_evaluation::accuracy::{bound_with_noise, in_order_of_bound};
use phugoid_evaluation::cramer_rao::Bound;
use phugoid_simulation::scenario::Scenario;

/// How accurately a flight with this input can determine one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PredictedParameter {
    /// Name of the parameter in the model file.
    pub name: String,
    /// Value at which the bound was taken, SI.
    pub value: f64,
    /// Prior standard deviation of the parameter, in its unit.
    pub prior_std: f64,
    /// Smallest standard error that any unbiased estimator can have after the flight, in the parameter's unit; infinite
    /// where the input does not determine the parameter.
    pub std_error: f64,
    /// `std_error` in percent of the prior.
    pub percent_of_prior: f64,
    /// True for offsets and sensor biases.
    pub nuisance: bool,
    /// Bound at each of [`Prediction::time_s`]; infinite where there is none yet.
    #[serde(skip)]
    pub history: Vec<f64>,
}

/// The bound for one input.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Prediction {
    /// Name of the model file whose parameters are predicted.
    pub model: String,
    /// Parameters in the order of the model file.
    pub parameters: Vec<PredictedParameter>,
    /// The two parameters, no nuisance, that are told apart worst, and the correlation of their errors.
    pub worst_correlation: Option<(String, String, f64)>,
    /// Times of the histories, s.
    #[serde(skip)]
    pub time_s: Vec<f64>,
    /// Geometric mean over the parameters, nuisances left out, of bound over prior: the smaller, the more the input tells.
    pub score: f64,
}

/// The bound of a model's parameters for a fitted input, from the flight of the scenario with its own increments (what the
/// model does not know is zero there unless the scenario says otherwise).
///
/// Nothing is known of the terms beforehand; offsets and sensor biases of the model file are unknown too, with their priors.
/// Noise is that of the model file, else that of the scenario's sensors. Initial states are unknown, the air is calm.
///
/// # Errors
/// [`DesignError`]: the model does not fit the scenario, the noise of an output is known to neither.
pub fn predict(fitted: &Fitted, model: &ModelFile) -> Result<Prediction, DesignError> {
    /// Points of the curves over time.
    const POINTS: usize = 120;
    let end = fitted.design.time_s.last().copied().unwrap_or(0.0);
    let at: Vec<f64> = (1..=POINTS).map(|k| end * k as f64 / POINTS as f64).collect();
    let noise = |output: Output| scenario_noise(&fitted.scenario, output);
    let bounds = bound_with_noise(&fitted.flight, model, &noise, &at)?;
    let ordered = in_order_of_bound(model);
    let of = |bound: &Bound, j: usize| bound.std_error.get(j).copied().unwrap_or(f64::INFINITY);
    let parameters: Vec<PredictedParameter> = ordered
        .iter()
        .enumerate()
        .map(|(j, parameter)| {
            let history: Vec<f64> = bounds.iter().map(|bound| of(bound, j)).collect();
            let std_error = history.last().copied().unwrap_or(f64::INFINITY);
            PredictedParameter {
                name: parameter.name.clone(),
                value: fitted.flight.true_parameters.get(&parameter.name).copied().unwrap_or(0.0),
                prior_std: parameter.prior_std,
                std_error,
                percent_of_prior: 100.0 * std_error / parameter.prior_std,
                nuisance: parameter.is_nuisance(),
                history,
            }
        })
        .collect();
    let correlation = bounds.last().map(|bound| bound.correlation.as_slice()).unwrap_or_default();
    let mut worst: Option<(String, String, f64)> = None;
    for (i, row) in correlation.iter().enumerate() {
        for (j, value) in row.iter().enumerate().take(i) {
            let (Some(a), Some(b)) = (parameters.get(i), parameters.get(j)) else { continue };
            if !a.nuisance && !b.nuisance && worst.as_ref().is_none_or(|(_, _, w)| value.abs() > w.abs()) {
                worst = Some((b.name.clone(), a.name.clone(), *value));
            }
        }
    }
    let mains = || parameters.iter().filter(|p| !p.nuisance);
    let score = (mains().map(|p| (p.std_error / p.prior_std).ln()).sum::<f64>() / mains().count().max(1) as f64).exp();
    Ok(Prediction {
        model: model.name.clone(),
        worst_correlation: worst,
        time_s: bounds.iter().map(|b| b.time_s).collect(),
        score,
        parameters,
    })
}

/// Candidates in the order of what they tell, best first: kind, fitted input, prediction.
pub fn ranked(mut candidates: Vec<(Kind, Fitted, Prediction)>) -> Vec<(Kind, Fitted, Prediction)> {
    candidates.sort_by(|a, b| a.2.score.total_cmp(&b.2.score));
    candidates
}

/// Noise of a scenario's sensor, one sigma, SI; none where it has none.
fn scenario_noise(scenario: &Scenario, output: Output) -> Option<f64> {
    let specification = phugoid_simulation::sensing::specification(&scenario.sensors, output.name())?;
    (specification.noise > 0.0).then_some(specification.noise)
}
