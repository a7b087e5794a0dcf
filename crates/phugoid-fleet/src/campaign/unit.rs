//! One unit of a campaign: a flight is simulated and estimated, and the result is scored against the truth.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;
use toml::{Table, Value};

use crate::key::{VERSION, hash, hash_file, key};
use crate::row::{Refusal, Row};

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
    /// Its text, with the values of the factors.
    pub model: Arc<str>,
    /// The method.
    pub method: Method,
    /// The seed that is flown.
    pub seed: u64,
    /// The factors with their values, as a JSON object.
    pub factors: Arc<str>,
}

impl Unit {
    /// SHA-256 of the scenario as it is flown: its text, the seed, and the content of every file that the text names.
    pub fn source_sha256(&self) -> String {
        let mut files = Vec::new();
        if let Ok(table) = toml::from_str::<Table>(&self.scenario) {
            self.named_files("", &Value::Table(table), &mut files);
        }
        let seed = self.seed.to_string();
        let mut parts = vec![("scenario", self.scenario.as_ref()), ("seed", seed.as_str())];
        parts.extend(files.iter().map(|hash| ("file", hash.as_str())));
        key(&parts)
    }

    /// Hashes of the files that texts of the scenario name, in the order of the scenario.
    fn named_files(&self, key: &str, value: &Value, files: &mut Vec<String>) {
        match value {
            Value::Table(table) => table.iter().for_each(|(key, value)| self.named_files(key, value, files)),
            Value::Array(list) => list.iter().for_each(|value| self.named_files(key, value, files)),
            Value::String(text) => {
                let path = self.folder.join(text);
                match key == "file" && path.is_dir() {
                    // An aircraft in several files.
                    true => hash_folder(&path, files),
                    false => files.extend(hash_file(&path).ok().map(|(hash, _)| hash)),
                }
            }
            _ => {}
        }
    }

    /// SHA-256 of the text of the model.
    pub fn model_sha256(&self) -> String {
        hash(self.model.as_bytes())
    }

    /// The key of this unit. The names of scenario and model and the factors are in its rows, and so in its key.
    pub fn key(&self) -> String {
        key(&[
            ("flight", &self.source_sha256()),
            ("scenario", &self.scenario_name),
            ("factors", &self.factors),
            ("model", &self.model_sha256()),
            ("method", self.method.name()),
        ])
    }

    /// Flies, estimates and scores: one row per parameter, or one that says why there are none.
    pub fn rows(&self) -> Vec<Row> {
        let common = Row {
            key: self.key(),
            kind: "campaign".to_owned(),
            source_sha256: Some(self.source_sha256()),
            model_sha256: self.model_sha256(),
            model: self.model_name.clone(),
            version: VERSION.to_owned(),
            method: self.method.name().to_owned(),
            segment: Some(0),
            scenario: Some(self.scenario_name.clone()),
            seed: i64::try_from(self.seed).ok(),
            factors: Some(self.factors.to_string()),
            ..Row::default()
        };
        let refused = |why: Refusal, error: String| vec![common.refused(why, error)];
        let model = match ModelFile::parse(&self.model_name, &self.model) {
            Ok(model) => model,
            Err(error) => return refused(Refusal::NotEstimated, error.to_string()),
        };
        let mut scenario = match Scenario::parse(&self.scenario, &self.scenario_name) {
            Ok(scenario) => scenario,
            Err(error) => return refused(Refusal::NotFlown, error.to_string()),
        };
        scenario.folder.clone_from(&self.folder);
        scenario.seed = self.seed;
        let flight = match fly(&scenario) {
            Ok(flight) => flight,
            Err(error) => return refused(Refusal::NotFlown, error.to_string()),
        };
        let options = EstimateOptions {
            method: Some(self.method),
            truth: flight.true_parameters.clone(),
            ..EstimateOptions::default()
        };
        match estimate(&flight.measured, &model, &options, &mut |_| {}) {
            Ok(estimation) => {
                let time = &flight.measured.time;
                let duration_s = time.first().zip(time.last()).map(|(first, last)| last - first);
                Row { duration_s, ..common }.of_estimation(&estimation)
            }
            Err(error) => refused(Refusal::NotEstimated, error.to_string()),
        }
    }
}

/// Hashes of all files in a folder and below it, in the order of their paths.
fn hash_folder(folder: &Path, files: &mut Vec<String>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        // A link may lead back.
        match path.is_dir() && !path.is_symlink() {
            true => hash_folder(&path, files),
            false => files.extend(hash_file(&path).ok().map(|(hash, _)| hash)),
        }
    }
}
