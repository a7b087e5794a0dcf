//! How good are the estimates, and how true their bounds? Many flights of one scenario, each with its own sensor noise,
//! against the Cramer-Rao bound.

use phugoid_identification::axes::Axes;
use phugoid_identification::estimate::{CAPACITY, EstimateError, EstimateOptions, capacity, estimate};
use phugoid_identification::estimation::{Estimation, EventKind};
use phugoid_identification::lateral::LateralModel;
use phugoid_identification::longitudinal::LongitudinalModel;
use phugoid_identification::model_file::{InputHold, ModelFile, Role};
use phugoid_identification::motion::MotionModel;
use phugoid_identification::output::Output;
use phugoid_identification::prepare::prepare;
use phugoid_identification::six::SixModel;
use serde::Serialize;

use crate::cramer_rao::{Between, Bound, CramerRaoError, Experiment, Knowledge};
use crate::monte_carlo::{Accuracy, Outcome, monte_carlo};
use phugoid_simulation::flight::{Flight, FlightError, fly, sense};
use phugoid_simulation::scenario::Scenario;

/// Room for parameters of the longitudinal motion in the bound; the model's own count decides how many are used.
const LONGITUDINAL_CAPACITY: usize = capacity(Axes::Longitudinal);

/// Accuracy at one time of the flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Checkpoint {
    /// Time, s.
    pub time_s: f64,
    /// Parameters in the model's order.
    pub parameters: Vec<Accuracy>,
}

/// Result of an accuracy study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AccuracyStudy {
    /// Scenario.
    pub scenario: String,
    /// Model file.
    pub model: String,
    /// Estimator.
    pub method: String,
    /// Number of runs; run `i` has the scenario's seed plus `i`.
    pub runs: usize,
    /// Accuracy at each time asked for.
    pub checkpoints: Vec<Checkpoint>,
    /// Runs in which a sudden change was believed to have happened.
    pub runs_with_changes: usize,
}

