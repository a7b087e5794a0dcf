//! Studies of the printed laws: what decides whether they converge, what they cannot do, and what mends them.

mod draw;
mod reaching;

use super::Entry;

/// Entries of the studies of the laws.
pub(super) const ENTRIES: &[Entry] =
    &[Entry { id: "laws/reaching", title: "Reaching condition and gain of the printed law", run: reaching::run }];
