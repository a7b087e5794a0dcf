//! A result from the documents that `phugoid live` publishes.

use std::io::{BufRead, Read};

use phugoid_identification::estimation::ParameterReadiness;
use phugoid_identification::session::Layout;
use serde::Deserialize;
use serde_json::Value;

use super::finished::{Event, FinalParameter, Finished, Hello, ViewError};
use super::thinned::{Row, Thinned};
use crate::audience::Audience;
use crate::document::{DocumentKind, DocumentType};
use crate::event::{EventKind, LiveEventKind};

/// Longest line that is read as a document. An estimate of 48 parameters has some twenty thousand characters.
const LINE_BYTES: u64 = 1 << 24;
/// Events that are kept at most.
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
    /// None in documents of earlier versions.
    #[serde(default)]
    systematic_std: Option<f64>,
    status: String,
    #[serde(default)]
    readiness: Option<ParameterReadiness>,
}

/// Collects documents into a result: those of a file, or those that are published while a recording is estimated again.
///
/// ```
/// use phugoid_live::run::Audience;
/// use phugoid_live::document::DocumentKind;
/// use phugoid_live::view::{Collector, ViewError};
///
/// let mut collector = Collector::default();
/// collector.hear(DocumentKind::Event, r#"{"type":"event","time_s":null,"kind":"silent","message":"nothing has arrived for 2 s"}"#);
/// // Without the names of the parameters and without an estimate there is no result.
/// assert!(matches!(collector.finish(), Err(ViewError::NoResult(_))));
/// ```
#[derive(Default)]
pub struct Collector {
    begun: Option<(Hello, Thinned)>,
    last: Option<Estimate>,
    events: Vec<Event>,
    link: Option<Value>,
    /// Sentences for people about what was left out.
    notes: Vec<String>,
    /// Documents that could not be read.
    bad: usize,
    estimates: usize,
}

/// Reads documents, one per line.
pub(super) fn read(mut file: impl BufRead) -> Result<Finished, ViewError> {
    let mut reading = Collector::default();
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
            // If the program was killed, the file ends within a line.
            reading.bad += 1;
            if reading.bad == 1 {
                let what = if line.ends_with(b"\n") { "is left out" } else { "at the end is cut off and left out" };
                reading.notes.push(format!("Line {number} {what}: {error}."));
            }
        }
    }
    reading.finish()
}

impl Audience for Collector {
    fn hear(&mut self, _: DocumentKind, document: &str) {
        if let Err(error) = self.document(document.as_bytes()) {
            self.bad += 1;
            self.notes.push(format!("A document is left out: {error}."));
        }
    }
}

impl Collector {
    fn document(&mut self, line: &[u8]) -> Result<(), serde_json::Error> {
        // Most documents are estimates, so they are tried first and read only once.
        if let Some((_, columns)) = &mut self.begun
            && let Ok(Tagged { kind: DocumentType::Estimate, mut estimate }) = serde_json::from_slice(line)
        {
            columns.push(estimate.time_s, &row(&estimate));
            // The readiness is only in documents where it was renewed; it is valid until the next of them.
            let before = self.last.take().map(|last| last.parameters).unwrap_or_default();
            for (parameter, before) in estimate.parameters.iter_mut().zip(before) {
                parameter.readiness = parameter.readiness.take().or(before.readiness);
            }
            self.estimates += 1;
            self.last = Some(estimate);
            return Ok(());
        }
        let document: Value = serde_json::from_slice(line)?;
        match DocumentType::of(&document) {
            DocumentType::Hello => self.hello(document)?,
            DocumentType::Event if self.events.len() < MOST_EVENTS => {
                self.events.push(serde_json::from_value(document)?);
            }
            DocumentType::Link => self.link = Some(document),
            _ => {}
        }
        Ok(())
    }

    /// A later `hello` means that the sender was restarted; what came before belongs to another result.
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

    /// The result of the documents so far.
    ///
    /// # Errors
    /// [`ViewError::NoResult`] if there is no `hello` or no estimate, with the reason that was published for it.
    pub fn finish(mut self) -> Result<Finished, ViewError> {
        let Some((hello, columns)) = self.begun else {
            return Err(ViewError::NoResult("there is no document of type `hello` in it".to_owned()));
        };
        let Some(last) = self.last else {
            let explains = [LiveEventKind::Waiting, LiveEventKind::Impossible].map(EventKind::Live);
            let why = self.events.iter().rfind(|event| explains.contains(&event.kind));
            let why = why.map(|event| format!(": {}", event.message)).unwrap_or_default();
            return Err(ViewError::NoResult(format!("there is no estimate in it{why}")));
        };
        if self.bad > 1 {
            self.notes.push(format!("{} lines in all are left out.", self.bad));
        }
        let parameter = |p: Parameter| FinalParameter {
            value: p.value,
            std_error: p.std_error,
            systematic_std: p.systematic_std,
            status: p.status,
            readiness: p.readiness,
            truth: None,
        };
        Ok(Finished {
            hello,
            history: columns.finish(),
            parameters: last.parameters.into_iter().map(parameter).collect(),
            events: self.events,
            status: None,
            verdict: self.notes,
            link: self.link,
        })
    }
}

/// A document whose fields are those of an estimate.
#[derive(Deserialize)]
struct Tagged {
    #[serde(rename = "type")]
    kind: DocumentType,
    #[serde(flatten)]
    estimate: Estimate,
}

fn row(estimate: &Estimate) -> Row {
    let number = |value: &Option<f64>| value.unwrap_or(f64::NAN);
    let outputs = estimate.outputs.iter().zip(&estimate.predicted).zip(&estimate.residuals);
    Row::new(
        estimate.parameters.iter().map(|parameter| [number(&parameter.value), number(&parameter.std_error)]),
        outputs.map(|((measured, predicted), residual)| [measured, predicted, residual].map(number)),
        estimate.inputs.iter().map(number),
    )
}
