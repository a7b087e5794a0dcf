//! What the documents have told.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use phugoid_identification::session::Layout;
use serde::Deserialize;
use serde_json::Value;

use super::course::Course;

/// Events kept.
const MOST_EVENTS: usize = 100;
/// Without an estimate for so long what is shown is called old.
const STALE: Duration = Duration::from_secs(2);

/// What is shown.
#[derive(Clone, Debug, Default)]
pub struct State {
    pub(super) source: String,
    pub(super) layout: Layout,
    pub(super) estimate: Option<Estimate>,
    pub(super) courses: Vec<Course>,
    pub(super) events: VecDeque<Event>,
    pub(super) link: Option<Link>,
    pub(super) end: Option<String>,
    pub(super) estimate_at: Option<Instant>,
    /// The state that is shown while the screen is paused.
    pub(super) held: Option<Box<State>>,
    pub(super) first_row: usize,
    /// A document that could not be understood.
    pub(super) trouble: Option<String>,
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
    /// Told where it was renewed; it stands until the next.
    pub(super) readiness: Option<Readiness>,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Readiness {
    pub(super) verdict: String,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Event {
    pub(super) time_s: Option<f64>,
    pub(super) kind: String,
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
    /// Takes one document. What later versions add is passed over.
    pub fn take(&mut self, text: &str, now: Instant) {
        if let Err(error) = self.understand(text, now) {
            self.trouble = Some(error.to_string());
        }
    }

    fn understand(&mut self, text: &str, now: Instant) -> Result<(), serde_json::Error> {
        let document: Value = serde_json::from_str(text)?;
        match document.get("type").and_then(Value::as_str) {
            Some("hello") => {
                let Hello { source, layout } = serde_json::from_value(document)?;
                (self.source, self.layout) = (source, layout);
                self.courses = vec![Course::default(); self.layout.parameters.len()];
                (self.estimate, self.estimate_at, self.end) = (None, None, None);
            }
            Some("estimate") => {
                let mut estimate: Estimate = serde_json::from_value(document)?;
                let before = self.estimate.take().map(|estimate| estimate.parameters).unwrap_or_default();
                for (parameter, before) in estimate.parameters.iter_mut().zip(before) {
                    parameter.readiness = parameter.readiness.take().or(before.readiness);
                }
                for (course, parameter) in self.courses.iter_mut().zip(&estimate.parameters) {
                    course.push(estimate.time_s, parameter.value.unwrap_or(f64::NAN));
                }
                self.estimate = Some(estimate);
                self.estimate_at = Some(now);
            }
            Some("event") => {
                self.events.push_front(serde_json::from_value(document)?);
                self.events.truncate(MOST_EVENTS);
            }
            Some("link") => self.link = Some(serde_json::from_value(document)?),
            Some("end") => {
                let reason = document.get("reason").and_then(Value::as_str);
                self.end = Some(reason.unwrap_or("no reason was given").to_owned());
            }
            _ => {}
        }
        Ok(())
    }

    /// True after the last document.
    pub fn has_ended(&self) -> bool {
        self.end.is_some()
    }

    /// Holds what is shown, or goes on; documents are taken all the while.
    pub fn pause(&mut self) {
        self.held = match self.held {
            Some(_) => None,
            None => Some(Box::new(self.clone())),
        };
    }

    /// Moves the table of parameters by so many rows.
    pub fn scroll(&mut self, rows: isize) {
        let last = self.layout.parameters.len().saturating_sub(1);
        self.first_row = self.first_row.saturating_add_signed(rows).min(last);
    }

    /// Seconds since the last estimate, where that is too long.
    pub(super) fn stale(&self, now: Instant) -> Option<f64> {
        let age = now.saturating_duration_since(self.estimate_at?);
        (age > STALE && !self.has_ended()).then_some(age.as_secs_f64())
    }
}
