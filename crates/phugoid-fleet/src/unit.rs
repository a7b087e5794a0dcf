//! One unit of work: a log and a model in, rows out. It depends on nothing else, so that it can run anywhere.

use std::path::Path;

use phugoid_flight_data::reader::{ReadError, ReadOptions};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;
use phugoid_identification::error::EstimateError;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::Estimation;
use phugoid_identification::manoeuvres::{Settings, find};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{ModelError, ModelFile, ModelFileError};
use phugoid_identification::parts::for_parts;

use crate::content::{base_hashes, model_sha256};
use crate::key::{VERSION, hash_log, key};
use crate::row::{Refusal, Row, finite};

/// What is estimated of a flight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Segments {
    /// Each manoeuvre by itself. This is the default.
    #[default]
    Manoeuvres,
    /// The whole flight at once.
    Whole,
}

impl Segments {
    /// The word of the command line and of keys.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Manoeuvres => "manoeuvres",
            Self::Whole => "whole",
        }
    }
}

/// Everything that decides on the rows of a log, beside the log: the model and the options.
#[derive(Clone, Debug)]
pub struct Task {
    model: ModelFile,
    model_text: String,
    model_sha256: String,
    method: Option<Method>,
    segments: Segments,
}

impl Task {
    /// A task with this model: a file, or the name of a built-in one. `method` is that of the model file where it is
    /// `None`.
    ///
    /// # Errors
    /// [`ModelError`]: no such file or name, or its text is wrong.
    pub fn open(model: &str, method: Option<Method>, segments: Segments) -> Result<Self, ModelError> {
        let (name, text) = ModelFile::find_text(model)?;
        Ok(Self::parse(&name, text, method, segments)?)
    }

    /// As [`open`](Self::open), from the text of the model file; `name` stands in messages.
    ///
    /// # Errors
    /// [`ModelFileError`]: the text is wrong.
    pub fn parse(name: &str, text: String, method: Option<Method>, segments: Segments) -> Result<Self, ModelFileError> {
        let model = ModelFile::parse(name, &text)?;
        let model_sha256 = model_sha256(&text, &base_hashes(&model));
        Ok(Self { model, model_text: text, model_sha256, method, segments })
    }

    /// SHA-256 of the text of the model file, and of the files of its `base` if it has any.
    pub fn model_sha256(&self) -> &str {
        &self.model_sha256
    }

    /// The text of the model file.
    pub fn model_text(&self) -> &str {
        &self.model_text
    }

    /// The key of this task with the log of this hash.
    pub fn key(&self, log_sha256: &str) -> String {
        key(&[
            ("log", log_sha256),
            ("model", &self.model_sha256),
            ("method", self.method().name()),
            ("segments", self.segments.word()),
        ])
    }

    /// The key of the row that says that a file could not be read: it has no content, so that its path stands for it.
    pub fn key_of_unreadable(&self, path: &Path) -> String {
        self.key(&format!("unreadable {}", path.display()))
    }

    /// The method that estimates.
    fn method(&self) -> Method {
        self.method.unwrap_or(self.model.estimator.method)
    }

    /// What all rows of a log have in common.
    fn common(&self, key: String, log_sha256: Option<&str>) -> Row {
        Row {
            key,
            kind: "log".to_owned(),
            source_sha256: log_sha256.map(str::to_owned),
            model_sha256: self.model_sha256.clone(),
            model: self.model.name.clone(),
            version: VERSION.to_owned(),
            method: self.method().name().to_owned(),
            ..Row::default()
        }
    }

    /// The row of a file that the operating system does not give.
    pub fn unreadable(&self, path: &Path, error: &str) -> Row {
        let message = format!("{}: cannot be read: {error}", path.display());
        self.common(self.key_of_unreadable(path), None).refused(Refusal::Unreadable, message)
    }

    /// All rows of the log at this path, whose hash is known: one for each segment and parameter; one for each segment
    /// without numbers; one for a log without any.
    pub fn rows(&self, path: &Path, log_sha256: &str) -> Vec<Row> {
        let common = self.common(self.key(log_sha256), Some(log_sha256));
        match self.record(path, log_sha256) {
            Ok(record) => self.rows_of_record(&record, common),
            Err(error) => {
                let refusal = match &*error {
                    ReadError::Io { .. } => Refusal::Unreadable,
                    ReadError::NotRead { format, .. } if format.feature().is_some() => Refusal::FormatNotInBuild,
                    _ => Refusal::NotAFlight,
                };
                // A copy of the log elsewhere gives the same row.
                let message = error.to_string().replace(&path.display().to_string(), "the log");
                vec![common.refused(refusal, message)]
            }
        }
    }

