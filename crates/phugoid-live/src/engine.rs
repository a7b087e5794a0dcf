//! From arrivals to documents: reception and estimation, without threads, files or clocks. The same arrivals give the
//! same documents.

mod estimation;

use phugoid_flight_data::log::utc;
use phugoid_identification::estimate::{EstimateError, EstimateOptions};
use phugoid_identification::model_file::{AirDensity, ModelFile, Source};
use phugoid_identification::session::Session;

use crate::arrival::Arrival;
pub use crate::document::Publish;
use crate::document::{Document, DocumentKind, publish_event, seconds};
use crate::event::LiveEventKind;
use crate::link::Counts;
use crate::receiver::{Receiver, ReceiverOptions};
use estimation::Estimation;

/// Time between two documents about the link, ns.
const LINK_INTERVAL_NS: u64 = 1_000_000_000;

/// Counts of the recorder and of the writer of lines, which the engine does not know; they go into the document about
/// the link.
#[derive(Clone, Copy, Debug, Default)]
pub struct WriterCounts {
    /// Bytes of the recording so far.
    pub recorded_bytes: u64,
    /// Arrivals that could not be recorded.
    pub recording_dropped: u64,
    /// Estimates that were left out for a slow reader of the lines.
    pub published_dropped: u64,
    /// Datagrams of others than the sender in use that were thrown away as they came; they count as strangers.
    pub strangers_dropped: u64,
}

/// Reception and estimation of one live stream.
///
/// The caller hands over what arrives ([`Engine::take`]) and calls [`Engine::advance`] when [`Engine::deadline_ns`] has
/// passed; every document goes to the function that it passes in.
///
/// ```
/// use phugoid_identification::estimate::EstimateOptions;
/// use phugoid_identification::model_file::ModelFile;
/// use phugoid_live::document::DocumentKind;
/// use phugoid_live::engine::Engine;
/// use phugoid_live::receiver::ReceiverOptions;
///
/// let model = ModelFile::named("f16")?;
/// let mut engine = Engine::new(&model, &EstimateOptions::default(), &ReceiverOptions::default(), "nobody")?;
/// let mut kinds = Vec::new();
/// let mut publish = |kind: DocumentKind, _json: &str| kinds.push(kind);
/// engine.begin(&mut publish);
/// engine.end("nothing came", &|| 0, &mut publish);
/// assert_eq!(kinds, [DocumentKind::Hello, DocumentKind::End]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Engine {
    receiver: Receiver,
    estimation: Estimation,
    /// Stamp of the last step, ns. No later step gets an earlier stamp.
    now_ns: u64,
    /// When the next document about the link is due, ns.
    link_due_ns: u64,
    /// Datagrams of strangers that the source has thrown away, as last told.
    strangers_dropped: u64,
}

