//! The result of an estimation: plain data to print, plot, save and compare.

use std::fmt;

use phugoid_flight_data::channels::by_name;
use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use serde::{Deserialize, Serialize};

pub use phugoid_estimators::verdict::Readiness;
pub use phugoid_estimators::{ChangeState, ParameterStatus, Phase};

use super::method::Method;
use crate::batch::{Equation, OutputFit, Unknown};

/// What the flight made of a parameter by the end of the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FinalStatus {
    /// The bound is a small part of what was known beforehand, and nothing in the residuals speaks against the value.
    Converged,
    /// The bound is shrinking and not yet small: more excitation would help.
    Improving,
    /// The flight said almost nothing about it: the bound is that of the prior.
    NotExcited,
    /// It rests on one of its declared limits, which exclude what the data say.
    AtLimit,
    /// The bound is small, but the model contradicts the flight, so that the value must not be used.
    InDoubt,
    /// Not estimated: the model file gives its value.
    Fixed,
}

impl FinalStatus {
    /// Its word in results: that of its serialised form, e.g. `not_excited`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Improving => "improving",
            Self::NotExcited => "not_excited",
            Self::AtLimit => "at_limit",
            Self::InDoubt => "in_doubt",
            Self::Fixed => "fixed",
        }
    }
}

impl fmt::Display for FinalStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

impl From<ParameterStatus> for FinalStatus {
    fn from(status: ParameterStatus) -> Self {
        match status {
            ParameterStatus::NotExcited => Self::NotExcited,
            ParameterStatus::Improving => Self::Improving,
            ParameterStatus::Converged => Self::Converged,
            ParameterStatus::AtLimit => Self::AtLimit,
        }
    }
}

/// What happened at one instant of an estimation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// A change of the parameters is suspected; bounds are widened until it is decided.
    InDoubt,
    /// A change was adopted. Results of older versions say `re_reached`.
    #[serde(alias = "re_reached")]
    Adopted,
    /// The suspicion was dropped.
    DoubtDropped,
    /// Model error hides small changes from here on.
    Insensitive,
    /// No sample for longer than is predicted through.
    Gap,
    /// The state was started again from the measurements.
    Restarted,
}

impl EventKind {
    /// Its word in results: that of its serialised form, e.g. `doubt_dropped`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::InDoubt => "in_doubt",
            Self::Adopted => "adopted",
            Self::DoubtDropped => "doubt_dropped",
            Self::Insensitive => "insensitive",
            Self::Gap => "gap",
            Self::Restarted => "restarted",
        }
    }

    /// True for what the change detector says.
    pub const fn is_of_detector(self) -> bool {
        matches!(self, Self::InDoubt | Self::Adopted | Self::DoubtDropped | Self::Insensitive)
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// The final word on one parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterResult {
    /// Name from the model file, e.g. `Cm_alpha` or `dCm_alpha`.
    pub name: String,
    /// Unit as printed: `per rad`, `-`; that of the sensor for a bias. Empty where an older version wrote the result.
    #[serde(default)]
    pub unit: String,
    /// Estimate at the end of the record, per radian where an angle is involved.
    pub value: f64,
    /// One-sigma error claimed by the covariance.
    pub std_error: f64,
    /// One-sigma error corrected for the colour of the residuals; this one makes the bounds.
    pub corrected_std_error: f64,
    /// `value - 2 corrected_std_error`.
    pub lower: f64,
    /// `value + 2 corrected_std_error`.
    pub upper: f64,
    /// What the flight made of it.
    pub status: FinalStatus,
    /// First time after which the estimate stays within 5 % of its final value, or of the truth where that is known, s
    /// from the start of the record; none if it is not reached or the parameter was not excited.
    pub converged_at_s: Option<f64>,
    /// Observability, `1 - variance / prior variance`.
    pub observability: f64,
    /// Start value.
    pub initial: f64,
    /// Prior one-sigma.
    pub prior_std: f64,
    /// Declared lower and upper bounds, if any.
    pub bounds: Option<[f64; 2]>,
    /// The true value, where the flight was simulated.
    pub truth: Option<f64>,
    /// True for sensor bias columns and other parameters that only support the others.
    pub nuisance: bool,
    /// May it be believed, and what would help? None for a fixed parameter and for methods that look at the record as a
    /// whole.
    #[serde(default)]
    pub readiness: Option<ParameterReadiness>,
}

