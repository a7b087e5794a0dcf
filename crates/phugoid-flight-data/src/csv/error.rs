//! Why a file could not be read or written.

use super::ColumnMapping;

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
    /// No column is the time.
    #[error(
        "{source_name}, line {line}: no column is the time. Found: {headers}.{nearest} Call the time column time_s \
         (or time_ms, time_us), map it (channel 'time'), or give the sample time of the rows"
    )]
    NoTime {
        /// File or stream.
        source_name: String,
        /// Line of the header.
        line: usize,
        /// The headers found.
        headers: String,
        /// A sentence about a header that looks like the time, or empty.
        nearest: String,
    },
    /// Two columns claim to be one channel.
    #[error(
        "{source_name}, line {line}: columns {first_column} ('{first}') and {second_column} ('{second}') are both \
         {channel}. Rename one of them, or map {channel} to the one that is to be used"
    )]
    TwoColumns {
        /// File or stream.
        source_name: String,
        /// Line of the header.
        line: usize,
        /// The channel, by its canonical name.
        channel: String,
        /// Column number of the first, from 1.
        first_column: usize,
        /// Header of the first.
        first: String,
        /// Column number of the second.
        second_column: usize,
        /// Header of the second.
        second: String,
    },
    /// Two units for one column.
    #[error(
        "{source_name}, line {line}, column {column} ('{header}'): the unit is given twice and differently, as \
         '{first}' and as '{second}'. Correct one of them, or map the column with its unit"
    )]
    TwoUnits {
        /// File or stream.
        source_name: String,
        /// Line of the header.
        line: usize,
        /// Column number, from 1.
        column: usize,
        /// The header.
        header: String,
        /// One unit.
        first: String,
        /// The other.
        second: String,
    },
    /// A mapping names a column that is not in the file.
    #[error(
        "{source_name}, line {line}: channel '{}' is mapped to the column '{}', but the file has no such column{nearest}. \
         The columns are: {headers}",
        mapping.channel,
        mapping.header
    )]
    MappedColumnMissing {
        /// File or stream.
        source_name: String,
        /// Line of the header.
        line: usize,
        /// The mapping.
        mapping: Box<ColumnMapping>,
        /// `; did you mean '...'?` or empty.
        nearest: String,
        /// The headers found.
        headers: String,
    },
    /// A mapping is wrong in itself.
    #[error("the mapping of channel '{channel}' to column '{header}': {problem}")]
    BadMapping {
        /// The mapping's channel.
        channel: String,
        /// The mapping's header.
        header: String,
        /// What was found, what is accepted.
        problem: String,
    },
    /// An option is out of its range.
    #[error("reader option {option}: {problem}")]
    BadOption {
        /// The option's name.
        option: &'static str,
        /// What was found, what is accepted.
        problem: String,
    },
    /// A header and nothing, or nothing usable, below it.
    #[error("{source_name}: no usable row of data below the header in line {line}: {reason}")]
    NoRows {
        /// File or stream.
        source_name: String,
        /// Line of the header.
        line: usize,
        /// What was wrong with the rows that there are.
        reason: String,
    },
    /// The time column is no time.
    #[error(
        "{source_name}: column '{header}' does not work as the time: it rises in only {rising} of {rows} rows. Expected \
         are times that increase from row to row. If another column is the time, map the channel 'time' to it"
    )]
    TimeDoesNotRise {
        /// File or stream.
        source_name: String,
        /// The time column's header.
        header: String,
        /// Rows in the longest rising sequence.
        rising: usize,
        /// Rows with a time.
        rows: usize,
    },
    /// More than fits into the set bound.
    #[error(
        "{source_name}, line {line}: the file holds more than {max_values} values, the set bound on memory. Cut it into \
         pieces, leave out columns, or raise `max_values`"
    )]
    TooLarge {
        /// File or stream.
        source_name: String,
        /// Line at which the bound was reached.
        line: usize,
        /// The bound.
        max_values: usize,
    },
    /// More columns than any flight record has.
    #[error(
        "{source_name}, line {line}: the header has {columns} columns, more than the {max_columns} that are read. Check \
         that it is a CSV file with one signal per column, or leave out columns"
    )]
    TooManyColumns {
        /// File or stream.
        source_name: String,
        /// Line of the header.
        line: usize,
        /// Columns found.
        columns: usize,
        /// The bound.
        max_columns: usize,
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
