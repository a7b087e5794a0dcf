//! Runs the units of work that a store does not have yet, on as many threads as wanted.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use phugoid_identification::stack::STACK_BYTES;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::key::hash_file;
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
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
    /// Of those, logs without any numbers.
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
    /// The system gives no threads.
    #[error("no threads to work with: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
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
    let hashed: Vec<_> = pool.install(|| files.par_iter().map(|path| hash_file(path)).collect());
    let mut summary = Summary { files: files.len(), ..Summary::default() };
    let mut seen = std::collections::HashSet::new();
    let mut work = Vec::new();
    for (path, hashed) in files.iter().zip(hashed) {
        let hash = hashed.as_ref().map_or_else(|_| task.key_of_unreadable(path), |(hash, _)| hash.clone());
        if !seen.insert(hash.clone()) {
            summary.copies += 1;
        } else if !share.shard.has(&hash) {
            summary.of_others += 1;
        } else {
            work.push((path, hashed));
        }
    }
    let (found, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let all = work.len();
    let unit = |(path, hashed): (&PathBuf, std::io::Result<(String, u64)>)| -> Result<(bool, usize, bool), StoreError> {
        let tell = || {
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(Progress { done, all, found: found.load(Ordering::Relaxed) });
        };
        let (hash, bytes) = match hashed {
            Ok(hashed) => hashed,
            Err(error) => {
                store.write_unit(&[task.unreadable(path, &error)], true)?;
                tell();
                return Ok((true, 1, true));
            }
        };
        store.write_log(&flights.log(path, &hash, bytes))?;
        // A file that could not be read before can be read now: the row that said so is no longer true. It goes before
        // its successor comes, so that there are never both.
        store.remove_unit("log", task.model_sha256(), &task.key_of_unreadable(path))?;
        if store.has("log", task.model_sha256(), &task.key(&hash)) {
            found.fetch_add(1, Ordering::Relaxed);
            tell();
            return Ok((false, 0, false));
        }
        let rows = task.rows(path, &hash);
        store.write_unit(&rows, is_tried_again(&rows))?;
        tell();
        Ok((true, rows.len(), rows.iter().all(|row| row.parameter.is_none())))
    };
    let results: Vec<Option<Result<_, StoreError>>> = pool.install(|| {
        let begun = |work| if stop.load(Ordering::Relaxed) { None } else { Some(unit(work)) };
        work.into_par_iter().map(begun).collect()
    });
    for result in results {
        match result.transpose()? {
            None => summary.left += 1,
            Some((false, ..)) => summary.found += 1,
            Some((true, rows, refused)) => {
                summary.estimated += 1;
                summary.rows += rows;
                summary.refused += usize::from(refused);
            }
        }
    }
    Ok(summary)
}

/// Whether what is in these rows may be otherwise in the next run.
pub(crate) fn is_tried_again(rows: &[Row]) -> bool {
    let again = [Refusal::Unreadable, Refusal::FormatNotInBuild].map(|refusal| {
        debug_assert!(refusal.is_tried_again());
        refusal.word()
    });
    rows.iter().any(|row| row.refusal.as_deref().is_some_and(|refusal| again.contains(&refusal)))
}

/// Threads with the stack that an estimation needs.
pub(crate) fn pool(workers: usize) -> Result<ThreadPool, rayon::ThreadPoolBuildError> {
    ThreadPoolBuilder::new().num_threads(workers).stack_size(STACK_BYTES).build()
}
