//! Residuals of the rows of one frame, and their predicted size, before the frame corrected the estimate.

/// How one output row was used.
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
    /// How each row was used.
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

/// An output row before it is used: its residual and how the parameters enter it.
pub(crate) struct ScoredRow<'a> {
    /// Index of the output that the row belongs to.
    pub(crate) output: usize,
    /// Whitened sensitivity `psi`, columns scaled to the prior standard deviation.
    pub(crate) psi: &'a [f64],
    /// Normalised surface `xi`: residual over its whole predicted standard deviation.
    pub(crate) xi: f64,
    /// `v = psi C psi^T`.
    pub(crate) v: f64,
    /// `nn = sqrt(1 + v)`.
    pub(crate) nn: f64,
}
