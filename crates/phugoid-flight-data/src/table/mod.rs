//! From a table of numbers, one named column per signal, to a record. CSV, Parquet, Arrow and MATLAB files all take
//! this way once their cells are numbers.

mod assemble;
pub(crate) mod clock;
mod coarse_times;
pub(crate) mod columns;
mod derived;
mod error;
mod from_columns;
pub(crate) mod header;
mod markers;
pub(crate) mod misspelt;
mod stuck_and_spikes;
pub(crate) mod time_base;
mod time_column;

pub(crate) use assemble::{BYTES_PER_ROW, Read, record};
pub use error::{MappingProblem, OptionProblem, TableError};
#[cfg(any(feature = "matlab", feature = "parquet"))]
pub(crate) use from_columns::from_counted_columns;
pub(crate) use from_columns::from_sparse_columns;
pub use from_columns::{Column, LeftOut, from_columns};
pub use misspelt::Misspelt;

use serde::{Deserialize, Serialize};

use crate::memory::Memory;

/// Maps a column to a channel by hand, where its header does not name the channel or names a wrong one. Several columns
/// can be added to make one channel.
///
/// ```
/// use phugoid_flight_data::csv::{self, ColumnMapping, CsvOptions};
/// let text = "time_s,left,right\n0.0,2.0,4.0\n0.1,2.5,3.5\n"; // two elevons, deg, positive trailing edge up
/// let elevator = ColumnMapping::new("elevator", "left").with_scale(-0.5).plus("right", -0.5).with_unit("deg");
/// let options = CsvOptions { columns: vec![elevator], ..CsvOptions::default() };
/// let record = csv::read(text.as_bytes(), "flight.csv", &options)?;
/// assert!((record.require("elevator")?.values[0] + 3.0_f64.to_radians()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMapping {
    /// Canonical channel name (see [`crate::channels::CHANNELS`]), or any other name for a signal of your own.
    pub channel: String,
    /// Header of the column as in the file, such as `ELEV_POS_2`; case does not matter if only one column fits. Of a
    /// log `topic.field` or `topic#instance.field`.
    pub header: String,
    /// Unit of the column, such as `deg`. Without it the unit of the header is taken, else SI with a warning.
    #[serde(default)]
    pub unit: Option<String>,
    /// Factor by which the values are multiplied before the unit is converted; -1 reverses the sign. Finite, not 0.
    #[serde(default = "one")]
    pub scale: f64,
    /// Further columns, each times a factor of its own, that are added before the unit is converted: two elevons
    /// together make an elevator. They are in the unit of the first column. Where one value is missing, the sum is
    /// missing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plus: Vec<Addend>,
}

/// A column that is added to another one, with its factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Addend {
    /// Header of the column as in the file.
    pub header: String,
    /// Factor by which its values are multiplied. Finite, not 0.
    #[serde(default = "one")]
    pub scale: f64,
}

fn one() -> f64 {
    1.0
}

impl ColumnMapping {
    /// Maps the column `header` to `channel`, with the unit of the header and the factor 1.
    pub fn new(channel: impl Into<String>, header: impl Into<String>) -> Self {
        Self { channel: channel.into(), header: header.into(), unit: None, scale: 1.0, plus: Vec::new() }
    }

    /// Returns the mapping with the unit of the column set.
    #[must_use]
    pub fn with_unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = Some(unit.into());
        self
    }

    /// Returns the mapping with the factor set, such as -1 to reverse the sign.
    #[must_use]
    pub fn with_scale(mut self, scale: f64) -> Self {
        self.scale = scale;
        self
    }

    /// Returns the mapping with a further column added, times a factor.
    #[must_use]
    pub fn plus(mut self, header: impl Into<String>, scale: f64) -> Self {
        self.plus.push(Addend { header: header.into(), scale });
        self
    }

    /// Header and factor of all its columns, the first one first.
    pub fn terms(&self) -> impl Iterator<Item = (&str, f64)> {
        let further = self.plus.iter().map(|addend| (addend.header.as_str(), addend.scale));
        [(self.header.as_str(), self.scale)].into_iter().chain(further)
    }
}

/// How a table is to be read. The default reads every table whose headers name the time, the channels and their units.
#[derive(Clone, Debug, PartialEq)]
pub struct TableOptions {
    /// Columns mapped by hand; all others become channels by their headers.
    pub columns: Vec<ColumnMapping>,
    /// Names of the columns, with units, in the order of the file: for a table of numbers without a header, or in place of
    /// the one that it has. Empty: the names are those of the file. Parquet, Arrow and logs name their columns themselves, so that
    /// they are refused with names ([`ReadError::NamedInTheFile`](crate::reader::ReadError::NamedInTheFile)).
    pub column_names: Vec<String>,
    /// The variable to read of a MATLAB file that holds several tables (`flight2`, or `data.flight2` for a field of a
    /// struct), or the sheet of a workbook; of other formats it is not read. `None`: everything in the file, or its first
    /// sheet.
    pub variable: Option<String>,
    /// Time step `h` from one row to the next, s, for tables without a time or with a bad one: the rows are then at 0,
    /// h, 2h, ..., and a time column, if there is one, is left out. Positive.
    pub sample_time_s: Option<f64>,
    /// A step in time longer than this many median steps is reported as a gap. More than 1.
    pub gap_factor: f64,
    /// Whether times that begin more than a second from zero count from the first row, as those of a clock and of a calendar
    /// always do. [`crate::reader`] sets it, so that 4 s of a flight is four seconds into it.
    pub count_from_first: bool,
    /// The most memory that reading may take (default 200 MB), see [`crate::memory`].
    pub max_memory: Memory,
}

impl Default for TableOptions {
    fn default() -> Self {
        Self {
            columns: Vec::new(),
            column_names: Vec::new(),
            variable: None,
            sample_time_s: None,
            gap_factor: 3.5,
            count_from_first: false,
            max_memory: Memory::default(),
        }
    }
}

impl TableOptions {
    pub(crate) fn check(&self) -> Result<(), TableError> {
        if self.gap_factor.is_nan() || self.gap_factor <= 1.0 {
            return Err(TableError::BadOption(OptionProblem::GapFactor(self.gap_factor)));
        }
        if let Some(step) = self.sample_time_s.filter(|step| !step.is_finite() || *step <= 0.0) {
            return Err(TableError::BadOption(OptionProblem::SampleTime(step)));
        }
        Ok(())
    }
}
