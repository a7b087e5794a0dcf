//! Runs what a store does not have of a campaign.

use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use super::unit::Unit;
use crate::run::{Outcome, Progress, RunError, Share, Summary, each, pool, share_out};
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
    let keyed = |unit| {
        let key = Unit::key(unit);
        (key.clone(), (unit, key))
    };
    let keyed: Vec<(String, (&Unit, String))> = pool.install(|| units.par_iter().map(keyed).collect());
    let (work, mut summary) = share_out(keyed, share.shard);
    let one = |(unit, key): (&Unit, String)| -> Result<Outcome, StoreError> {
        let model = unit.model_sha256();
        if store.has("campaign", &model, &key) {
            return Ok(Outcome::Found);
        }
        store.write_model(&model, &unit.model)?;
        let rows = unit.rows();
        store.write_unit(&rows, false)?;
        Ok(Outcome::Estimated { rows: rows.len(), refused: rows.iter().all(|row| row.parameter.is_none()) })
    };
    each(&pool, work, &mut summary, one, progress, stop)?;
    Ok(summary)
}
