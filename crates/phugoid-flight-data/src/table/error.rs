//! Why a table makes no record, whatever file it stood in.

use super::ColumnMapping;

/// Why a table makes no record. Every message says where, what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// No column is the time.
    #[error(
        "{source_name}{}: no column is the time. Found: {headers}.{nearest} Call the time column time_s \
         (or time_ms, time_us), map it (channel 'time'), or give the sample time of the rows",
        at(*line)
    )]
    NoTime {
        /// File or stream.
        source_name: String,
        /// Line of the header, in a file of lines.
        line: Option<usize>,
        /// The headers found.
        headers: String,
        /// A sentence about a header that looks like the time, or empty.
        nearest: String,
    },
    /// Two columns claim to be one channel.
    #[error(
        "{source_name}{}: columns {} ('{}') and {} ('{}') are both {channel}. Rename one of them, or map {channel} to \
         the one that is to be used",
        at(*line),
        columns[0].0,
        columns[0].1,
        columns[1].0,
        columns[1].1
    )]
    TwoColumns {
        /// File or stream.
        source_name: String,
        /// Line of the header, in a file of lines.
        line: Option<usize>,
        /// The channel, by its canonical name.
        channel: String,
        /// Number (from 1) and header of each of them.
        columns: Box<[(usize, String); 2]>,
    },
    /// Two units for one column.
    #[error(
        "{source_name}{}, column {column} ('{header}'): the unit is given twice and differently, as \
         '{first}' and as '{second}'. Correct one of them, or map the column with its unit",
        at(*line)
    )]
    TwoUnits {
        /// File or stream.
        source_name: String,
        /// Line of the header, in a file of lines.
        line: Option<usize>,
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
        "{source_name}{}: channel '{}' is mapped to the column '{}', but the file has no such column{nearest}. \
         The columns are: {headers}",
        at(*line),
        mapping.channel,
        mapping.header
    )]
    MappedColumnMissing {
        /// File or stream.
        source_name: String,
        /// Line of the header, in a file of lines.
        line: Option<usize>,
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
    #[error(
        "{source_name}: no usable row of data{}: {reason}",
        line.map(|line| format!(" below the header in line {line}")).unwrap_or_default()
    )]
    NoRows {
        /// File or stream.
        source_name: String,
        /// Line of the header, in a file of lines.
        line: Option<usize>,
        /// What was wrong with the rows that there are.
        reason: String,
    },
    /// The time column is no time.
    #[error(
        "{source_name}: column '{header}' does not work as the time: it rises in only {rising} of {rows} rows. Expected \
         are times that increase from row to row. {hint}"
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
        /// What to do.
        hint: &'static str,
    },
    /// More than fits into the set bound.
    #[error(
        "{source_name}, {place}: the file holds more than {max_values} values, the set bound on memory. Cut it into \
         pieces, leave out columns, or raise `max_values`"
    )]
    TooLarge {
        /// File or stream.
        source_name: String,
        /// Line, row or variable at which the bound was reached.
        place: String,
        /// The bound.
        max_values: usize,
    },
    /// More columns than any flight record has.
    #[error(
        "{source_name}{}: the header has {columns} columns, more than the {max_columns} that are read. Check \
         that it is a table with one signal per column, or leave out columns",
        at(*line)
    )]
    TooManyColumns {
        /// File or stream.
        source_name: String,
        /// Line of the header, in a file of lines.
        line: Option<usize>,
        /// Columns found.
        columns: usize,
        /// The bound.
        max_columns: usize,
    },
    /// Columns of different lengths.
    #[error(
        "{source_name}: column '{header}' has {found} values, the first column has {expected}. The columns of a table \
         have one value per row"
    )]
    Length {
        /// File or stream.
        source_name: String,
        /// The column's header.
        header: String,
        /// Its values.
        found: usize,
        /// Values of the first column.
        expected: usize,
    },
}

fn at(line: Option<usize>) -> String {
    line.map(|line| format!(", line {line}")).unwrap_or_default()
}
