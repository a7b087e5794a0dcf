//! `phugoid fleet`.

use std::io::{IsTerminal as _, Write as _};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use phugoid_fleet::logs::FlightTable;
use phugoid_fleet::run::{Progress, RunError, Share, Summary, run as run_fleet};
use phugoid_fleet::source::files;
use phugoid_fleet::store::{Store, StoreError};
use phugoid_fleet::unit::Task;

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
        Some(arguments::fleet::Question::View(view)) => super::fleet_tell::view(view),
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
        let summary = super::fleet_on_ray::run(arguments, model, folder, address.as_deref())?;
        let store = Store::open(folder)?;
        return deliver(&summary, arguments.delivery.json, arguments.delivery.out.as_deref(), || {
            text(&summary, &store)
        });
    }
    let task = Task::open(model, arguments.method, arguments.segments.into()).map_err(Failure::input)?;
    let table = arguments.flights.as_deref().map(FlightTable::open).transpose().map_err(Failure::input)?;
    let logs = files(&arguments.logs).map_err(Failure::input)?;
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
    deliver(&summary, arguments.delivery.json, arguments.delivery.out.as_deref(), || text(&summary, &store))
}

fn text(s: &Summary, store: &Store) -> String {
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
        store.folder().display()
    );
    if s.refused > 0 {
        text.push_str("Why logs were refused stands in the columns `refusal` and `message`.\n");
    }
    text
}

/// A bar with rate and remaining time on a terminal; nothing for pipes. Ctrl-C says what is kept, and ends the program.
pub(super) struct Bar(ProgressBar);

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
        Self(bar)
    }

    pub(super) fn set(&self, progress: Progress) {
        self.0.set_length(progress.all as u64);
        self.0.set_position(progress.done as u64);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
