//! Which rooms are compiled, and the smallest that holds a model.

use super::gate::{Gated, GatedInput};
use super::stepper::{CausalRun, Stepper};
use super::table::{SetUp, is_for_largest_room, set_up, set_up_any};
use super::task::Task;
use crate::core::axes::Axes;
use crate::core::error::EstimateError;
use crate::core::options::CAPACITY;
use crate::motion::MotionModel;

/// Rooms that are compiled in beside [`CAPACITY`]: unused room costs time in every update, and an estimator that is
/// full has loops of constant length (five parameters take 1.95 us in room for five and 2.57 us in room for 24;
/// benches/update.rs). Five is the longitudinal increments of a database; eleven those with six biases, or a whole
/// longitudinal build-up; 24 holds the 18 lateral derivatives.
pub(super) const SMALL_ROOM: usize = 5;
pub(super) const MIDDLE_ROOM: usize = 11;
pub(super) const LARGE_ROOM: usize = 24;

/// A motion model with every room that is compiled in.
pub(crate) trait EveryRoom<const N: usize, const R: usize>:
    MotionModel<N, R, SMALL_ROOM>
    + MotionModel<N, R, MIDDLE_ROOM>
    + MotionModel<N, R, LARGE_ROOM>
    + MotionModel<N, R, CAPACITY>
{
}

impl<M, const N: usize, const R: usize> EveryRoom<N, R> for M where
    M: MotionModel<N, R, SMALL_ROOM>
        + MotionModel<N, R, MIDDLE_ROOM>
        + MotionModel<N, R, LARGE_ROOM>
        + MotionModel<N, R, CAPACITY>
{
}

/// Sets the causal method of a task up in the smallest room that holds its model, a teaching method in the largest of
/// its motion; the numbers do not depend on the room. Which rooms there are is decided when the motion is compiled: the small ones for the longitudinal alone, the
/// largest for the others alone.
///
/// # Errors
/// [`EstimateError::NotCausal`] for a batch method, and what the settings are refused for.
pub(crate) fn causal_run<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
) -> Result<Box<dyn CausalRun<M::KnownInput, R>>, EstimateError> {
    let columns = task.file.estimated().count();
    let largest = is_for_largest_room(task.method());
    if const { matches!(M::AXES, Axes::Longitudinal) } {
        return match columns {
            0..=SMALL_ROOM if !largest => in_room::<M, N, R, SMALL_ROOM>(task, set_up),
            columns if columns <= MIDDLE_ROOM && !largest => in_room::<M, N, R, MIDDLE_ROOM>(task, set_up),
            _ => in_room::<M, N, R, LARGE_ROOM>(task, set_up_any),
        };
    }
    if const { matches!(M::AXES, Axes::LateralDirectional) } && columns <= LARGE_ROOM && !largest {
        return in_room::<M, N, R, LARGE_ROOM>(task, set_up);
    }
    in_room::<M, N, R, CAPACITY>(task, set_up_any)
}

#[inline(never)] // one room's estimator on the stack at a time
pub(super) fn in_room<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    task: &Task<M, N, R>,
    set_up: SetUp<Gated<M>, GatedInput<M::KnownInput>, N, R, P>,
) -> Result<Box<dyn CausalRun<M::KnownInput, R>>, EstimateError> {
    Ok(Box::new(Stepper::<M, N, R, P>::new(task, set_up)?))
}
