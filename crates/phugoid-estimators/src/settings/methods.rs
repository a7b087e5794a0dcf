//! Settings that one method has of its own. They stand in [`EstimatorSettings`](super::EstimatorSettings), so that
//! every method is set up from one value and comparisons are fair.

use super::SettingsError;

/// Settings of the joint extended Kalman filter ([`ekf`](crate::ekf)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EkfSettings<const P: usize> {
    /// A row whose innovation is more than this many of its predicted standard deviations is not used. Greater than
    /// zero, may be infinite. The rule is 4: one row in 16,000 of a normal distribution is refused.
    pub gate: f64,
    /// Random walk of each parameter, (parameter unit)^2/s: the classical alternative to re-initialisation after a
    /// detected change. Zero for constant parameters. Biases do not walk.
    pub parameter_walk_per_s: [f64; P],
}

impl<const P: usize> Default for EkfSettings<P> {
    fn default() -> Self {
        Self { gate: 4.0, parameter_walk_per_s: [0.0; P] }
    }
}

impl<const P: usize> EkfSettings<P> {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        if self.gate.is_nan() || self.gate <= 0.0 {
            return Err(SettingsError::Setting { name: "gate", value: self.gate });
        }
        match self.parameter_walk_per_s.into_iter().find(|walk| !(walk.is_finite() && *walk >= 0.0)) {
            Some(value) => Err(SettingsError::Setting { name: "parameter_walk_per_s", value }),
            None => Ok(()),
        }
    }
}

/// Settings of the methods that solve a regression ([`regression`](crate::regression)).
///
/// Of the shared settings these methods take priors, noise levels, biases, input, start and gaps. The sliding limits,
/// the process noise (a state source may use it) and change detection are not used. The blocks of the colour correction
/// are at least one second long, because the residuals of a regression stay correlated for about that time.
///
/// A bias column stands for a constant offset of an output that sees the parameters directly (an accelerometer). The
/// bias of a measured *state* shifts the regressors and is no column of a regression: such a column keeps its prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegressionSettings {
    /// `w`, rad/s: corner of the filter that spares differentiating the states. A low corner lets less noise through;
    /// with a high one errors of the regressors are forgotten sooner. The rule is 8 rad/s: with 4
    /// the slow errors of angle of attack and speed, and what the model lacks, outweigh the manoeuvres of light aircraft
    /// (docs/field.md), and the errors of the F-16's moment derivatives are 5 to 9 % larger; with 12 their bounds are 40 %
    /// wider, and the errors the same.
    pub filter_rate: f64,
    /// `lambda`, 1/s: information older than `1/lambda` fades. Zero, the rule, for constant parameters.
    pub forgetting_per_s: f64,
    /// A measurement further than this many learnt standard deviations from its prediction counts as an outlier. The
    /// rule is 6; infinite for no such test.
    pub outlier_limit: f64,
    /// Whether that test allows for what the parameters do not know yet of the motion over one interval, and uses a
    /// channel that it has refused for a quarter of a second until its prediction fits again. Without it (the rule) a
    /// channel is used once in a quarter of a second where the first parameters predict too little: on a stabilised fighter
    /// for up to 29 s (docs/field.md). The methods of the pipeline have it.
    pub reopens: bool,
}

impl Default for RegressionSettings {
    fn default() -> Self {
        Self { filter_rate: 8.0, forgetting_per_s: 0.0, outlier_limit: 6.0, reopens: false }
    }
}

impl RegressionSettings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
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

/// Most frequencies that a Fourier regression has room for.
pub const MAXIMUM_BINS: usize = 32;

/// Settings of the recursive Fourier regression ([`fourier`](crate::fourier)). It also uses [`RegressionSettings`],
/// without their filter rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourierSettings {
    /// Lowest and highest frequency, Hz. The highest has to be below half the sample rate. The rule is 0.2 to 2 Hz.
    /// (From 0.1 to 1.5 Hz the F-16's moment derivatives are half again as wrong, because the smoothed states err
    /// slowly.)
    pub band_hz: [f64; 2],
    /// Number of frequencies, evenly over the band; 1 to [`MAXIMUM_BINS`]. The rule is 29.
    pub bins: usize,
    /// Time between two solutions of the least squares, s. The rule is 0.1 s; zero solves at every sample.
    pub solve_interval_s: f64,
    /// Whether the states at both ends of the record enter the transforms of their derivatives. Right is `true`;
    /// `false` shows what leaving them out does to a record that does not end as it began.
    pub end_point: bool,
}

impl Default for FourierSettings {
    fn default() -> Self {
        Self { band_hz: [0.2, 2.0], bins: 29, solve_interval_s: 0.1, end_point: true }
    }
}

impl FourierSettings {
    /// The frequency of a bin, Hz.
    pub fn frequency_hz(&self, bin: usize) -> f64 {
        let [low, high] = self.band_hz;
        if self.bins < 2 { low } else { low + (high - low) * bin as f64 / (self.bins - 1) as f64 }
    }

    pub(crate) fn check(&self, sample_time_s: f64) -> Result<(), SettingsError> {
        let [low, high] = self.band_hz;
        for (name, value, right) in [
            ("band_hz", low, low > 0.0 && low.is_finite()),
            ("band_hz", high, high >= low && high * sample_time_s < 0.5),
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
