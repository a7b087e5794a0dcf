//! The result of an estimation: plain data to print, plot, save and compare.

use std::fmt;

use phugoid_flight_data::channels::by_name;
use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use phugoid_flight_data::statistics::median;
use serde::{Deserialize, Serialize};

pub use phugoid_estimators::verdict::Readiness;
pub use phugoid_estimators::{ChangeState, ParameterStatus, Phase};

use super::method::Method;
use super::options::Opens;
pub use super::soundness::{EstimationStatus, ReasonCode, VerdictReason, headline, is_in_part, status_of};
use super::systematic::in_words;
pub use super::systematic::{LearntQuantity, SystematicPart, UncertainQuantity, UncertaintyUnit};
use crate::batch::{BandUsed, Equation, OutputFit, Unknown};

/// How well a parameter is known at the end of the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FinalStatus {
    /// The bound is small against the prior, and the residuals do not contradict the value: it can be used.
    Converged,
    /// The bound has become smaller than the prior but is not small yet: more excitation would help.
    Improving,
    /// The flight hardly determines the parameter: the bound is still that of the prior. Fly an input that moves its
    /// regressor.
    NotExcited,
    /// A change was adopted that re-opened it, and nothing has excited it since: what it was before need not hold any
    /// more.
    Unknown,
    /// The estimate lies on one of the limits of the model file, which exclude the value that the data ask for. Check
    /// the limits and the model.
    AtLimit,
    /// The bound is small, but the result as a whole is [refused](EstimationStatus::Refused) or
    /// [doubtful](EstimationStatus::Doubtful): the value must not be used before its reasons are settled.
    InDoubt,
    /// Not estimated: the model file gives its value.
    Fixed,
}

impl FinalStatus {
    /// The word that results, recordings and other programs use, e.g. `not_excited`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Improving => "improving",
            Self::NotExcited => "not_excited",
            Self::Unknown => "unknown",
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
            ParameterStatus::Unknown => Self::Unknown,
            ParameterStatus::AtLimit => Self::AtLimit,
        }
    }
}

/// The kinds of events during an estimation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// A change of the parameters is suspected; bounds are widened until it is decided.
    InDoubt,
    /// A change of the parameters was adopted: from here on the estimates are those after it. Results of older versions
    /// say `re_reached`.
    #[serde(alias = "re_reached")]
    Adopted,
    /// The suspected change was not confirmed: the estimate from before it is kept.
    DoubtDropped,
    /// An adopted change was taken back: the estimate from before it has predicted better.
    RolledBack,
    /// From here on model error hides small changes of the parameters.
    Insensitive,
    /// There was no sample for longer than the estimator predicts without one.
    Gap,
    /// The state was started again from the measurements.
    Restarted,
    /// A unit or a sign of a channel is implausible in the last samples of a live session: from here on no parameter counts as
    /// ready.
    Units,
}

