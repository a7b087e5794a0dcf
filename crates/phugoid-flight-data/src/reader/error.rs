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
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// The format is known, but this build does not read it: it is never read, or its feature is switched off
    /// ([`Format::feature`]).
    #[error("{source_name}: this is {}; {}", format.in_words(), advice(*format))]
    NotRead {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The format of the file.
        format: Format,
    },
    /// A CSV file could not be read, or no record can be made of it.
    #[error(transparent)]
    Csv(#[from] csv::ReadError),
    /// No record can be made of the columns of a table or the signals of a log.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A log could not be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The profile that was given, or a built-in one, is not valid.
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
    /// A mapping names a topic or a field that is not in the log.
    #[error("{source_name}: channel '{channel}' is mapped to '{header}', but {problem}")]
    NoSuchField {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The channel that the mapping names.
        channel: String,
        /// The column or field that the mapping names.
        header: String,
        /// What is missing, what the log has instead, and the most similar name.
        problem: String,
    },
    /// None of the topics whose times a record could take has two samples.
    #[error("{source_name}: no topic that could give the times of a record: {wanted}. The log has: {present}")]
    NoTimeBase {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The topics that were looked for, as a clause.
        wanted: String,
        /// The topics that the log has, separated by commas; long lists are cut.
        present: String,
    },
    /// No field of the log is a channel by the profile or the mappings.
    #[error(
        "{source_name}: nothing in the log is a channel that is known to the profile '{profile}'. The log has: {present}. Map \
         fields in the model file: [channels] q = {{ header = \"topic.field\", unit = \"rad/s\" }}"
    )]
    NothingUsable {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Name of the profile that was used.
        profile: String,
        /// The topics that the log has, separated by commas; long lists are cut.
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
