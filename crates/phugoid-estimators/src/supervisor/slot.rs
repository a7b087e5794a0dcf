//! One running estimate: the operations that the supervisor needs, independent of the form of the covariance.

use crate::columns::Columns;
use crate::discretization::IntervalInput;
use crate::innovation::Innovations;
use crate::levels::{Frame, Levels};
use crate::model::Model;
use crate::settings::{EstimatorSettings, SettingsError};
use crate::supervisor::common::Common;
use crate::supervisor::faults::Watch;

/// State, parameters and their covariance, with prediction and correction. The supervisor runs one, and a second one
/// while a change of the parameters is in doubt.
pub trait Slot<const N: usize, const P: usize>: Copy {
    /// Checks the settings that are the method's own; the shared ones have been checked.
    fn check<const R: usize>(settings: &EstimatorSettings<N, R, P>) -> Result<(), SettingsError>;

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

    /// Covariance of the state given the parameters, state units.
    fn state_covariance(&self) -> [[f64; N]; N];

    /// Covariance of the columns, scaled to the prior, into the leading part of `out`.
    fn write_covariance(&self, out: &mut [[f64; P]; P]);

    /// Ends the running block of the colour correction.
    fn close_colour_block(&mut self);

    /// Renews a few factors of the colour correction.
    fn renew_colour(&mut self);

    /// True if everything is finite and no variance is negative.
    fn is_sound(&self, columns: usize) -> bool;
}
