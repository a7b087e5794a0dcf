//! From a flight record and a model file to parameters with bounds: the whole pipeline.

use phugoid_flight_data::record::Record;

use crate::core::axes::Axes;
pub use crate::core::error::EstimateError;
use crate::core::estimation::Estimation;
use crate::core::health::HealthOptions;
pub use crate::core::options::{CAPACITY, EstimateOptions, Method, OfferTerms, capacity};
use crate::core::stack::on_a_large_stack;
use crate::judge::offer::{offer, sentence};
use crate::judge::summary::summarise;
use crate::methods::{EveryRoom, HealthRun, Task, run};
use crate::model_file::ModelFile;
use crate::models::lateral::LateralModel;
use crate::models::longitudinal::LongitudinalModel;
use crate::models::six::SixModel;
use crate::preparation::checks::{doubts, noise_levels};
use crate::preparation::prepare::{Prepared, prepare};

/// Estimates the parameters of `model` from `record`, sample by sample as an on-board computer would: no estimate uses
/// a later sample. It may be called on any thread: models of the lateral motion, whose estimators need 3 MB of stack,
/// run on one of their own, and `progress` is called from the caller's. (Measured noise levels, where the model file
/// gives none, are those of the first two seconds, or of the first 40 samples if that is longer.) `progress` is called
/// with the fraction done, 0 to 1.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
/// use phugoid_identification::estimation::FinalStatus;
/// use phugoid_identification::model_file::ModelFile;
/// let flight = Record::open("examples/flight.csv")?;
/// let options = EstimateOptions { method: Some(Method::Ekf), ..EstimateOptions::default() };
/// let mut done = 0.0;
/// let result = estimate(&flight, &ModelFile::named("f16")?, &options, &mut |fraction| done = fraction)?;
/// let stability = result.parameter("dCm_alpha").ok_or("no such parameter")?;
/// assert_eq!(stability.status, FinalStatus::Converged);
/// assert!(stability.lower < -0.2 && -0.2 < stability.upper); // it was flown with -0.2 per rad
/// assert_eq!(done, 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