/// May a parameter be believed at the end of the record?
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterReadiness {
    /// Whether the value can be used.
    pub verdict: Readiness,
    /// Why, in words.
    pub reason: String,
    /// What input would help, in words; none where an input would not.
    pub advice: Option<String>,
    /// Since when it has been ready without a break, s; none if it is not.
    pub ready_since_s: Option<f64>,
    /// Bound over prior, one sigma each.
    pub bound_over_prior: f64,
    /// The same if all other parameters were known: what the excitation of this regressor alone gives.
    pub excitation: f64,
    /// Variance inflation factor: variance with the others unknown over that with the others known.
    pub variance_inflation: f64,
    /// The parameters that it is most correlated with (beyond 0.7), and the correlations.
    pub correlated_with: Vec<(String, f64)>,
}

/// A named signal with its unit, one value per time of the estimation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Signal {
    /// Canonical name, e.g. `alpha`.
    pub name: String,
    /// SI unit as printed, e.g. `rad`, `m/s`, or `-`.
    pub unit: String,
    /// Values; NaN where missing.
    pub values: Vec<f64>,
}

/// Parameter against time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterHistory {
    /// Name as in [`ParameterResult::name`].
    pub name: String,
    /// Estimate after each sample.
    pub value: Vec<f64>,
    /// Corrected one-sigma error after each sample.
    pub std_error: Vec<f64>,
    /// Surface per parameter for display: `theta_LS - theta`, in parameter units.
    pub surface: Vec<f64>,
}

/// What happened at one instant of the estimation: a change suspected or adopted, a gap, a restart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// When, s.
    pub time_s: f64,
    /// What kind of event.
    pub kind: EventKind,
    /// In words.
    pub message: String,
}

/// Histories over the samples of the record, all of the length of `time_s`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Known inputs as used.
    pub inputs: Vec<Signal>,
    /// Measured outputs.
    pub measured: Vec<Signal>,
    /// The estimated model's outputs before the correction by the same sample (one-step prediction).
    pub predicted: Vec<Signal>,
    /// Whitened residuals, one sigma = 1, one signal per output.
    pub residuals: Vec<Signal>,
    /// Parameters.
    pub parameters: Vec<ParameterHistory>,
    /// How the estimator met each sample.
    pub phase: Vec<Phase>,
}

impl History {
    /// As a record to be written as CSV: inputs and measured outputs under their names, `<output>_predicted`,
    /// `<output>_residual` (one sigma = 1), and each parameter with `<parameter>_std`, the corrected one-sigma error.
    pub fn record(&self, source: &str) -> Record {
        let quantity = |name: &str| by_name(name).map_or(Quantity::Number, |spec| spec.quantity);
        let channel =
            |name: String, quantity: Quantity, values: &[f64]| Channel { name, quantity, values: values.to_vec() };
        let plain = |s: &Signal| channel(s.name.clone(), quantity(&s.name), &s.values);
        let mut channels: Vec<Channel> = self.inputs.iter().chain(&self.measured).map(plain).collect();
        channels.extend(
            self.predicted.iter().map(|s| channel(format!("{}_predicted", s.name), quantity(&s.name), &s.values)),
        );
        let residual = |s: &Signal| channel(format!("{}_residual", s.name), Quantity::Number, &s.values);
        channels.extend(self.residuals.iter().map(residual));
        for parameter in &self.parameters {
            channels.push(channel(parameter.name.clone(), Quantity::Number, &parameter.value));
            channels.push(channel(format!("{}_std", parameter.name), Quantity::Number, &parameter.std_error));
        }
        Record { source: source.to_owned(), time: self.time_s.clone(), channels, ..Record::default() }
    }
}

