//! A progress bar for people; nothing for pipes.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Steps of the bar.
const STEPS: u64 = 1000;

/// How long work may take before the bar appears.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar on standard error that appears when the work takes longer than a second and standard error is a terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    /// Dropped at the end of the work: tells the thread that waits for the second to pass that there is nothing to
    /// show.
    _waiting: Option<Sender<()>>,
}

impl Progress {
    /// Work of which the fraction done is told by [`Progress::set`].
    pub(crate) fn new(what: &'static str) -> Self {
        Self::start(what, "{msg} {wide_bar} {percent:>3} %  {eta} left")
    }

    /// Work of which nobody knows how much is left.
    pub(crate) fn spinner(what: &'static str) -> Self {
        Self::start(what, "{spinner} {msg}, {elapsed}")
    }

    fn start(what: &'static str, template: &str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what);
        let waiting = std::io::stderr().is_terminal().then(|| {
            let (sender, receiver) = channel::<()>();
            let bar = bar.clone();
            std::thread::spawn(move || {
                if receiver.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                    bar.enable_steady_tick(Duration::from_millis(100));
                }
            });
            sender
        });
        Self { bar, _waiting: waiting }
    }

    /// `fraction` of the work is done, 0 to 1.
    pub(crate) fn set(&self, fraction: f64) {
        self.bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Several pieces of work behind one bar, each as long as the others.
pub(crate) struct Shares<'a> {
    progress: &'a Progress,
    /// Fraction done of each piece, as bits of an `f64`.
    done: Vec<AtomicU64>,
}

impl<'a> Shares<'a> {
    pub(crate) fn new(progress: &'a Progress, count: usize) -> Self {
        Self { progress, done: (0..count).map(|_| AtomicU64::new(0)).collect() }
    }

    /// `fraction` of a piece of work is done, 0 to 1; from any thread.
    pub(crate) fn set(&self, index: usize, fraction: f64) {
        if let Some(piece) = self.done.get(index) {
            piece.store(fraction.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
            let sum: f64 = self.done.iter().map(|piece| f64::from_bits(piece.load(Ordering::Relaxed))).sum();
            self.progress.set(sum / self.done.len() as f64);
        }
    }
}
