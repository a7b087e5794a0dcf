//! What the regression methods are told before the first sample.

use crate::settings::{EstimatorSettings, ParameterPrior, SettingsError};

/// Settings of the regression methods. [`Self::automatic`] fills them by rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegressionSettings<const N: usize, const R: usize, const P: usize> {
    /// Priors, noise, biases, input and gaps, as the flagship takes them, so that comparisons are fair. Of the rest these are
    /// not used: the sliding limits, the process noise and its adaptation (a state source may), change detection.
    ///
    /// A bias column stands for a constant offset of an output that sees the parameters directly (an accelerometer). The bias
    /// of a measured *state* shifts the regressors and is no column of a regression: such a column keeps its prior.
    pub common: EstimatorSettings<N, R, P>,
    /// `w`, rad/s: corner of the filter that spares differentiating the states. Low: less noise; high: errors of the
    /// regressors are forgotten sooner.
    pub filter_rate: f64,
    /// `lambda`, 1/s: information older than `1/lambda` fades. Zero: constant parameters.
    pub forgetting_per_s: f64,
    /// A measurement further than this many learnt sigmas from its prediction is taken for an outlier; infinite: none is.
    pub outlier_limit: f64,
}

impl<const N: usize, const R: usize, const P: usize> RegressionSettings<N, R, P> {
    /// The automatic rule, see [`EstimatorSettings::automatic`] and [`Self::with`].
    ///
    /// # Errors
    /// [`SettingsError`]: what cannot be, and which.
    pub fn automatic(
        priors: &[ParameterPrior],
        noise_std: [f64; R],
        sample_time_s: f64,
    ) -> Result<Self, SettingsError> {
        Ok(Self::with(EstimatorSettings::automatic(priors, noise_std, sample_time_s)?))
    }

    /// With the priors, noise levels and timing of the flagship: filter at 4 rad/s (between 3 and 6 the F-16's moment derivatives
    /// change by 15 %), no forgetting, outliers from six sigmas on, and blocks of at least a second for the colour of the
    /// residuals, whose correlation lasts that long.
    pub fn with(common: EstimatorSettings<N, R, P>) -> Self {
        let common = EstimatorSettings { colour_block_s: common.colour_block_s.max(1.0), ..common };
        Self { common, filter_rate: 4.0, forgetting_per_s: 0.0, outlier_limit: 6.0 }
    }

    /// Checks the settings for a model with `parameters` parameters.
    pub(crate) fn check(&self, parameters: usize) -> Result<(), SettingsError> {
        if parameters > P {
            return Err(SettingsError::Capacity { needed: parameters, capacity: P });
        }
        self.common.check(parameters)?;
        let right = |value: f64, least: bool| value.is_finite() && (value > 0.0 || least && value == 0.0);
        for (name, value, fits) in [
            ("filter_rate", self.filter_rate, right(self.filter_rate, false)),
            ("forgetting_per_s", self.forgetting_per_s, right(self.forgetting_per_s, true)),
            ("outlier_limit", self.outlier_limit, self.outlier_limit > 0.0),
        ] {
            if !fits {
                return Err(SettingsError::Setting { name, value });
            }
        }
        Ok(())
    }
}
