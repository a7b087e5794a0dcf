//! Documents as lines of text, written by a thread of their own so that the estimation does not wait for the reader.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender, TrySendError};
use std::thread::JoinHandle;

use crate::budget::Budget;

/// Lines that may wait for a slow reader, ...
const WAITING: usize = 16_384;
/// ... and their bytes.
const WAITING_BYTES: usize = 64 << 20;

/// What happens if the reader of the lines is slower than the estimation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhenSlow {
    /// Documents are left out and counted. For a flight, which does not wait.
    LeaveOut,
    /// The estimation waits. For a replay as fast as possible, and for data from a pipe.
    Wait,
}

/// Writes lines from a queue of 16,384 lines.
pub struct Lines {
    queue: Option<SyncSender<String>>,
    thread: Option<JoinHandle<io::Result<()>>>,
    when_slow: WhenSlow,
    dropped: Arc<AtomicU64>,
    gone: Arc<AtomicBool>,
    budget: Arc<Budget>,
}

impl Lines {
    /// Starts a thread that writes to `out`.
    ///
    /// # Errors
    /// What the system says if it gives no further thread.
    pub fn new(out: impl Write + Send + 'static, when_slow: WhenSlow) -> io::Result<Self> {
        let (queue, lines) = mpsc::sync_channel(WAITING);
        let gone = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&gone);
        let budget = Arc::new(Budget::new(WAITING_BYTES));
        let returned = Arc::clone(&budget);
        let thread = std::thread::Builder::new().name("lines".to_owned()).spawn(move || {
            let result = write(out, &lines, &returned);
            ended.store(true, Ordering::Relaxed);
            result
        })?;
        Ok(Self { queue: Some(queue), thread: Some(thread), when_slow, dropped: Arc::default(), gone, budget })
    }

    /// Puts a line, without its end, into the queue. With [`WhenSlow::LeaveOut`] it is dropped if the queue is full.
    pub fn send(&self, line: &str) {
        let Some(queue) = &self.queue else { return };
        match self.when_slow {
            WhenSlow::Wait => {
                // This fails only if writing has failed; `is_gone` tells the caller.
                if self.budget.take(line.len(), &|| self.is_gone()) {
                    let _ = queue.send(line.to_owned());
                }
            }
            WhenSlow::LeaveOut => {
                if !self.budget.try_take(line.len()) {
                    self.dropped.fetch_add(1, Ordering::Relaxed);
                } else if let Err(TrySendError::Full(_)) = queue.try_send(line.to_owned()) {
                    self.budget.give_back(line.len());
                    self.dropped.fetch_add(1, Ordering::Relaxed);
                }
            }
        }
    }

    /// Number of lines that were dropped.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// True once writing has failed, usually because the reader is gone.
    pub fn is_gone(&self) -> bool {
        self.gone.load(Ordering::Relaxed)
    }

    /// Writes the lines that still wait and ends the thread.
    ///
    /// # Errors
    /// What the system said when writing failed; [`io::ErrorKind::BrokenPipe`] if the reader was gone.
    pub fn finish(mut self) -> io::Result<()> {
        self.queue = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(io::Error::other("the thread that writes has stopped")),
            None => Ok(()),
        }
    }
}

fn write(out: impl Write, lines: &Receiver<String>, budget: &Budget) -> io::Result<()> {
    let mut out = io::BufWriter::new(out);
    while let Ok(line) = lines.recv() {
        writeln!(out, "{line}")?;
        budget.give_back(line.len());
        // All lines that wait go out in one write.
        while let Ok(line) = lines.try_recv() {
            writeln!(out, "{line}")?;
            budget.give_back(line.len());
        }
        out.flush()?;
    }
    out.flush()
}
