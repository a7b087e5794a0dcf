//! Reads MCAP files (mcap.dev, "MCAP Format Specification") whose messages are JSON.
//!
//! A topic's fields are the numbers and truth values in its messages, nested ones by their path: `pose.position.x`,
//! `motors[2]`. Times are those of `log_time`, in seconds from the first message. Messages in other encodings (ROS 2,
//! Protobuf, FlatBuffers) are counted and left out with advice on converting them. JSON has no units: write them into
//! the names of the fields (`alpha_deg`), or give them in a profile or a mapping.
//!
//! Records and chunks are read one after the other, in bounded memory, without the index at the end, so that a file
//! that was cut off is read up to the cut. A damaged chunk is left out as a whole: its check sum is verified before its
//! records are used.

mod chunk;
mod content;
mod flatten;
mod records;

use std::io::Read;

use super::sink::into_log;
use super::survey::{Survey, into_survey};
use super::{Log, LogError, Selection};
use crate::memory::{Account, Memory};
pub(super) use records::run;

/// The first bytes of an MCAP file.
pub const MAGIC: [u8; 8] = crate::format::MCAP_MAGIC;

/// Reads the selected messages in JSON. `source` is the file's name in messages and reports.
///
/// # Errors
/// [`LogError`] if it cannot be read, does not begin as an MCAP file, has no message that could be read, or holds more
/// than `selection.max_memory`. Damage within the file is no error; `quality` names what was skipped.
pub fn read(reader: impl Read, source: &str, selection: &Selection) -> Result<Log, LogError> {
    let account = Account::new(selection.max_memory);
    into_log(source, selection, &account, |sink| run(reader, source, sink, &account))
}

/// Surveys a file, in memory that does not grow with it.
///
/// # Errors
/// As [`read()`], but a survey has no bound on the number of values.
pub fn survey(reader: impl Read, source: &str) -> Result<Survey, LogError> {
    let account = Account::new(Memory::default());
    into_survey(source, &account, |sink| run(reader, source, sink, &account))
}
