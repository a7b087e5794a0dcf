//! A progress bar for people; nothing for pipes.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Steps of the bar.
const STEPS: u64 = 1000;

/// How long work may take before the bar appears.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar on standard error that appears when the work takes longer than a second, if somebody is looking: `indicatif`
/// draws nothing when standard error is no terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    started: std::time::Instant,
    what: &'static str,
}

impl Progress {
    pub(crate) fn new(what: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        Self { bar, started: std::time::Instant::now(), what }
    }

    /// `fraction` of the work is done, 0 to 1.
    pub(crate) fn set(&self, fraction: f64) {
        if self.bar.is_hidden() && self.started.elapsed() > PATIENCE {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.bar.set_message(self.what);
        }
        self.bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
