//! Runs what a store does not have of a campaign.

use std::sync::atomic::AtomicBool;

use super::kept::Kept;
use super::layout::{Block, Layout};
use crate::content::NamedFiles;
use crate::run::{Progress, RunError, Share, Summary, Work, each, is_refused, pool, share_out};
use crate::shard::Shard;
use crate::store::Store;

/// Flies and estimates every block that the store does not have. `progress` and `stop` are those of [`crate::run::run`]; all is
/// counted in estimations.
///
/// # Errors
/// [`RunError`]. A unit that cannot be flown or estimated is no error but a row.
pub fn run(
    layout: &Layout,
    blocks: &[Block],
    store: &Store,
    share: Share,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Summary, RunError> {
    let pool = pool(share.workers)?;
    let (work, mut summary) = plan(blocks, share.shard);
    each(&pool, work, &mut summary, |(_, block)| one(layout, block, store), progress, stop)?;
    Ok(summary)
}

/// The blocks that a shard has to do, with their numbers; those of other shards are counted. Every engine asks this function.
pub fn plan(blocks: &[Block], shard: Shard) -> (Vec<(usize, &Block)>, Summary) {
    share_out(blocks.iter().enumerate().map(|piece| (piece.1.key.clone(), piece)).collect(), shard)
}

/// Does one block, unless the store has it.
///
/// # Errors
/// [`RunError`]: the store cannot be written.
pub fn one(layout: &Layout, block: &Block, store: &Store) -> Result<Summary, RunError> {
    if store.has("campaign", &block.model_sha256, &block.key) {
        return Ok(Summary { found: block.units.len(), ..Summary::default() });
    }
    store.write_model(&block.model_sha256, &block.model)?;
    let (mut files, mut kept) = (NamedFiles::default(), Kept::default());
    let (mut rows, mut refused) = (Vec::new(), 0);
    for number in block.units.clone() {
        let of_unit = layout.unit(number, &mut files).map_err(Box::new)?.rows(&block.key, &mut kept);
        refused += usize::from(is_refused(&of_unit));
        rows.extend(of_unit);
    }
    store.write_block(&rows, ("campaign", &block.model_sha256, &block.key), false)?;
    Ok(Summary { estimated: block.units.len(), refused, rows: rows.len(), ..Summary::default() })
}

impl Work for (usize, &Block) {
    fn size(&self) -> usize {
        self.1.units.len()
    }
}
