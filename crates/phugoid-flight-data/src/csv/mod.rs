//! Reads and writes flight records as CSV.
//!
//! These variants are understood:
//!
//! - a header line with names and units in any usual form (`alpha_deg`, `Alpha [deg]`, `KTAS`), also as a comment, in
//!   quotes, with a byte-order mark (also of UTF-16), or with a row of units below it;
//! - comma, semicolon, tab, bar or blanks between the cells, and decimal commas where the cells have no commas between
//!   them; thousands that are separated by blanks, apostrophes, or the mark that does not stand before decimals;
//! - comment lines (`#`), and line ends of Unix, Windows and old Macs;
//! - empty cells, `NaN`, `inf` and `NA` as missing values;
//! - times in any unit of time, or as a clock (`12:34:56.7`, `2024-05-01T12:34:56Z`).
//!
//! A wrong row is left out and reported with its line number; what puts the whole file in doubt is an error. Lines are
//! counted as an editor shows them, from 1.
//!
//! ```
//! use phugoid_flight_data::csv::{self, CsvOptions};
//! let file = "time_s;alpha [deg];KTAS\n0,0;2,5;250\n0,1;2,6;\n0,2;2,7;251\n"; // decimal commas, a missing value
//! let record = csv::read(file.as_bytes(), "example.csv", &CsvOptions::default())?;
//! assert!((record.require("alpha")?.values[0] - 2.5_f64.to_radians()).abs() < 1e-15);
//! assert!(record.require("true_airspeed")?.values[1].is_nan());
//!
//! let mut written = Vec::new();
//! csv::write(&record, &mut written)?;
//! assert!(written.starts_with(b"time_s,alpha_rad,true_airspeed_m_s\n"));
//! let again = csv::read(written.as_slice(), "example.csv", &CsvOptions::default())?;
//! assert_eq!(again.channels[0], record.channels[0]); // to the last bit
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cells;
mod error;
mod format;
mod read;
mod rows;
mod stream;
mod text_file;
mod utf16;
mod write;

pub use error::{NameProblem, ReadError, WriteError};
pub(crate) use read::read_counted;
pub use read::{read, read_path};
pub use stream::{BadRow, RowReader, StreamColumns};
#[cfg(feature = "parquet")]
pub(crate) use write::headers;
pub use write::{write, write_path};

use crate::memory::Memory;
use crate::table::TableOptions;
pub use crate::table::{ColumnMapping, TableError};

/// How a CSV file is to be read. The default reads every file whose headers name the time, the channels and their
/// units.
#[derive(Clone, Debug, PartialEq)]
pub struct CsvOptions {
    /// Columns mapped by hand; all others become channels by their headers.
    pub columns: Vec<ColumnMapping>,
    /// Names of the columns, with units, in the order of the file: for a file without a header line, or in place of it.
    /// Empty: the names are those of the header line.
    pub column_names: Vec<String>,
    /// The character between cells, one of `,` `;` tab `|` blank; found automatically if not given.
    pub delimiter: Option<char>,
    /// Time step `h` from one row to the next, s, for files without a time or with a bad one: the rows are then at 0,
    /// h, 2h, ..., and a time column, if there is one, is left out. Positive.
    pub sample_time_s: Option<f64>,
    /// A step in time longer than this many median steps is reported as a gap. More than 1.
    pub gap_factor: f64,
    /// Whether times that begin more than a second from zero count from the first row ([`TableOptions::count_from_first`]).
    pub count_from_first: bool,
    /// The most memory that reading may take (default 200 MB), see [`crate::memory`].
    pub max_memory: Memory,
}

impl Default for CsvOptions {
    fn default() -> Self {
        Self::of(TableOptions::default(), None)
    }
}

impl CsvOptions {
    /// The options of tables with what concerns text: the character between cells.
    pub(crate) fn of(options: TableOptions, delimiter: Option<char>) -> Self {
        let TableOptions {
            columns,
            column_names,
            variable: _,
            sample_time_s,
            gap_factor,
            count_from_first,
            max_memory,
        } = options;
        Self { columns, column_names, delimiter, sample_time_s, gap_factor, count_from_first, max_memory }
    }

    /// The options that do not concern text, as other formats of tables take them.
    pub fn table(&self) -> TableOptions {
        TableOptions {
            columns: self.columns.clone(),
            column_names: self.column_names.clone(),
            variable: None,
            sample_time_s: self.sample_time_s,
            gap_factor: self.gap_factor,
            count_from_first: self.count_from_first,
            max_memory: self.max_memory,
        }
    }
}
