//! A method over the samples of a record, and what it said at each of them.

mod batch;
mod causal;
mod gate;
mod kalman;
mod predict;
mod readiness;
mod regression;
mod settings;
mod stepper;
mod watch;

use phugoid_estimators::{DetectorReport, Innovations};
use phugoid_estimators::{ParameterStatus, Phase, Status};

use crate::axes::Axes;
use crate::error::EstimateError;
use crate::estimation::{BatchReport, Event};
use crate::health::HealthOptions;
use crate::method::Method;
use crate::model_file::ModelFile;
use crate::monitor::HealthRun;
use crate::motion::{Motion, MotionModel};
use crate::noise::NoiseLevel;
use crate::options::{CAPACITY, EstimateOptions};
use crate::prepare::Prepared;
pub(crate) use causal::Causal;
use causal::run_causal;
pub(crate) use predict::predict;
pub use predict::{Predicted, PredictedParameter};
pub(crate) use readiness::ColumnVerdict;
pub(crate) use stepper::Stepper;

/// Everything that one run gave, by sample and by column.
#[derive(Debug)]
pub(crate) struct Run<const R: usize> {
    /// One per estimated parameter, in the order of the columns.
    pub(crate) columns: Vec<ColumnRun>,
    pub(crate) predicted: Vec<[f64; R]>,
    pub(crate) residuals: Vec<[f64; R]>,
    /// Bounded logarithm of the density that each innovation had before it was seen ([`log_density`]), by sample: NaN where
    /// there was none and before anything had moved. Empty for a batch method.
    pub(crate) log_density: Vec<[f64; R]>,
    pub(crate) phases: Vec<Phase>,
    pub(crate) events: Vec<Event>,
    /// Of the parameters at the end, row and column as in `columns`.
    pub(crate) covariance: Vec<Vec<f64>>,
    /// At the end.
    pub(crate) status: Status,
    pub(crate) detector: Option<DetectorReport>,
    /// True if any motion was visible above the noise.
    pub(crate) excited: bool,
    /// What the health monitor said, if one was asked for.
    pub(crate) health: Option<HealthRun>,
    /// What a batch method says beside.
    pub(crate) batch: Option<BatchReport>,
}

/// What one run gave of one parameter.
#[derive(Clone, Debug)]
pub(crate) struct ColumnRun {
    /// By sample.
    pub(crate) values: Vec<f64>,
    /// By sample, corrected for the colour of the residuals.
    pub(crate) std_errors: Vec<f64>,
    /// By sample.
    pub(crate) surfaces: Vec<f64>,
    /// The rest: at the end.
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    pub(crate) corrected_std_error: f64,
    pub(crate) observability: f64,
    pub(crate) status: ParameterStatus,
    pub(crate) change_sensitivity: f64,
    /// May it be believed?
    pub(crate) verdict: ColumnVerdict,
}

/// What a method is run on.
pub(crate) struct Task<'a, M: Motion<N, R>, const N: usize, const R: usize> {
    pub(crate) prepared: &'a Prepared<M, N, R>,
    pub(crate) file: &'a ModelFile,
    pub(crate) options: &'a EstimateOptions,
    pub(crate) noise: &'a [NoiseLevel; R],
    /// What is to be watched beside it, if anything.
    pub(crate) health: Option<&'a HealthOptions>,
}

impl<M: Motion<N, R>, const N: usize, const R: usize> Task<'_, M, N, R> {
    /// The method: as asked for, else as the model file says.
    pub(crate) fn method(&self) -> Method {
        self.options.method.unwrap_or(self.file.estimator.method)
    }
}

/// Rooms that are compiled in beside [`CAPACITY`]: unused room costs time in every update, and an estimator that is full
/// has loops of constant length (five parameters take 1.95 us in room for five and 2.57 us in room for 24;
/// benches/update.rs). Five is the longitudinal increments of a database; eleven those with six biases, or a whole
/// longitudinal build-up; 24 holds the 18 lateral derivatives.
const SMALL_ROOM: usize = 5;
const MIDDLE_ROOM: usize = 11;
const LARGE_ROOM: usize = 24;

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

/// What is done with a causal method in a room for `P` columns.
pub(crate) trait InRoom<M, const N: usize, const R: usize> {
    /// What it gives.
    type Output;

    /// Does it.
    fn with<C: Causal + 'static, const P: usize>(self) -> Self::Output
    where
        M: MotionModel<N, R, P>;
}

/// Runs the method of the task.
pub(crate) fn run<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    let method = task.method();
    if !method.is_batch() {
        return in_its_room(method, task.file, OverRecord { task, progress });
    }
    if const { matches!(M::AXES, Axes::Longitudinal) } {
        batch::run_batch::<M, N, R, LARGE_ROOM>(task, progress)
    } else {
        batch::run_batch::<M, N, R, CAPACITY>(task, progress)
    }
}

