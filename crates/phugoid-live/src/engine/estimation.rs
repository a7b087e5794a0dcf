//! Samples become documents of estimates.

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::session::{Session, Step};

use super::{Publish, say};
use crate::document::{Document, Kind};
use crate::link::Latency;
use crate::receiver::Reception;

/// Between two estimates for pages, s: at most fifty a second.
const SHOWN_S: f64 = 0.02;

/// One session after the other, as often as the sender begins anew.
pub(super) struct Estimation {
    model: ModelFile,
    options: EstimateOptions,
    source: String,
    pub(super) started: Option<String>,
    /// Give every estimate, not those for pages alone.
    pub(super) every: bool,
    session: Session,
    flight: u64,
    pub(super) estimates: u64,
    shown_s: f64,
    told: Told,
    pub(super) latency: Latency,
    pub(super) waiting: Option<String>,
    refused: u64,
    /// An estimation is impossible with what came: said, and tried again with the next flight.
    broken: bool,
}

/// When the readiness that was told last was renewed, s: in any document, and in one for pages.
#[derive(Clone, Copy, Debug, Default)]
struct Told {
    any_s: Option<f64>,
    shown_s: Option<f64>,
}

impl Told {
    /// Is the readiness to be told in a document, so that those who get every one have it and those who get those for pages too?
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
            every: false,
            session,
            flight: 0,
            estimates: 0,
            shown_s: f64::NEG_INFINITY,
            told: Told::default(),
            latency: Latency::default(),
            waiting: None,
            refused: 0,
            broken: false,
        }
    }

    pub(super) fn hello(&self, publish: Publish<'_>) {
        let document = Document::Hello {
            version: env!("CARGO_PKG_VERSION"),
            source: &self.source,
            started: self.started.as_deref(),
            flight: self.flight,
            layout: self.session.layout(),
        };
        publish(Kind::Hello, &document.text());
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
            Reception::Restart { from_s, to_s } => self.restart(from_s, to_s, now_ns, publish),
            Reception::Event { kind, message } => say(None, now_ns, kind, &message, publish),
        }
    }

    fn sample(&mut self, time_s: f64, values: &[f64], now_ns: u64, publish: Publish<'_>) {
        if self.broken {
            return;
        }
        match self.session.update(time_s, values) {
            Ok(Step::Estimated) => {
                self.waiting = None;
                self.estimates += 1;
                if let Some(snapshot) = self.session.snapshot() {
                    // A hair less than the step, so that rounding does not halve a rate of exactly fifty a second.
                    let shown = snapshot.time_s - self.shown_s >= SHOWN_S - 1e-6;
                    if shown {
                        self.shown_s = snapshot.time_s;
                    }
                    if shown || self.every {
                        let readiness = self.told.is_due(snapshot.readiness_s, shown);
                        let document = Document::estimate(self.flight, snapshot, readiness);
                        publish(Kind::Estimate { shown, readiness }, &document.text());
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
                    say(Some(time_s), now_ns, "refused", &reason, publish);
                }
            }
            Err(error) => {
                self.broken = true;
                say(Some(time_s), now_ns, "impossible", &format!("no estimation of this flight: {error}"), publish);
            }
        }
        for event in self.session.take_events() {
            say(Some(event.time_s), now_ns, event.kind.word(), &event.message, publish);
        }
    }

    fn restart(&mut self, from_s: f64, to_s: f64, now_ns: u64, publish: Publish<'_>) {
        let message = format!(
            "the sender's clock went from {from_s:.3} s to {to_s:.3} s: it was restarted; the estimation begins anew"
        );
        say(Some(to_s), now_ns, "restart", &message, publish);
        match Session::new(&self.model, &self.options) {
            Ok(session) => self.session = session,
            // It could be made at the start, so that it can be made now.
            Err(error) => say(None, now_ns, "impossible", &error.to_string(), publish),
        }
        self.flight += 1;
        (self.broken, self.shown_s, self.waiting, self.told) = (false, f64::NEG_INFINITY, None, Told::default());
        self.hello(publish);
    }
}
