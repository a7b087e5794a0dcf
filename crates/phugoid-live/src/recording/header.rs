//! The first block of a recording.

use serde::{Deserialize, Serialize};

/// Version of the format that is written; later ones are not read. Version 1 has no [`Header::mapped`], which is then
/// false; versions before 3 have no [`Header::sender`] and no [`Header::signed`].
pub const VERSION: u32 = 3;

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
    /// True if the rows have canonical channel names and SI units already, because a flight record was replayed when
    /// this was recorded. The columns that the model file maps are not mapped once more then.
    #[serde(default)]
    pub mapped: bool,
    /// The sender that alone was used, if one was named.
    #[serde(default)]
    pub sender: Option<String>,
    /// True if every frame had to be signed with a key. The key itself is not recorded.
    #[serde(default)]
    pub signed: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_of_version_1_has_rows_as_they_came() {
        let text = r#"{"version":1,"program":"0.1.0","source":"udp://127.0.0.1:14550","started_wall_ns":7,
            "model_name":"f16","model_text":"","method":null,"change_detection":null,"reorder_ns":4000000,
            "system":null,"base":null}"#;
        let header: Header = serde_json::from_str(text).unwrap();
        assert_eq!((header.version, header.mapped), (1, false));
        assert!(header.version <= VERSION);
    }
}
