//! Writing a recording on threads of its own, so that the estimation never waits for the disk.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender, TryRecvError, TrySendError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::block::{Block, BlockKind, append};
use super::header::Header;
use crate::arrival::{Arrival, wall_ns};

/// Data are handed to the operating system within this time. A kill of the program loses no more than that.
const WRITE_WITHIN: Duration = Duration::from_millis(50);
/// Data are put on the disk at this interval. A loss of power loses no more than about that, if the disk does what it
/// reports.
const SYNC_INTERVAL: Duration = Duration::from_secs(1);
/// Arrivals that may wait for a slow disk: 13 s at 2400 messages a second.
const WAITING: usize = 32_768;

/// Counts of the recorder, shared with its thread.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    bytes: Arc<AtomicU64>,
    dropped: Arc<AtomicU64>,
    failed: Arc<AtomicBool>,
}

impl Recorded {
    /// Bytes handed to the operating system so far.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Number of arrivals that were not recorded because the disk was too slow or full.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Whether writing has failed, as on a full disk. Nothing more is recorded then.
    pub fn failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }
}

/// Writes a recording while it is received. [`write_whole`] writes one at once.
pub struct Recorder {
    queue: Option<SyncSender<Arrival>>,
    thread: Option<JoinHandle<io::Result<()>>>,
    recorded: Recorded,
}

impl Recorder {
    /// Creates the file and writes the header.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if the file exists; else what the operating system says.
    pub fn create(path: &Path, header: &Header) -> io::Result<Self> {
        let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
        let mut first = Vec::new();
        append_header(&mut first, header)?;
        file.write_all(&first)?;
        let recorded = Recorded::default();
        recorded.bytes.store(first.len() as u64, Ordering::Relaxed);
        let (queue, arrivals) = mpsc::sync_channel(WAITING);
        let shared = recorded.clone();
        let thread = std::thread::Builder::new().name("recorder".to_owned()).spawn(move || {
            let result = write(file, &arrivals, &shared);
            shared.failed.fetch_or(result.is_err(), Ordering::Relaxed);
            result
        })?;
        Ok(Self { queue: Some(queue), thread: Some(thread), recorded })
    }

    /// Hands over an arrival. This never waits: if the disk is too far behind, the arrival is dropped and counted.
    pub fn record(&self, arrival: Arrival) {
        let sent = self.queue.as_ref().map(|queue| queue.try_send(arrival));
        if let Some(Err(TrySendError::Full(_) | TrySendError::Disconnected(_))) = sent {
            self.recorded.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The counts, which go on changing while the recorder writes.
    pub fn recorded(&self) -> Recorded {
        self.recorded.clone()
    }

    /// Writes the arrivals that still wait and the end, and puts everything on the disk.
    ///
    /// # Errors
    /// What the operating system said when writing failed.
    pub fn finish(mut self) -> io::Result<()> {
        self.queue = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(io::Error::other("the recorder has stopped")),
            None => Ok(()),
        }
    }
}

/// Writes a whole recording with its end: for conversions and tests. Stamps must not decrease from one arrival to the
/// next.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_whole<'a>(
    mut out: impl Write,
    header: &Header,
    arrivals: impl IntoIterator<Item = &'a Arrival>,
) -> io::Result<()> {
    let mut buffer = Vec::new();
    append_header(&mut buffer, header)?;
    let mut last_ns = [0, header.started_wall_ns];
    for arrival in arrivals {
        append_arrival(&mut buffer, arrival);
        last_ns = [arrival.arrival_ns, arrival.wall_ns];
        out.write_all(&buffer)?;
        buffer.clear();
    }
    append(&mut buffer, BlockKind::End, last_ns, 0, &[]);
    out.write_all(&buffer)
}

fn append_header(buffer: &mut Vec<u8>, header: &Header) -> io::Result<()> {
    let text = serde_json::to_vec(header).map_err(io::Error::other)?;
    append(buffer, BlockKind::Header, [0, header.started_wall_ns], 0, &text);
    Ok(())
}

fn append_arrival(buffer: &mut Vec<u8>, arrival: &Arrival) {
    let (kind, content) = Block::of(arrival);
    append(buffer, kind, [arrival.arrival_ns, arrival.wall_ns], arrival.origin, content);
}

/// The recorder's thread: writes arrivals until their sender is gone, then the end.
fn write(mut file: File, arrivals: &Receiver<Arrival>, recorded: &Recorded) -> io::Result<()> {
    // Putting data on the disk may take long, so another thread does it.
    let (sync, wanted) = mpsc::sync_channel::<()>(1);
    let same_file = file.try_clone()?;
    let syncing = std::thread::Builder::new().name("recorder-sync".to_owned()).spawn(move || {
        while wanted.recv().is_ok() {
            // If this fails, the data are still with the operating system; nothing else can be done.
            let _ = same_file.sync_data();
        }
    })?;
    let mut buffer = Vec::new();
    let mut synced = Instant::now();
    let result = loop {
        // The thread sleeps most of the time, because waking up for every arrival would cost more than writing.
        std::thread::sleep(WRITE_WITHIN / 2);
        let ended = loop {
            match arrivals.try_recv() {
                Ok(arrival) => append_arrival(&mut buffer, &arrival),
                Err(TryRecvError::Empty) => break false,
                Err(TryRecvError::Disconnected) => {
                    append(&mut buffer, BlockKind::End, [u64::MAX, wall_ns()], 0, &[]);
                    break true;
                }
            }
        };
        if let Err(error) = file.write_all(&buffer) {
            break Err(error);
        }
        recorded.bytes.fetch_add(buffer.len() as u64, Ordering::Relaxed);
        buffer.clear();
        if ended {
            break file.sync_data();
        }
        if synced.elapsed() >= SYNC_INTERVAL {
            // A full queue means that the other thread is still at work.
            let _ = sync.try_send(());
            synced = Instant::now();
        }
    };
    drop(sync);
    let _ = syncing.join();
    result
}
