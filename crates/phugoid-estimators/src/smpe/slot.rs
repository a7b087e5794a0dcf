//! One running estimate: what the supervisor asks of it, whatever form its covariance has.

use super::columns::Columns;
use super::common::Common;
use super::settings::{OutputInput, SmpeError, SmpeSettings};
use crate::discretization::IntervalInput;
use crate::model::Model;

/// State, parameters and their covariance, with prediction and correction. The supervisor runs one, and a second one
/// while a change of the parameters is in doubt.
pub trait Slot<const N: usize, const R: usize, const P: usize>: Copy {
    /// What the method is told: at least what the supervisor needs.
    type Settings: Copy;

    /// What the supervisor needs of them.
    fn shared(settings: &Self::Settings) -> &SmpeSettings<N, R, P>;

    /// Checks what is the method's own; the shared settings have been checked.
    fn check(settings: &Self::Settings) -> Result<(), SmpeError>;

    /// The prior, with a state still to be started.
    fn prior(settings: &Self::Settings, columns: &Columns<N, R, P>) -> Self;

    /// Starts the state from measurements alone, with these variances where it is not wrong by the bias of the channel
    /// it was read from (`measured`).
    fn start_state(&mut self, x: [f64; N], variances: &[f64; N], measured: &[bool; N], columns: &Columns<N, R, P>);

    /// One interval. Changes nothing and gives `false` if the model's answer is not finite.
    fn predict<M>(
        &mut self,
        model: &M,
        settings: &Self::Settings,
        columns: &Columns<N, R, P>,
        input: &IntervalInput<M::Input>,
        interval_s: f64,
    ) -> bool
    where
        M: Model<N, R, P>;

    /// Corrects by every row that is there, in order. `observe` sees each row before it is used; `surface` receives
    /// `theta_LS - theta`, the parameter step that least squares would take on this frame's used rows.
    #[allow(clippy::too_many_arguments)]
    fn correct<M>(
        &mut self,
        model: &M,
        settings: &Self::Settings,
        columns: &Columns<N, R, P>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        observe: impl FnMut(ScoredRow<'_>),
    ) -> Innovations<R>
    where
        M: Model<N, R, P>;

    /// Opens the `tested` columns again: they have just jumped by `N(0, diag d^2)`. `change_over_prior` is `d_j` over
    /// the prior standard deviation. Gives `false`, with the slot in an unspecified but finite state, if the arithmetic
    /// fails.
    fn reopen(
        &mut self,
        columns: &Columns<N, R, P>,
        tested: &[usize],
        change_over_prior: &[f64; P],
        noise_sd: &[f64; R],
        allowance: f64,
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
}

/// How one output row met its sliding surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RowPhase {
    /// Not measured in this frame (or not usable).
    #[default]
    Missing,
    /// Inside the boundary layer: equivalent control.
    Sliding,
    /// Outside: bounded influence on the parameters, no covariance reduction.
    Reaching,
    /// Too far away for any parameter inside the bounds: not used.
    Rejected,
}

/// The rows of the last frame as the estimated model saw them *before* the frame corrected it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovations<const R: usize> {
    /// Predicted outputs (with the estimated biases), output units.
    pub predicted: [f64; R],
    /// Normalised surface `xi`: residual over its whole predicted standard deviation, parameters included. NaN where
    /// missing.
    pub normalised: [f64; R],
    /// Residual whitened by state and measurement noise alone, `e`. NaN where missing.
    pub whitened: [f64; R],
    /// `s (1 + v)`, predicted variance of the residual, output units squared. NaN where missing.
    pub variance: [f64; R],
    /// Phase per row.
    pub phase: [RowPhase; R],
}

impl<const R: usize> Innovations<R> {
    pub(crate) const EMPTY: Self = Self {
        predicted: [f64::NAN; R],
        normalised: [f64::NAN; R],
        whitened: [f64::NAN; R],
        variance: [f64::NAN; R],
        phase: [RowPhase::Missing; R],
    };
}

/// What an output row says about the parameters, before the row is used.
pub struct ScoredRow<'a> {
    /// Index of the output.
    pub(crate) output: usize,
    /// Whitened sensitivity `psi`, columns scaled to the prior standard deviation.
    pub(crate) psi: &'a [f64],
    /// Normalised surface `xi`.
    pub(crate) xi: f64,
    /// `v = psi C psi^T`.
    pub(crate) v: f64,
    /// `nn = sqrt(1 + v)`.
    pub(crate) nn: f64,
}

/// The input that the outputs see at the end of an interval.
pub(crate) fn output_input<I: Copy, const N: usize, const R: usize, const P: usize>(
    settings: &SmpeSettings<N, R, P>,
    previous: I,
    current: I,
) -> I {
    match settings.output_input {
        OutputInput::Current => current,
        OutputInput::Previous => previous,
    }
}