impl EventKind {
    /// The word that results, recordings and other programs use, e.g. `doubt_dropped`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::InDoubt => "in_doubt",
            Self::Adopted => "adopted",
            Self::DoubtDropped => "doubt_dropped",
            Self::RolledBack => "rolled_back",
            Self::Insensitive => "insensitive",
            Self::Gap => "gap",
            Self::Restarted => "restarted",
            Self::Units => "units",
        }
    }

    /// True for the events of the change detector.
    pub const fn is_of_detector(self) -> bool {
        matches!(self, Self::InDoubt | Self::Adopted | Self::DoubtDropped | Self::RolledBack | Self::Insensitive)
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// The result for one parameter at the end of the record.
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
    /// One-sigma error corrected for the colour of the residuals, with the systematic part; this one makes the bounds.
    pub corrected_std_error: f64,
    /// The part of it that comes from the uncertainties that the model file declares (`[uncertainty]`), one sigma: a
    /// longer flight does not make it smaller.
    #[serde(default)]
    pub systematic_std: f64,
    /// The declared quantities that make the systematic part, the largest share first. Empty where nothing is declared
    /// that moves this parameter.
    #[serde(default)]
    pub systematic_parts: Vec<SystematicPart>,
    /// What the flight says of the declared quantities ([`Estimation::learnt`]) has added to the estimate, in its unit; 0 where nothing is
    /// learnt.
    #[serde(default)]
    pub learnt_shift: f64,
    /// The part of it that comes from the errors of corrections of the sensors, one sigma; 0 where the record was not
    /// corrected, or the corrections say nothing of their errors.
    #[serde(default)]
    pub correction_std: f64,
    /// Lower bound at about 95 %: `value - 2 corrected_std_error`.
    pub lower: f64,
    /// Upper bound at about 95 %: `value + 2 corrected_std_error`.
    pub upper: f64,
    /// How well the parameter is known.
    pub status: FinalStatus,
    /// First time after which the estimate stays within 5 % of its final value, or of the truth where that is known, s
    /// from the start of the record; none if it is not reached or the parameter was not excited.
    pub converged_at_s: Option<f64>,
    /// Observability, `1 - variance / prior variance`: 0 where the flight adds nothing to the prior, near 1 where it
    /// decides.
    pub observability: f64,
    /// Start value from the model file, in the parameter's unit.
    pub initial: f64,
    /// Standard deviation of what was known beforehand about the distance from the start value, in the parameter's
    /// unit.
    pub prior_std: f64,
    /// Declared lower and upper bounds, if any.
    pub bounds: Option<[f64; 2]>,
    /// The true value, where the flight was simulated.
    pub truth: Option<f64>,
    /// True for offsets and sensor biases, which are estimated only to keep the other parameters right.
    pub nuisance: bool,
    /// Whether the value can be used, why, and what input would help. `None` for a fixed parameter and for batch
    /// methods.
    #[serde(default)]
    pub readiness: Option<ParameterReadiness>,
}

#[cfg(test)]
impl ParameterResult {
    /// A converged parameter of 1.0 with a random standard error of 0.1, for tests to change what they are about.
    pub(crate) fn for_tests(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            unit: "-".to_owned(),
            value: 1.0,
            std_error: 0.1,
            corrected_std_error: 0.1,
            systematic_std: 0.0,
            systematic_parts: Vec::new(),
            learnt_shift: 0.0,
            correction_std: 0.0,
            lower: 0.8,
            upper: 1.2,
            status: FinalStatus::Converged,
            converged_at_s: None,
            observability: 1.0,
            initial: 0.0,
            prior_std: 1.0,
            bounds: None,
            truth: None,
            nuisance: false,
            readiness: None,
        }
    }
}

/// Whether the value of a parameter can be used, and what input would improve it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterReadiness {
    /// Whether the value can be used.
    pub verdict: Readiness,
    /// Why the verdict is what it is, in words.
    pub reason: String,
    /// What input would help, in words; none where an input would not.
    pub advice: Option<String>,
    /// Time since which the parameter has been ready without interruption, s; `None` if it is not ready.
    pub ready_since_s: Option<f64>,
    /// Standard error over the standard deviation of the prior.
    pub bound_over_prior: f64,
    /// The same ratio if all other parameters were known: the effect of the excitation of this regressor alone.
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
    /// One value per time, in `unit`; NaN where it is missing.
    pub values: Vec<f64>,
}

/// The course of one parameter over the samples of the record.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterHistory {
    /// Name as in [`ParameterResult::name`].
    pub name: String,
    /// Estimate after each sample, in the parameter's unit.
    pub value: Vec<f64>,
    /// Corrected one-sigma error after each sample.
    pub std_error: Vec<f64>,
    /// The correction that the least squares of the moment would make, `theta_LS - theta`, in the parameter's unit; for
    /// display only.
    pub surface: Vec<f64>,
}

/// What happened at one instant of the estimation: a change suspected or adopted, a gap, a restart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Time of the sample at which it was noticed, s.
    pub time_s: f64,
    /// What happened, as a word for programs.
    pub kind: EventKind,
    /// What happened, in words for the user.
    pub message: String,
}

