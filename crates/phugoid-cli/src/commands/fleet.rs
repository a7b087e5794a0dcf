//! `phugoid fleet`.

use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use phugoid_fleet::logs::FlightTable;
use phugoid_fleet::run::{Progress, RunError, Share, Summary, run as run_fleet};
use phugoid_fleet::source::{ENDS, files};
use phugoid_fleet::store::{Store, StoreError};
use phugoid_fleet::unit::{Segments, Task};

use crate::arguments::{
    self,
    fleet::{Engine, Estimating},
};
use crate::failure::Failure;
use crate::output::deliver;

pub(crate) fn run(arguments: &arguments::Fleet) -> Result<(), Failure> {
    match &arguments.question {
        None => estimate(&arguments.estimating),
        Some(arguments::fleet::Question::Tell(tell)) => super::fleet_tell::run(tell),
        Some(arguments::fleet::Question::View(view)) => super::fleet_view::run(view),
        Some(arguments::fleet::Question::Analyses(analyses)) => super::fleet_analyses::run(analyses),
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Write { .. } | StoreError::NotAStore { .. } => Self::Output(error.to_string()),
            _ => Self::input(error),
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Store(error) => error.into(),
            RunError::Campaign(error) => Self::input(error),
            RunError::Threads(_) => Self::impossible(error),
        }
    }
}

fn estimate(arguments: &Estimating) -> Result<(), Failure> {
    // The command line gives both; clap cannot say so in a type, since questions need neither.
    let (Some(model), Some(folder)) = (&arguments.model, &arguments.store) else {
        return Err(Failure::input("fleet needs --model and --store"));
    };
    if let Engine::Ray(address) = &arguments.engine {
        let request = serde_json::json!({
            "logs": arguments.logs,
            "model": model,
            "store": folder,
            "method": arguments.method.map(|method| method.name()),
            "segments": Segments::from(arguments.segments).word(),
            "flights": arguments.flights,
            "engine": "ray",
            "workers": arguments.workers.unwrap_or(0),
            "shard": arguments.shard.to_string(),
            "address": address,
        });
        let summary = super::on_ray::run("fleet", request)?;
        return deliver(&summary, arguments.delivery.json, arguments.delivery.out.as_deref(), || {
            text(&summary, folder)
        });
    }
    refuse_address(folder, "--engine ray, or in Python phugoid.fleet(..., store=...)")?;
    let task = Task::open(model, arguments.method, arguments.segments.into()).map_err(Failure::input)?;
    let table = arguments.flights.as_deref().map(FlightTable::open).transpose().map_err(Failure::input)?;
    let logs = files(&arguments.logs).map_err(Failure::input)?;
    if let (Some(table), Some(file)) = (&table, &arguments.flights) {
        let left = table.without_a_log(logs.iter().map(PathBuf::as_path));
        if let Some(first) = left.first() {
            eprintln!(
                "{}: {} of its rows name no log of this run (`{first}`, ...): `log` is the name of a file, or the end of its path",
                file.display(),
                left.len()
            );
        }
    }
    if logs.is_empty() {
        eprintln!("no flight is in the folders that are named: taken are files that end in {}", ENDS.join(", "));
    }
    let store = Store::create(folder)?;
    let share = Share { workers: arguments.workers.map_or(0, usize::from), shard: arguments.shard };
    let bar = Bar::new("logs");
    let summary = run_fleet(
        &logs,
        &task,
        &table.unwrap_or_default(),
        &store,
        share,
        &|progress| bar.set(progress),
        &AtomicBool::new(false),
    )?;
    drop(bar);
    deliver(&summary, arguments.delivery.json, arguments.delivery.out.as_deref(), || text(&summary, folder))
}

/// This program reads and writes disks. A path with `://` in it would make folders of that name. `instead`: what reaches it.
pub(super) fn refuse_address(store: &Path, instead: &str) -> Result<(), Failure> {
    match store.to_str().filter(|word| word.contains("://")) {
        Some(word) => Err(Failure::input(format!(
            "--store {word}: stores behind addresses are reached by the Python package: {instead}"
        ))),
        None => Ok(()),
    }
}

fn text(s: &Summary, store: &Path) -> String {
    let mut text = format!(
        "{} files: {} estimated ({} of them refused), {} in the store before, {} copies, {} of other shards\n{} rows \
         written to {}\n",
        s.files,
        s.estimated,
        s.refused,
        s.found,
        s.copies,
        s.of_others,
        s.rows,
        store.display()
    );
    if s.refused > 0 {
        text.push_str("Why logs were refused stands in the columns `refusal` and `message`.\n");
    }
    text
}

/// A bar with rate and remaining time on a terminal; a line with the same each minute elsewhere, for the logs of jobs. Ctrl-C says
/// what is kept, and ends the program.
pub(super) struct Bar {
    bar: ProgressBar,
    what: &'static str,
    begun: Instant,
    /// When the last line was written; none on a terminal.
    lines: Option<Mutex<Instant>>,
}

/// Time between two lines.
const LINE: Duration = Duration::from_secs(60);

impl Bar {
    pub(super) fn new(what: &'static str) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(
            Some(0),
            if terminal { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() },
        );
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos} of {len}, {per_sec}, {eta} left") {
            bar.set_style(style);
        }
        bar.set_message(what);
        if terminal {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        // Without a handler Ctrl-C loses nothing either: it only says less.
        let _ = ctrlc::set_handler(|| {
            let message = "\nstopped: what is done is in the store, and the same command goes on from there";
            let _ = writeln!(std::io::stderr(), "{message}");
            std::process::exit(130);
        });
        let begun = Instant::now();
        Self { bar, what, begun, lines: (!terminal).then(|| Mutex::new(begun)) }
    }

    pub(super) fn set(&self, progress: Progress) {
        self.bar.set_length(progress.all as u64);
        self.bar.set_position(progress.done as u64);
        // Another thread that is writing a line writes it for this one.
        let Some(Ok(mut last)) = self.lines.as_ref().map(Mutex::try_lock) else { return };
        if last.elapsed() >= LINE {
            *last = Instant::now();
            // A line that nobody reads stops nothing.
            let _ = writeln!(std::io::stderr(), "{}", line(self.what, progress, self.begun.elapsed()));
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// How far a run has come after a time. What was found done took no time.
fn line(what: &str, progress: Progress, after: Duration) -> String {
    let Progress { done, all, found } = progress;
    let rate = done.saturating_sub(found) as f64 / after.as_secs_f64();
    let left = match rate > 0.0 {
        true => {
            format!("{rate:.1} per second, {} left", HumanDuration(Duration::from_secs_f64((all - done) as f64 / rate)))
        }
        false => "none of them in this run".to_owned(),
    };
    format!("{what}: {done} of {all}, {left}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_progress_has_rate_and_remaining_time_without_what_was_found() {
        let at = |done, found| line("flights", Progress { done, all: 1000, found }, Duration::from_secs(60));
        assert_eq!(at(400, 100), "flights: 400 of 1000, 5.0 per second, 2 minutes left");
        assert_eq!(at(400, 400), "flights: 400 of 1000, none of them in this run");
    }
}
