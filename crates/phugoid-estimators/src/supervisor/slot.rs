//! One running estimate: the operations that the supervisor needs, independent of the form of the covariance.

use crate::columns::Columns;
use crate::discretization::{IntervalInput, Part};
use crate::innovation::Innovations;
use crate::levels::{Frame, Levels};
use crate::model::Model;
use crate::settings::{EstimatorSettings, SettingsError};
use crate::supervisor::common::Common;
use crate::supervisor::faults::Watch;
use crate::supervisor::learnt::Evidence;

/// State, parameters and their covariance, with prediction and correction. The supervisor runs one, and a second one
/// while a change of the parameters is in doubt.
pub trait Slot<const N: usize, const P: usize>: Copy {
    /// Checks the settings that are the method's own; the shared ones have been checked.
    fn check<const R: usize>(settings: &EstimatorSettings<N, R, P>) -> Result<(), SettingsError>;

    /// Checks that there is room for the constants that a model wants considered. A slot that considers none takes every
    /// model.
    fn check_constants(_count: usize) -> Result<(), SettingsError> {
        Ok(())
    }

    /// The prior, with a state still to be started.
    fn prior<const R: usize>(settings: &EstimatorSettings<N, R, P>, columns: &Columns<R, P>) -> Self;

    /// Starts the state from measurements alone, with these variances where it is not wrong by the bias of the channel
    /// it was read from (`read_from`).
    fn start_state<const R: usize>(
        &mut self,
        x: [f64; N],
        variances: &[f64; N],
        read_from: &[Option<usize>; N],
        columns: &Columns<R, P>,
    );

    /// One interval. Changes nothing and gives `false` if the model's answer is not finite. `transition` receives `A`
    /// over the interval.
    #[allow(clippy::too_many_arguments)]
    fn predict<M, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &IntervalInput<M::Input>,
        interval_s: f64,
        transition: &mut [[f64; N]; N],
    ) -> bool
    where
        M: Model<N, R, P>;

    /// Corrects by every row that is there, in order. `watch` sees each row before it is used; `surface` receives
    /// `theta_LS - theta`, the parameter step that least squares would take on this frame's used rows. `frame` receives
    /// what the levels are learnt from.
    #[allow(clippy::too_many_arguments)]
    fn correct<M, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        watch: Option<Watch<'_, R, P>>,
        frame: Option<&mut Frame<N, R>>,
    ) -> Innovations<R>
    where
        M: Model<N, R, P>;

    /// Normalised surface beyond which this filter does not use a row.
    fn gate<const R: usize>(settings: &EstimatorSettings<N, R, P>) -> f64;

    /// Opens the `tested` columns again: they have just jumped by `N(0, diag d^2)`. `change_over_prior` is `d_j` over
    /// the prior standard deviation; `state_variance` is added to the variances of the states. Gives `false`, with the
    /// slot in an unspecified but finite state, if the arithmetic fails.
    fn reopen<const R: usize>(
        &mut self,
        columns: &Columns<R, P>,
        tested: &[usize],
        change_over_prior: &[f64; P],
        state_variance: &[f64; N],
    ) -> bool;

    /// What does not depend on the form of the covariance.
    fn common(&self) -> &Common<N, P>;

    /// Variances of the columns, scaled to the prior.
    fn variances(&self) -> [f64; P];

    /// Covariance of the columns, scaled to the prior, into the leading part of `out`.
    fn write_covariance(&self, out: &mut [[f64; P]; P]);

    /// Ends the running block of the colour correction.
    fn close_colour_block(&mut self);

    /// Renews a few factors of the colour correction.
    fn renew_colour(&mut self);

    /// True if everything is finite and no variance is negative.
    fn is_sound(&self, columns: usize) -> bool;

    /// Error of a column per unit of each considered constant, parameter units; none where none is considered.
    fn by_constant(&self, _column: usize) -> Option<&[f64]> {
        None
    }

    /// What the residuals say of the constants that can be learnt, `constants` by their places; none where none is considered.
    fn evidence<'a>(&'a self, _constants: &'a [usize]) -> Option<Evidence<'a>> {
        None
    }
}

/// A slot whose arithmetic can be followed by what moves along with the estimate.
pub trait Followed<const N: usize, const P: usize>: Slot<N, P> {
    /// [`Slot::predict`], every part of the interval told to `follower`, also those before one that fails.
    #[allow(clippy::too_many_arguments)]
    fn predict_followed<M, F: Follower<N, P>, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &IntervalInput<M::Input>,
        interval_s: f64,
        transition: &mut [[f64; N]; N],
        follower: &mut F,
    ) -> bool
    where
        M: Model<N, R, P>;

    /// [`Slot::correct`], every row that counts fully told to `follower`.
    #[allow(clippy::too_many_arguments)]
    fn correct_followed<M, F: Follower<N, P>, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        watch: Option<Watch<'_, R, P>>,
        frame: Option<&mut Frame<N, R>>,
        follower: &mut F,
    ) -> Innovations<R>
    where
        M: Model<N, R, P>;
}

/// What moves along with an estimate. It is told of each linear step of the estimate's error, and changes nothing.
pub trait Follower<const N: usize, const P: usize> {
    /// False for one that wants to know nothing, so that nothing is worked out for it.
    const ACTIVE: bool;

    /// A part of an interval: the state before and after it, `A`, and `B = dF/dtheta` in parameter units, of which the
    /// entries of the model's own columns are filled.
    fn part(&mut self, states: [&[f64; N]; 2], part: Part, transition: &[[f64; N]; N], by_parameter: &[[f64; P]; N]);

    /// A row by whose residual state and parameters have moved in proportion.
    fn row(&mut self, row: &UsedRow<'_, N>);
}

/// A row that counts fully.
pub struct UsedRow<'a, const N: usize> {
    /// The output that it belongs to.
    pub(crate) output: usize,
    /// `H`, by state.
    pub(crate) by_state: &'a [f64; N],
    /// `D`, of the model's own columns.
    pub(crate) by_parameter: &'a [f64],
    /// Column of the output's bias.
    pub(crate) bias: Option<usize>,
    /// What is measured less what is predicted, with the steps of the rows before it in the frame.
    pub(crate) residual: f64,
    /// Its variance, as the filter has it.
    pub(crate) variance: f64,
    /// Step of the state per unit of the residual.
    pub(crate) state_gain: [f64; N],
    /// Step of the columns in use per unit of the residual, parameter units.
    pub(crate) parameter_gain: &'a [f64],
}

/// Nothing follows.
impl<const N: usize, const P: usize> Follower<N, P> for () {
    const ACTIVE: bool = false;

    #[inline(always)]
    fn part(&mut self, _: [&[f64; N]; 2], _: Part, _: &[[f64; N]; N], _: &[[f64; P]; N]) {}

    #[inline(always)]
    fn row(&mut self, _: &UsedRow<'_, N>) {}
}
