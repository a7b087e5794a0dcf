//! From a flight record and a model file to parameters with bounds: the whole pipeline.

use phugoid_flight_data::record::Record;

use crate::batch::BatchError;
use crate::core::axes::Axes;
pub use crate::core::error::EstimateError;
use crate::core::estimation::{Estimation, Offer};
use crate::core::health::HealthOptions;
pub use crate::core::options::{CAPACITY, EstimateOptions, KnownChange, Method, Opens, StructureSearch, capacity};
use crate::core::stack::on_a_large_stack;
use crate::judge::offer::{
    Found, Missing, complete, confirm, found_rate_of_alpha, missing, missing_in_words, place, search, sentence,
    with_rate_of_alpha,
};
pub use crate::judge::offer::{tried_by_the_method, with_offered};
use crate::judge::summary::summarise;
use crate::methods::{
    EveryRoom, HealthRun, Task, begin_again, beside_causal, by_surfaces, follow_regression, is_run_again, run,
};
use crate::model_file::ModelFile;
use crate::models::lateral::LateralModel;
use crate::models::longitudinal::LongitudinalModel;
use crate::models::six::SixModel;
use crate::pipeline::base_tables;
use crate::pipeline::look_back::{look_back, looks_back};
use crate::preparation::checks::{doubts, noise_levels};
use crate::preparation::prepare::prepare;
use crate::preparation::prepared::Prepared;

/// Estimates the parameters of `model` from `record`, sample by sample as an on-board computer would: no estimate uses
/// a later sample, except that SMPE and the EKF, with a model in absolute form, look at the whole record again for sudden changes
/// that they did not find in flight, and are then opened where they happened ([`ChangeOutcome::FoundAfterwards`](crate::estimation::ChangeOutcome)),
/// and that they begin again from the values of equation error where that predicts the record much better (the verdict says so);
/// [`EstimateOptions::causal_only`] leaves that out. It may be called on any thread: models of the lateral motion, whose estimators need 3 MB of stack,
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
    // What a live session would have had is asked for by studies too, of how well known values predict a flight.
    if wanted == 0 && !options.causal_only {
        return Err(EstimateError::AllFixed { model: model.source.clone() });
    }
    let method = options.method.unwrap_or(model.estimator.method);
    if !method.is_batch() && (options.predict.is_some() || !options.further.is_empty()) {
        return Err(EstimateError::OneRecordOnly { method });
    }
    if !method.is_in_band() && options.band.is_some() {
        return Err(EstimateError::NoBand { method });
    }
    let longitudinal = |progress: &mut dyn FnMut(f64)| {
        pipeline_of::<LongitudinalModel, _, _>(record, model, options, health, progress)
    };
    let lateral =
        |progress: &mut dyn FnMut(f64)| pipeline_of::<LateralModel, _, _>(record, model, options, health, progress);
    let six = |progress: &mut dyn FnMut(f64)| pipeline_of::<SixModel, _, _>(record, model, options, health, progress);
    let found = match model.axes {
        Axes::Longitudinal => on_a_large_stack(&longitudinal, progress),
        Axes::LateralDirectional => on_a_large_stack(&lateral, progress),
        Axes::All => on_a_large_stack(&six, progress),
    };
    if base_tables::is_wanted(model, options) {
        progress(1.0);
    }
    found
}

/// The pipeline of one motion: the estimate, and what it says of terms that the model lacks.
fn pipeline_of<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    health: Option<&HealthOptions>,
    progress: &mut dyn FnMut(f64),
) -> Result<(Estimation, Option<HealthRun>), EstimateError> {
    // A health monitor is about what is known in flight.
    let carries = health.is_none() && base_tables::is_wanted(model, options);
    // The runs with moved tables of the base take the second half.
    let part = if carries { 0.5 } else { 1.0 };
    let progress = &mut |done: f64| progress(part * done);
    if options.structure == StructureSearch::Never {
        let once = once::<M, N, R>(record, model, options, health, progress)?;
        let estimation = if carries { (once.judged)(None, true) } else { once.estimation };
        return Ok((estimation, once.watched));
    }
    // Terms are tried in a second half.
    let first = once::<M, N, R>(record, model, options, health, &mut |done| progress(0.5 * done));
    let (first, mut offer) = match first {
        Ok(mut first) => {
            let offer = first.offer.take();
            (Ok(first), offer)
        }
        // A search that does not end may lack a term: the equations of motion need no search.
        Err(EstimateError::Batch(error @ BatchError::NotConverged { .. })) => {
            (Err(error), asked_for::<M, N, R>(record, model, options)?)
        }
        Err(error) => return Err(error),
    };
    let mut run = |with: &ModelFile| {
        let options = EstimateOptions { structure: StructureSearch::Never, ..options.clone() };
        once::<M, N, R>(record, with, &options, health, &mut |done| progress(0.5 + 0.5 * done))
    };
    let before = first.as_ref().ok().map(|first| &first.estimation);
    let confirmed = offer.as_mut().and_then(|offer| {
        let method = options.method.unwrap_or(model.estimator.method);
        let confirmed = confirmed(offer, model, before, &mut run);
        by_the_method(offer, model, method, before, &mut run).or(confirmed)
    });
    let taken = options.structure == StructureSearch::Auto && confirmed.is_some();
    let (mut chosen, said) = match (first, confirmed) {
        (_, Some(with)) if taken => (with, None),
        (Ok(first), with) => {
            let said =
                offer.as_ref().and_then(|offer| missing(offer, first.found(), with.as_ref().map(Once::found), model));
            (first, said)
        }
        (Err(error), None) => return Err(EstimateError::Batch(error)),
        (Err(error), Some(_)) => {
            let terms = offer.as_ref().map(missing_in_words).unwrap_or_default();
            return Err(EstimateError::LacksTerms { error, terms });
        }
    };
    if carries || said.is_some() {
        chosen.estimation = (chosen.judged)(said, carries);
    }
    if let Some(mut offer) = offer {
        offer.taken = taken;
        if let Some(sentence) = sentence(&offer) {
            let place = place(&chosen.estimation, &offer);
            chosen.estimation.verdict.insert(place, sentence);
        }
        chosen.estimation.offer = Some(offer);
    }
    progress(1.0);
    Ok((chosen.estimation, chosen.watched))
}