impl Engine {
    /// An engine that has received nothing. `source` is the name of the source, which goes into the `hello` document.
    /// It publishes at most fifty estimates a second; see [`Engine::with_every_estimate`].
    ///
    /// # Errors
    /// [`EstimateError`] if the model and the options cannot be estimated live, or if a column mapping of the model
    /// file names a field that MAVLink does not have.
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
            link_due_ns: 0,
            strangers_dropped: 0,
        })
    }

    /// Publishes every estimate, not only those for the page.
    pub fn with_every_estimate(mut self) -> Self {
        self.estimation.publish_all = true;
        self
    }

    /// Sets the start of the reception, ns since 1970-01-01 UTC, for the `hello` document. Without it `started` is
    /// `null` there.
    pub fn with_start(mut self, wall_ns: u64) -> Self {
        self.estimation.started = utc::text(wall_ns as f64 / 1e9);
        self
    }

    /// Publishes the first document, `hello`.
    pub fn begin(&self, publish: Publish<'_>) {
        self.estimation.hello(self.now_ns, publish);
    }

    /// Counts of the link since the start.
    pub fn counts(&self) -> Counts {
        *self.receiver.counts()
    }

    /// The number of the sender whose samples are used; `None` while there is none.
    pub fn pinned(&self) -> Option<u16> {
        self.receiver.pinned()
    }

    /// Number of estimates made so far, published or not.
    pub fn estimates(&self) -> u64 {
        self.estimation.estimates
    }

    /// Raises the stamp of an arrival to that of the last step, so that stamps never decrease in the recording.
    pub fn stamp(&self, arrival: &mut Arrival) {
        arrival.arrival_ns = arrival.arrival_ns.max(self.now_ns);
    }

    /// Takes an arrival and publishes what follows from it. `finished_ns` is asked for the present time on the clock of
    /// the arrivals when an estimate is finished, for the latency; in a replay, where that clock does not run, it
    /// should return 0.
    pub fn take(&mut self, arrival: &Arrival, finished_ns: &dyn Fn() -> u64, publish: Publish<'_>) {
        self.now_ns = self.now_ns.max(arrival.arrival_ns);
        let (estimation, now_ns) = (&mut self.estimation, self.now_ns);
        self.receiver.take(arrival, &mut |reception| estimation.take(reception, now_ns, finished_ns, publish));
    }

    /// The time at which [`Engine::advance`] is due if nothing arrives before, ns; `None` if nothing waits.
    pub fn deadline_ns(&self) -> Option<u64> {
        self.receiver.deadline_ns()
    }

    /// Does what was due until this time, ns: samples that waited for missing messages, and the event that nothing
    /// arrives.
    pub fn advance(&mut self, now_ns: u64, finished_ns: &dyn Fn() -> u64, publish: Publish<'_>) {
        // Each step gets the time at which it was due, not the present time, so that a replay gives the same documents.
        while let Some(due_ns) = self.receiver.deadline_ns().filter(|due| *due <= now_ns) {
            self.now_ns = self.now_ns.max(due_ns);
            let (estimation, at_ns) = (&mut self.estimation, self.now_ns);
            self.receiver.advance(due_ns, &mut |reception| estimation.take(reception, at_ns, finished_ns, publish));
        }
    }

    /// Publishes a document about the link if a second has passed since the last one.
    pub fn publish_link(&mut self, now_ns: u64, writers: WriterCounts, publish: Publish<'_>) {
        if now_ns < self.link_due_ns {
            return;
        }
        self.link_due_ns = now_ns.saturating_add(LINK_INTERVAL_NS);
        let waiting = self.waiting();
        let document = Document::Link {
            arrival_s: seconds(now_ns),
            counts: self.counts_with(writers.strangers_dropped),
            latency_ms: self.estimation.latency.quantiles(),
            recorded_bytes: writers.recorded_bytes,
            recording_dropped: writers.recording_dropped,
            published_dropped: writers.published_dropped,
            waiting: waiting.as_deref(),
        };
        publish(DocumentKind::Link, &document.text());
    }

    fn counts_with(&mut self, strangers_dropped: u64) -> Counts {
        self.strangers_dropped = strangers_dropped;
        let counts = self.counts();
        Counts { strangers: counts.strangers + strangers_dropped, ..counts }
    }

    /// What the estimation waits for; `None` once it has begun.
    fn waiting(&self) -> Option<String> {
        let waiting = self.estimation.waiting.clone()?;
        Some(self.receiver.missing().map_or_else(|| waiting.clone(), |missing| format!("{waiting}; {missing}")))
    }

    /// Why there is no estimate although data arrived, as a sentence for people; `None` if there is one, or if nothing
    /// arrived.
    pub fn missing(&self) -> Option<String> {
        if self.estimation.estimates > 0 {
            return None;
        }
        let failure = self.estimation.failure.clone();
        let why = self.receiver.no_sample().or(failure);
        // What never comes is more than what has not come yet.
        let absent = self.receiver.never_came();
        let absent =
            absent.map(|absent| self.receiver.missing().map_or(absent.clone(), |why| format!("{absent}; {why}")));
        let why = why.or_else(|| self.waiting().map(|waiting| absent.unwrap_or(waiting)));
        why.or_else(|| self.estimation.first_refusal.clone())
    }

    /// Publishes an event about the reception itself, at a time since its start, ns.
    pub fn publish_event(&self, now_ns: u64, kind: LiveEventKind, message: &str, publish: Publish<'_>) {
        publish_event(None, now_ns, &kind.into(), message, publish);
    }

    /// Uses the samples that still wait and publishes the last document. `reason` says to people why the estimation
    /// ends.
    pub fn end(&mut self, reason: &str, finished_ns: &dyn Fn() -> u64, publish: Publish<'_>) {
        let (estimation, now_ns) = (&mut self.estimation, self.now_ns);
        self.receiver.finish(&mut |reception| estimation.take(reception, now_ns, finished_ns, publish));
        if let Some(waiting) = self.waiting().or_else(|| self.receiver.no_sample()) {
            let message = format!("it ended before an estimation could begin: {waiting}");
            self.publish_event(now_ns, LiveEventKind::Waiting, &message, publish);
        }
        let document = Document::End {
            reason,
            counts: self.counts_with(self.strangers_dropped),
            estimates: self.estimation.estimates,
            latency_ms: self.estimation.latency.quantiles(),
        };
        publish(DocumentKind::End, &document.text());
    }
}

/// The density of the air, kg/m^3, if the model file states it as a constant.
fn stated_density(model: &ModelFile) -> Option<f64> {
    match model.aircraft.air_density {
        AirDensity::Known(Source::Constant(density)) => Some(density),
        _ => None,
    }
}
