//! A second answer: the same record by a method of another kind. Beside equation error stands a filter, beside a filter
//! equation error.
//!
//! Equation error takes the states as measured, and solves each equation by itself. A filter weighs the measured states
//! against the motion that all equations make together. A sensor that is late, a term that the model lacks, or gusts bend the
//! two in different ways, and neither shows it in its own bounds.

use super::batch::{manoeuvre, others, structure};
use super::causal::run_causal;
use super::room::{EveryRoom, causal_run};
use super::settings::sample_time;
use super::task::{ColumnRun, Run, Task};
use crate::batch::{EquationErrorSettings, Manoeuvre, equation_error};
use crate::core::error::EstimateError;
use crate::core::estimation::{OtherValue, SecondAnswer, without_part};
use crate::core::method::Method;
use crate::core::options::EstimateOptions;
use crate::model_file::{Parameter, Role};

/// The filter: it needs no settings, learns its noise, and takes a tenth of the time of filter error.
const FILTER: Method = Method::Smpe;

/// The parameters of the task's record by a filter that takes them for constant, as a batch method does.
///
/// # Errors
/// What the filter refuses the record or the model file for.
pub(super) fn by_filter<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
) -> Result<SecondAnswer, EstimateError> {
    let options = EstimateOptions { method: Some(FILTER), change_detection: Some(false), ..EstimateOptions::default() };
    let Task { prepared, file, noise, .. } = *task;
    let own = Task { prepared, file, options: &options, noise, health: None };
    let run = run_causal(&mut *causal_run(&own)?, &own, &mut |_| {})?;
    let is_derivative = |parameter: &&Parameter| !matches!(parameter.role, Role::Bias(_));
    let columns = file.estimated().zip(&run.columns).filter(|(parameter, _)| is_derivative(parameter));
    Ok(SecondAnswer { method: FILTER, values: columns.filter_map(|(p, column)| other(p, column)).collect() })
}

/// The parameters of the task's record by equation error, from the samples since the last change that stands in the run: what
/// it says is about the same aircraft as the estimates at the end. `None` where the equations give no answer, where only what a live
/// session would have had is asked for, and of a method that is a regression itself or a law without a search for the best values.
pub(crate) fn by_equations<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &Run<R>,
) -> Option<SecondAnswer> {
    if task.options.causal_only || !task.method().learns_noise() || !run.excited {
        return None;
    }
    let prepared = task.prepared;
    let changed_s =
        run.changes.iter().filter(|change| change.outcome.stands()).map(|change| change.time_s).reduce(f64::max);
    let first = changed_s.map_or(0, |changed_s| prepared.time.partition_point(|t| *t < changed_s));
    let since = Manoeuvre {
        first,
        time_s: &prepared.time[first..],
        outputs: &prepared.outputs[first..],
        ..manoeuvre::<M, N, R>("the record", prepared)
    };
    let regression = EquationErrorSettings::automatic(sample_time(&prepared.time));
    let found = equation_error(&[since], &structure::<M, N, R>(task).ok()?, &regression).ok()?;
    Some(SecondAnswer { method: Method::EquationError, values: others(&found.fit) })
}

/// A parameter without the part of its error that the model file declares: that is the same for both methods.
fn other(parameter: &Parameter, column: &ColumnRun) -> Option<OtherValue> {
    let random = without_part(column.corrected_std_error, column.systematic_std);
    let is_known = column.value.is_finite() && random.is_finite() && random > 0.0;
    is_known.then(|| OtherValue { name: parameter.name.clone(), value: column.value, std_error: random })
}
