//! One unit of a campaign: a flight is simulated and estimated, and the result is scored against the truth.

use std::path::PathBuf;
use std::sync::Arc;

use phugoid_evaluation::accuracy::{bound_of_flight, in_order_of_bound};
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::model_file::{ModelFile, Parameter};
use phugoid_simulation::flight::Flight;

use super::kept::{Kept, Problem};
use super::question::Question;
use crate::key::{VERSION, key};
use crate::row::{BOUND, Refusal, Row, finite};

/// A flight and how it is estimated, with everything that decides on the result.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Name of the scenario, as the campaign calls it.
    pub scenario_name: String,
    /// Its text, with the values of the factors.
    pub scenario: Arc<str>,
    /// Folder in which the relative paths of the scenario begin.
    pub folder: PathBuf,
    /// Name of the model, as the campaign calls it.
    pub model_name: String,
    /// Folder in which the name of the model begins, and with it the path of its `base`; empty for a built-in model.
    pub model_folder: PathBuf,
    /// Its text, with the values of the factors.
    pub model: Arc<str>,
    /// What is asked of the flight.
    pub method: Question,
    /// The seed that is flown.
    pub seed: u64,
    /// SHA-256 of the scenario as it is flown: its text, the seed, and the content of every file that the text names.
    pub source_sha256: String,
    /// SHA-256 of the text of the model, and of the files of its `base`.
    pub model_sha256: String,
    /// The factors with their values, as a JSON object.
    pub factors: Arc<str>,
}

impl Unit {
    /// The key of this unit by itself. The names of scenario and model and the factors are in its rows, and so in its key.
    pub fn key(&self) -> String {
        key(&[
            ("flight", &self.source_sha256),
            ("scenario", &self.scenario_name),
            ("factors", &self.factors),
            ("model name", &self.model_name),
            ("model", &self.model_sha256),
            ("method", self.method.name()),
        ])
    }

    /// Flies, estimates and scores: one row per parameter, or one that says why there are none. `key` is that of the block which
    /// the rows belong to; what was read and flown for the unit before is taken from `kept`.
    pub fn rows(&self, key: &str, kept: &mut Kept) -> Vec<Row> {
        let common = Row {
            key: key.to_owned(),
            kind: "campaign".to_owned(),
            source_sha256: Some(self.source_sha256.clone()),
            model_sha256: self.model_sha256.clone(),
            model: self.model_name.clone(),
            version: VERSION.to_owned(),
            method: self.method.name().to_owned(),
            segment: Some(0),
            scenario: Some(self.scenario_name.clone()),
            seed: i64::try_from(self.seed).ok(),
            factors: Some(self.factors.to_string()),
            ..Row::default()
        };
        let (model, flight) = match kept.of(self) {
            Ok(both) => both,
            Err(Problem::Model(error)) => return vec![common.refused(Refusal::NotEstimated, error)],
            Err(Problem::Flight(error)) => return vec![common.refused(Refusal::NotFlown, error)],
        };
        let time = &flight.measured.time;
        let duration_s = time.first().zip(time.last()).map(|(first, last)| last - first);
        let common = Row { duration_s, ..common };
        let Question::Estimate(method) = self.method else { return bound(&common, model, flight) };
        let options = EstimateOptions {
            method: Some(method),
            truth: flight.true_parameters.clone(),
            ..EstimateOptions::causal()
        };
        match estimate(&flight.measured, model, &options, &mut |_| {}) {
            Ok(estimation) => common.of_estimation(&estimation),
            Err(error) => vec![common.refused(Refusal::NotEstimated, error.to_string())],
        }
    }
}

/// The smallest standard errors that any unbiased estimator can have of a flight; `common` is what the rows have in common.
fn bound(common: &Row, model: &ModelFile, flight: &Flight) -> Vec<Row> {
    let end = flight.truth.time.last().copied().unwrap_or(0.0);
    let last = bound_of_flight(flight, model, &[end]).map(|mut bounds| bounds.pop());
    let std_error = match last {
        Ok(bound) => bound.map(|bound| bound.std_error).unwrap_or_default(),
        Err(error) => return vec![common.refused(Refusal::NotEstimated, error.to_string())],
    };
    let row = |(place, parameter): (usize, &Parameter)| {
        let std_error = std_error.get(place).copied().and_then(finite);
        Row {
            status: "sound".to_owned(),
            parameter: Some(parameter.name.clone()),
            unit: Some(parameter.unit()),
            std_error,
            random_std: std_error,
            parameter_status: Some(if std_error.is_some() { BOUND } else { "not_excited" }.to_owned()),
            nuisance: Some(parameter.is_nuisance()),
            truth: flight.true_parameters.get(&parameter.name).copied().and_then(finite),
            ..common.clone()
        }
    };
    in_order_of_bound(model).into_iter().enumerate().map(row).collect()
}
