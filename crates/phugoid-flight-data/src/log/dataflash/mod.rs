//! Reads ArduPilot DataFlash logs (`.BIN`), streaming, as ArduPilot writes them (libraries/AP_Logger, `LogStructure.h`).
//!
//! Every message is `A3 95`, a type, and as many bytes as its definition (`FMT`) says. Read are `FMT`, `FMTU`, `UNIT` and `MULT`
//! (fields, units, multipliers, which field tells the instance), `PARM`, `MSG` and all data. There are no check sums: where no
//! message begins, the reader looks for the next place at which one does and another follows it, and says what it skipped.
//!
//! Values are in the unit that the log states, multipliers applied; times are seconds from the first stamp. Messages without a
//! stamp of their own (`EV`, `PM` in old logs) carry the time of the message before them, and `quality` names them.

mod format;
mod reader;

use std::io::Read;

use super::sink::into_log;
use super::survey::{Survey, into_survey};
use super::{Log, LogError, Selection};
pub(super) use reader::run;

/// How a message, and with it a file, begins.
pub const MAGIC: [u8; 2] = crate::format::DATAFLASH_MAGIC;

/// Reads a log. `source` is its name in messages and reports.
///
/// # Errors
/// [`LogError`] if it cannot be read, does not begin as a DataFlash log, has no samples at all, or holds more than
/// `selection.max_values`. Damage within it is no error; `quality` says what was skipped.
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
