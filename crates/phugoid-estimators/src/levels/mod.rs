//! Noise levels and the size of the process noise, learnt in flight.
//!
//! What a filter has to be told of an output is the size of its residual: the noise of the sensor, and filters,
//! calibration, lag and model error as well. It can be many times the white noise of the channel. How much of a residual
//! is process noise (gusts, and what the model lacks) and how much is measurement noise cannot be told from the *size* of the
//! innovations: in the steady state there are as many sizes as outputs, and more unknowns. It can be told from their *colour*,
//! and the slope of the likelihood contains it, if the effect of each unknown on the filter's gain is followed as well. So a cheap
//! filter for the state alone runs beside the estimator, with its derivatives by each level and scale, and these take a
//! step of Newton's method with each frame. docs/theory.md derives it.

mod frame;
mod in_use;
mod likelihood;

pub use crate::settings::{LearntLevels, NoiseLearning, SCALES};
pub(crate) use frame::Frame;
pub(crate) use in_use::Levels;

/// The noise levels that an estimator uses at present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseReport<const R: usize> {
    /// One sigma of the residual per output, output units; as given for an output that is not used.
    pub std: [f64; R],
    /// What has been learnt so far, from which another run over the same flight can start; `None` where the levels are
    /// as given and not learnt.
    pub learnt: Option<LearntLevels<R>>,
}
