//! From arrivals to documents: reception and estimation, without threads, files or clocks of their own.

mod estimation;

use phugoid_flight_data::log::utc;
use phugoid_identification::estimate::{EstimateError, EstimateOptions};
use phugoid_identification::model_file::{AirDensity, ModelFile, Source};
use phugoid_identification::session::Session;

use crate::arrival::Arrival;
use crate::document::{Document, Kind};
use crate::link::Counts;
use crate::receiver::{Receiver, ReceiverOptions};
use estimation::Estimation;

/// Between two documents about the link, ns.
const LINK_NS: u64 = 1_000_000_000;

/// What the link document says beside what the engine knows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Beside {
    /// Bytes of the recording.
    pub recorded_bytes: u64,
    /// Arrivals that could not be recorded.
    pub recording_dropped: u64,
    /// Estimates that a reader was too slow for.
    pub published_dropped: u64,
}

/// Reception and estimation.
pub struct Engine {
    receiver: Receiver,
    estimation: Estimation,
    /// Stamp of the last thing done, ns: nothing happens before it any more.
    now_ns: u64,
    link_ns: u64,
}

/// Gives every document to whoever publishes it.
pub type Publish<'a> = &'a mut dyn FnMut(Kind, &str);

impl Engine {
    /// An engine that has received nothing. `source` is said to readers. Of the estimates it gives at most fifty a second, those for
    /// pages; see [`Engine::with_every_estimate`].
    ///
    /// # Errors
    /// [`EstimateError`]: the model or the options do not make a live estimation; a mapping of the model file that cannot be.
    pub fn new(
        model: &ModelFile,
        options: &EstimateOptions,
        receiver: &ReceiverOptions,
        source: &str,
    ) -> Result<Self, EstimateError> {
        let session = Session::new(model, options)?;
        Ok(Self {
            receiver: Receiver::new(session.channels(), receiver)
                .map_err(EstimateError::Model)?
                .with_air_density(stated_density(model)),
            estimation: Estimation::new(model, options, source, session),
            now_ns: 0,
            link_ns: 0,
        })
    }

    /// Gives every estimate.
    pub fn with_every_estimate(mut self) -> Self {
        self.estimation.every = true;
        self
    }

    /// Says when the reception began, ns since 1970-01-01 UTC.
    pub fn with_start(mut self, wall_ns: u64) -> Self {
        self.estimation.started = utc::text(wall_ns as f64 / 1e9);
        self
    }

    /// The first document.
    pub fn begin(&self, publish: Publish<'_>) {
        self.estimation.hello(publish);
    }

    /// Counts so far.
    pub fn counts(&self) -> Counts {
        *self.receiver.counts()
    }

    /// Estimates so far.
    pub fn estimates(&self) -> u64 {
        self.estimation.estimates
    }

    /// Gives an arrival a stamp that is not before what has been done, so that a recording of it is in order.
    pub fn stamp(&self, arrival: &mut Arrival) {
        arrival.arrival_ns = arrival.arrival_ns.max(self.now_ns);
    }

    /// Takes what arrived. `finished_ns` gives the time at which an estimate is made, for the latency.
    pub fn take(&mut self, arrival: &Arrival, finished_ns: &dyn Fn() -> u64, publish: Publish<'_>) {
        self.now_ns = self.now_ns.max(arrival.arrival_ns);
        let (estimation, now_ns) = (&mut self.estimation, self.now_ns);
        self.receiver.take(arrival, &mut |reception| estimation.take(reception, now_ns, finished_ns, publish));
    }

    /// When [`Engine::advance`] is due if nothing arrives before, ns.
    pub fn deadline_ns(&self) -> Option<u64> {
        self.receiver.deadline_ns()
    }

    /// Does what was due at this time, ns.
    pub fn advance(&mut self, now_ns: u64, finished_ns: &dyn Fn() -> u64, publish: Publish<'_>) {
        // What is due is done as of its time: a replay, where no clock runs, does it then too.
        while let Some(due_ns) = self.receiver.deadline_ns().filter(|due| *due <= now_ns) {
            self.now_ns = self.now_ns.max(due_ns);
            let (estimation, at_ns) = (&mut self.estimation, self.now_ns);
            self.receiver.advance(due_ns, &mut |reception| estimation.take(reception, at_ns, finished_ns, publish));
        }
    }

    /// Tells about the link, once a second of arrivals.
    pub fn tell_link(&mut self, now_ns: u64, beside: Beside, publish: Publish<'_>) {
        if now_ns < self.link_ns {
            return;
        }
        self.link_ns = now_ns.saturating_add(LINK_NS);
        let waiting = self.waiting();
        let document = Document::Link {
            arrival_s: seconds(now_ns),
            counts: self.counts(),
            latency_ms: self.estimation.latency.told(),
            recorded_bytes: beside.recorded_bytes,
            recording_dropped: beside.recording_dropped,
            published_dropped: beside.published_dropped,
            waiting: waiting.as_deref(),
        };
        publish(Kind::Link, &document.text());
    }

    /// What the estimation waits for, if it has not begun.
    fn waiting(&self) -> Option<String> {
        let waiting = self.estimation.waiting.clone()?;
        Some(self.receiver.lacking().map_or_else(|| waiting.clone(), |lacking| format!("{waiting}; {lacking}")))
    }

    /// Something to be said about the reception itself.
    pub fn tell(&self, now_ns: u64, kind: &str, message: &str, publish: Publish<'_>) {
        let document = Document::Event { time_s: None, arrival_s: seconds(now_ns), kind, message };
        publish(Kind::Event, &document.text());
    }

    /// Does what still waits and says that it is over.
    pub fn end(&mut self, reason: &str, finished_ns: &dyn Fn() -> u64, publish: Publish<'_>) {
        let (estimation, now_ns) = (&mut self.estimation, self.now_ns);
        self.receiver.finish(&mut |reception| estimation.take(reception, now_ns, finished_ns, publish));
        if let Some(waiting) = self.waiting() {
            self.tell(now_ns, "waiting", &format!("it ended before an estimation could begin: {waiting}"), publish);
        }
        let document = Document::End {
            reason,
            counts: self.counts(),
            estimates: self.estimation.estimates,
            latency_ms: self.estimation.latency.told(),
        };
        publish(Kind::End, &document.text());
    }
}

/// The density of the air where the model file states a constant, kg/m^3.
fn stated_density(model: &ModelFile) -> Option<f64> {
    match model.aircraft.air_density {
        AirDensity::Known(Source::Constant(density)) => Some(density),
        _ => None,
    }
}

fn say(time_s: Option<f64>, now_ns: u64, kind: &str, message: &str, publish: Publish<'_>) {
    publish(Kind::Event, &Document::Event { time_s, arrival_s: seconds(now_ns), kind, message }.text());
}

fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}
