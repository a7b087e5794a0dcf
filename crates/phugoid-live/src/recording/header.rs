//! The first block of a recording.

use serde::{Deserialize, Serialize};

/// Version of the format that is written; later ones are not read.
pub const VERSION: u32 = 1;

/// The first block: what is needed to estimate again, with the model file as text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the format, [`VERSION`].
    pub version: u32,
    /// Version of the program that wrote the recording.
    pub program: String,
    /// Where the data came from, as on the command line.
    pub source: String,
    /// Start of the reception, ns since 1970-01-01 UTC.
    pub started_wall_ns: u64,
    /// Name of the model file, for people.
    pub model_name: String,
    /// Whole text of the model file (TOML).
    pub model_text: String,
    /// Name of the estimator, if one was chosen on the command line.
    pub method: Option<String>,
    /// Whether changes are detected, if that was chosen on the command line.
    pub change_detection: Option<bool>,
    /// How long samples wait for MAVLink messages that are missing, ns.
    pub reorder_ns: u64,
    /// Number of the MAVLink vehicle, if one was chosen.
    pub system: Option<u8>,
    /// Name of the MAVLink message that gives the times, if one was chosen.
    pub base: Option<String>,
}
