//! The result of an estimation: plain data to print, plot, save and compare.

use phugoid_flight_data::channels::by_name;
use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use serde::{Deserialize, Serialize};

use crate::batch::{Equation, OutputFit, Unknown};
pub use crate::effective::EffectiveDerivative;
pub use crate::offer::{Offer, OfferedTerm};

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
    /// One of `converged`, `improving`, `not_excited`, `at_limit`, `in_doubt` (settled, but the model contradicts the
    /// flight), `fixed`.
    pub status: String,
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
    /// One of `ready`, `improving` (wait, or move the aircraft more), `not_identifiable` (more of the same input will not
    /// do), `doubtful` (something speaks against it).
    pub verdict: String,
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
    /// One of `in_doubt`, `adopted`, `doubt_dropped`, `insensitive`, `gap`, `restarted`.
    pub kind: String,
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
    /// Phase per sample: `starting`, `sliding`, `reaching`, `rejected`, `predicting`.
    pub phase: Vec<String>,
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
    /// Estimator used, e.g. `smpe`.
    pub method: String,
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