/// Everything one run of one estimator on one record gives.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimation {
    /// Record (file name or scenario).
    pub source: String,
    /// Model file or its built-in name.
    pub model: String,
    /// Method used.
    pub method: Method,
    /// Parameters in the model's order, nuisance columns last.
    pub parameters: Vec<ParameterResult>,
    /// Correlation matrix of the parameters, same order.
    pub correlation: Vec<Vec<f64>>,
    /// Sums of derivatives that the flight determines although it may not tell the parts apart.
    #[serde(default)]
    pub effective: Vec<EffectiveDerivative>,
    /// Angle of attack at which the terms' `alpha` is zero, rad: where derivatives are turned into other axes.
    #[serde(default)]
    pub alpha_reference: f64,
    /// Terms that the residuals ask for; none where nobody asked, or there was no reason to look.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offer: Option<Offer>,
    /// Sentences for the user: verdict, pairs that cannot be told apart, unit doubts, model error.
    pub verdict: Vec<String>,
    /// Events in order of time.
    pub events: Vec<Event>,
    /// Data quality of the record.
    pub quality: QualityReport,
    /// Measurement noise used per output, SI: name, unit, one sigma (one value each).
    pub noise: Vec<Signal>,
    /// Histories. Of a batch method: the fitted outputs as predictions, the parameters constant.
    pub history: History,
    /// What a batch method says beside; none for a causal one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub batch: Option<BatchReport>,
}

/// What a batch method says beside the parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BatchReport {
    /// Iterations to the minimum.
    pub iterations: usize,
    /// Negative logarithm of the likelihood there, without constants: for comparing models on the same record.
    pub cost: f64,
    /// One sigma of the noise by output, given or estimated; of equation error: of the equations. NaN where not measured.
    pub noise_std: Vec<f64>,
    /// What was estimated beside the parameters and biases: initial states, noise.
    pub unknowns: Vec<Unknown>,
    /// Fit by manoeuvre and output: this record first, then the others that were fitted with it.
    pub manoeuvres: Vec<(String, Vec<OutputFit>)>,
    /// Equations with their terms, from equation error.
    pub equations: Vec<Equation>,
    /// The parameters tried on another record.
    pub prediction: Option<Prediction>,
    /// What should be known before the numbers are used.
    pub notes: Vec<String>,
}

/// The estimated parameters tried on a record that they have not seen: simulated with their values held, only the initial
/// state and the sensor biases fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// The record.
    pub source: String,
    /// Agreement by output.
    pub fit: Vec<OutputFit>,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Measured outputs.
    pub measured: Vec<Signal>,
    /// Predicted outputs.
    pub predicted: Vec<Signal>,
}

impl Estimation {
    /// The result for the parameter of this name, for example `Cm_alpha`; none if the model has no such parameter.
    pub fn parameter(&self, name: &str) -> Option<&ParameterResult> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}

impl ParameterResult {
    /// Two standard errors, corrected for the correlation of the residuals from sample to sample, in the parameter's unit: the
    /// value lies between [`lower`](Self::lower) and [`upper`](Self::upper) with a probability of about 95 %.
    pub fn bound(&self) -> f64 {
        2.0 * self.corrected_std_error
    }
}

/// A sum of two derivatives that a flight determines although it may not tell them apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectiveDerivative {
    /// E.g. `Cm_q + Cm_alpha_dot`.
    pub name: String,
    /// Its value, per radian.
    pub value: f64,
    /// One-sigma error, corrected for the colour of the residuals.
    pub std_error: f64,
    /// The parts.
    pub parts: [String; 2],
    /// Correlation of their errors.
    pub correlation: f64,
    /// True if the flight told the parts apart, so that each may be believed by itself.
    pub separable: bool,
}