/// Histories over the samples of the record, all of the length of `time_s`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// Times of the samples, s, on the time base of the record.
    pub time_s: Vec<f64>,
    /// Known inputs as the model used them: held over missing samples, SI.
    pub inputs: Vec<Signal>,
    /// Measured outputs, SI; NaN where missing.
    pub measured: Vec<Signal>,
    /// The estimated model's outputs before the correction by the same sample (one-step prediction).
    pub predicted: Vec<Signal>,
    /// Whitened residuals, one sigma = 1, one signal per output.
    pub residuals: Vec<Signal>,
    /// Course of each parameter, in the order of [`Estimation::parameters`].
    pub parameters: Vec<ParameterHistory>,
    /// How the estimator treated each sample.
    pub phase: Vec<Phase>,
}

impl History {
    /// As a record to be written as CSV: inputs and measured outputs under their names, `<output>_predicted`,
    /// `<output>_residual` (one sigma = 1), and each parameter with `<parameter>_std`, the corrected one-sigma error.
    ///
    /// ```
    /// use phugoid_flight_data::csv;
    /// use phugoid_identification::estimation::{History, Signal};
    /// let alpha = Signal { name: "alpha".to_owned(), unit: "rad".to_owned(), values: vec![0.05, f64::NAN] };
    /// let history = History { time_s: vec![0.0, 0.1], measured: vec![alpha], ..History::default() };
    /// let mut text = Vec::new();
    /// csv::write(&history.record("example"), &mut text)?;
    /// assert_eq!(String::from_utf8(text)?, "time_s,alpha_rad\n0,0.05\n0.1,\n");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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

/// The result of one run of one method on one record.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimation {
    /// Source of the record: its file name, or the name of a scenario.
    pub source: String,
    /// Model file or its built-in name.
    pub model: String,
    /// The method that made this estimation.
    pub method: Method,
    /// Results of the parameters in the order of the model file, offsets and sensor biases last.
    pub parameters: Vec<ParameterResult>,
    /// What the flight itself says of declared quantities; empty where nothing is declared, or the flight does not tell. Values and bounds
    /// contain it where the model file says `learn = true` ([`ParameterResult::learnt_shift`]).
    #[serde(default)]
    pub learnt: Vec<LearntQuantity>,
    /// Correlation matrix of the errors, row and column as in `parameters`; 0 for a fixed parameter off the diagonal.
    pub correlation: Vec<Vec<f64>>,
    /// Sums of two derivatives that the flight determines, even where it does not determine the parts.
    #[serde(default)]
    pub effective: Vec<EffectiveDerivative>,
    /// Of increments to a database, the derivatives that they make together with its slopes; empty for any other model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub totals: Vec<TotalDerivative>,
    /// Angle of attack at which the terms' `alpha` is zero, rad: where derivatives are turned into other axes.
    #[serde(default)]
    pub alpha_reference: f64,
    /// Terms that the model lacks, by the residuals; `None` where
    /// [`EstimateOptions::structure`](super::options::EstimateOptions::structure) did not ask for them, or nothing
    /// moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offer: Option<Offer>,
    /// What the result as a whole is worth.
    #[serde(default)]
    pub status: EstimationStatus,
    /// Why it is not sound, the severest first; empty for a sound result.
    #[serde(default)]
    pub reasons: Vec<VerdictReason>,
    /// Sentences for the user: the headline of a refused or doubtful result, the reasons, how many parameters
    /// have converged, pairs of parameters that are only known together, doubtful units, model error.
    pub verdict: Vec<String>,
    /// Suspected and adopted changes, gaps and restarts, in order of time.
    pub events: Vec<Event>,
    /// The adopted changes with the estimates before and after each, in order of time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<AdoptedChange>,
    /// What the reader of the record found, assumed and left out.
    pub quality: QualityReport,
    /// Measurement noise used per output, SI: name, unit, one sigma (one value each).
    pub noise: Vec<Signal>,
    /// How each measured output agreed with its predictions. Empty for a batch method.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub consistency: Vec<OutputConsistency>,
    /// Histories. Of a batch method: the fitted outputs as predictions, the parameters constant.
    pub history: History,
    /// The additional results of a batch method; `None` for a causal one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub batch: Option<BatchReport>,
    /// The parameters by another method from the same samples: another answer to the same question. `None` where that gives
    /// none, with [`EstimateOptions::causal_only`](super::options::EstimateOptions::causal_only), and of the laws
    /// without bounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_answer: Option<SecondAnswer>,
    /// The parameters by a filter that takes the record sample by sample and looks for changes in flight, beside filter error and output
    /// error with simulated air data, whose second answer is that of equation error: a change bends both of these alike. `None` of the
    /// other methods, and where the filter gives none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub third_answer: Option<SecondAnswer>,
    /// The parameters from what the surfaces explain of the motion ([`by_surfaces`](crate::batch::by_surfaces())).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_surfaces: Vec<OtherValue>,
}

