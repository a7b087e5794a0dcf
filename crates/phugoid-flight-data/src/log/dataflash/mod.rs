//! Reads ArduPilot DataFlash logs (`.BIN`), streaming, as ArduPilot writes them (libraries/AP_Logger,
//! `LogStructure.h`).
//!
//! Every message is `A3 95`, a type, and as many bytes as its definition (`FMT`) states. The reader understands `FMT`,
//! `FMTU`, `UNIT` and `MULT` (fields, units, multipliers, and the field that numbers the instance), `PARM`, `MSG` and
//! all data. There are no check sums: where no message begins, the reader searches for the next place at which one
//! begins and another one follows, and reports the bytes that it skipped.
//!
//! Values are in the unit that the log states, with multipliers applied. Times are seconds from the first time stamp.
//! Messages without a stamp of their own (`EV`, and `PM` in old logs) get the time of the message before them, and
//! `quality` names them.

mod format;
mod reader;

use std::io::Read;

use super::sink::into_log;
use super::survey::{Survey, into_survey};
use super::{Log, LogError, Selection};
use crate::memory::{Account, Memory};
pub(super) use reader::run;

/// The first bytes of every message, and so of the file.
pub const MAGIC: [u8; 2] = crate::format::DATAFLASH_MAGIC;

/// Reads the selected part of a log. `source` is its name in messages and reports.
///
/// # Errors
/// [`LogError`] if it cannot be read, does not begin as a DataFlash log, has no samples at all, or holds more than
/// `selection.max_memory`. Damage within the log is no error; `quality` names what was skipped.
pub fn read(reader: impl Read, source: &str, selection: &Selection) -> Result<Log, LogError> {
    let account = Account::new(selection.max_memory);
    into_log(source, selection, &account, |sink| run(reader, source, sink))
}

/// Surveys a log, in memory that does not grow with it.
///
/// # Errors
/// As [`read()`], but a survey has no bound on the number of values.
pub fn survey(reader: impl Read, source: &str) -> Result<Survey, LogError> {
    let account = Account::new(Memory::default());
    into_survey(source, &account, |sink| run(reader, source, sink))
}
