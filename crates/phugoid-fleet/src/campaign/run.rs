//! Runs what a store does not have of a campaign.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use super::unit::Unit;
use crate::run::{Outcome, Progress, RunError, Share, Summary, pool};
use crate::store::{Store, StoreError};

/// Flies and estimates every unit that the store does not have. `progress` and `stop` are those of [`crate::run::run`].
///
/// # Errors
/// [`RunError`]. A unit that cannot be flown or estimated is no error but a row.
pub fn run(
    units: &[Unit],
    store: &Store,
    share: Share,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Summary, RunError> {
    let pool = pool(share.workers)?;
    let (done, found) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let keys: Vec<String> = pool.install(|| units.par_iter().map(Unit::key).collect());
    let mut seen = std::collections::HashSet::new();
    let mut summary = Summary { files: units.len(), ..Summary::default() };
    let mut work: Vec<(&Unit, &String)> = Vec::new();
    for (unit, key) in units.iter().zip(&keys) {
        if !seen.insert(key) {
            summary.copies += 1;
        } else if share.shard.has(key) {
            work.push((unit, key));
        } else {
            summary.of_others += 1;
        }
    }
    let all = work.len();
    let one = |(unit, key): (&Unit, &String)| -> Result<Outcome, StoreError> {
        let model = unit.model_sha256();
        let new = if store.has("campaign", &model, key) {
            found.fetch_add(1, Ordering::Relaxed);
            Outcome::Found
        } else {
            store.write_model(&model, &unit.model)?;
            let rows = unit.rows();
            store.write_unit(&rows, false)?;
            Outcome::Estimated { rows: rows.len(), refused: rows.iter().all(|row| row.parameter.is_none()) }
        };
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(Progress { done, all, found: found.load(Ordering::Relaxed) });
        Ok(new)
    };
    let results: Vec<Option<Result<_, StoreError>>> = pool.install(|| {
        let begun = |work| if stop.load(Ordering::Relaxed) { None } else { Some(one(work)) };
        work.into_par_iter().map(begun).collect()
    });
    for result in results {
        match result.transpose()? {
            None => summary.left += 1,
            Some(outcome) => summary.add(outcome),
        }
    }
    Ok(summary)
}
