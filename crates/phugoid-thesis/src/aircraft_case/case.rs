//! The file of a published case with the F-16.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::published::Published;
use phugoid_simulation::scenario::{Scenario, ScenarioError, nearest, parse_toml};

/// Increments that a case may look for, in the order of the estimators' parameters.
pub const PARAMETERS: [&str; 4] = ["dCm_alpha", "dCm_q", "dCL_alpha", "dCD_alpha"];

/// A case with the F-16: what was published, the flight, and what the estimators are told.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AircraftCase {
    /// What it is, in a few words.
    pub title: String,
    /// What the thesis published of this case.
    #[serde(default)]
    pub published: Published,
    /// The flight of the reference aircraft, with its true increments.
    pub scenario: Scenario,
    /// What the estimators are told of each increment that they look for. Increments that are not named here are taken as
    /// zero by the estimators.
    pub parameters: BTreeMap<String, ParameterSettings>,
    /// What the estimators are told beside that.
    #[serde(default)]
    pub estimator: EstimatorSettings,
}

/// What the estimators are told of one increment.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterSettings {
    /// Lower bound that the estimators are told, per radian.
    pub lower: f64,
    /// Upper bound, per radian. Of the sign of the lower one: the printed gain contains `sqrt(upper/lower)`.
    pub upper: f64,
    /// Start value, per radian; the thesis's nominal value, the geometric mean of the bounds, if it is not given.
    pub start: Option<f64>,
    /// `lambda` of the sliding laws, 1/s.
    pub lambda: f64,
    /// `eta` of the laws as printed, in the thesis's units: those of `z` with V in ft/s and angles in rad.
    pub eta: f64,
    /// `eta` of the printed law whose channels are divided by their typical size, in units of the scaled `z`.
    pub scaled_eta: f64,
    /// `eta` of the damped form on the coefficient's own channel, in units of the scaled `z`.
    pub damping: f64,
}

/// What the estimators are told beside bounds and start values.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EstimatorSettings {
    /// One-sigma noise that the flagship is told of a sensor without noise, as a fraction of a realistic sensor's
    /// (1 ft/s, 0.1 deg, 0.05 deg, 0.1 deg/s, 0.01 g): a covariance cannot be built on none.
    pub assumed_noise: f64,
    /// Whether the flagship expects gusts: process noise that starts at light turbulence and whose size is learnt from the
    /// residuals, as in `scenarios/f16-gust-model.toml`. The laws have no such notion.
    pub gusts: bool,
}

impl Default for EstimatorSettings {
    fn default() -> Self {
        Self { assumed_noise: 1e-4, gusts: false }
    }
}

impl ParameterSettings {
    /// Start value of the estimates, per radian: the given one, else the geometric mean of the bounds with their sign.
    pub fn start(&self) -> f64 {
        self.start.unwrap_or_else(|| (self.lower * self.upper).sqrt().copysign(self.lower))
    }

    fn check(&self) -> Result<(), String> {
        let Self { lower, upper, .. } = *self;
        if !(lower < upper && lower * upper > 0.0 && upper.is_finite() && lower.is_finite()) {
            return Err(format!(
                "bounds {lower} to {upper}: two finite numbers of one sign are needed, the lower one first (-2, then -1)"
            ));
        }
        let start = self.start();
        if !(lower..=upper).contains(&start) {
            return Err(format!("start {start} lies outside the bounds {lower} to {upper}"));
        }
        let positive =
            [("lambda", self.lambda), ("eta", self.eta), ("scaled_eta", self.scaled_eta), ("damping", self.damping)];
        match positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            Some((name, value)) => Err(format!("{name} must be positive and finite, found {value}")),
            None => Ok(()),
        }
    }
}

impl AircraftCase {
    /// Parses the text of a case; `place` is its name in messages.
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
        if self.parameters.is_empty() {
            return Err(format!("[parameters] names no increment: expected one or more of {}", PARAMETERS.join(", ")));
        }
        for (name, settings) in &self.parameters {
            if !PARAMETERS.contains(&name.as_str()) {
                let near = nearest(name, PARAMETERS.into_iter());
                let expected = || format!("expected one of {}", PARAMETERS.join(", "));
                let hint = near.map_or_else(expected, |near| format!("did you mean `{near}`?"));
                return Err(format!("[parameters.{name}] is no increment that can be looked for: {hint}"));
            }
            settings.check().map_err(|message| format!("[parameters.{name}]: {message}"))?;
            if self.truth(name) == 0.0 {
                return Err(format!(
                    "[scenario.increments]: give a `{name}` that is not 0, [parameters.{name}] looks for it and convergence \
                     is told in per cent of the truth"
                ));
            }
        }
        if let Some(name) = self.published.converged_after.keys().find(|name| !self.parameters.contains_key(*name)) {
            return Err(format!("[published] says when `{name}` converged, but no [parameters.{name}] looks for it"));
        }
        let assumed = self.estimator.assumed_noise;
        if !(assumed > 0.0 && assumed.is_finite()) {
            return Err(format!("[estimator]: assumed_noise must be a positive fraction, found {assumed}"));
        }
        Ok(())
    }

    /// The increments looked for, in the order of [`PARAMETERS`], with what the estimators are told.
    pub fn unknowns(&self) -> Vec<(&'static str, ParameterSettings)> {
        PARAMETERS.into_iter().filter_map(|name| Some((name, *self.parameters.get(name)?))).collect()
    }

    /// True value of an increment at the end of the flight, per radian.
    pub fn truth(&self, name: &str) -> f64 {
        self.scenario.true_parameters().get(name).copied().unwrap_or(f64::NAN)
    }
}
