//! The file of a comparison: one flight, one unknown, several methods.

use phugoid_identification::model_file::ModelFile;
use serde::Deserialize;

use crate::aircraft_case::sensor_noise;
use crate::published::Published;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::published::THESIS_MODEL;
use phugoid_simulation::scenario::{Scenario, ScenarioError, parse_toml};

/// The unknown of every comparison, as in the thesis: the increment of the pitch damping.
pub const UNKNOWN: &str = "dCm_q";

/// A comparison with the F-16: what was published, the flight, and what the methods are told.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComparisonCase {
    /// What it is, in a few words.
    pub title: String,
    /// What the thesis published of this comparison.
    #[serde(default)]
    pub published: Published,
    /// The flight of the reference aircraft, with the true `dCm_q`. If `sensors.qdot` is named, the laws that want the
    /// pitch acceleration are given it; otherwise they are integrated over the sampling interval.
    pub scenario: Scenario,
    /// What the methods are told.
    pub comparison: Comparison,
}

/// What the methods are told of `dCm_q`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// Lower and upper bound, per radian; either sign.
    pub bounds: [f64; 2],
    /// Estimate before the first sample, per radian.
    #[serde(default)]
    pub start: f64,
    /// True values of the flights on which the gains of the laws are tuned, per radian. The flagship has no gain to tune.
    pub training: Vec<f64>,
    /// `lambda` of the sliding-mode law, 1/s.
    #[serde(default = "lambda")]
    pub lambda: f64,
    /// Whether the thesis says that its model-reference estimator finds the truth; leave it out where nothing was published.
    pub model_reference_finds_it: Option<bool>,
}

fn lambda() -> f64 {
    10.0
}

impl ComparisonCase {
    /// Parses the text of a comparison; `place` is its name in messages.
    ///
    /// # Errors
    /// [`ScenarioError`] with the line, or with the key whose value is out of range.
    pub fn parse(text: &str, place: &str) -> Result<Self, ScenarioError> {
        let case: Self = parse_toml(text, place)?;
        case.check().map_err(|message| ScenarioError::OutOfRange { place: place.to_owned(), message })?;
        Ok(case)
    }

    fn check(&self) -> Result<(), String> {
        self.scenario.check().map_err(|message| format!("[scenario]: {message}"))?;
        if !self.scenario.damage.is_empty() {
            return Err("[[scenario.damage]]: a comparison needs a truth that does not change".to_owned());
        }
        let told = &self.comparison;
        let [lower, upper] = told.bounds;
        let within = |value: f64| lower <= value && value <= upper;
        if !(lower.is_finite() && upper.is_finite() && lower < upper) {
            return Err(format!(
                "comparison.bounds {lower} to {upper}: two finite numbers are needed, the lower one first"
            ));
        }
        if !within(told.start) {
            return Err(format!("comparison.start {} lies outside the bounds {lower} to {upper}", told.start));
        }
        if told.training.is_empty() || !told.training.iter().all(|value| within(*value) && *value != 0.0) {
            return Err(
                "comparison.training: one or more true values within the bounds are needed, none of them 0".to_owned()
            );
        }
        if !(told.lambda > 0.0 && told.lambda.is_finite()) {
            return Err(format!("comparison.lambda must be positive and finite, found {}", told.lambda));
        }
        if self.truth() == 0.0 {
            return Err("scenario.increments: give a `dCm_q` that is not 0, the methods look for it".to_owned());
        }
        let mut others = self.scenario.true_parameters();
        others.remove(UNKNOWN);
        if let Some((name, _)) = others.iter().find(|(name, value)| name.starts_with('d') && **value != 0.0) {
            return Err(format!("scenario.increments: `{name}` is not 0, but the methods look for `{UNKNOWN}` alone"));
        }
        Ok(())
    }

    /// True value of the unknown, per radian.
    pub fn truth(&self) -> f64 {
        self.scenario.increments.dCm_q
    }

    /// Half the distance between the bounds, per radian.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.comparison.bounds[1] - self.comparison.bounds[0])
    }

    /// The F-16 as the methods know it: exact tables and mass, `dCm_q` with its bounds, and the noise of the sensors; of a
    /// sensor without noise one ten-thousandth of a realistic one's, because a covariance cannot be built on none.
    ///
    /// # Errors
    /// [`StudyError::Unsuitable`] if the embedded model cannot be read.
    pub(super) fn model(&self) -> Result<ModelFile, StudyError> {
        let mut model = ModelFile::parse("f16-thesis-model", THESIS_MODEL).map_err(StudyError::unsuitable)?;
        model.parameters.retain(|parameter| parameter.name == UNKNOWN);
        let [lower, upper] = self.comparison.bounds;
        for parameter in &mut model.parameters {
            parameter.bounds = Some([lower, upper]);
            parameter.start = self.comparison.start;
            // The bounds decide the gain: C0 = (R/2)^2, R their half width.
            parameter.prior_std = 0.25 * (upper - lower);
        }
        for (told, own) in model.noise.iter_mut().zip(sensor_noise(&self.scenario)) {
            if own > 0.0 {
                *told = Some(own);
            }
        }
        Ok(model)
    }
}
