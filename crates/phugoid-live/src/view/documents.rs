//! The documents that `phugoid live` publishes, one per line.

use std::io::{BufRead, Read};

use phugoid_identification::estimation::ParameterReadiness;
use phugoid_identification::session::Layout;
use serde::Deserialize;
use serde_json::Value;

use super::thinned::Thinned;
use super::{Event, FinalParameter, Finished, Hello, ViewError};

/// Longest line that is taken for a document; an estimate of 48 parameters has some twenty thousand characters.
const LINE_BYTES: u64 = 1 << 24;
/// Events kept.
const MOST_EVENTS: usize = 10_000;

#[derive(Deserialize)]
struct Estimate {
    time_s: f64,
    parameters: Vec<Parameter>,
    outputs: Vec<Option<f64>>,
    predicted: Vec<Option<f64>>,
    residuals: Vec<Option<f64>>,
    inputs: Vec<Option<f64>>,
}

#[derive(Deserialize)]
struct Parameter {
    value: Option<f64>,
    std_error: Option<f64>,
    status: String,
    #[serde(default)]
    readiness: Option<ParameterReadiness>,
}

/// What has been read.
#[derive(Default)]
struct Reading {
    begun: Option<(Hello, Thinned)>,
    last: Option<Estimate>,
    events: Vec<Event>,
    link: Option<Value>,
    notes: Vec<String>,
    bad: usize,
    estimates: usize,
}

pub(super) fn read(mut file: impl BufRead) -> Result<Finished, ViewError> {
    let mut reading = Reading::default();
    let mut line = Vec::new();
    for number in 1_usize.. {
        line.clear();
        if file.by_ref().take(LINE_BYTES).read_until(b'\n', &mut line)? == 0 {
            break;
        }
        if line.iter().all(u8::is_ascii_whitespace) {
            continue;
        }
        if let Err(error) = reading.document(&line) {
            // A stream that was killed ends in the middle of a line.
            reading.bad += 1;
            if reading.bad == 1 {
                let what = if line.ends_with(b"\n") { "is left out" } else { "at the end is cut off and left out" };
                reading.notes.push(format!("Line {number} {what}: {error}."));
            }
        }
    }
    reading.finish()
}

impl Reading {
    fn document(&mut self, line: &[u8]) -> Result<(), serde_json::Error> {
        // Estimates are most of the documents: they are not read twice.
        if let Some((_, columns)) = &mut self.begun
            && let Ok(Tagged { kind: Kind::Estimate, estimate }) = serde_json::from_slice(line)
        {
            columns.push(estimate.time_s, &row(&estimate));
            self.estimates += 1;
            self.last = Some(estimate);
            return Ok(());
        }
        let document: Value = serde_json::from_slice(line)?;
        match document.get("type").and_then(Value::as_str) {
            Some("hello") => self.hello(document)?,
            Some("event") if self.events.len() < MOST_EVENTS => self.events.push(serde_json::from_value(document)?),
            Some("link") => self.link = Some(document),
            _ => {}
        }
        Ok(())
    }

    /// A later `hello` is that of another start: what came before it is another result.
    fn hello(&mut self, document: Value) -> Result<(), serde_json::Error> {
        let source = document.get("source").and_then(Value::as_str).unwrap_or_default().to_owned();
        let layout = document.get("layout").cloned().unwrap_or_default();
        let layout: Layout = serde_json::from_value(layout)?;
        if self.estimates > 0 {
            let earlier = format!("The {} estimates before the last start are left out.", self.estimates);
            *self = Self { notes: vec![earlier], ..Self::default() };
        }
        let columns = Thinned::new(layout.parameters.len(), layout.outputs.len(), layout.inputs.len());
        self.begun = Some((Hello { source, layout }, columns));
        Ok(())
    }

    fn finish(mut self) -> Result<Finished, ViewError> {
        let Some((hello, columns)) = self.begun else {
            return Err(ViewError::NoResult("there is no document of type `hello` in it".to_owned()));
        };
        let Some(last) = self.last else {
            return Err(ViewError::NoResult("there is no estimate in it".to_owned()));
        };
        if self.bad > 1 {
            self.notes.push(format!("{} lines in all are left out.", self.bad));
        }
        let parameter = |p: Parameter| FinalParameter {
            value: p.value,
            std_error: p.std_error,
            status: p.status,
            readiness: p.readiness,
            truth: None,
        };
        Ok(Finished {
            hello,
            history: columns.finish(),
            parameters: last.parameters.into_iter().map(parameter).collect(),
            events: self.events,
            verdict: self.notes,
            link: self.link,
        })
    }
}

#[derive(Deserialize)]
struct Tagged {
    #[serde(rename = "type")]
    kind: Kind,
    #[serde(flatten)]
    estimate: Estimate,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Estimate,
}

fn row(estimate: &Estimate) -> Vec<f64> {
    let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let mut row = Vec::with_capacity(3 * (estimate.parameters.len() + estimate.outputs.len()) + estimate.inputs.len());
    for parameter in &estimate.parameters {
        let (value, bound) = (number(parameter.value), 2.0 * number(parameter.std_error));
        row.extend([value, value - bound, value + bound]);
    }
    for ((measured, predicted), residual) in estimate.outputs.iter().zip(&estimate.predicted).zip(&estimate.residuals) {
        row.extend([number(*measured), number(*predicted), number(*residual)]);
    }
    row.extend(estimate.inputs.iter().copied().map(number));
    row
}