/// How one measured output agreed with the predictions of a causal method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputConsistency {
    /// Name of the output.
    pub name: String,
    /// Mean square of its normalised innovations (residual over its whole predicted standard deviation) since the first
    /// motion: one where the covariance is right. `None` without an innovation.
    pub mean_square: Option<f64>,
    /// Longest time in which more than four of five measured rows were rejected, s: rejected time less four times the
    /// accepted time.
    pub longest_rejected_s: f64,
}

/// A sudden change of the parameters that was adopted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdoptedChange {
    /// When it was adopted, s; where it was found afterwards: the moment with which the record is predicted best.
    pub time_s: f64,
    /// The times between which it happened, s: moments with which the record is predicted as well, but for 10 nats and a tenth of
    /// what the change gains. In seconds in which nothing moves all moments are as good. `None` where it was found in flight (it
    /// happened before `time_s` then) or given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval_s: Option<[f64; 2]>,
    /// Which parameters may have changed: every one, or the constants alone.
    #[serde(default)]
    pub opens: Opens,
    /// What has become of it.
    pub outcome: ChangeOutcome,
    /// The estimates before and after it, one per parameter that was opened for it: every estimated one, or the constants
    /// alone where these explain the record as well (a trim shift).
    pub parameters: Vec<ChangedParameter>,
}

/// What has become of an adopted change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChangeOutcome {
    /// The estimate from before it still runs as a rival: not everything that was re-opened has been excited, or it has
    /// not predicted better for long enough.
    OnProbation,
    /// The estimate after it has predicted better with everything known again.
    Confirmed,
    /// It was taken back: the estimate from before it has predicted better, or the levels of the residuals explain it.
    RolledBack,
    /// It was not found in flight, but when the whole record was looked at again: the record is predicted much better with the
    /// parameters opened at this time. A live session does not look again.
    FoundAfterwards,
    /// It was adopted in flight, and taken back when the whole record was looked at again: the record is not predicted
    /// better with it. The results are those without it. A live session does not look again.
    WithdrawnAfterwards,
    /// With a term that the model lacks ([`ReasonCode::MissingTerm`]) there is no change, and the record is predicted better: it is
    /// none of the aircraft. The results are those after it all the same.
    ExplainedByTerm,
}

impl ChangeOutcome {
    /// Whether it counts as a change of the aircraft: it was neither taken back nor explained by a missing term.
    pub const fn stands(self) -> bool {
        !matches!(self, Self::RolledBack | Self::WithdrawnAfterwards | Self::ExplainedByTerm)
    }
}

/// A parameter before and after a change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChangedParameter {
    /// Its name.
    pub name: String,
    /// The estimate before the change, in the parameter's unit: one second before it was suspected in flight, since a filter learns from
    /// the changed aircraft until then; of the last sample before it where it was given or found afterwards.
    pub before: f64,
    /// Its corrected standard error.
    pub before_std: f64,
    /// The estimate at the end of the record, or before the next change.
    pub after: f64,
    /// Its corrected standard error.
    pub after_std: f64,
    /// One sigma of the difference. What the model file declares is the same error before and after: of that it has only what it does
    /// otherwise to the one than to the other, so that a change is known better than either value. Zero in a result that was written
    /// before this was told.
    #[serde(default)]
    pub difference_std: f64,
    /// The random part of that: what noise and turbulence leave open. Zero in a result that was written before this was told.
    #[serde(default)]
    pub random_std: f64,
}

