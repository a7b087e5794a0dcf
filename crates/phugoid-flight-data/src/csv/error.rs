//! Errors of reading and writing CSV.

use crate::table::TableError;

/// Why a file could not be read. Every message says where, what was found, what was expected and what to do.
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
    /// It is not a text file.
    #[error("{source_name}: this is not a text file but {found}. A CSV file (UTF-8 text) is expected: {advice}")]
    NotText {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// What the file seems to be, such as `a zip archive`.
        found: &'static str,
        /// What the user can do about it, as a sentence.
        advice: &'static str,
    },
    /// The file has no line with cells: it is empty, or holds only blank lines and comments.
    #[error(
        "{source_name}: the file is empty. A header line with names and units and at least two rows of numbers are \
         expected, such as\n  time_s,alpha_deg,q_deg_s\n  0.00,2.41,0.02\n  0.01,2.42,0.05"
    )]
    Empty {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
    },
    /// The first row holds numbers where the names of the columns are expected.
    #[error(
        "{source_name}, line {line}: a header line with the names of the columns is expected, found numbers: \
         {found}. Give the names and units of the columns (--columns time_s,alpha_deg,q_deg_s), or put a line with them \
         above"
    )]
    NoHeader {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line number in the file, from 1.
        line: usize,
        /// The beginning of that line.
        found: String,
    },
    /// The names that were given for the columns are more or fewer than the columns.
    #[error("{source_name}, line {line}: {given} names of columns were given, and this row has {found} cells")]
    Names {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line number of the first row in the file, from 1.
        line: usize,
        /// Number of names.
        given: usize,
        /// Number of cells.
        found: usize,
    },
    /// A line is longer than any row of a table.
    #[error(
        "{source_name}, line {line}: the line is longer than {max_bytes} bytes; this is hardly a table of text. Check \
         that it is a CSV file with one row per line"
    )]
    LineTooLong {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line number in the file, from 1.
        line: usize,
        /// The longest line that is read, bytes.
        max_bytes: usize,
    },
    /// A column has numbers that mean a thousand and more by the marks of the other columns, and others that deny it.
    #[error(
        "{source_name}, column '{header}': '{thousands}' is a thousand and more where the file has its decimals behind the other \
         mark, and '{decimals}' in the same column has decimals behind this one. Write the column without marks of thousands, \
         and all numbers of the file with one decimal mark"
    )]
    Marks {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Header of the column.
        header: String,
        /// A number whose mark could separate thousands.
        thousands: String,
        /// A number whose mark cannot.
        decimals: String,
    },
    /// The cells were read, but no record can be made of them.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// Why a record could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system could not create or write it.
    #[error("{target}: cannot be written: {error}")]
    Io {
        /// Name of the file or stream, as the caller gave it.
        target: String,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// A channel is not as long as the time.
    #[error("{target}: channel '{channel}' has {found} values, but there are {expected} times; nothing was written")]
    Length {
        /// Name of the file or stream, as the caller gave it.
        target: String,
        /// Name of the channel.
        channel: String,
        /// Number of its values.
        found: usize,
        /// Number of times of the record.
        expected: usize,
    },
    /// A channel name that could not be read back as the same channel.
    #[error("{target}: the channel name '{channel}' {problem}; rename it in the record; nothing was written")]
    Name {
        /// Name of the file or stream, as the caller gave it.
        target: String,
        /// The name of the channel.
        channel: String,
        /// What is wrong with it.
        problem: NameProblem,
    },
}

/// Why a channel cannot be written under its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NameProblem {
    /// Two channels of the record have this name.
    #[error("stands twice in the record")]
    Twice,
    /// The name cannot be a header of a column.
    #[error(
        "is empty, begins or ends with a blank, holds a line end or another control character, or begins like a formula \
         (=, +, -, @)"
    )]
    Unwritable,
    /// No header with this name would be read back as this channel.
    #[error("would not be read back as the same channel")]
    Misread,
}
