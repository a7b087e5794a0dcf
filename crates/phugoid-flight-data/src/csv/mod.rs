//! Reads and writes flight records as CSV.
//!
//! What is understood: a header line with names and units in any usual form (`alpha_deg`, `Alpha [deg]`, `KTAS`), also
//! behind a comment mark, with a row of units below it, quoted, with a byte-order mark; comma, semicolon, tab, bar or
//! blanks between the cells, decimal commas where the cells are not separated by commas; comment lines (`#`); Unix,
//! Windows and old Mac line ends; empty cells, `NaN`, `inf`, `NA` as missing values; times in any unit of time or as a
//! clock (`12:34:56.7`, `2024-05-01T12:34:56Z`).
//!
//! What is wrong in single rows is left out and reported with line numbers; what makes the whole file doubtful is an
//! error. Lines are counted as an editor shows them, from 1.

mod cells;
mod error;
mod format;
mod read;
mod rows;
mod stream;
mod text_file;
mod write;

pub use error::{ReadError, WriteError};
pub use read::{read, read_path};
pub use stream::{BadRow, RowReader, StreamColumns};
#[cfg(feature = "parquet")]
pub(crate) use write::headers;
pub use write::{write, write_path};

use crate::table::TableOptions;
pub use crate::table::{ColumnMapping, TableError};

/// How a CSV file is to be read. The default reads every file that explains itself.
#[derive(Clone, Debug, PartialEq)]
pub struct CsvOptions {
    /// Columns mapped by hand; all others are taken by their headers.
    pub columns: Vec<ColumnMapping>,
    /// The character between cells; found by itself if not given. One of `,` `;` tab `|` blank.
    pub delimiter: Option<char>,
    /// Time from one row to the next, s, for files without a time or with a bad one: the rows are then at 0, h, 2h, ...
    /// and a time column, if there is one, is left out.
    pub sample_time_s: Option<f64>,
    /// A step in time longer than this many median steps is reported as a gap. More than 1.
    pub gap_factor: f64,
    /// Bound on memory: rows times columns, 8 bytes each (default 100 million, 0.8 GB).
    pub max_values: usize,
}

impl Default for CsvOptions {
    fn default() -> Self {
        let TableOptions { columns, sample_time_s, gap_factor, max_values } = TableOptions::default();
        Self { columns, delimiter: None, sample_time_s, gap_factor, max_values }
    }
}

impl CsvOptions {
    /// What is not about text.
    pub fn table(&self) -> TableOptions {
        TableOptions {
            columns: self.columns.clone(),
            sample_time_s: self.sample_time_s,
            gap_factor: self.gap_factor,
            max_values: self.max_values,
        }
    }
}