impl ChangedParameter {
    /// The difference over its random part, by which the parameters of a change are put in order: what is declared in parts of a
    /// value would make every large change as sure as any other. Zero if that is not positive.
    pub fn sigmas(&self) -> f64 {
        let std = if self.random_std > 0.0 { self.random_std } else { self.before_std.hypot(self.after_std) };
        if std > 0.0 { (self.after - self.before) / std } else { 0.0 }
    }
}

/// The additional results of a batch method: cost, noise, fit by output, equations, prediction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BatchReport {
    /// Number of steps from the start values to the minimum.
    pub iterations: usize,
    /// Negative logarithm of the likelihood there, without constants: for comparing models on the same record.
    pub cost: f64,
    /// One sigma of the noise by output, given or estimated; of equation error: of the equations. NaN where not
    /// measured.
    #[serde(alias = "noise_sd")]
    pub noise_std: Vec<f64>,
    /// The unknowns that were estimated in addition to the parameters and biases: initial states, noise.
    pub unknowns: Vec<Unknown>,
    /// Fit by manoeuvre and output: this record first, then the others that were fitted with it.
    pub manoeuvres: Vec<(String, Vec<OutputFit>)>,
    /// Equations with their terms, from equation error.
    pub equations: Vec<Equation>,
    /// The band of a frequency-domain method; `None` of the others. Levels, fit and residuals are then those in the band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band: Option<BandUsed>,
    /// True if output error took the angles of attack and sideslip as measured and did not fit them, and airspeed and attitude too
    /// where gusts could be told from the noise of the vanes.
    #[serde(default)]
    pub measured_angles: bool,
    /// The prediction of another record with these parameters; `None` where none was given.
    pub prediction: Option<Prediction>,
    /// Warnings about the result in sentences; read them before you use the numbers.
    pub notes: Vec<String>,
}

/// The parameters by another method than that of the result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SecondAnswer {
    /// Equation error, which output error and filter error begin with, and which stands beside SMPE and the EKF; beside
    /// equation error the filter that takes the record sample by sample.
    pub method: Method,
    /// The parameters that it gives a number for.
    pub values: Vec<OtherValue>,
}

/// A parameter by another method, in the parameter's own unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OtherValue {
    /// Name of the parameter.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// One sigma, corrected for the colour of the residuals, without what the model file declares of systematic errors:
    /// those are the same for both methods.
    pub std_error: f64,
}

/// The prediction of a record that was not used for the estimation: simulated with their values held, only the initial
/// state and the sensor biases fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// Source of the record, e.g. its file name.
    pub source: String,
    /// How well each predicted output follows the measured one.
    pub fit: Vec<OutputFit>,
    /// Times of the samples, s.
    pub time_s: Vec<f64>,
    /// Measured outputs, SI; NaN where missing.
    pub measured: Vec<Signal>,
    /// Outputs of the simulation with the estimated parameters, SI.
    pub predicted: Vec<Signal>,
    /// How far measured values may lie from the predicted ones, in the order of `measured`
    /// ([`prediction_intervals`](crate::batch::prediction_intervals)). Empty for equation error, which knows no noise of
    /// the outputs.
    #[serde(default)]
    pub intervals: Vec<PredictionInterval>,
}

/// The prediction interval of one output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PredictionInterval {
    /// Canonical name of the output, e.g. `alpha`.
    pub name: String,
    /// One sigma of measured minus predicted, one value per time of the prediction, in the unit of the output; NaN where
    /// nothing was simulated.
    pub std_error: Vec<f64>,
    /// Part of the measured values that lies within two sigma, 0 to 1: about 0.95 if the model and the bounds of its
    /// parameters are right. NaN without a measured value.
    pub within: f64,
}

impl PredictionInterval {
    /// Median over time of one sigma, in the unit of the output; NaN where nothing was simulated.
    pub fn median_std(&self) -> f64 {
        let mut finite: Vec<f64> = self.std_error.iter().copied().filter(|s| s.is_finite()).collect();
        median(&mut finite).unwrap_or(f64::NAN)
    }
}

