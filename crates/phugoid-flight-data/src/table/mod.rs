//! Tables of numbers, one named column per signal, and the record that they make: the one road of CSV, Parquet, Arrow
//! and MATLAB files once their cells are numbers.

mod assemble;
pub(crate) mod columns;
mod error;
mod from_columns;
pub(crate) mod header;
mod stuck_and_spikes;
pub(crate) mod time_base;

pub(crate) use assemble::{Read, record};
pub use error::TableError;
pub(crate) use from_columns::from_sparse_columns;
pub use from_columns::{Column, LeftOut, from_columns};

use serde::{Deserialize, Serialize};

/// Maps a column to a channel by hand, where the header does not say it or says it wrongly; or several columns that make it together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMapping {
    /// Canonical channel name (see [`crate::channels::CHANNELS`]), or a free name for a signal of your own.
    pub channel: String,
    /// The column's header as it stands in the file, e.g. `ELEV_POS_2`; case does not matter if that is unambiguous.
    pub header: String,
    /// The column's unit, e.g. `deg`; without it, the unit in the header, else SI with a warning.
    #[serde(default)]
    pub unit: Option<String>,
    /// Multiplies the column's values before the unit is converted; -1 turns the sign. Finite, not zero.
    #[serde(default = "one")]
    pub scale: f64,
    /// Further columns, each times a factor of its own, that are added before the unit is converted: two elevons make an elevator
    /// together. They are in the unit of the first; where one has no value, the sum has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plus: Vec<Addend>,
}

/// A column that is added to another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Addend {
    /// The column's header as it stands in the file.
    pub header: String,
    /// Multiplies its values. Finite, not zero.
    #[serde(default = "one")]
    pub scale: f64,
}

fn one() -> f64 {
    1.0
}

impl ColumnMapping {
    /// A mapping with the unit of the header and no change of sign.
    pub fn new(channel: impl Into<String>, header: impl Into<String>) -> Self {
        Self { channel: channel.into(), header: header.into(), unit: None, scale: 1.0, plus: Vec::new() }
    }

    /// The same with the unit given.
    #[must_use]
    pub fn with_unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = Some(unit.into());
        self
    }

    /// The same with a factor, such as -1 for a sign.
    #[must_use]
    pub fn with_scale(mut self, scale: f64) -> Self {
        self.scale = scale;
        self
    }

    /// The same with a further column added, times a factor.
    #[must_use]
    pub fn plus(mut self, header: impl Into<String>, scale: f64) -> Self {
        self.plus.push(Addend { header: header.into(), scale });
        self
    }

    /// All its columns: header and factor.
    pub fn terms(&self) -> impl Iterator<Item = (&str, f64)> {
        let further = self.plus.iter().map(|addend| (addend.header.as_str(), addend.scale));
        [(self.header.as_str(), self.scale)].into_iter().chain(further)
    }
}

/// How a table is to be read. The default reads every table that explains itself.
#[derive(Clone, Debug, PartialEq)]
pub struct TableOptions {
    /// Columns mapped by hand; all others are taken by their headers.
    pub columns: Vec<ColumnMapping>,
    /// Time from one row to the next, s, for tables without a time or with a bad one: the rows are then at 0, h, 2h, ...
    /// and a time column, if there is one, is left out.
    pub sample_time_s: Option<f64>,
    /// A step in time longer than this many median steps is reported as a gap. More than 1.
    pub gap_factor: f64,
    /// Bound on memory: rows times columns, 8 bytes each (default 100 million, 0.8 GB).
    pub max_values: usize,
}

impl Default for TableOptions {
    fn default() -> Self {
        Self { columns: Vec::new(), sample_time_s: None, gap_factor: 3.5, max_values: 100_000_000 }
    }
}

impl TableOptions {
    pub(crate) fn check(&self) -> Result<(), TableError> {
        if self.gap_factor.is_nan() || self.gap_factor <= 1.0 {
            let problem = format!("is {}; it counts median time steps and must be more than 1", self.gap_factor);
            return Err(TableError::BadOption { option: "gap_factor", problem });
        }
        if let Some(step) = self.sample_time_s.filter(|step| !step.is_finite() || *step <= 0.0) {
            let problem = format!("is {step}; it must be a positive number of seconds");
            return Err(TableError::BadOption { option: "sample_time_s", problem });
        }
        Ok(())
    }
}
