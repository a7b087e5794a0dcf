//! Noise levels and the size of the process noise, learnt in flight.
//!
//! What a filter has to be told of an output is the size of its residual: the noise of the sensor, and filters,
//! calibration, lag and model error as well. It can be many times the white noise of the channel. How much of a residual
//! is process noise (gusts) and how much is measurement noise cannot be told from the *size* of the innovations: in the
//! steady state there are as many sizes as outputs and one more unknown. It can be told from their *colour*, and the
//! likelihoods of filters that have really run with different process noise contain it. So a few cheap filters for the
//! state alone run beside the estimator, each with its own scale of the process noise and its own
//! noise levels; their likelihoods weigh them, and the estimator uses the weighted levels. docs/theory.md derives it.

mod bank;
mod in_use;

pub use crate::settings::{LearntLevels, NoiseLearning, SHADOWS};
pub(crate) use bank::Frame;
pub(crate) use in_use::Levels;

/// The noise levels that an estimator uses at present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseReport<const R: usize> {
    /// One sigma of the residual per output, output units; as given for an output that is not used.
    pub std: [f64; R],
    /// Scale `q_s` of the process noise.
    pub process_noise_scale: f64,
    /// What has been learnt so far, from which another run over the same flight can start; `None` where the levels are
    /// as given and not learnt.
    pub learnt: Option<LearntLevels<R>>,
}