impl Estimation {
    /// The result for the parameter of this name, for example `Cm_alpha`; none if the model has no such parameter.
    pub fn parameter(&self, name: &str) -> Option<&ParameterResult> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}

impl TotalDerivative {
    /// The range of the variable as it is printed, and its unit: `deg` of an angle, empty of a dimensionless rate.
    pub fn printed_range(&self) -> ([f64; 2], &'static str) {
        match self.variable.ends_with("_hat") {
            true => (self.range, ""),
            false => (self.range.map(f64::to_degrees), "deg"),
        }
    }
}

/// The rest of a standard deviation without an independent part of it; 0 where the part is the larger, and NaN stays NaN.
pub(crate) fn without_part(whole: f64, part: f64) -> f64 {
    let variance = (whole - part) * (whole + part);
    if variance < 0.0 { 0.0 } else { variance.sqrt() }
}

impl ParameterResult {
    /// Two standard errors, corrected for the correlation of the residuals from sample to sample, in the parameter's
    /// unit: the value lies between [`lower`](Self::lower) and [`upper`](Self::upper) with a probability of about 95 %.
    pub fn bound(&self) -> f64 {
        2.0 * self.corrected_std_error
    }

    /// The part of [`corrected_std_error`](Self::corrected_std_error) that a longer or livelier flight makes smaller,
    /// one sigma in the parameter's unit: what noise and turbulence leave open (GUM: type A). NaN stays NaN.
    pub fn random_std(&self) -> f64 {
        without_part(self.corrected_std_error, self.systematic_std.hypot(self.correction_std))
    }

    /// The largest of the [`systematic_parts`](Self::systematic_parts), at most `most` of them and none below half a percent of
    /// the variance, and what is left for the others: `airspeed 34 %, inertia 33 %, others 33 %`. Empty where there are none.
    pub fn contributors_in_words(&self, most: usize) -> String {
        in_words(&self.systematic_parts, most)
    }
}

/// A sum of two derivatives that a flight determines even where it does not determine the two parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectiveDerivative {
    /// Name of the sum, e.g. `Cm_q + Cm_alpha_dot`.
    pub name: String,
    /// Estimate of the sum, per radian.
    pub value: f64,
    /// One-sigma error, corrected for the colour of the residuals.
    pub std_error: f64,
    /// Names of the two parameters that are added.
    pub parts: [String; 2],
    /// Correlation of the errors of the two parts, -1 to 1.
    pub correlation: f64,
    /// True if the flight determines each of the parts, so that each can be used by itself.
    pub separable: bool,
}

/// A derivative as the sum of the slope of a database and the increment that was estimated, at the reference condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TotalDerivative {
    /// Name, e.g. `Cm_alpha`.
    pub name: String,
    /// Unit as printed, `per rad`; rates made dimensionless count as angles.
    pub unit: String,
    /// Slope of the database plus increment, in the unit.
    pub value: f64,
    /// One-sigma error of it: that of the increment, random and systematic, for a database whose shape is right.
    pub std_error: f64,
    /// How well the increment is known.
    pub status: FinalStatus,
    /// Name of the increment in the model file, e.g. `dCm_alpha`.
    pub increment: String,
    /// Slope of the database: the secant over [`range`](Self::range), all other variables at the reference.
    pub database: f64,
    /// How far its local slopes lie from the secant, root mean square over the flight.
    pub database_std: f64,
    /// One-sigma error of the increment with that of the slope that it was added to. Another range of the same flight may
    /// give another increment, by so much.
    pub increment_std_error: f64,
    /// Name of the variable in a term: `alpha`, `q_hat` or `elevator`.
    pub variable: String,
    /// The variable from its 2 % to its 98 % point in the flight, rad, or dimensionless for a rate.
    pub range: [f64; 2],
    /// Angle of attack of the reference condition, rad.
    pub reference_alpha: f64,
    /// Elevator of the reference condition, rad.
    pub reference_elevator: f64,
}

