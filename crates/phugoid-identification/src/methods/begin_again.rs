//! Another start of a filter over a whole record: the values of equation error.
//!
//! A filter linearises where it is. Textbook values with wide priors and noise levels that are not known yet can lead it, in the first
//! seconds, to values from which it does not come back: in gusts to the solution with the signs of lift and stability reversed, after a
//! long quiet to a lift that is hardly there. Equation error solves linear equations and needs no start. So a filter over a
//! whole record runs a second time from its values, and the run that has predicted the record better stands: the sum of the logarithms of
//! the densities that it gave to each sample before it saw it (as in looking back).
//!
//! The same record is then used twice. Each prior is ten standard errors of equation error wide, or that of the model file where that is
//! narrower: of what the filter knows in the end a hundredth at most is from the start where it knows as much as equation error.

use std::ops::Range;

use super::batch::equations_of;
use super::task::{BegunAgain, ColumnRun, Run, Task};
use super::{EveryRoom, run_alone};
use crate::core::estimation::{OtherValue, without_part};
use crate::core::options::EstimateOptions;
use crate::model_file::{Base, ModelFile};

/// Standard errors of equation error that the priors of the second run are wide.
const WIDTH: f64 = 10.0;
/// Nats by which the second run has to predict the record better. A better start alone gains up to 1,000 on foreign flights
/// in which both end at the same values (docs/methods.md).
const EVIDENCE: f64 = 1000.0;

/// The run of a filter, and the starts that it had.
pub(crate) struct Begun<const R: usize> {
    pub(crate) run: Run<R>,
    /// The model file with these starts, where they are others than those of the task.
    pub(crate) file: Option<ModelFile>,
    /// What equation error has said of the record on the way.
    pub(crate) equations: Option<PartByEquations>,
}

/// The parameters by equation error from a part of a record.
pub(crate) struct PartByEquations {
    pub(crate) samples: Range<usize>,
    pub(crate) values: Vec<OtherValue>,
}

/// Whether a run of this task may begin again: of a filter that learns its noise, over a whole record, of a model in absolute form. That of
/// increments to a database begins at the database.
fn may_begin_again<M: EveryRoom<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>) -> bool {
    let is_whole = !task.options.causal_only && task.health.is_none();
    is_whole && task.file.base == Base::None && task.method().learns_noise()
}

/// The run of a filter from the starts of the model file, `first`; or the one from the values of equation error, where that predicts the
/// record better by [`EVIDENCE`].
pub(crate) fn begin_again<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    first: Run<R>,
) -> Begun<R> {
    let none = |equations: Option<PartByEquations>, run: Run<R>| Begun { run, file: None, equations };
    if !may_begin_again(task) || !first.excited {
        return none(None, first);
    }
    let Some(equations) = before_the_first_change(task, &first) else { return none(None, first) };
    let file = started(task.file, &equations.values);
    match second(&task.with_file(&file), &first) {
        Some(run) => Begun { run, file: Some(file), equations: Some(equations) },
        None => none(Some(equations), first),
    }
}

/// The run of a task that starts at the values of equation error; `None` where it is no better than this one.
fn second<M: EveryRoom<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>, first: &Run<R>) -> Option<Run<R>> {
    let mut run = run_alone(task, &mut |_| {}).ok()?;
    if standing(&run) > standing(first) {
        // A change that is none predicts better as well, and is a matter for looking back.
        let options = EstimateOptions { change_detection: Some(false), ..task.options.clone() };
        run = run_alone(&Task { options: &options, ..*task }, &mut |_| {}).ok()?;
    }
    let gain = run.evidence() - first.evidence();
    run.begun_again = Some(BegunAgain { gain, most: most(first, &run) });
    // What is no number does not stand.
    (gain >= EVIDENCE).then_some(run)
}

/// Number of changes that stand.
fn standing<const R: usize>(run: &Run<R>) -> usize {
    run.changes.iter().filter(|change| change.outcome.stands()).count()
}

/// What equation error says of the time before the first change; `None` where it gives no answer.
fn before_the_first_change<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    first: &Run<R>,
) -> Option<PartByEquations> {
    let found = first.changes.iter().filter(|change| change.outcome.stands()).map(|change| change.time_s);
    let known = task.options.known_changes.iter().map(|change| change.time_s);
    let until_s = found.chain(known).fold(f64::INFINITY, f64::min);
    let samples = 0..task.prepared.time.partition_point(|t| *t < until_s);
    let values = equations_of(task, samples.clone()).ok()?;
    Some(PartByEquations { samples, values })
}

/// The model file with the values of equation error as starts.
fn started(file: &ModelFile, values: &[OtherValue]) -> ModelFile {
    let mut file = file.clone();
    for OtherValue { name, value, std_error } in values {
        let Some(parameter) = file.parameters.iter_mut().find(|parameter| parameter.name == *name) else { continue };
        parameter.start = parameter.bounds.map_or(*value, |[low, high]| value.clamp(low, high));
        parameter.prior_std = parameter.prior_std.min(WIDTH * std_error);
    }
    file
}

/// The column that is the most another one in the second run, in random standard errors of both, and its value in the first.
fn most<const R: usize>(first: &Run<R>, second: &Run<R>) -> Option<(usize, f64)> {
    let random = |column: &ColumnRun| without_part(column.corrected_std_error, column.systematic_std);
    let apart = |(a, b): (&ColumnRun, &ColumnRun)| (a.value - b.value).abs() / random(a).hypot(random(b));
    let pairs = first.columns.iter().zip(&second.columns).map(apart).enumerate().filter(|(_, apart)| apart.is_finite());
    let (column, _) = pairs.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((column, first.columns[column].value))
}