/// Why a study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The flight.
    #[error(transparent)]
    Flight(#[from] FlightError),
    /// The estimation.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The bound.
    #[error("Cramer-Rao bound: {0}")]
    CramerRao(#[from] CramerRaoError),
    /// The study does not fit the model.
    #[error("{0}")]
    Unsuitable(String),
}

impl StudyError {
    /// Something that does not fit, in its own words.
    pub fn unsuitable(error: impl std::fmt::Display) -> Self {
        Self::Unsuitable(error.to_string())
    }
}

/// Flies `scenario` once, measures it `runs` times and estimates each measured flight with `model` and `options` (whose
/// truth is the flight's); compares with the truth and the Cramer-Rao bound at the times `at` (s). `done` is called after each run, from any thread.
///
/// # Errors
/// [`StudyError`]: the scenario cannot be flown, the model does not fit it, the bound does not exist.
pub fn accuracy(
    scenario: &Scenario,
    model: &ModelFile,
    options: &EstimateOptions,
    runs: usize,
    at: &[f64],
    done: impl Fn() + Sync,
) -> Result<AccuracyStudy, StudyError> {
    let flight = fly(scenario)?;
    let bounds = bound(&flight, model, at)?;
    let options = EstimateOptions { truth: flight.true_parameters.clone(), ..options.clone() };
    let results = monte_carlo(
        runs,
        |run| {
            let measured = sense(&flight.truth, scenario, scenario.seed.wrapping_add(run as u64))?;
            let estimation = estimate(&measured, model, &options, &mut |_| {})?;
            let adopted = estimation.events.iter().any(|e| e.kind == EventKind::Adopted);
            Ok::<_, StudyError>((outcomes(&estimation, at), adopted))
        },
        done,
    )?;
    let names: Vec<&str> = model.estimated().map(|p| p.name.as_str()).collect();
    let checkpoints = bounds
        .iter()
        .enumerate()
        .map(|(k, bound)| Checkpoint {
            time_s: bound.time_s,
            parameters: bound
                .std_error
                .iter()
                .zip(&names)
                .enumerate()
                .map(|(j, (cramer_rao, name))| {
                    let outcomes: Vec<Outcome> =
                        results.iter().filter_map(|(o, _)| o.get(k)?.get(j)).copied().collect();
                    let truth = flight.true_parameters.get(*name).copied().unwrap_or(0.0);
                    Accuracy::of(name, truth, *cramer_rao, &outcomes)
                })
                .collect(),
        })
        .collect();
    Ok(AccuracyStudy {
        scenario: scenario.name.clone(),
        model: model.name.clone(),
        method: options.method.unwrap_or(model.estimator.method).to_string(),
        runs,
        checkpoints,
        runs_with_changes: results.iter().filter(|(_, adopted)| *adopted).count(),
    })
}

/// Estimates at the last sample not after each of the times `at` (s), in the order of the parameters.
fn outcomes(estimation: &Estimation, at: &[f64]) -> Vec<Vec<Outcome>> {
    let time = &estimation.history.time_s;
    at.iter()
        .map(|&t| {
            let k = time.partition_point(|&s| s <= t + 1e-9).saturating_sub(1);
            let value = |values: &[f64]| values.get(k).copied().unwrap_or(f64::NAN);
            estimation
                .history
                .parameters
                .iter()
                .map(|p| Outcome { value: value(&p.value), corrected_std_error: value(&p.std_error) })
                .collect()
        })
        .collect()
}

/// The Cramer-Rao bound of a model's parameters on a flight, at each of the times `at` (s).
///
/// The noise is what the model file gives; the initial states are unknown, nothing is known of the parameters beforehand,
/// and there is no process noise.
///
/// # Errors
/// [`StudyError`]: the model needs a channel that the flight has not, sensor biases are asked for, no bound exists.
pub fn bound(flight: &Flight, model: &ModelFile, at: &[f64]) -> Result<Vec<Bound>, StudyError> {
    if model.estimated().any(|p| matches!(p.role, Role::Bias(_))) {
        let message = "sensor biases have no place in this bound: leave [biases] out";
        return Err(StudyError::Unsuitable(format!("model `{}`: {message}", model.source)));
    }
    bound_with_noise(flight, model, &|_| None, at)
}

/// As [`bound`], with the sensor biases of the model file, of which their priors are known, and with the noise (one sigma,
/// SI) of outputs for which the model file gives none.
///
/// # Errors
/// As [`bound`], but for the biases.
pub fn bound_with_noise(
    flight: &Flight,
    model: &ModelFile,
    noise: &dyn Fn(Output) -> Option<f64>,
    at: &[f64],
) -> Result<Vec<Bound>, StudyError> {
    match model.axes {
        Axes::Longitudinal => bound_of::<LongitudinalModel, _, _, LONGITUDINAL_CAPACITY>(flight, model, noise, at),
        Axes::LateralDirectional => bound_of::<LateralModel, _, _, CAPACITY>(flight, model, noise, at),
        Axes::All => bound_of::<SixModel, _, _, CAPACITY>(flight, model, noise, at),
    }
}

fn bound_of<M, const N: usize, const R: usize, const P: usize>(
    flight: &Flight,
    model: &ModelFile,
    noise: &dyn Fn(Output) -> Option<f64>,
    at: &[f64],
) -> Result<Vec<Bound>, StudyError>
where
    M: MotionModel<N, R, P>,
{
    let unsuitable = |what: &str| Err(StudyError::Unsuitable(format!("model `{}`: {what}", model.source)));
    let prepared = prepare::<M, N, R>(&flight.truth, model)?;
    let mut parameters = [0.0; P];
    let mut knowledge = Knowledge::<R, P>::of_noise([f64::INFINITY; R]);
    let mut terms = 0;
    for parameter in model.estimated() {
        if let Role::Bias(output) = parameter.role {
            if let Some(row) = M::AXES.row(output) {
                knowledge.bias_std[row] = parameter.prior_std;
            }
            continue;
        }
        let Some(truth) =
            flight.true_parameters.get(&parameter.name).copied().or(parameter.is_nuisance().then_some(0.0))
        else {
            return unsuitable(&format!("the true value of `{}` is not known", parameter.name));
        };
        let Some(slot) = parameters.get_mut(terms) else {
            return unsuitable(&format!("there is room for {P} parameters"));
        };
        *slot = truth;
        if parameter.is_nuisance() {
            knowledge.prior_std[terms] = parameter.prior_std;
        }
        terms += 1;
    }
    for (row, output) in M::AXES.outputs().iter().enumerate().filter(|(_, o)| model.outputs[o.index()]) {
        match model.noise[output.index()].or_else(|| noise(*output)) {
            Some(noise) => knowledge.noise_std[row] = noise,
            None => return unsuitable(&format!("the noise of `{}` is needed: give it under [noise]", output.name())),
        }
    }
    // A state need not be measured: its true value is in the flight.
    let mut initial_state = [f64::NAN; N];
    for (value, state) in initial_state.iter_mut().zip(M::AXES.states()) {
        let truth = flight.truth.channel(state.name()).and_then(|c| c.values.get(prepared.first));
        *value = truth.copied().unwrap_or(f64::NAN);
    }
    let experiment = Experiment {
        initial_state,
        parameters,
        time_s: &prepared.time,
        inputs: &prepared.inputs,
        between: match (model.input, M::AXES) {
            (InputHold::Held, Axes::Longitudinal) => Between::Held,
            // The input knows itself what is held; a measured motion that is an input runs on between the samples.
            _ => Between::Interpolated,
        },
    };
    Ok(experiment.bound(&prepared.model, &knowledge, at)?)
}
