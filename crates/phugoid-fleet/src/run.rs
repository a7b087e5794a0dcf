//! Runs the units of work that a store does not have yet, on as many threads as wanted.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use phugoid_identification::stack::STACK_BYTES;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::campaign::file::CampaignError;
use crate::key::hash_log;
use crate::logs::FlightTable;
use crate::row::{Refusal, Row};
use crate::shard::Shard;
use crate::store::{Store, StoreError};
use crate::unit::Task;

/// How the work is shared out. Nothing here changes a row.
#[derive(Clone, Copy, Debug, Default)]
pub struct Share {
    /// Number of threads; 0 for one per core. Each holds one log in memory.
    pub workers: usize,
    /// The part of the logs that this process takes.
    pub shard: Shard,
}

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Units that are done, those found done included.
    pub done: usize,
    /// Units in all, as far as they are known.
    pub all: usize,
    /// Units that were done before this run.
    pub found: usize,
}

/// What a run has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// Files that were looked at.
    pub files: usize,
    /// Files with the content of another one, which are not estimated twice.
    pub copies: usize,
    /// Logs of other shards.
    pub of_others: usize,
    /// Logs that were in the store already.
    pub found: usize,
    /// Logs that were estimated.
    pub estimated: usize,
    /// Of those, logs without any number that may be used: none at all, or all with the result `refused`.
    pub refused: usize,
    /// Rows that were written.
    pub rows: usize,
    /// Logs that were left, because the run was stopped.
    pub left: usize,
}

/// Why a run ends.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The store cannot be written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A campaign whose factors cannot be put into its files.
    #[error(transparent)]
    Campaign(#[from] Box<CampaignError>),
    /// The system gives no threads.
    #[error("no threads to work with: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// A log and its content, as far as it can be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hashed {
    /// The name by which results know the log: its path, or its address.
    pub name: PathBuf,
    /// SHA-256 of its content and its length in bytes; the reason where the operating system does not give it.
    pub content: Result<(String, u64), String>,
}

impl Hashed {
    /// Reads a file to the end; of a folder that is one log, all files in it.
    pub fn of(path: &Path) -> Self {
        Self { name: path.to_owned(), content: hash_log(path).map_err(|error| error.to_string()) }
    }

    fn hash(&self, task: &Task) -> String {
        self.content.as_ref().map_or_else(|_| task.key_of_unreadable(&self.name), |(hash, _)| hash.clone())
    }
}

/// The logs that a shard has to do, each content once, in the order of their names; copies and logs of other shards are
/// counted. Every engine asks this function, so that all do the same.
pub fn plan(logs: Vec<Hashed>, task: &Task, shard: Shard) -> (Vec<Hashed>, Summary) {
    let hashed = logs.into_iter().map(|log| (log.hash(task), log));
    share_out(hashed.collect(), shard)
}

/// A piece of work, of one unit or more.
pub(crate) trait Work {
    /// Number of its units.
    fn size(&self) -> usize {
        1
    }
}

impl Work for Hashed {}

/// The pieces of work of a shard, each key once, in their order; copies and those of other shards are counted.
pub(crate) fn share_out<W: Work>(pieces: Vec<(String, W)>, shard: Shard) -> (Vec<W>, Summary) {
    let mut summary = Summary::default();
    let mut seen = HashSet::new();
    let mut work = Vec::new();
    for (key, piece) in pieces {
        let is_ours = shard.has(&key);
        summary.files += piece.size();
        if !seen.insert(key) {
            summary.copies += piece.size();
        } else if is_ours {
            work.push(piece);
        } else {
            summary.of_others += piece.size();
        }
    }
    (work, summary)
}