/// What came of trying terms that the model does not have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offer {
    /// Why terms were tried, in words; empty where they were asked for without a reason.
    pub reasons: Vec<String>,
    /// Estimator that they were tried with.
    pub method: Method,
    /// Gain from which a term is asked for, nats.
    pub threshold: f64,
    /// Changes that the detector adopts with the model as it is.
    pub adopted_changes: usize,
    /// The terms tried, the largest gain first.
    pub terms: Vec<OfferedTerm>,
}

impl Offer {
    /// The term that the residuals ask for most, if they ask for any.
    pub fn best(&self) -> Option<&OfferedTerm> {
        self.terms.iter().find(|term| term.asked_for)
    }
}

/// A term that the model does not have, tried in a model of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OfferedTerm {
    /// Symbol of the coefficient, e.g. `Cm`.
    pub coefficient: String,
    /// As a model file writes it, e.g. `alpha^2`.
    pub term: String,
    /// Name of its parameter, e.g. `dCm_alpha2`.
    pub parameter: String,
    /// Logarithm of how much more probable the flight is with the term than without, nats; both without change detection.
    pub gain: f64,
    /// The same with change detection in both; none where the first gain was too small to look. Where a change of the parameters
    /// explains the flight as well, nothing is gained here.
    pub gain_with_changes: Option<f64>,
    /// Estimate at the end of the record, per radian to the power of the term.
    pub value: f64,
    /// One-sigma error, corrected for the colour of the residuals.
    pub std_error: f64,
    /// Changes that the detector still adopts with the term in the model; none where that was not looked at.
    pub adopted_changes: Option<usize>,
    /// Both gains reach the threshold, the estimate lies three standard errors from zero, and fewer changes are adopted, if any
    /// were.
    pub asked_for: bool,
    /// What gave a reason to try terms and is still there with this one, in words; empty where that was not looked at.
    pub remaining: Vec<String>,
    /// The line to put under `[coefficients]`.
    pub coefficient_line: String,
    /// The line to put under `[parameters]`.
    pub parameter_line: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The words that results, recordings and other programs know: they do not change with the names in the code.
    #[test]
    fn results_keep_their_words() {
        for status in [
            FinalStatus::Converged,
            FinalStatus::Improving,
            FinalStatus::NotExcited,
            FinalStatus::AtLimit,
            FinalStatus::InDoubt,
            FinalStatus::Fixed,
        ] {
            assert_eq!(serde_json::to_string(&status).unwrap(), format!("\"{status}\""));
        }
        for phase in
            [Phase::Starting, Phase::Sliding, Phase::Reaching, Phase::Rejected, Phase::Predicting, Phase::Diverged]
        {
            assert_eq!(serde_json::to_string(&phase).unwrap(), format!("\"{phase}\""));
        }
        for verdict in [Readiness::Ready, Readiness::Improving, Readiness::NotIdentifiable, Readiness::Doubtful] {
            assert_eq!(serde_json::to_string(&verdict).unwrap(), format!("\"{verdict}\""));
        }
        for method in Method::ALL {
            assert_eq!(serde_json::to_string(method).unwrap(), format!("\"{method}\""));
        }
        let words = ["in_doubt", "adopted", "doubt_dropped", "insensitive", "gap", "restarted"];
        for word in words {
            let kind: EventKind = serde_json::from_str(&format!("\"{word}\"")).unwrap();
            assert_eq!(kind.word(), word);
        }
        // What versions before 0.2 wrote.
        assert_eq!(serde_json::from_str::<EventKind>("\"re_reached\"").unwrap(), EventKind::Adopted);
        assert_eq!(serde_json::from_str::<ChangeState>("\"re_reached\"").unwrap(), ChangeState::Adopted);
    }
}
