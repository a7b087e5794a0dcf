//! Errors of reading Parquet and Arrow files.

use crate::table::TableError;

/// Why a Parquet or Arrow file could not be read. Every message says where, what was found, what was expected and what
/// to do.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system could not open or read the file or stream.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// The file is in another format, or in a variant of the format that is not read.
    #[error("{source_name}: this is {found}. {advice}")]
    NotRead {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// What the file is, as a noun with its article.
        found: String,
        /// What the user can do about it, as a sentence.
        advice: &'static str,
    },
    /// The file is damaged, and not one row of it could be read.
    #[error("{source_name}, {place}: the file is damaged: {problem}. Copy or write it again")]
    Damaged {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Where the damage is: a byte offset, a group of rows, or the footer.
        place: String,
        /// What was found there and what was expected, as a clause.
        problem: String,
    },
    /// The numbers were read, but no record can be made of them.
    #[error(transparent)]
    Table(#[from] TableError),
}
