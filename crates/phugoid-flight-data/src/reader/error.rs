//! Why a flight could not be read.

use crate::csv;
use crate::format::{Format, build_with};
use crate::log::LogError;
use crate::profile::ProfileError;
use crate::table::TableError;

/// Why a flight could not be read. Every message says where, what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The operating system could not open or read it.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// File or stream.
        source_name: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// The format is known, but this build does not read it.
    #[error("{source_name}: this is {}; {}", format.in_words(), advice(*format))]
    NotRead {
        /// File or stream.
        source_name: String,
        /// What it is.
        format: Format,
    },
    /// A table as text could not be read.
    #[error(transparent)]
    Csv(#[from] csv::ReadError),
    /// The columns make no record.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A log could not be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The profile is wrong.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// A Parquet or Arrow file could not be read.
    #[cfg(feature = "parquet")]
    #[error(transparent)]
    Columnar(#[from] crate::parquet::ReadError),
    /// A MATLAB file could not be read.
    #[cfg(feature = "matlab")]
    #[error(transparent)]
    Matlab(#[from] crate::matlab::ReadError),
    /// A mapping names a field that is not in the log.
    #[error("{source_name}: channel '{channel}' is mapped to '{header}', but {problem}")]
    NoSuchField {
        /// File or stream.
        source_name: String,
        /// The mapping's channel.
        channel: String,
        /// The mapping's header.
        header: String,
        /// What is not there, what is, and the nearest.
        problem: String,
    },
    /// No topic can give the times.
    #[error("{source_name}: no topic that could give the times of a record: {wanted}. The log has: {present}")]
    NoTimeBase {
        /// File or stream.
        source_name: String,
        /// What was looked for.
        wanted: String,
        /// The topics that there are.
        present: String,
    },
    /// The log has nothing that is a channel.
    #[error(
        "{source_name}: nothing in the log is a channel that is known to the profile '{profile}'. The log has: {present}. Map \
         fields in the model file: [channels] q = {{ header = \"topic.field\", unit = \"rad/s\" }}"
    )]
    NothingUsable {
        /// File or stream.
        source_name: String,
        /// The profile's name.
        profile: String,
        /// The topics that there are.
        present: String,
    },
}

fn advice(format: Format) -> String {
    if let Some(feature) = format.feature() {
        return format!("this build does not read it; {}. Or save it as CSV", build_with(feature));
    }
    let advice = match format {
        Format::Hdf5 => "it is not read. In MATLAB, save it with -v7, or write a table as CSV with writetable",
        Format::DataFlashText => "give the binary log (.BIN) that it was made of",
        _ => "it is not read. Save it as CSV",
    };
    advice.to_owned()
}