    /// Messages name the flight by its content, wherever the file stands.
    fn record(&self, path: &Path, log_sha256: &str) -> Result<Record, Box<ReadError>> {
        let mut record = self.model.open_record_with(path, &ReadOptions::default()).map_err(Box::new)?;
        record.source = format!("log {}", log_sha256.get(..12).unwrap_or(log_sha256));
        Ok(record)
    }

    /// What the rows of one segment were made of, estimated again: `segment` is that of the rows.
    ///
    /// # Errors
    /// A sentence: the file cannot be read or has another content than this hash, there is no such segment, or it gives no numbers.
    pub fn estimation(&self, path: &Path, log_sha256: &str, segment: i64) -> Result<Estimation, String> {
        let named = |problem: &dyn std::fmt::Display| format!("{}: {problem}", path.display());
        let (hash, _) = hash_log(path).map_err(|error| named(&error))?;
        if hash != log_sha256 {
            return Err(named(&"the file has another content than when it was estimated"));
        }
        let mut record = self.record(path, log_sha256).map_err(|error| named(&error))?;
        record.source = path.display().to_string();
        let start_s = record.time.first().copied();
        let mut model = self.model.clone();
        if segment > 0 {
            let found = find(&record, &Settings::default());
            (record, model) = for_parts(&record, &model).unwrap_or((record, model));
            let manoeuvre = found.manoeuvres.iter().find(|manoeuvre| manoeuvre.number as i64 == segment);
            let part = manoeuvre.and_then(|manoeuvre| record.between(manoeuvre.from_s, manoeuvre.to_s));
            record = part.ok_or_else(|| named(&format!("has no manoeuvre {segment}")))?;
            record.source = format!("{}, manoeuvre {segment}", path.display());
        }
        self.estimate(&record, &model, start_s).map_err(|error| named(&error))
    }

    fn estimate(&self, part: &Record, model: &ModelFile, start_s: Option<f64>) -> Result<Estimation, EstimateError> {
        let options = EstimateOptions { method: self.method, start_s, ..EstimateOptions::default() };
        estimate(part, model, &options, &mut |_| {})
    }

    fn rows_of_record(&self, record: &Record, mut common: Row) -> Vec<Row> {
        common.clock_at_zero_us = record.quality.clock_at_zero_us.and_then(|clock_us| i64::try_from(clock_us).ok());
        let start_s = record.time.first().copied();
        common.duration_s = start_s.zip(record.time.last()).map(|(first, last)| last - first);
        if self.segments == Segments::Whole {
            let row = Row { segment: Some(0), ..common };
            return self.rows_of_segment(record, &self.model, start_s, row);
        }
        let found = find(record, &Settings::default());
        if found.manoeuvres.is_empty() {
            return vec![common.refused(Refusal::NoManoeuvre, found.reasons.join(" "))];
        }
        // What one manoeuvre is too short to tell of the surfaces, the whole flight may.
        let settled = for_parts(record, &self.model);
        let (record, model) = settled.as_ref().map_or((record, &self.model), |(record, model)| (record, model));
        let mut rows = Vec::new();
        for manoeuvre in &found.manoeuvres {
            let row = Row {
                segment: Some(manoeuvre.number as i64),
                from_s: finite(manoeuvre.from_s),
                to_s: finite(manoeuvre.to_s),
                input: Some(manoeuvre.words()),
                ..common.clone()
            };
            match record.between(manoeuvre.from_s, manoeuvre.to_s).filter(|_| manoeuvre.useful) {
                Some(part) => rows.extend(self.rows_of_segment(&part, model, start_s, row)),
                None => rows.push(row.refused(Refusal::NotUseful, manoeuvre.remarks.join(" "))),
            }
        }
        rows
    }

    fn rows_of_segment(&self, part: &Record, model: &ModelFile, start_s: Option<f64>, row: Row) -> Vec<Row> {
        let row = Row {
            from_s: part.time.first().copied(),
            to_s: part.time.last().copied(),
            airspeed_m_s: median_of(part, "true_airspeed"),
            alpha_rad: median_of(part, "alpha"),
            altitude_m: median_of(part, "altitude"),
            ..row
        };
        match self.estimate(part, model, start_s) {
            Ok(estimation) => row.of_estimation(&estimation),
            Err(error) => vec![row.refused(Refusal::NotEstimated, error.to_string())],
        }
    }
}

/// Median of the finite values of a channel, SI; `None` without any.
fn median_of(record: &Record, name: &str) -> Option<f64> {
    let mut values: Vec<f64> = record.channel(name)?.values.iter().copied().filter(|value| value.is_finite()).collect();
    median(&mut values)
}
