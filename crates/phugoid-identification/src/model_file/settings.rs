//! The settings of a model file for the estimation: process noise, estimator, input between samples.

use crate::core::method::Method;
use crate::core::output::STATE_CHANNELS;

/// The process noise of the states, which stands for gusts and model error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoise {
    /// Spectral densities of the rates of the states, by [`Output::index`](crate::output::Output::index): airspeed
    /// (m^2/s^3), angles (rad^2/s), angular rates (rad^2/s^3). Those that are no states of the axes are not used.
    pub density: [f64; STATE_CHANNELS],
    /// True if a common factor on all densities is estimated from the residuals.
    pub adaptive: bool,
}

/// The table `[estimator]`: settings of the estimator that replace the automatic rule (`docs/tuning.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatorTuning {
    /// The method, unless [`EstimateOptions::method`](crate::options::EstimateOptions::method) gives another one.
    pub method: Method,
    /// `kappa`: up to this normalised surface value a row slides; none for the rule, 3.
    pub reaching_limit: Option<f64>,
    /// Factor on the rule for `kappa2`, `max(6, 2 sqrt(p) + 2)`, beyond which a row is rejected; never below `kappa`.
    pub rejection_scale: f64,
    /// Factor on the start priors of the terms; sudden changes and nuisance columns keep theirs.
    pub prior_scale: f64,
    /// Factor on the process noise that the file gives (with adaptive noise: on its start).
    pub process_noise_scale: f64,
    /// Part of the information about the scale of the process noise that is forgotten per sample; none for the rule,
    /// 0.003. Only where it is adaptive.
    pub adaptation_gain: Option<f64>,
    /// Length of the median start, s; none for the rule, 0.2 s.
    pub start_window_s: Option<f64>,
}

impl Default for EstimatorTuning {
    fn default() -> Self {
        Self {
            method: Method::default(),
            reaching_limit: None,
            rejection_scale: 1.0,
            prior_scale: 1.0,
            process_noise_scale: 1.0,
            adaptation_gain: None,
            start_window_s: None,
        }
    }
}

/// How control surfaces and extra inputs move between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputHold {
    /// They keep the value of the earlier sample, as a digital command does.
    Held,
    /// They move on a straight line to the next sample, as a recorded surface does.
    Interpolated,
    /// One of the two, found from when the aircraft of a record reacts to the surfaces, with their delay; held in a live
    /// session, which cannot look ahead.
    Auto,
}
