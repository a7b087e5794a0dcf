//! What the Fourier regression is told before the first sample.

use crate::regression::RegressionSettings;
use crate::settings::{EstimatorSettings, SettingsError};

/// Most frequencies.
pub const MAXIMUM_BINS: usize = 32;

/// Settings of the recursive Fourier regression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourierSettings<const N: usize, const R: usize, const P: usize> {
    /// Priors, noise, timing, forgetting and the outlier gate. Its filter rate is not used.
    pub regression: RegressionSettings<N, R, P>,
    /// Lowest and highest frequency, Hz.
    pub band_hz: [f64; 2],
    /// Number of frequencies, evenly over the band; 1 to [`MAXIMUM_BINS`].
    pub bins: usize,
    /// Least squares is solved this often, s.
    pub solve_interval_s: f64,
    /// Whether the states at both ends of the record enter the transforms of their derivatives. Right is `true`; `false` shows what
    /// leaving them out does to a record that does not end as it began.
    pub end_point: bool,
}

impl<const N: usize, const R: usize, const P: usize> FourierSettings<N, R, P> {
    /// With the priors, noise levels and timing of the flagship: 29 frequencies from 0.2 to 2 Hz, solved ten times a second.
    /// (From 0.1 to 1.5 Hz the F-16's moment derivatives are half again as wrong: the smoothed states err slowly.)
    pub fn with(common: EstimatorSettings<N, R, P>) -> Self {
        Self {
            regression: RegressionSettings::with(common),
            band_hz: [0.2, 2.0],
            bins: 29,
            solve_interval_s: 0.1,
            end_point: true,
        }
    }

    /// The frequency of a bin, Hz.
    pub fn frequency_hz(&self, bin: usize) -> f64 {
        let [low, high] = self.band_hz;
        if self.bins < 2 { low } else { low + (high - low) * bin as f64 / (self.bins - 1) as f64 }
    }

    pub(super) fn check(&self) -> Result<(), SettingsError> {
        let [low, high] = self.band_hz;
        for (name, value, right) in [
            ("band_hz", low, low > 0.0 && low.is_finite()),
            ("band_hz", high, high >= low && high * self.regression.common.sample_time_s < 0.5),
            ("bins", self.bins as f64, (1..=MAXIMUM_BINS).contains(&self.bins)),
            ("solve_interval_s", self.solve_interval_s, self.solve_interval_s >= 0.0),
        ] {
            if !right {
                return Err(SettingsError::Setting { name, value });
            }
        }
        Ok(())
    }
}
