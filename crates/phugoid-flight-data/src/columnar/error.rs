//! Why a Parquet or Arrow file could not be read.

use crate::table::TableError;

/// Why a Parquet or Arrow file could not be read. Every message says where, what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system could not open or read it.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// File or stream.
        source_name: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// It is something else, or a kind of it that is not read.
    #[error("{source_name}: this is {found}. {advice}")]
    NotRead {
        /// File or stream.
        source_name: String,
        /// What it is.
        found: String,
        /// What to do.
        advice: &'static str,
    },
    /// Nothing in it could be read.
    #[error("{source_name}, {place}: the file is damaged: {problem}. Copy or write it again")]
    Damaged {
        /// File or stream.
        source_name: String,
        /// Byte, row group or footer.
        place: String,
        /// What was found and expected.
        problem: String,
    },
    /// The numbers were read, but make no record.
    #[error(transparent)]
    Table(#[from] TableError),
}
