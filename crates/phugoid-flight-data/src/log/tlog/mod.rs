//! Reads telemetry logs of ground stations (`.tlog` of QGroundControl, Mission Planner and MAVProxy), streaming: frames
//! of MAVLink, each after the time at which it came, microseconds since 1970 in eight bytes, most significant first.
//!
//! A topic is a message, a field one of its fields (`ATTITUDE.pitch`, `ATTITUDE_QUATERNION.repr_offset_q[2]`), in the unit
//! of the protocol's definitions. Every name of `NAMED_VALUE_FLOAT` is an instance of it with
//! one field of this name. Parameters are
//! those of `PARAM_VALUE`, messages those of `STATUSTEXT`.
//!
//! **Times** are those of the vehicle (`time_boot_ms`, `time_usec`), not those at which a frame came over the radio. A
//! message without one (`VFR_HUD`), or with the time of another clock, has the newest time of the vehicle before it, as in
//! `phugoid live`. Where the vehicle's clock begins again while the ground station goes on, the times go on by the clock of
//! the ground station.
//!
//! **One vehicle** is read: the first that sends its motion. What other systems send (the ground station itself, a second
//! aircraft) is counted. A message of another component of the vehicle is another instance, 256 times the number of the
//! component; sensors with an `id` are instances too.
//!
//! **Damage**: every message that the definitions know has a checksum. What does not pass it is left out and counted, and
//! the reader goes on where the next message certainly begins.

mod clock;
mod reader;

use std::io::Read;

use super::sink::into_log;
use super::survey::{Survey, into_survey};
use super::{Log, LogError, Selection};
use crate::memory::{Account, Memory};
pub(super) use reader::run;

/// Reads the selected part of a log. `source` is its name in messages and reports.
///
/// # Errors
/// [`LogError`] if it cannot be read, does not begin as a telemetry log, has no samples at all, or holds more than
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
