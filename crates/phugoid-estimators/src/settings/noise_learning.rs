//! How noise levels are learnt: their start and their floor, and what another run has learnt of them.

use super::SettingsError;

/// Largest number of states of which the process noise has a scale of its own.
pub const SCALES: usize = 6;

/// How the noise levels of the outputs and the process noise of the states are learnt in flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseLearning<const N: usize, const R: usize> {
    /// One sigma of the white noise of each output, output units: of its third differences
    /// ([`crate::noise::third_difference_std`]), never below its smallest step over the root of 12. A level is not
    /// learnt to be less than half of it. Zero where it is not known.
    pub white_std: [f64; R],
    /// Where the scale of each state's process noise begins, as a factor on
    /// [`ProcessNoise::variance_per_s`](crate::settings::ProcessNoise::variance_per_s). Rather too large than too small:
    /// process noise that is small beside the noise of the sensors leaves hardly a trace of how small it is. Of no use
    /// for a state without process noise, for those behind the first [`SCALES`] with it, which keep theirs, and where the
    /// process noise does not adapt: there levels alone are learnt.
    pub first_scale: [f64; N],
    /// Lowest and highest scale, as a factor on the first.
    pub limits: [f64; 2],
    /// States whose process noise stands for what the model lacks rather than for gusts: once the parameters are known, it
    /// rises by a factor of e in 20 s at most, so that a sudden change of the aircraft is found before it is taken for that.
    pub slow: [bool; N],
    /// States whose process noise has one common scale, which begins where that of the first of them does: gusts of one
    /// turbulence move airspeed and flow angles alike.
    pub shared: [bool; N],
    /// What an earlier run over the same flight has learnt, and until when, s of the time of the samples, it is used as
    /// it is. From then on learning goes on from it.
    pub known: Option<(LearntLevels<R>, f64)>,
}

impl<const N: usize, const R: usize> NoiseLearning<N, R> {
    /// Learning from the start values in
    /// [`EstimatorSettings::noise_std`](crate::settings::EstimatorSettings::noise_std) and from the process noise given,
    /// within a factor of a hundred thousand below and ten thousand above it.
    pub fn from_white(white_std: [f64; R]) -> Self {
        Self {
            white_std,
            first_scale: [1.0; N],
            limits: [1e-5, 1e4],
            slow: [false; N],
            shared: [false; N],
            known: None,
        }
    }

    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let right = |value: &f64| value.is_finite() && *value > 0.0;
        if let Some(value) = self.first_scale.iter().find(|scale| !right(scale)) {
            return Err(SettingsError::Setting { name: "noise_learning.first_scale", value: *value });
        }
        let [lowest, highest] = self.limits;
        for (value, is_right) in [(lowest, lowest <= 1.0), (highest, highest >= 1.0)] {
            if !(right(&value) && is_right) {
                return Err(SettingsError::Setting { name: "noise_learning.limits", value });
            }
        }
        Ok(())
    }
}

/// What has been learnt of the noise levels and of the scales of the process noise. It has no meaning beyond the settings
/// with which it was learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearntLevels<const R: usize> {
    /// Variance of the residual per output, output units squared.
    pub(crate) variance: [f64; R],
    /// Logarithm of each scale of the process noise, of those that are learnt, in the order of the states.
    pub(crate) log_scale: [f64; SCALES],
}

impl<const R: usize> LearntLevels<R> {
    /// Largest ratio, one or more, of a scale of the process noise to the same of another time.
    pub fn largest_scale_ratio(&self, other: &Self) -> f64 {
        let apart = self.log_scale.iter().zip(&other.log_scale).map(|(a, b)| (a - b).abs());
        libm::exp(apart.fold(0.0, f64::max))
    }
}
