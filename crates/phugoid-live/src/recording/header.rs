//! The first block of a recording.

use serde::{Deserialize, Serialize};

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
