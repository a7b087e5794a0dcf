//! Reads PX4 ULog files, streaming, as their public description says (PX4 User Guide, "ULog File Format").
//!
//! Read are definitions (`B F I M P Q`), data (`A R D L C S O`), appended data, multi-instance topics, nested types and arrays.
//! A log has no check sums. Where a message does not fit the definitions, the reader looks for the next one that does, keeps
//! everything else, and says which bytes it skipped. A length in the file allocates nothing.
//!
//! Times are seconds from the log's start as its head gives it. The format has no units; the profiles know them.

mod definitions;
mod format;
mod message;
mod reader;

use std::io::Read;

use super::sink::into_log;
use super::survey::{Survey, into_survey};
use super::{Log, LogError, Selection};
pub(super) use reader::run;

/// How a ULog file begins.
pub const MAGIC: [u8; 7] = crate::format::ULOG_MAGIC;

/// Reads a log. `source` is its name in messages and reports.
///
/// # Errors
/// [`LogError`] if it cannot be read, does not begin as a ULog file, needs a newer reader, has no samples at all, or holds
/// more than `selection.max_values`. Damage within it is no error; `quality` says what was skipped.
pub fn read(reader: impl Read, source: &str, selection: &Selection) -> Result<Log, LogError> {
    into_log(source, selection, |sink| run(reader, source, sink))
}

/// What is in a log, in memory that does not grow with it.
///
/// # Errors
/// As [`read()`]; there is no bound on its length.
pub fn survey(reader: impl Read, source: &str) -> Result<Survey, LogError> {
    into_survey(|sink| run(reader, source, sink))
}