struct OverRecord<'a, 'b, M: Motion<N, R>, const N: usize, const R: usize> {
    task: &'a Task<'b, M, N, R>,
    progress: &'a mut dyn FnMut(f64),
}

impl<M: Motion<N, R>, const N: usize, const R: usize> InRoom<M, N, R> for OverRecord<'_, '_, M, N, R> {
    type Output = Result<Run<R>, EstimateError>;

    fn with<C: Causal + 'static, const P: usize>(self) -> Self::Output
    where
        M: MotionModel<N, R, P>,
    {
        run_causal::<C, M, N, R, P>(self.task, self.progress)
    }
}

/// Does `work` with a causal method and the smallest room that holds the model. One arm per method.
///
/// # Errors
/// [`EstimateError::Model`] for a batch method.
pub(crate) fn in_its_room<W, T, M, const N: usize, const R: usize>(
    method: Method,
    file: &ModelFile,
    work: W,
) -> Result<T, EstimateError>
where
    W: InRoom<M, N, R, Output = Result<T, EstimateError>>,
    M: EveryRoom<N, R>,
{
    match method {
        Method::Smpe => in_smallest_room::<kalman::SlidingMode, W, M, N, R>(file, work),
        Method::Ekf => in_smallest_room::<kalman::ExtendedKalman, W, M, N, R>(file, work),
        Method::Rls => in_smallest_room::<regression::LeastSquares, W, M, N, R>(file, work),
        Method::Fourier => in_smallest_room::<regression::Fourier, W, M, N, R>(file, work),
        Method::ModelReference => in_smallest_room::<regression::ByModelReference, W, M, N, R>(file, work),
        Method::ImplicitSign => in_smallest_room::<regression::BySign, W, M, N, R>(file, work),
        Method::SuperTwisting => in_smallest_room::<regression::BySuperTwisting, W, M, N, R>(file, work),
        Method::EquationError | Method::OutputError | Method::FilterError => Err(EstimateError::Model(format!(
            "{method} looks at a record as a whole; sample by sample works a causal method: smpe, ekf, rls, fourier"
        ))),
    }
}

/// The numbers do not depend on the room. Which rooms there are is decided when the motion is compiled: the small ones for the
/// longitudinal alone, the largest for the others alone.
fn in_smallest_room<C, W, M, const N: usize, const R: usize>(file: &ModelFile, work: W) -> W::Output
where
    C: Causal + 'static,
    W: InRoom<M, N, R>,
    M: EveryRoom<N, R>,
{
    let columns = file.estimated().count();
    if const { matches!(M::AXES, Axes::Longitudinal) } {
        return match columns {
            0..=SMALL_ROOM => work.with::<C, SMALL_ROOM>(),
            columns if columns <= MIDDLE_ROOM => work.with::<C, MIDDLE_ROOM>(),
            _ => work.with::<C, LARGE_ROOM>(),
        };
    }
    if const { matches!(M::AXES, Axes::LateralDirectional) } && columns <= LARGE_ROOM {
        return work.with::<C, LARGE_ROOM>();
    }
    work.with::<C, CAPACITY>()
}

/// `-(min(xi^2, 9) + ln S)/2` of each row, nats, without the constant `ln(2 pi)/2`: the score of the change detector's contest
/// (docs/theory.md), so that one outlier costs 4.5 nats and no more.
pub(crate) fn log_density<const R: usize>(innovations: &Innovations<R>) -> [f64; R] {
    std::array::from_fn(|i| {
        let xi = innovations.normalised[i];
        // `min` alone would make a number of a missing row.
        if xi.is_finite() { -0.5 * ((xi * xi).min(9.0) + innovations.variance[i].ln()) } else { f64::NAN }
    })
}

/// The word for a parameter's status.
pub(crate) fn status_word(status: ParameterStatus) -> &'static str {
    match status {
        ParameterStatus::NotExcited => "not_excited",
        ParameterStatus::Improving => "improving",
        ParameterStatus::Converged => "converged",
        ParameterStatus::AtLimit => "at_limit",
    }
}

/// The word for a phase.
pub(crate) fn phase_word(phase: Phase) -> &'static str {
    match phase {
        Phase::Starting => "starting",
        Phase::Sliding => "sliding",
        Phase::Reaching => "reaching",
        Phase::Rejected => "rejected",
        Phase::Predicting => "predicting",
        Phase::Diverged => "diverged",
    }
}

#[cfg(test)]
mod tests;