/// The result of looking for terms that the model does not have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offer {
    /// Number of terms that were tried on the equations of motion.
    pub tried: usize,
    /// From when on a term counts as missing.
    pub criterion: OfferCriterion,
    /// The residuals of the equations of motion with the model as it is, against the noise of the sensors.
    pub levels: Vec<ResidualLevel>,
    /// The terms that count as missing in the order in which they were found, then the others, the largest partial F
    /// first.
    pub terms: Vec<OfferedTerm>,
    /// What the missing terms do to the other parameters; empty if nothing counts as missing.
    pub effects: Vec<TermEffect>,
    /// The lines to put into the model file; empty if nothing counts as missing.
    pub lines: Vec<ModelLine>,
    /// True if the estimation has the missing terms in its model ([`StructureSearch::Auto`]).
    ///
    /// [`StructureSearch::Auto`]: super::options::StructureSearch::Auto
    pub taken: bool,
    /// Airspeed (m/s) that becomes the reference speed of the model where a missing term needs one and the file has
    /// none.
    pub reference_speed: f64,
}

impl Offer {
    /// The terms that count as missing, in the order in which they were found.
    pub fn missing(&self) -> impl Iterator<Item = &OfferedTerm> {
        self.terms.iter().filter(|term| term.asked_for)
    }

    /// The missing term that was found first; `None` if no term counts as missing.
    pub fn best(&self) -> Option<&OfferedTerm> {
        self.missing().next()
    }
}

/// From when on a term counts as missing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OfferCriterion {
    /// Smallest partial F.
    pub partial_f: f64,
    /// Smallest share of the coefficient's motion that only this term makes, 0 to 1.
    pub share: f64,
    /// Smallest part of the residual's squares beyond the noise of the sensors that it explains, 0 to 1.
    pub excess: f64,
}

/// The residual of an equation of motion beside what the noise of the sensors makes of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualLevel {
    /// The left side: `d(q)/dt`, or the name of a measured acceleration.
    pub equation: String,
    /// Standard deviation of the residual, SI.
    pub residual_std: f64,
    /// Standard deviation that the noise of the sensors makes, measured in the channels themselves, SI.
    pub noise_std: f64,
}

/// A term that the model does not have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OfferedTerm {
    /// Symbol of the coefficient, e.g. `Cm`.
    pub coefficient: String,
    /// As a model file writes it, e.g. `alpha^2`.
    pub term: String,
    /// A channel that the term needs under `inputs`; none for variables of the motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input: Option<String>,
    /// Name of its parameter, e.g. `dCm_alpha2`.
    pub parameter: String,
    /// Value in a regression on the equations of motion, per radian to the power of the term; without a share that of the method.
    pub value: f64,
    /// One-sigma error of it, corrected for the colour of the residuals and for noise in the regressors; of the method its random
    /// part.
    pub std_error: f64,
    /// Partial F: the square of value over standard error.
    pub partial_f: f64,
    /// Share of the coefficient's motion that only this term makes, 0 to 1; none for a term that the method itself was tried
    /// with, in place of the equations of motion.
    pub share: Option<f64>,
    /// Part of the residual's squares beyond the noise of the sensors that it explains; none where there are none.
    pub excess: Option<f64>,
    /// True if the term counts as missing: all of [`OfferCriterion`] holds, and the method finds it in its own estimate
    /// with this sign, three standard errors from zero; without a share, the method finds it six random errors from zero.
    pub asked_for: bool,
    /// One sigma of what is known of its parameter beforehand, as the line for the model file says it.
    pub prior_std: f64,
}

/// What the missing terms do to a parameter, by the method of the estimation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TermEffect {
    /// Name of the parameter.
    pub parameter: String,
    /// Estimate without the missing terms; none for the parameter of a missing term.
    pub before: Option<f64>,
    /// Its corrected standard error.
    pub before_std: Option<f64>,
    /// Estimate with them.
    pub after: f64,
    /// Its corrected standard error.
    pub after_std: f64,
}

/// A line for the model file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelLine {
    /// The section that it belongs to; empty for the top of the file.
    pub section: String,
    /// The line.
    pub line: String,
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
