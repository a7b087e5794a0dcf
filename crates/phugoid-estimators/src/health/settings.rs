//! Settings of the health monitor: the expected parameters with tolerances, and the accepted rate of false alarms.

use core::fmt;

/// What is expected of one parameter of a healthy plant. Parameter units throughout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Expected value, parameter units.
    pub value: f64,
    /// Half width about it within which the parameter still counts as healthy.
    pub tolerance: f64,
    /// One sigma of what a failure would change: the alternative that the monitor tests against. A failure of another
    /// size is found too, a little later.
    pub failure_std: f64,
    /// A constant (trim, an offset) and no derivative: it moves with load, a tab or an asymmetry without any damage. Where
    /// changed constants explain all that is seen, they are named and no derivative is.
    pub constant: bool,
}

/// Settings of the health monitor: the accepted rate of false alarms and a few times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorSettings {
    /// False alarms per flight hour that are accepted, 1/h. A healthy flight of `T` hours raises one with a probability
    /// of at most `T` times this.
    pub false_alarms_per_hour: f64,
    /// Monitoring begins this long after the first sample, s: the noise levels are looked at first.
    pub settle_s: f64,
    /// Oldest onset that is looked for, s before now.
    pub horizon_s: f64,
    /// How long after the flag the onset is still refined, s.
    pub refinement_s: f64,
    /// Variance of the innovations along the monitored parameters, over what the noise levels in use make of it, that is
    /// assumed until the flight shows another: one for a model and noise levels that are known.
    pub scatter: f64,
    /// Degrees of freedom (moved parameters times blocks of two seconds) that this assumption is worth.
    pub scatter_weight: f64,
}

impl Default for MonitorSettings {
    fn default() -> Self {
        Self {
            false_alarms_per_hour: 0.01,
            settle_s: 2.0,
            horizon_s: 60.0,
            refinement_s: 0.5,
            scatter: 1.0,
            scatter_weight: 10.0,
        }
    }
}

impl MonitorSettings {
    pub(super) fn check(&self) -> Result<(), MonitorError> {
        let positive = [
            ("false_alarms_per_hour", self.false_alarms_per_hour),
            ("horizon_s", self.horizon_s),
            ("scatter", self.scatter),
            ("scatter_weight", self.scatter_weight),
        ];
        for (name, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(MonitorError::Setting { name, value });
            }
        }
        for (name, value) in [("settle_s", self.settle_s), ("refinement_s", self.refinement_s)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(MonitorError::Setting { name, value });
            }
        }
        if self.false_alarms_per_hour * self.horizon_s >= 3600.0 {
            return Err(MonitorError::RateTooHigh { largest: 3600.0 / self.horizon_s });
        }
        Ok(())
    }
}

/// Why a monitor cannot be set up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MonitorError {
    /// An expectation has an impossible value.
    Expected {
        /// Index of the parameter in the model.
        parameter: usize,
        /// Name of the number that is wrong: value, tolerance or failure_std.
        name: &'static str,
        /// The value that was refused.
        value: f64,
    },
    /// A setting has an impossible value.
    Setting {
        /// Name of the setting that is wrong.
        name: &'static str,
        /// The value that was refused.
        value: f64,
    },
    /// More than one false alarm within the horizon would be accepted: then no evidence is needed for an alarm.
    RateTooHigh {
        /// Rates below this one are possible, 1/h.
        largest: f64,
    },
    /// No parameter has an expectation.
    NothingExpected,
    /// The settings of the estimator do not fit the model.
    Estimator(crate::settings::SettingsError),
}

impl fmt::Display for MonitorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Expected { parameter, name, value } => write!(
                f,
                "parameter {parameter}: expected {name} cannot be {value}: the value must be finite, tolerance and \
                 failure_std finite and more than zero"
            ),
            Self::Setting { name, value } => write!(f, "setting {name} of the monitor cannot be {value}"),
            Self::RateTooHigh { largest } => write!(
                f,
                "the accepted rate of false alarms has to be below {largest} per hour: at a higher one no evidence is \
                 needed for an alarm"
            ),
            Self::NothingExpected => write!(f, "no parameter has an expected value: nothing to monitor"),
            Self::Estimator(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for MonitorError {}
