//! From samples to the documents of their estimates.

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::session::{Session, Step};

use crate::document::{Document, DocumentKind, Publish, publish_event, seconds};
use crate::event::{EventKind, LiveEventKind};
use crate::link::Latency;
use crate::receiver::Reception;

/// Least time between two estimates for the page, s: at most fifty a second.
const SHOWN_INTERVAL_S: f64 = 0.02;

/// The running session, which is replaced by a new one whenever the sender's clock starts again.
pub(super) struct Estimation {
    model: ModelFile,
    options: EstimateOptions,
    source: String,
    pub(super) started: Option<String>,
    /// Publish every estimate, not only those for the page.
    pub(super) publish_all: bool,
    session: Session,
    /// Number of restarts of the sender.
    flight: u64,
    pub(super) estimates: u64,
    /// Time of the last estimate for the page, s.
    shown_s: f64,
    readiness: ReadinessPublished,
    pub(super) latency: Latency,
    /// What the session waits for before its first estimate.
    pub(super) waiting: Option<String>,
    refused: u64,
    /// Why the session left out a sample for the first time.
    pub(super) first_refusal: Option<String>,
    /// Why the session has failed. That is published once; the next flight is tried again.
    pub(super) failure: Option<String>,
}

/// The time, s, at which the readiness that was published last had been computed.
#[derive(Clone, Copy, Debug, Default)]
struct ReadinessPublished {
    /// In a document of any kind.
    any_s: Option<f64>,
    /// In a document for the page.
    shown_s: Option<f64>,
}

impl ReadinessPublished {
    /// Whether the next document has to hold the readiness, and notes that it does. Readers of every document and
    /// readers of those for the page only must both get each readiness.
    fn is_due(&mut self, renewed_s: Option<f64>, shown: bool) -> bool {
        let due = renewed_s != self.any_s || (shown && renewed_s != self.shown_s);
        self.any_s = renewed_s;
        if shown {
            self.shown_s = renewed_s;
        }
        due
    }
}

impl Estimation {
    pub(super) fn new(model: &ModelFile, options: &EstimateOptions, source: &str, session: Session) -> Self {
        Self {
            model: model.clone(),
            options: options.clone(),
            source: source.to_owned(),
            started: None,
            publish_all: false,
            session,
            flight: 0,
            estimates: 0,
            shown_s: f64::NEG_INFINITY,
            readiness: ReadinessPublished::default(),
            latency: Latency::default(),
            waiting: None,
            refused: 0,
            first_refusal: None,
            failure: None,
        }
    }

    pub(super) fn hello(&self, now_ns: u64, publish: Publish<'_>) {
        let document = Document::Hello {
            version: env!("CARGO_PKG_VERSION"),
            source: &self.source,
            started: self.started.as_deref(),
            flight: self.flight,
            layout: self.session.layout(),
        };
        publish(DocumentKind::Hello, &document.text());
        if let Some(message) = self.model.declared_and_not_in_bounds_of_base() {
            publish_event(None, now_ns, &LiveEventKind::Bounds.into(), &message, publish);
        }
    }

    pub(super) fn take(
        &mut self,
        reception: Reception<'_>,
        now_ns: u64,
        finished_ns: &dyn Fn() -> u64,
        publish: Publish<'_>,
    ) {
        match reception {
            Reception::Sample { time_s, arrival_ns, values } => {
                self.sample(time_s, values, now_ns, publish);
                if let Some(latency_ns) = finished_ns().checked_sub(arrival_ns) {
                    self.latency.add(latency_ns);
                }
            }
            Reception::Restart { from_s, to_s, pause_ns } => self.restart([from_s, to_s], pause_ns, now_ns, publish),
            Reception::Event { kind, message } => publish_event(None, now_ns, &kind.into(), &message, publish),
        }
    }

    fn sample(&mut self, time_s: f64, values: &[f64], now_ns: u64, publish: Publish<'_>) {
        if self.failure.is_some() {
            return;
        }
        match self.session.update(time_s, values) {
            Ok(Step::Estimated) => {
                self.waiting = None;
                self.estimates += 1;
                if let Some(snapshot) = self.session.snapshot() {
                    // A little less than the interval, because rounding would otherwise halve a rate of exactly fifty a
                    // second.
                    let shown = snapshot.time_s - self.shown_s >= SHOWN_INTERVAL_S - 1e-6;
                    if shown {
                        self.shown_s = snapshot.time_s;
                    }
                    if shown || self.publish_all {
                        let readiness = self.readiness.is_due(snapshot.readiness_s, shown);
                        let document = Document::estimate(self.flight, snapshot, readiness);
                        publish(DocumentKind::Estimate { shown, readiness }, &document.text());
                    }
                }
            }
            Ok(Step::Waiting { have_s, need_s, reason }) => {
                let collected = || format!("{have_s:.1} s of {need_s:.1} s collected");
                self.waiting = Some(reason.unwrap_or_else(collected));
            }
            Ok(Step::Refused(reason)) => {
                self.refused += 1;
                if self.refused <= 5 {
                    publish_event(Some(time_s), now_ns, &LiveEventKind::Refused.into(), &reason, publish);
                }
                self.first_refusal.get_or_insert(reason);
            }
            Err(error) => {
                let message = format!("no estimation of this flight: {error}");
                publish_event(Some(time_s), now_ns, &LiveEventKind::Impossible.into(), &message, publish);
                self.failure = Some(message);
            }
        }
        for event in self.session.take_events() {
            publish_event(Some(event.time_s), now_ns, &EventKind::Estimation(event.kind), &event.message, publish);
        }
    }

    fn restart(&mut self, [from_s, to_s]: [f64; 2], pause_ns: u64, now_ns: u64, publish: Publish<'_>) {
        let mut kept = false;
        if self.failure.is_none() {
            kept = self.session.resume(to_s, seconds(pause_ns));
        } else {
            match Session::new(&self.model, &self.options) {
                Ok(session) => self.session = session,
                // The same call succeeded at the start, so this is not expected.
                Err(error) => {
                    publish_event(None, now_ns, &LiveEventKind::Impossible.into(), &error.to_string(), publish);
                }
            }
        }
        let then = match kept {
            true => "the parameters are kept with their bounds, the states start again",
            false => "the estimation begins with it",
        };
        let message =
            format!("the sender's clock went from {from_s:.3} s to {to_s:.3} s: it was restarted or set; {then}");
        publish_event(Some(to_s), now_ns, &LiveEventKind::Restart.into(), &message, publish);
        self.flight += 1;
        (self.failure, self.shown_s, self.waiting) = (None, f64::NEG_INFINITY, None);
        self.readiness = ReadinessPublished::default();
        self.hello(now_ns, publish);
    }
}
