//! How well the parameters of a model can be estimated from records: the bounds before the estimation.

use phugoid_flight_data::record::Record;
use serde::{Deserialize, Serialize};

use super::batch::{manoeuvre, structure};
use super::constants::systematic;
use super::settings::sample_time;
use super::task::Task;
use crate::batch::{
    self, BatchFit, EquationErrorSettings, Manoeuvre, Noise, OptimiserSettings, Structure, UnknownKind,
};
use crate::core::axes::Axes;
use crate::core::error::EstimateError;
use crate::core::method::Method;
use crate::core::options::{CAPACITY, EstimateOptions, capacity};
use crate::core::stack::on_a_large_stack;
use crate::core::systematic::SystematicPart;
use crate::model_file::{ModelFile, Role};
use crate::models::lateral::LateralModel;
use crate::models::longitudinal::LongitudinalModel;
use crate::models::six::SixModel;
use crate::motion::MotionModel;
use crate::preparation::checks::{doubts, noise_levels};
use crate::preparation::prepare::prepare;
use crate::preparation::prepared::Prepared;

/// How well one parameter of a model can be estimated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PredictedParameter {
    /// Name in the model file.
    pub name: String,
    /// Value at which the bound was taken: a rough fit by output error, else equation error, else the start value of
    /// the model file.
    pub value: f64,
    /// Standard deviation of what is known beforehand, in the parameter's unit.
    pub prior_std: f64,
    /// Smallest standard error of an unbiased estimator, where the outputs have no error but their noise: the
    /// Cramer-Rao bound with the priors of the model file.
    pub std_error: f64,
    /// The same with the residuals that the model leaves at these values in place of the noise, and their colour, and with
    /// the systematic errors that the model file declares: what an estimate will claim.
    pub expected_std_error: f64,
    /// The part of it that the uncertainties declared in the model file make, in the parameter's unit: a better calibration
    /// makes it smaller, another manoeuvre hardly.
    #[serde(default)]
    pub systematic_std: f64,
    /// The declared quantities that make the systematic part, the largest share first.
    #[serde(default)]
    pub systematic_parts: Vec<SystematicPart>,
    /// The unknown whose error is most correlated with that of this parameter, and the correlation.
    pub closest: Option<(String, f64)>,
    /// True for offsets and sensor biases.
    pub nuisance: bool,
}

/// The bounds of all parameters of a model on some records.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Predicted {
    /// In the order of the model file, those that are estimated.
    pub parameters: Vec<PredictedParameter>,
    /// How the bounds were computed, one sentence each.
    pub notes: Vec<String>,
}

/// The bound of a model's parameters on records that are fitted together.
///
/// # Errors
/// [`EstimateError`], as an estimation by output error: a missing channel, too few samples, units that are certainly
/// wrong, a free simulation that diverges.
pub(crate) fn predict(records: &[Record], model: &ModelFile) -> Result<Predicted, EstimateError> {
    let (wanted, capacity) = (model.estimated().count(), capacity(model.axes));
    if wanted > capacity {
        return Err(EstimateError::TooManyParameters { wanted, capacity });
    }
    let no_progress = &mut |_: f64| {};
    match model.axes {
        Axes::Longitudinal => predict_of::<LongitudinalModel, _, _>(records, model),
        Axes::LateralDirectional => {
            on_a_large_stack(&|_: &mut dyn FnMut(f64)| predict_of::<LateralModel, _, _>(records, model), no_progress)
        }
        Axes::All => {
            on_a_large_stack(&|_: &mut dyn FnMut(f64)| predict_of::<SixModel, _, _>(records, model), no_progress)
        }
    }
}

