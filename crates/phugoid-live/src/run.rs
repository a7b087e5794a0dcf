//! A live estimation with its threads: one receives, one estimates, others record and publish.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use phugoid_identification::estimate::{EstimateError, EstimateOptions};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::stack::STACK_BYTES;

use crate::arrival::{Clock, wall_ns};
pub use crate::audience::Audience;
use crate::budget::Budget;
use crate::document::DocumentKind;
use crate::engine::{Engine, WriterCounts};
use crate::event::LiveEventKind;
use crate::publish::{Lines, WhenSlow};
use crate::receiver::ReceiverOptions;
use crate::recording::{Header, Recorder, VERSION};
use crate::source::{Outlet, Source};
use crate::stop::{Stop, Why};

/// Arrivals that may wait for the estimation. Further ones stay in the operating system's buffers.
const WAITING: usize = 8192;
/// Bytes of the arrivals that may wait for the estimation.
const WAITING_BYTES: usize = 16 << 20;
/// Longest time without a look at whether to stop and whether a document about the link is due, ns.
const LOOK_NS: u64 = 100_000_000;

/// Everything that a live estimation is made from. [`Live::run`] runs it.
pub struct Live<'a> {
    /// The model of the aircraft.
    pub model: &'a ModelFile,
    /// Text of the model file, which goes into the recording.
    pub model_text: &'a str,
    /// The estimator and its options, as for a record.
    pub options: &'a EstimateOptions,
    /// How the bytes that arrive are interpreted. Its column mappings are left out for a source whose rows are mapped
    /// already ([`Source::is_mapped`]).
    pub receiver: &'a ReceiverOptions,
    /// File of the recording, which must not exist; `None` records nothing.
    pub record: Option<PathBuf>,
    /// Size that the recording may have, bytes; of a longer one only the newest parts are kept. `None` sets no limit.
    pub record_limit: Option<u64>,
    /// Writes every estimate, not only the fifty a second for the page.
    pub all: bool,
    /// What happens if the reader of the lines is slow.
    pub when_slow: WhenSlow,
    /// True for a replay: the arrivals have the stamps of another time, so no clock of this machine is used and there
    /// is no latency.
    pub replayed: bool,
    /// For a replay, the start of the original reception, ns since 1970-01-01 UTC; `None` for what is received now.
    pub started_wall_ns: Option<u64>,
}

/// Counts at the end of a live estimation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Number of samples that the estimation got.
    pub samples: u64,
    /// Number of estimates that were made.
    pub estimates: u64,
    /// Why no estimate was made although data arrived, as a sentence for people; `None` if one was made, or if nothing
    /// arrived.
    pub missing: Option<String>,
}

/// Why a live estimation could not begin, or why its documents or recording could not be written.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// The model and the options cannot be estimated live.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The recording cannot be created or written.
    #[error("the recording `{}` cannot be written: {error}", file.display())]
    Recording {
        /// Path of the recording.
        file: PathBuf,
        /// What the operating system said.
        error: io::Error,
    },
    /// The lines of the documents cannot be written.
    #[error("the documents cannot be written: {0}")]
    Documents(io::Error),
    /// The operating system gives no further thread.
    #[error("the system gives no further thread: {0}")]
    Thread(io::Error),
}

