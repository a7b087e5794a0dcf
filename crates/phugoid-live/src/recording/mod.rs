//! The recording: everything that arrived, with its times, in a file that survives a kill at any moment.
//!
//! `docs/live.md` describes the format. Blocks follow one another: `PHGL`, length, CRC-32, body. A block that was not written to its
//! end, or is damaged, costs that block; what follows is found by the next `PHGL`.

mod block;
mod read;
mod write;

use serde::{Deserialize, Serialize};

pub use block::BlockKind;
pub use read::{Damage, Reader, RecordingError};
pub use write::{Recorded, Recorder};

/// Version of the format.
pub const VERSION: u32 = 1;

/// The first block: all that is needed to estimate again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the format.
    pub version: u32,
    /// Version of the program that wrote it.
    pub program: String,
    /// Where it was received from, as on the command line.
    pub source: String,
    /// Start of the reception, ns since 1970-01-01 UTC.
    pub started_wall_ns: u64,
    /// Name of the model file.
    pub model_name: String,
    /// Text of the model file.
    pub model_text: String,
    /// Estimator, if one was chosen beside the model file.
    pub method: Option<String>,
    /// Whether changes are looked for, if it was chosen beside the model file.
    pub change_detection: Option<bool>,
    /// How long MAVLink messages wait for earlier ones, ns.
    pub reorder_ns: u64,
    /// The MAVLink system that is listened to.
    pub system: Option<u8>,
    /// The MAVLink message that is the time base.
    pub base: Option<String>,
}
