//! Health monitoring of an aircraft: its options, and its result as plain data.

use serde::{Deserialize, Serialize};

use crate::model_file::Expectation;

/// What a health monitor compares the aircraft with, and how many false alarms are accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct HealthOptions {
    /// The expected parameters with their tolerances: those of
    /// [`ModelFile::expectations`](crate::model_file::ModelFile::expectations), or of a file of their own.
    pub expected: Vec<Expectation>,
    /// Accepted false alarms per flight hour, 1/h.
    pub false_alarms_per_hour: f64,
}

/// The default of [`HealthOptions::false_alarms_per_hour`]: one false alarm in a hundred flight hours.
pub const FALSE_ALARMS_PER_HOUR: f64 = 0.01;

/// The condition of the aircraft by the health monitor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// The noise levels are still being measured; there is no judgement yet.
    #[default]
    Settling,
    /// No divergence, but too little is known to call the aircraft healthy.
    Unknown,
    /// Every monitored parameter is known better than its tolerance, and is within it as far as is known.
    Healthy,
    /// The aircraft has diverged from what is expected.
    Diverged,
}

impl Condition {
    /// The condition in words, as reports show it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Settling => "settling",
            Self::Unknown => "not enough information",
            Self::Healthy => "healthy",
            Self::Diverged => "diverged",
        }
    }
}

/// The result for one monitored parameter at the end of the record, per radian where an angle is involved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterHealth {
    /// Name of the parameter in the model file.
    pub name: String,
    /// Expected value, in the unit of the parameter.
    pub expected: f64,
    /// Half width that still counts as healthy.
    pub tolerance: f64,
    /// Estimate at the end of the record.
    pub value: f64,
    /// One-sigma error of it, corrected for the colour of the residuals.
    pub corrected_std_error: f64,
    /// How far the estimate lies outside of the tolerance, in corrected standard errors, with its sign; zero inside.
    pub deviation: f64,
    /// False while the bounds are wider than the tolerance.
    pub known: bool,
    /// Time at which the parameter was named as diverged, s; `None` if it was not.
    pub diverged_at_s: Option<f64>,
    /// Change since the onset, from the innovations of the reference alone, linear about the expectation.
    pub change: Option<f64>,
    /// Standard error of [`change`](Self::change).
    pub change_std: Option<f64>,
}

/// A failure that the monitor has flagged: when, since when, and in which parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailureReport {
    /// Time of the sample at which the flag was raised, s.
    pub flagged_at_s: f64,
    /// When it began, s: half of the likelihood lies before.
    pub onset_s: Option<f64>,
    /// 95 % of the likelihood of the onset lies between these, s.
    pub onset_interval_s: Option<[f64; 2]>,
    /// It may have begun before the oldest onset that was looked for.
    pub or_earlier: bool,
    /// Parameters that were named, in the order in which they were.
    pub parameters: Vec<String>,
}

/// Whether the accepted rate of false alarms is promised for a flight, and what was checked on it.
///
/// The promise is a theorem about innovations that are white and have the level in use. Where that was not seen to be so
/// on the flight itself, nothing is promised.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Promise {
    /// Whether the rate is promised.
    pub holds: bool,
    /// Why not, as a part of a sentence; `None` where it is promised.
    pub reason: Option<String>,
    /// Mean square of the reference's normalised innovations, of the output where it is largest; `None` if there were
    /// none. Right noise levels give up to about one.
    pub level: Option<f64>,
    /// Correlation of successive innovations, of the output where its size is largest; white noise has none.
    pub correlation: Option<f64>,
    /// Mean square of what blocks of two seconds say of the monitored parameters, over what white noise would make of
    /// it; `None` if nothing has moved. The evidence allows for it.
    pub scatter: Option<f64>,
    /// Largest scatter with which the rate is promised; `None` if nothing has moved.
    pub largest_scatter: Option<f64>,
}

/// The course of the monitor: one entry per sample.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HealthHistory {
    /// Times of the samples, s.
    pub time_s: Vec<f64>,
    /// Condition of the aircraft after each sample.
    pub condition: Vec<Condition>,
    /// Evidence of a failure, natural logarithm of hours: a healthy aircraft shows this much at most once in
    /// `exp(evidence)` hours, where the rate is promised ([`Promise`]). Minus infinity before the first look; after the flag it stays.
    pub evidence: Vec<f64>,
    /// Squared distance of the estimate from the nearest healthy parameters, in its corrected covariance; NaN where it
    /// cannot be computed.
    pub joint_deviation: Vec<f64>,
    /// As [`ParameterHealth::deviation`], by parameter and sample.
    pub deviation: Vec<Vec<f64>>,
}

/// The result of one run of the health monitor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HealthReport {
    /// Source of the record, e.g. its file name.
    pub source: String,
    /// Name of the model file or of the built-in model.
    pub model: String,
    /// Accepted false alarms per flight hour, 1/h.
    pub false_alarms_per_hour: f64,
    /// Whether that rate is promised for this flight.
    pub promise: Promise,
    /// Evidence at which the flag is raised, natural logarithm of hours.
    pub threshold: f64,
    /// Largest evidence so far, natural logarithm of hours.
    pub evidence: f64,
    /// Condition of the aircraft at the end of the record.
    pub condition: Condition,
    /// The monitored parameters, in the order of [`HealthOptions::expected`].
    pub parameters: Vec<ParameterHealth>,
    /// The failure, if there is one.
    pub failure: Option<FailureReport>,
    /// The result in sentences for the user.
    pub sentences: Vec<String>,
    /// Course of the monitor over the samples.
    pub history: HealthHistory,
}
