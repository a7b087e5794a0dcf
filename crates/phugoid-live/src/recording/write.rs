//! Writing a recording, beside the estimation and never in its way.

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

/// What was received is with the operating system after this long at most: a kill of the program loses no more.
const TO_THE_SYSTEM: Duration = Duration::from_millis(50);
/// It is on the disk after this long: a loss of power loses no more, as far as the disk keeps its word.
const TO_THE_DISK: Duration = Duration::from_secs(1);
/// Arrivals that wait for a disk that is behind; at 2400 messages a second, 13 s.
const WAITING: usize = 32_768;

/// What became of what arrived.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    bytes: Arc<AtomicU64>,
    dropped: Arc<AtomicU64>,
    failed: Arc<AtomicBool>,
}

impl Recorded {
    /// Bytes handed to the operating system.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Arrivals that were not recorded, because the disk was too slow or full.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Whether writing has failed (a full disk).
    pub fn failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }
}

/// Writes a recording on threads of its own.
pub struct Recorder {
    queue: Option<SyncSender<Arrival>>,
    thread: Option<JoinHandle<io::Result<()>>>,
    recorded: Recorded,
}

impl Recorder {
    /// Creates the file, which must not exist, and writes the header.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn create(path: &Path, header: &Header) -> io::Result<Self> {
        let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
        let mut first = Vec::new();
        let text = serde_json::to_vec(header).map_err(io::Error::other)?;
        append(&mut first, BlockKind::Header, [0, header.started_wall_ns], 0, &text);
        file.write_all(&first)?;
        let recorded = Recorded::default();
        recorded.bytes.store(first.len() as u64, Ordering::Relaxed);
        let (queue, arrivals) = mpsc::sync_channel(WAITING);
        let told = recorded.clone();
        let thread = std::thread::Builder::new().name("recorder".to_owned()).spawn(move || {
            let result = write(file, &arrivals, &told);
            told.failed.fetch_or(result.is_err(), Ordering::Relaxed);
            result
        })?;
        Ok(Self { queue: Some(queue), thread: Some(thread), recorded })
    }

    /// Hands over what arrived. Never waits: where the disk is too far behind, it is counted as dropped.
    pub fn record(&self, arrival: Arrival) {
        let sent = self.queue.as_ref().map(|queue| queue.try_send(arrival));
        if let Some(Err(TrySendError::Full(_) | TrySendError::Disconnected(_))) = sent {
            self.recorded.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// What became of it so far.
    pub fn recorded(&self) -> Recorded {
        self.recorded.clone()
    }

    /// Writes what waits, the end, and puts it on the disk.
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

fn write(mut file: File, arrivals: &Receiver<Arrival>, recorded: &Recorded) -> io::Result<()> {
    // The disk may take its time: putting things there is the job of another thread.
    let (sync, wanted) = mpsc::sync_channel::<()>(1);
    let same_file = file.try_clone()?;
    let syncing = std::thread::Builder::new().name("recorder-sync".to_owned()).spawn(move || {
        while wanted.recv().is_ok() {
            // Without this the data are as safe as the system keeps them: nothing else to be done.
            let _ = same_file.sync_data();
        }
    })?;
    let mut buffer = Vec::new();
    let mut synced = Instant::now();
    let result = loop {
        // Asleep most of the time: to be woken by every arrival would cost more than to write them.
        std::thread::sleep(TO_THE_SYSTEM / 2);
        let ended = loop {
            match arrivals.try_recv() {
                Ok(arrival) => {
                    let (kind, content) = Block::of(&arrival);
                    append(&mut buffer, kind, [arrival.arrival_ns, arrival.wall_ns], arrival.origin, content);
                }
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
        if synced.elapsed() >= TO_THE_DISK {
            // Full: it is at it.
            let _ = sync.try_send(());
            synced = Instant::now();
        }
    };
    drop(sync);
    let _ = syncing.join();
    result
}
