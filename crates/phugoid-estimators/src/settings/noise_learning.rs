//! How noise levels are learnt: their start and their floor, and what another run has learnt of them.

use super::SettingsError;

/// Number of shadows.
pub const SHADOWS: usize = 6;

/// How the noise levels of the outputs and the scale of the process noise are learnt in flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseLearning<const R: usize> {
    /// One sigma of the white noise of each output, output units: of its third differences
    /// ([`crate::noise::third_difference_std`]), never below its smallest step over the root of 12. A level is not
    /// learnt to be less than half of it. Zero where it is not known.
    pub white_std: [f64; R],
    /// Scales of the process noise of the shadows, as factors on
    /// [`ProcessNoise::variance_per_s`](crate::settings::ProcessNoise::variance_per_s), in increasing order. Only the
    /// first is used, and learnt levels alone, where the process noise does not adapt.
    pub scales: [f64; SHADOWS],
    /// What an earlier run over the same flight has learnt, and until when, s of the time of the samples, it is used as
    /// it is. From then on the shadows go on from it.
    pub known: Option<(LearntLevels<R>, f64)>,
}

impl<const R: usize> NoiseLearning<R> {
    /// Learning from the start values in
    /// [`EstimatorSettings::noise_std`](crate::settings::EstimatorSettings::noise_std), with shadows a decade apart
    /// about the process noise given.
    pub fn from_white(white_std: [f64; R]) -> Self {
        Self { white_std, scales: [1e-5, 1e-3, 1e-2, 1e-1, 1.0, 10.0], known: None }
    }

    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let right = |value: &f64| value.is_finite() && *value > 0.0;
        match self.scales.iter().find(|scale| !right(scale)) {
            Some(value) => Err(SettingsError::Setting { name: "noise_learning.scales", value: *value }),
            None => Ok(()),
        }
    }
}

/// What has been learnt of the noise levels and of the scale of the process noise: the levels of each shadow and how
/// well it explains the flight. It has no meaning beyond the settings with which it was learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearntLevels<const R: usize> {
    /// Variance of the residual per shadow and output, output units squared.
    pub(crate) variance: [[f64; R]; SHADOWS],
    /// Log likelihood of each shadow, nats, up to a constant.
    pub(crate) evidence: [f64; SHADOWS],
    /// Information about the logarithm of each level.
    pub(crate) information: [[f64; R]; SHADOWS],
    /// Time since the first frame, s.
    pub(crate) elapsed_s: f64,
}
