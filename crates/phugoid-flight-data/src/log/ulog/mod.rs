//! Reads PX4 ULog files, streaming, as their public description says (PX4 User Guide, "ULog File Format").
//!
//! The reader understands definitions (`B F I M P Q`), data (`A R D L C S O`), appended data, multi-instance topics,
//! nested types and arrays. ULog has no check sums: where a message does not fit the definitions, the reader searches
//! for the next one that does, keeps everything else, and reports the bytes that it skipped. No memory is allocated for
//! a length before its bytes have been read.
//!
//! Times are seconds from the start of the log that its header gives. The format has no units; [`crate::profile`] knows
//! those of PX4.

mod definitions;
mod format;
mod message;
mod reader;

use std::io::Read;

use super::sink::into_log;
use super::survey::{Survey, into_survey};
use super::{Log, LogError, Selection};
use crate::memory::{Account, Memory};
pub(super) use reader::run;

/// The first bytes of a ULog file.
pub const MAGIC: [u8; 7] = crate::format::ULOG_MAGIC;

/// Reads the selected part of a log. `source` is its name in messages and reports.
///
/// # Errors
/// [`LogError`] if it cannot be read, does not begin as a ULog file, needs a newer reader, has no samples at all, or
/// holds more than `selection.max_memory`. Damage within the log is no error; `quality` names what was skipped.
pub fn read(reader: impl Read, source: &str, selection: &Selection) -> Result<Log, LogError> {
    let account = Account::new(selection.max_memory);
    into_log(source, selection, &account, |sink| run(reader, source, sink, &account))
}

/// Surveys a log, in memory that does not grow with it.
///
/// # Errors
/// As [`read()`], but a survey has no bound on the number of values.
pub fn survey(reader: impl Read, source: &str) -> Result<Survey, LogError> {
    let account = Account::new(Memory::default());
    into_survey(source, &account, |sink| run(reader, source, sink, &account))
}