fn predict_of<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    records: &[Record],
    model: &ModelFile,
) -> Result<Predicted, EstimateError> {
    let mut prepared: Vec<Prepared<M, N, R>> = Vec::with_capacity(records.len());
    for record in records {
        doubts(record, model)?;
        prepared.push(prepare(record, model)?);
    }
    let Some(first) = prepared.first() else { return Err(EstimateError::TooShort { samples: 0 }) };
    let noise = noise_levels(first, model)?;
    let options = EstimateOptions { method: Some(Method::OutputError), ..EstimateOptions::default() };
    let task = Task::new(first, model, &options, &noise);
    let mut structure = structure::<M, N, R>(&task)?;
    for (channel, noise) in structure.outputs.iter_mut().zip(&noise) {
        // A simulated record without noise gets the noise that the residuals of the model show.
        channel.noise = if noise.std > 0.0 { Noise::Known(noise.std) } else { Noise::Estimated };
    }
    let own = || model.estimated().filter(|p| !matches!(p.role, Role::Bias(_)));
    for (parameter, of) in structure.parameters.iter_mut().zip(own()) {
        parameter.prior_std = Some(of.prior_std).filter(|std| std.is_finite());
    }
    let manoeuvres: Vec<Manoeuvre<'_, N, R>> = records
        .iter()
        .zip(&prepared)
        .map(|(record, prepared)| manoeuvre::<M, N, R>(&record.source, prepared))
        .collect();
    let mut notes = Vec::new();
    let regression = EquationErrorSettings::automatic(sample_time(&first.time));
    let Rough { values, fit } = rough(&manoeuvres, &structure, &regression, &mut notes);
    let bounds = batch::bound(&manoeuvres, &structure, &values)?;
    let followed = fit
        .filter(|_| task.follows_constants())
        .and_then(|(fit, structure)| systematic::<M, N, R>(&task, &manoeuvres, &structure, (&regression, None), &fit));
    if task.follows_constants() && followed.is_none() {
        notes.push(
            "errors of the declared constants could not be followed: the bounds hold the powers of the scales"
                .to_owned(),
        );
    }
    let parameters = model.estimated().zip(first.by_powers(model)).map(|(parameter, by_powers)| {
        let bias = match parameter.role {
            Role::Bias(output) => M::AXES.row(output),
            _ => None,
        };
        let place = own().position(|p| p.name == parameter.name);
        let bound = bounds.iter().find(|b| match b.kind {
            UnknownKind::Parameter { index } => Some(index) == place,
            UnknownKind::Bias { output, .. } => Some(output) == bias,
            _ => false,
        });
        let value = place.and_then(|i| values.get(i)).copied().unwrap_or(parameter.start);
        let (systematic_std, systematic_parts) = place
            .and_then(|place| followed.as_ref()?.of(place))
            .unwrap_or_else(|| (by_powers.std(value), by_powers.shares(value)));
        PredictedParameter {
            name: parameter.name.clone(),
            value,
            prior_std: parameter.prior_std,
            // A parameter without a bound keeps its prior.
            std_error: bound.map_or(parameter.prior_std, |b| b.std_error),
            expected_std_error: bound.map_or(parameter.prior_std, |b| b.with_residuals.hypot(systematic_std)),
            systematic_std,
            systematic_parts,
            closest: bound.and_then(|b| b.closest.clone()),
            nuisance: parameter.is_nuisance(),
        }
    });
    Ok(Predicted { parameters: parameters.collect(), notes })
}

/// Where the bound is taken.
struct Rough<const N: usize, const R: usize> {
    /// Near those of output error; else those of equation error; else the start values of the model file.
    values: Vec<f64>,
    /// The fit by output error and what was unknown in it; none where it found no minimum.
    fit: Option<(BatchFit, Structure<N, R>)>,
}

/// Largest last step of the fit, in standard errors. What constants do is measured from there, so that the step is an error of
/// the systematic part; it is small beside the random part.
const STEP_TOLERANCE: f64 = 0.1;

fn rough<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    regression: &EquationErrorSettings,
    notes: &mut Vec<String>,
) -> Rough<N, R> {
    let mut near = structure.clone();
    near.outputs.iter_mut().for_each(|channel| channel.noise = Noise::Estimated);
    match batch::equation_error(manoeuvres, structure, regression) {
        Ok(found) => {
            for (parameter, value) in near.parameters.iter_mut().zip(found.fit.parameters) {
                parameter.start = value.clamp(parameter.lower, parameter.upper);
            }
        }
        Err(why) => notes.push(format!("started from the model file, as a regression gave no values: {why}")),
    }
    let search =
        OptimiserSettings { maximum_iterations: 30, step_tolerance: STEP_TOLERANCE, ..OptimiserSettings::default() };
    match batch::output_error(manoeuvres, &near, &search) {
        Ok(fit) => Rough { values: fit.parameters.clone(), fit: Some((fit, near)) },
        Err(why) => {
            notes.push(format!("taken where the search began: {why}"));
            Rough { values: near.parameters.iter().map(|p| p.start).collect(), fit: None }
        }
    }
}
