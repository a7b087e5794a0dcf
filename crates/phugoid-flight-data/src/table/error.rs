//! Errors of tables, whatever file they came from.

use super::ColumnMapping;
use crate::memory::OverBudget;
use crate::units::{self, Quantity};

/// Why no record can be made of a table. Every message says where, what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// No column can be recognised as the time.
    #[error(
        "{source_name}{}: no column is the time. Found: {headers}.{nearest} Call the time column time_s \
         (or time_ms, time_us), map it (channel 'time'), or give the sample time of the rows (--sample-time 0.02s)",
        at(*line)
    )]
    NoTime {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line of the header, counted from 1; `None` where the table is no text file.
        line: Option<usize>,
        /// The headers found, separated by commas; long lists are cut.
        headers: String,
        /// A sentence about a header that looks like the time, or empty.
        nearest: String,
    },
    /// Two columns have headers of the same channel.
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
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line of the header, counted from 1; `None` where the table is no text file.
        line: Option<usize>,
        /// The channel, by its canonical name.
        channel: String,
        /// Number (from 1) and header of the two columns.
        columns: Box<[(usize, String); 2]>,
    },
    /// The header of a column states two different units, or its header and the row of units do.
    #[error(
        "{source_name}{}, column {column} ('{header}'): the unit is given twice and differently, as \
         '{first}' and as '{second}'. Correct one of them, or map the column with its unit",
        at(*line)
    )]
    TwoUnits {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line of the header, counted from 1; `None` where the table is no text file.
        line: Option<usize>,
        /// Number of the column, counted from 1.
        column: usize,
        /// The header of the column, as written.
        header: String,
        /// The unit that was found first, as written.
        first: String,
        /// The unit that contradicts it, as written.
        second: String,
    },
    /// A mapping names a column that the file does not have.
    #[error(
        "{source_name}{}: channel '{}' is mapped to the column '{}', but the file has no such column{nearest}. \
         The columns are: {headers}",
        at(*line),
        mapping.channel,
        mapping.header
    )]
    MappedColumnMissing {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line of the header, counted from 1; `None` where the table is no text file.
        line: Option<usize>,
        /// The mapping that was asked for.
        mapping: Box<ColumnMapping>,
        /// The question whether the most similar header is meant, beginning with `; `; empty if none is similar.
        nearest: String,
        /// The headers found, separated by commas; long lists are cut.
        headers: String,
    },
    /// A mapping is wrong in itself: its channel name, unit or factor is not valid, or it names a column without
    /// numbers.
    #[error("the mapping of channel '{channel}' to column '{header}': {problem}")]
    BadMapping {
        /// The channel that the mapping names.
        channel: String,
        /// The column or field that the mapping names.
        header: String,
        /// What is wrong with it.
        problem: Box<MappingProblem>,
    },
    /// An option is out of its range.
    #[error("reader option {0}")]
    BadOption(OptionProblem),
    /// There are fewer rows with a usable time than a record needs (two).
    #[error(
        "{source_name}: no usable row of data{}: {reason}",
        line.map(|line| format!(" below the header in line {line}")).unwrap_or_default()
    )]
    NoRows {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line of the header, counted from 1; `None` where the table is no text file.
        line: Option<usize>,
        /// Why the rows cannot be used, as a clause.
        reason: String,
    },
    /// The time column rises in fewer than half of the rows.
    #[error(
        "{source_name}: column '{header}' does not work as the time: it rises in only {rising} of {rows} rows. Expected \
         are times that increase from row to row. {hint}"
    )]
    TimeDoesNotRise {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Header of the time column.
        header: String,
        /// Number of rows in the longest sequence of rising times.
        rising: usize,
        /// Number of rows that have a time.
        rows: usize,
        /// What the user can do about it, as a sentence.
        hint: &'static str,
    },
    /// It needs more memory than [`super::TableOptions::max_memory`].
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The table has more columns than are read.
    #[error(
        "{source_name}{}: the header has {columns} columns, more than the {max_columns} that are read. Check \
         that it is a table with one signal per column, or leave out columns",
        at(*line)
    )]
    TooManyColumns {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Line of the header, counted from 1; `None` where the table is no text file.
        line: Option<usize>,
        /// Number of columns found.
        columns: usize,
        /// The largest number of columns that is read.
        max_columns: usize,
    },
    /// The columns have different numbers of values.
    #[error(
        "{source_name}: column '{header}' has {found} values, the first column has {expected}. The columns of a table \
         have one value per row"
    )]
    Length {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Header of the column whose length differs.
        header: String,
        /// Number of its values.
        found: usize,
        /// Number of values of the first column.
        expected: usize,
    },
}

/// What is wrong with a mapping.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MappingProblem {
    /// The name of the channel is empty.
    #[error("the channel has no name")]
    NoChannelName,
    /// The name of the channel is a synonym or a misspelling of a known channel.
    #[error("'{channel}' is no channel name; did you mean '{nearest}'?")]
    NotCanonical {
        /// The name as it is written in the mapping.
        channel: String,
        /// The canonical name that is probably meant.
        nearest: &'static str,
    },
    /// A factor is 0, infinite or NaN.
    #[error(
        "scale = {scale}{} makes no sense; write 1, -1 or another factor",
        header.as_ref().map(|header| format!(" of '{header}'")).unwrap_or_default()
    )]
    Scale {
        /// The column with this factor, if the mapping adds several.
        header: Option<String>,
        /// The factor that was given.
        scale: f64,
    },
    /// The unit is not known, or is one of another quantity than that of the channel.
    #[error(
        "unit '{unit}' is not understood for {}; accepted are {}",
        quantity.in_words(),
        units::accepted(*quantity)
    )]
    UnitOfChannel {
        /// The unit as it is written in the mapping.
        unit: String,
        /// The quantity of the channel.
        quantity: Quantity,
    },
    /// The unit for a channel of one's own is not known.
    #[error("unit '{unit}' is not understood; write for instance deg, rad/s, ft/s, kt, psf")]
    UnknownUnit {
        /// The unit as it is written in the mapping.
        unit: String,
    },
    /// The column holds no numbers.
    #[error("this column is {why}; map a column of numbers")]
    NoNumbers {
        /// What the column is instead, as it follows "it is".
        why: String,
    },
}

/// Which option is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionProblem {
    /// [`super::TableOptions::gap_factor`] is not more than 1.
    #[error("gap_factor: is {0}; it counts median time steps and must be more than 1")]
    GapFactor(f64),
    /// [`super::TableOptions::sample_time_s`] is not a positive number.
    #[error("sample_time_s: is {0}; it must be a positive number of seconds")]
    SampleTime(f64),
    /// [`crate::csv::CsvOptions::delimiter`] is none of those that are understood.
    #[error("delimiter: is {0:?}; use one of ',' ';' tab '|' ' '")]
    Delimiter(char),
}

fn at(line: Option<usize>) -> String {
    line.map(|line| format!(", line {line}")).unwrap_or_default()
}
