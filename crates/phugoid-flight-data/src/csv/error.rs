//! Why a file could not be read or written.

use crate::table::TableError;

/// Why a file could not be read. Every message says where, what was found, what was expected and what to do.
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
    /// It is not a text file.
    #[error("{source_name}: this is not a text file but {found}. A CSV file (UTF-8 text) is expected: {advice}")]
    NotText {
        /// File or stream.
        source_name: String,
        /// What it seems to be.
        found: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// No line at all.
    #[error(
        "{source_name}: the file is empty. A header line with names and units and at least two rows of numbers are \
         expected, such as\n  time_s,alpha_deg,q_deg_s\n  0.00,2.41,0.02\n  0.01,2.42,0.05"
    )]
    Empty {
        /// File or stream.
        source_name: String,
    },
    /// The first line is numbers.
    #[error(
        "{source_name}, line {line}: a header line with the names of the columns is expected, found numbers: \
         {found}. Put a line with names and units above it, such as time_s,alpha_deg,q_deg_s"
    )]
    NoHeader {
        /// File or stream.
        source_name: String,
        /// Line number in the file, from 1.
        line: usize,
        /// The line, cut.
        found: String,
    },
    /// A line without an end.
    #[error(
        "{source_name}, line {line}: the line is longer than {max_bytes} bytes; this is hardly a table of text. Check \
         that it is a CSV file with one row per line"
    )]
    LineTooLong {
        /// File or stream.
        source_name: String,
        /// Line number, from 1.
        line: usize,
        /// The bound.
        max_bytes: usize,
    },
    /// The cells were read, but make no record.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// Why a record could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system could not create or write it.
    #[error("{target}: cannot be written: {error}")]
    Io {
        /// File or stream.
        target: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// A channel is not as long as the time.
    #[error("{target}: channel '{channel}' has {found} values, but there are {expected} times; nothing was written")]
    Length {
        /// File or stream.
        target: String,
        /// Canonical name.
        channel: String,
        /// Its values.
        found: usize,
        /// The record's times.
        expected: usize,
    },
    /// A name that could not be read back as what it is.
    #[error("{target}: the channel name '{channel}' {problem}; rename it in the record; nothing was written")]
    Name {
        /// File or stream.
        target: String,
        /// The name.
        channel: String,
        /// Why.
        problem: &'static str,
    },
}