impl Live<'_> {
    /// Receives from `source` until it ends, `stop` is set, or nobody reads the lines any more. Every document goes to
    /// `out` as a line of JSON and to each audience. The estimation runs on a thread with the stack that large models
    /// need; this call waits for it.
    ///
    /// # Errors
    /// [`LiveError`]. What was received until then is in the recording.
    pub fn run(
        &self,
        source: Source,
        out: impl Write + Send + 'static,
        audience: &mut [&mut dyn Audience],
        stop: &Arc<Stop>,
    ) -> Result<Summary, LiveError> {
        std::thread::scope(|scope| {
            let here = std::thread::Builder::new().name("estimation".to_owned()).stack_size(STACK_BYTES);
            let thread =
                here.spawn_scoped(scope, || self.estimate(source, out, audience, stop)).map_err(LiveError::Thread)?;
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    }

    fn estimate(
        &self,
        source: Source,
        out: impl Write + Send + 'static,
        audience: &mut [&mut dyn Audience],
        stop: &Arc<Stop>,
    ) -> Result<Summary, LiveError> {
        let started_wall_ns = self.started_wall_ns.unwrap_or_else(wall_ns);
        let receiver = match source.is_mapped() {
            true => self.receiver.without_columns(),
            false => self.receiver.clone(),
        };
        let mut engine = Engine::new(self.model, self.options, &receiver, &source.name)?.with_start(started_wall_ns);
        if self.all {
            engine = engine.with_every_estimate();
        }
        let recorder = self.recorder(&source, started_wall_ns)?;
        let recorded = recorder.as_ref().map(Recorder::recorded).unwrap_or_default();
        let lines = Lines::new(out, self.when_slow).map_err(LiveError::Thread)?;
        let mut publish = |kind: DocumentKind, document: &str| {
            lines.send(document);
            audience.iter_mut().for_each(|listener| listener.hear(kind, document));
        };
        let clock = Clock::start();
        let (queue, arrivals) = mpsc::sync_channel(WAITING);
        let budget = Arc::new(Budget::new(WAITING_BYTES));
        let outlet = Outlet::new(queue, Arc::clone(stop), clock).with_budget(Arc::clone(&budget));
        let attention = outlet.attention();
        // Reading standard input cannot be interrupted, so this thread is left behind at the end.
        std::thread::Builder::new()
            .name("source".to_owned())
            .spawn(move || source.run(&outlet))
            .map_err(LiveError::Thread)?;
        engine.begin(&mut publish);
        // A replay has no latency, because its stamps are of another time.
        let finished = || if self.replayed { 0 } else { clock.now_ns() };
        let reason = loop {
            if let Some(why) = stop.asked() {
                break why.words();
            }
            if lines.is_gone() {
                break "nobody reads any more";
            }
            let now_ns = clock.now_ns();
            let deadline_ns = engine.deadline_ns().filter(|_| !self.replayed).unwrap_or(u64::MAX);
            let due_ns = deadline_ns.min(now_ns.saturating_add(LOOK_NS));
            match arrivals.recv_timeout(Duration::from_nanos(due_ns.saturating_sub(now_ns))) {
                Ok(mut arrival) => {
                    budget.give_back(arrival.size());
                    engine.stamp(&mut arrival);
                    engine.take(&arrival, &finished, &mut publish);
                    attention.pin(engine.pinned());
                    if let Some(recorder) = &recorder {
                        recorder.record(arrival);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                // A source that was asked to stop may end before the reason is read here.
                Err(RecvTimeoutError::Disconnected) => break stop.asked().map_or("the source has ended", Why::words),
            }
            let now_ns = clock.now_ns();
            if !self.replayed {
                engine.advance(now_ns, &finished, &mut publish);
            }
            let writers = WriterCounts {
                recorded_bytes: recorded.bytes(),
                recording_dropped: recorded.dropped(),
                published_dropped: lines.dropped(),
                strangers_dropped: attention.thrown_away(),
            };
            for news in recorded.take_news() {
                engine.publish_event(now_ns, LiveEventKind::Recording, &news, &mut publish);
            }
            engine.publish_link(now_ns, writers, &mut publish);
        };
        engine.end(reason, &finished, &mut publish);
        stop.ask(Why::Over);
        let summary =
            Summary { samples: engine.counts().samples, estimates: engine.estimates(), missing: engine.missing() };
        let written = lines.finish();
        if let (Some(recorder), Some(file)) = (recorder, &self.record) {
            recorder.finish().map_err(|error| LiveError::Recording { file: file.clone(), error })?;
        }
        match written {
            // The reader has closed the pipe, as `head` does.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(summary),
            other => other.map(|()| summary).map_err(LiveError::Documents),
        }
    }

    fn recorder(&self, source: &Source, started_wall_ns: u64) -> Result<Option<Recorder>, LiveError> {
        let Some(file) = &self.record else { return Ok(None) };
        let header = Header {
            version: VERSION,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            source: source.name.clone(),
            started_wall_ns,
            model_name: self.model.source.clone(),
            model_text: self.model_text.to_owned(),
            method: self.options.method.map(|method| method.name().to_owned()),
            change_detection: self.options.change_detection,
            reorder_ns: self.receiver.mavlink.reorder_ns,
            system: self.receiver.mavlink.system,
            base: self.receiver.mavlink.base.clone(),
            mapped: source.is_mapped(),
            sender: self.receiver.sender.as_ref().map(ToString::to_string),
            signed: self.receiver.mavlink.key.is_some(),
        };
        let recorder = Recorder::create_limited(file, &header, self.record_limit);
        recorder.map(Some).map_err(|error| LiveError::Recording { file: file.clone(), error })
    }
}
