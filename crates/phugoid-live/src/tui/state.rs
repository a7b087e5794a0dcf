//! What the terminal view knows from the documents.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use phugoid_identification::session::Layout;
use serde::Deserialize;
use serde_json::Value;

use super::sparkline::Sparkline;
use crate::document::DocumentType;
use crate::event::EventKind;

/// Events that are kept at most.
const MOST_EVENTS: usize = 100;
/// The data are called old if there has been no estimate for this long.
const STALE: Duration = Duration::from_secs(2);

/// What the terminal view shows.
#[derive(Clone, Debug, Default)]
pub struct State {
    pub(super) source: String,
    pub(super) layout: Layout,
    pub(super) estimate: Option<Estimate>,
    pub(super) sparklines: Vec<Sparkline>,
    pub(super) events: VecDeque<Event>,
    pub(super) link: Option<Link>,
    /// Why the stream has ended, once it has.
    pub(super) end: Option<String>,
    /// When the last estimate came.
    pub(super) estimate_at: Option<Instant>,
    /// The state that is shown while the view is paused.
    pub(super) paused: Option<Box<State>>,
    /// First row of the table that is shown.
    pub(super) first_row: usize,
    /// Why the last document that could not be read could not.
    pub(super) unreadable: Option<String>,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Estimate {
    pub(super) time_s: f64,
    pub(super) change: String,
    pub(super) parameters: Vec<Parameter>,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Parameter {
    pub(super) value: Option<f64>,
    pub(super) std_error: Option<f64>,
    pub(super) status: String,
    /// Only in documents where it was renewed; valid until the next of them.
    pub(super) readiness: Option<Readiness>,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Readiness {
    pub(super) verdict: String,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Event {
    pub(super) time_s: Option<f64>,
    pub(super) kind: EventKind,
    pub(super) message: String,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Link {
    pub(super) received: u64,
    pub(super) lost: u64,
    pub(super) late: u64,
    pub(super) duplicated: u64,
    pub(super) reordered: u64,
    pub(super) restarts: u64,
    pub(super) latency_ms: Latency,
    pub(super) recorded_bytes: u64,
    pub(super) waiting: Option<String>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Latency {
    pub(super) p50: Option<f64>,
    pub(super) p99_9: Option<f64>,
}

#[derive(Deserialize)]
struct Hello {
    source: String,
    layout: Layout,
}

impl State {
    /// Takes one document, which arrived at the time `now`. Types and fields that are not known are ignored.
    pub fn take(&mut self, text: &str, now: Instant) {
        if let Err(error) = self.read(text, now) {
            self.unreadable = Some(error.to_string());
        }
    }

    fn read(&mut self, text: &str, now: Instant) -> Result<(), serde_json::Error> {
        let document: Value = serde_json::from_str(text)?;
        match DocumentType::of(&document) {
            DocumentType::Hello => {
                let Hello { source, layout } = serde_json::from_value(document)?;
                (self.source, self.layout) = (source, layout);
                self.sparklines = vec![Sparkline::default(); self.layout.parameters.len()];
                (self.estimate, self.estimate_at, self.end) = (None, None, None);
            }
            DocumentType::Estimate => {
                let mut estimate: Estimate = serde_json::from_value(document)?;
                let before = self.estimate.take().map(|estimate| estimate.parameters).unwrap_or_default();
                for (parameter, before) in estimate.parameters.iter_mut().zip(before) {
                    parameter.readiness = parameter.readiness.take().or(before.readiness);
                }
                for (sparkline, parameter) in self.sparklines.iter_mut().zip(&estimate.parameters) {
                    sparkline.push(estimate.time_s, parameter.value.unwrap_or(f64::NAN));
                }
                self.estimate = Some(estimate);
                self.estimate_at = Some(now);
            }
            DocumentType::Event => {
                self.events.push_front(serde_json::from_value(document)?);
                self.events.truncate(MOST_EVENTS);
            }
            DocumentType::Link => self.link = Some(serde_json::from_value(document)?),
            DocumentType::End => {
                let reason = document.get("reason").and_then(Value::as_str);
                self.end = Some(reason.unwrap_or("no reason was given").to_owned());
            }
            DocumentType::Unknown => {}
        }
        Ok(())
    }

    /// Whether the last document has come.
    pub fn has_ended(&self) -> bool {
        self.end.is_some()
    }

    /// Pauses the view, or lets it go on. Documents are taken while it is paused, too.
    pub fn pause(&mut self) {
        self.paused = match self.paused {
            Some(_) => None,
            None => Some(Box::new(self.clone())),
        };
    }

    /// Scrolls the table of parameters by so many rows; it stops at the first and the last.
    pub fn scroll(&mut self, rows: isize) {
        let last = self.layout.parameters.len().saturating_sub(1);
        self.first_row = self.first_row.saturating_add_signed(rows).min(last);
    }

    /// The time since the last estimate, s, if it is so long that the data are old.
    pub(super) fn stale(&self, now: Instant) -> Option<f64> {
        let age = now.saturating_duration_since(self.estimate_at?);
        (age > STALE && !self.has_ended()).then_some(age.as_secs_f64())
    }
}
