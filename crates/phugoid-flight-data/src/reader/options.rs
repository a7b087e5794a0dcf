//! How a flight is to be read.

use crate::profile::Profile;
use crate::table::{ColumnMapping, TableOptions};

/// How a flight is to be read. The default reads every file that explains itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Mappings by hand, the bound on memory, what is a gap.
    pub table: TableOptions,
    /// Text only: the character between cells.
    pub delimiter: Option<char>,
    /// Logs only: which fields are which channels; the built-in profile of the format if not given.
    pub profile: Option<Profile>,
    /// Logs only: the topic whose times the record takes; the profile's choice if not given.
    pub time_base: Option<String>,
}

impl ReadOptions {
    /// The default with these mappings.
    pub fn with_columns(columns: Vec<ColumnMapping>) -> Self {
        Self { table: TableOptions { columns, ..TableOptions::default() }, ..Self::default() }
    }
}