/// Does every piece of work with `one` on the threads of a pool and counts what became of them. `progress` is called after each,
/// from any thread; when `stop` becomes true no other begins.
pub(crate) fn each<W: Work + Send>(
    pool: &ThreadPool,
    work: Vec<W>,
    summary: &mut Summary,
    one: impl Fn(W) -> Result<Summary, RunError> + Sync,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<(), RunError> {
    let (found, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let all = work.iter().map(Work::size).sum();
    let counted = |piece: W| -> Result<Summary, RunError> {
        let size = piece.size();
        let became = one(piece)?;
        found.fetch_add(became.found, Ordering::Relaxed);
        let done = done.fetch_add(size, Ordering::Relaxed) + size;
        progress(Progress { done, all, found: found.load(Ordering::Relaxed) });
        Ok(became)
    };
    let begun = |piece: W| match stop.load(Ordering::Relaxed) {
        true => Ok(Summary { left: piece.size(), ..Summary::default() }),
        false => counted(piece),
    };
    let results: Vec<Result<Summary, RunError>> = pool.install(|| work.into_par_iter().map(begun).collect());
    for result in results {
        summary.add(&result?);
    }
    Ok(())
}

/// What has become of one log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It was in the store already.
    Found,
    /// It was estimated.
    Estimated {
        /// Rows that were written.
        rows: usize,
        /// Whether none of them has a number.
        refused: bool,
    },
}

impl From<Outcome> for Summary {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Found => Self { found: 1, ..Self::default() },
            Outcome::Estimated { rows, refused } => {
                Self { estimated: 1, rows, refused: usize::from(refused), ..Self::default() }
            }
        }
    }
}

impl Summary {
    /// Counts what another one counts.
    pub fn add(&mut self, other: &Self) {
        let Self { files, copies, of_others, found, estimated, refused, rows, left } = other;
        self.files += files;
        self.copies += copies;
        self.of_others += of_others;
        self.found += found;
        self.estimated += estimated;
        self.refused += refused;
        self.rows += rows;
        self.left += left;
    }
}

/// Does one log, unless the store has it. `file` is where its content can be read at the moment.
///
/// # Errors
/// [`StoreError`]: the store cannot be written.
pub fn one(
    log: &Hashed,
    file: &Path,
    task: &Task,
    flights: &FlightTable,
    store: &Store,
) -> Result<Outcome, StoreError> {
    let (hash, bytes) = match &log.content {
        Ok((hash, bytes)) => (hash, *bytes),
        Err(error) => {
            store.write_unit(&[task.unreadable(&log.name, error)], true)?;
            return Ok(Outcome::Estimated { rows: 1, refused: true });
        }
    };
    store.write_log(&flights.log(&log.name, hash, bytes))?;
    // A file that could not be read before can be read now: the row that said so is no longer true. It goes before its
    // successor comes, so that there are never both.
    store.remove_unit("log", task.model_sha256(), &task.key_of_unreadable(&log.name))?;
    if store.has("log", task.model_sha256(), &task.key(hash)) {
        return Ok(Outcome::Found);
    }
    let rows = task.rows(file, hash);
    store.write_unit(&rows, is_tried_again(&rows))?;
    Ok(Outcome::Estimated { rows: rows.len(), refused: is_refused(&rows) })
}

/// Estimates every log that the store does not have with this task.
///
/// A log whose content is there already is not estimated, wherever it stands. `progress` is called after each unit, from
/// any thread. When `stop` becomes true, units that have begun are finished and no other begins; a process that is
/// killed instead loses what it was working on and nothing else.
///
/// # Errors
/// [`RunError`]. A log that cannot be read or estimated is no error but a row.
pub fn run(
    files: &[PathBuf],
    task: &Task,
    flights: &FlightTable,
    store: &Store,
    share: Share,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Summary, RunError> {
    let pool = pool(share.workers)?;
    store.write_model(task.model_sha256(), task.model_text())?;
    let hashed = pool.install(|| files.par_iter().map(|path| Hashed::of(path)).collect());
    let (work, mut summary) = plan(hashed, task, share.shard);
    let unit = |log: Hashed| Ok(one(&log, &log.name, task, flights, store)?.into());
    each(&pool, work, &mut summary, unit, progress, stop)?;
    Ok(summary)
}

/// Whether rows give no number that may be used: there is none, or the result says so of each.
pub(crate) fn is_refused(rows: &[Row]) -> bool {
    rows.iter().all(|row| row.parameter.is_none() || row.status == "refused")
}

/// Whether what is in these rows may be otherwise in the next run.
pub(crate) fn is_tried_again(rows: &[Row]) -> bool {
    let again = Refusal::ALL.iter().filter(|refusal| refusal.is_tried_again()).map(|refusal| refusal.word());
    let again: Vec<&str> = again.collect();
    rows.iter().any(|row| row.refusal.as_deref().is_some_and(|refusal| again.contains(&refusal)))
}

/// Threads with the stack that an estimation needs.
pub(crate) fn pool(workers: usize) -> Result<ThreadPool, rayon::ThreadPoolBuildError> {
    ThreadPoolBuilder::new().num_threads(workers).stack_size(STACK_BYTES).build()
}
