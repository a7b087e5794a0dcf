//! The methods: causal ones sample by sample, batch ones over whole records, behind one call.

mod air_data;
mod batch;
mod begin_again;
mod causal;
mod changes;
mod consistency;
mod constants;
mod declared_errors;
mod flown_record;
mod gate;
mod health_watch;
mod predict;
mod readiness;
mod replay;
mod room;
mod second;
mod settings;
mod snapshot;
mod stepper;
mod table;
mod task;
mod watch;

use crate::core::error::EstimateError;
use crate::core::method::Method;
pub(crate) use batch::manoeuvre as whole_record;
pub(crate) use begin_again::begin_again;
use causal::run_causal;
pub(crate) use constants::{follow_regression, is_run_again};
pub(crate) use health_watch::HealthRun;
pub(crate) use predict::predict;
pub use predict::{Predicted, PredictedParameter};
pub(crate) use readiness::ColumnVerdict;
pub(crate) use room::{EveryRoom, causal_run};
pub(crate) use second::{beside_causal, by_surfaces};
pub(crate) use snapshot::Snapshot;
pub(crate) use stepper::CausalRun;
pub(crate) use task::{BegunAgain, BySurfaces, ColumnRun, Disputed, ModelError, Run, RunChange, Task};

/// Runs the method of the task.
///
/// # Errors
/// [`EstimateError`]: what the method needs and is missing in the record or the model file.
pub(crate) fn run<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    let mut run = run_alone(task, progress)?;
    // Output error with measured air data is bent by a late vane as equation error is, which is no witness then.
    let is_measured = run.batch.as_ref().is_some_and(|report| report.measured_angles);
    let method = task.method();
    if method.is_equation_error() || is_measured {
        match second::by_filter(task) {
            Ok(answer) => run.second_answer = Some(answer),
            Err(_) if run.second_answer.is_some() => {}
            Err(error) => run.no_second_answer = Some(error.to_string()),
        }
    } else if matches!(method, Method::OutputError | Method::FilterError) {
        // A change of the aircraft in flight bends these as it bends equation error, which looks for none.
        let answer = second::by_filter(task).ok();
        match run.second_answer {
            Some(_) => run.third_answer = answer,
            None if answer.is_some() => (run.second_answer, run.no_second_answer) = (answer, None),
            None => {}
        }
    }
    Ok(run)
}

/// Runs the method of the task, and no other beside it.
///
/// # Errors
/// As [`run`].
pub(crate) fn run_alone<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    if task.method().is_batch() {
        batch::run_batch(task, progress)
    } else {
        run_causal(&mut *causal_run(task)?, task, progress)
    }
}

#[cfg(test)]
mod tests;