/// Runs the method with the terms of an offer, until it finds all that are left: those that it does not find are left
/// out, and the others tried again. The run with them; `None` if none is left.
fn confirmed<'a>(
    offer: &mut Offer,
    model: &ModelFile,
    before: Option<&Estimation>,
    run: &mut dyn FnMut(&ModelFile) -> Result<Once<'a>, EstimateError>,
) -> Option<Once<'a>> {
    while offer.best().is_some() {
        let with = with_offered(model, offer);
        let Some((with, Ok(after))) = with.as_ref().map(|with| (with, run(with))) else {
            // Without place for them, or where the method fails with them, nothing can be said of them.
            offer.terms.iter_mut().for_each(|term| term.asked_for = false);
            return None;
        };
        if confirm(offer, &after.estimation) {
            complete(offer, model, with, before, &after.estimation);
            return Some(after);
        }
    }
    None
}

/// Runs the method with the term that only it can be asked for, beside those that are missing already, and puts that into the
/// offer if it finds it: the run with all of them.
fn by_the_method<'a>(
    offer: &mut Offer,
    model: &ModelFile,
    method: Method,
    before: Option<&Estimation>,
    run: &mut dyn FnMut(&ModelFile) -> Result<Once<'a>, EstimateError>,
) -> Option<Once<'a>> {
    let with = with_rate_of_alpha(&with_offered(model, offer)?, method)?;
    if with.estimated().count() > capacity(with.axes) {
        return None;
    }
    let after = run(&with).ok()?;
    offer.terms.insert(0, found_rate_of_alpha(&with, &after.estimation)?);
    complete(offer, model, &with, before, &after.estimation);
    Some(after)
}

/// One run of a method.
struct Once<'a> {
    estimation: Estimation,
    /// What the method has predicted of the record, nats.
    evidence: f64,
    /// The same, judged with what is known of a term that the model lacks, and with errors of the tables of the base carried into it.
    judged: Box<dyn Fn(Option<Missing>, bool) -> Estimation + 'a>,
    watched: Option<HealthRun>,
    /// The terms that the equations of motion ask for, not confirmed yet, if they are to be looked for.
    offer: Option<Offer>,
}

impl Once<'_> {
    fn found(&self) -> Found<'_> {
        Found { estimation: &self.estimation, evidence: self.evidence }
    }
}

fn once<'a, M: EveryRoom<N, R> + 'a, const N: usize, const R: usize>(
    record: &'a Record,
    model: &ModelFile,
    options: &EstimateOptions,
    health: Option<&HealthOptions>,
    progress: &mut dyn FnMut(f64),
) -> Result<Once<'a>, EstimateError> {
    let prepared: Prepared<M, N, R> = prepare(record, model)?;
    let doubts = doubts(record, model)?;
    let noise = noise_levels(&prepared, model)?;
    let model = prepared.with_time_of_surfaces(model).into_owned();
    let task = Task { health, ..Task::new(&prepared, &model, options, &noise) };
    // The second look takes the second half, and runs with constants that are off take more than all before them.
    let first = match (looks_back(&task), is_run_again(&task)) {
        (true, _) => 0.5,
        (false, true) => 0.3,
        (false, false) => 1.0,
    };
    let causal = run(&task, &mut |done| progress(first * done))?;
    let begun = begin_again(&task, causal);
    let from = task.with_file(begun.file.as_ref().unwrap_or(task.file));
    let mut run = look_back(&from, begun.run, &mut |done| progress(first + (1.0 - first) * done))?;
    if !task.method().is_batch() {
        match beside_causal(&task, &run, begun.equations) {
            Some(Ok(answer)) => run.second_answer = Some(answer),
            Some(Err(error)) => run.no_second_answer = Some(error.to_string()),
            None => {}
        }
        follow_regression(&task, &mut run, &mut |done| progress(first + (1.0 - first) * done));
    }
    run.by_surfaces = by_surfaces(&task, &run);
    progress(1.0);
    let watched = run.health.take();
    let estimation = summarise(record, &task, &run, &doubts, None);
    let is_wanted = options.structure != StructureSearch::Never && run.excited;
    let offer = if is_wanted { search(record, &task)? } else { None };
    let options = options.clone();
    let evidence = run.evidence();
    let judged = Box::new(move |missing: Option<Missing>, carries: bool| {
        let task = Task::new(&prepared, &model, &options, &noise);
        if !carries {
            return summarise(record, &task, &run, &doubts, missing);
        }
        let mut wider = run.clone();
        base_tables::carry(record, &task, &mut wider);
        summarise(record, &task, &wider, &doubts, missing)
    });
    Ok(Once { estimation, evidence, judged, watched, offer })
}

/// The terms that the equations of motion ask for, where the method itself gave nothing.
fn asked_for<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
) -> Result<Option<Offer>, EstimateError> {
    let prepared: Prepared<M, N, R> = prepare(record, model)?;
    let noise = noise_levels(&prepared, model)?;
    search(record, &Task::new(&prepared, model, options, &noise))
}
