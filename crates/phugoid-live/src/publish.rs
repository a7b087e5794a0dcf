//! Documents as lines of text, on a thread of their own.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender, TrySendError};
use std::thread::JoinHandle;

/// Lines that wait for a reader that is slow.
const WAITING: usize = 16_384;

/// What happens where the reader of the lines is slower than what is published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhenSlow {
    /// Estimates are left out and counted: a flight does not wait.
    LeaveOut,
    /// Everything waits: a replay as fast as possible.
    Wait,
}

/// Writes lines.
pub struct Lines {
    queue: Option<SyncSender<String>>,
    thread: Option<JoinHandle<io::Result<()>>>,
    when_slow: WhenSlow,
    dropped: Arc<AtomicU64>,
    gone: Arc<AtomicBool>,
}

impl Lines {
    /// Starts a thread that writes to `out`.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(out: impl Write + Send + 'static, when_slow: WhenSlow) -> io::Result<Self> {
        let (queue, lines) = mpsc::sync_channel(WAITING);
        let gone = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&gone);
        let thread = std::thread::Builder::new().name("lines".to_owned()).spawn(move || {
            let result = write(out, &lines);
            ended.store(true, Ordering::Relaxed);
            result
        })?;
        Ok(Self { queue: Some(queue), thread: Some(thread), when_slow, dropped: Arc::default(), gone })
    }

    /// Writes a line.
    pub fn send(&self, line: &str) {
        let Some(queue) = &self.queue else { return };
        match self.when_slow {
            WhenSlow::Wait => {
                // Nobody reads any more: `gone` says so.
                let _ = queue.send(line.to_owned());
            }
            WhenSlow::LeaveOut => {
                if let Err(TrySendError::Full(_)) = queue.try_send(line.to_owned()) {
                    self.dropped.fetch_add(1, Ordering::Relaxed);
                }
            }
        }
    }

    /// Lines that were left out.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// True if nobody reads any more.
    pub fn is_gone(&self) -> bool {
        self.gone.load(Ordering::Relaxed)
    }

    /// Writes what waits.
    ///
    /// # Errors
    /// What the system said when writing failed.
    pub fn finish(mut self) -> io::Result<()> {
        self.queue = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(io::Error::other("the thread that writes has stopped")),
            None => Ok(()),
        }
    }
}

fn write(out: impl Write, lines: &Receiver<String>) -> io::Result<()> {
    let mut out = io::BufWriter::new(out);
    while let Ok(line) = lines.recv() {
        writeln!(out, "{line}")?;
        // One write for all that is there.
        while let Ok(line) = lines.try_recv() {
            writeln!(out, "{line}")?;
        }
        out.flush()?;
    }
    out.flush()
}
