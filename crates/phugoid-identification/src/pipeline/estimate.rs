//! From a flight record and a model file to parameters with bounds: the whole pipeline.

use phugoid_flight_data::plausibility::{self, Certainty, Doubt};
use phugoid_flight_data::record::Record;

use crate::core::axes::Axes;
pub use crate::core::error::EstimateError;
use crate::core::estimation::Estimation;
use crate::core::health::HealthOptions;
pub use crate::core::options::{CAPACITY, EstimateOptions, Method, OfferTerms, capacity};
use crate::judge::offer::{offer, sentence};
use crate::judge::summary::summarise;
use crate::methods::{EveryRoom, HealthRun, Task, run};
use crate::model_file::ModelFile;
use crate::models::lateral::LateralModel;
use crate::models::longitudinal::LongitudinalModel;
use crate::models::six::SixModel;
use crate::motion::Motion;
use crate::pipeline::stack::on_a_large_stack;
use crate::preparation::noise::{NoiseLevel, measure_noise};
use crate::preparation::prepare::{Prepared, prepare};

/// Estimates the parameters of `model` from `record`, sample by sample as an on-board computer would: no estimate uses
/// a later sample. It may be called on any thread: models of the lateral motion, whose estimators need 3 MB of stack, run on one
/// of their own, and `progress` is called from the caller's. (Measured noise levels, where the model file gives none, are those of the first two seconds, or of
/// the first 40 samples if that is longer.) `progress` is called with the fraction done, 0 to 1.
///
/// # Errors
/// [`EstimateError`]: a missing channel, too few samples, units that are certainly wrong, too many parameters.
pub fn estimate(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Estimation, EstimateError> {
    pipeline(record, model, options, None, progress).map(|(estimation, _)| estimation)
}

/// The pipeline, with a health monitor beside the estimator if one is asked for.
pub(crate) fn pipeline(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    health: Option<&HealthOptions>,
    progress: &mut dyn FnMut(f64),
) -> Result<(Estimation, Option<HealthRun>), EstimateError> {
    let (wanted, capacity) = (model.estimated().count(), capacity(model.axes));
    if wanted > capacity {
        return Err(EstimateError::TooManyParameters { wanted, capacity });
    }
    let method = options.method.unwrap_or(model.estimator.method);
    if !method.is_batch() && (options.predict.is_some() || !options.further.is_empty()) {
        return Err(EstimateError::OneRecordOnly { method });
    }
    let longitudinal = |progress: &mut dyn FnMut(f64)| {
        pipeline_of::<LongitudinalModel, _, _>(record, model, options, health, progress)
    };
    let lateral =
        |progress: &mut dyn FnMut(f64)| pipeline_of::<LateralModel, _, _>(record, model, options, health, progress);
    let six = |progress: &mut dyn FnMut(f64)| pipeline_of::<SixModel, _, _>(record, model, options, health, progress);
    match model.axes {
        Axes::Longitudinal => on_a_large_stack(&longitudinal, progress),
        Axes::LateralDirectional => on_a_large_stack(&lateral, progress),
        Axes::All => on_a_large_stack(&six, progress),
    }
}

/// The pipeline of one motion.
fn pipeline_of<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    health: Option<&HealthOptions>,
    progress: &mut dyn FnMut(f64),
) -> Result<(Estimation, Option<HealthRun>), EstimateError> {
    let prepared: Prepared<M, N, R> = prepare(record, model)?;
    let doubts = doubts(record, model)?;
    let noise = noise_levels(&prepared, model)?;
    let task = Task { prepared: &prepared, file: model, options, noise: &noise, health };
    // Terms are tried in a second half.
    let share = if options.offer == OfferTerms::Never { 1.0 } else { 0.5 };
    let mut run = run(&task, &mut |done| progress(share * done))?;
    let watched = run.health.take();
    let mut estimation = summarise(record, &task, &run, &doubts);
    if options.offer != OfferTerms::Never {
        estimation.offer = offer(record, &task, &estimation, &run, &mut |done| progress(0.5 + 0.5 * done))?;
        estimation.verdict.extend(estimation.offer.as_ref().map(sentence));
        progress(1.0);
    }
    Ok((estimation, watched))
}

/// What is doubtful about the units of the channels that the model uses.
///
/// # Errors
/// [`EstimateError::Units`] if one of them is certainly wrong.
pub(crate) fn doubts(record: &Record, model: &ModelFile) -> Result<Vec<Doubt>, EstimateError> {
    let used = model.channels_used();
    let is_used = |name: &String| used.contains(&name.as_str());
    let concerned = plausibility::check(record).into_iter().filter(|doubt| doubt.channels.iter().any(is_used));
    // Where two contradict one another and one of them is not used, the other may well be right.
    let (refused, doubts): (Vec<Doubt>, Vec<Doubt>) =
        concerned.partition(|doubt| doubt.certainty == Certainty::Certain && doubt.channels.iter().all(is_used));
    if !refused.is_empty() {
        return Err(EstimateError::Units { units: refused.iter().map(Doubt::to_string).collect() });
    }
    Ok(doubts)
}

/// One sigma of the noise per output: the model file's, else measured from the beginning of the record.
///
/// # Errors
/// [`EstimateError::Noise`] if it cannot be measured.
pub(crate) fn noise_levels<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    model: &ModelFile,
) -> Result<[NoiseLevel; R], EstimateError> {
    let length = prepared.noise_samples();
    let mut levels = [NoiseLevel { std: 0.0, measured: false }; R];
    for (row, output) in M::AXES.outputs().iter().enumerate().filter(|(_, o)| model.outputs[o.index()]) {
        levels[row] = match model.noise[output.index()] {
            Some(std) => NoiseLevel { std, measured: false },
            None => {
                let values: Vec<f64> = prepared.outputs[..length].iter().map(|y| y[row]).collect();
                let found = measure_noise(&values).ok_or_else(|| EstimateError::Noise(output.name().to_owned()))?;
                NoiseLevel { std: found.std, measured: true }
            }
        };
    }
    Ok(levels)
}
