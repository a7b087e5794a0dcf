//! How a flight is to be read.

use crate::memory::Memory;
use crate::profile::Profile;
use crate::table::{ColumnMapping, TableOptions};

/// How a flight is to be read. The default reads every file whose headers, or whose profile, name the channels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Mappings by hand, the budget of memory, and what is reported as a gap.
    pub table: TableOptions,
    /// CSV only: the character between cells; found automatically if not given.
    pub delimiter: Option<char>,
    /// Logs only: which fields are which channels. If not given, the built-in profile of the format is used.
    pub profile: Option<Profile>,
    /// Logs only: the topic whose times become the times of the record. If not given, the profile chooses.
    pub time_base: Option<String>,
}

impl ReadOptions {
    /// The same options with another budget of memory.
    #[must_use]
    pub fn with_max_memory(mut self, max_memory: Memory) -> Self {
        self.table.max_memory = max_memory;
        self
    }

    /// The default options with these mappings.
    pub fn with_columns(columns: Vec<ColumnMapping>) -> Self {
        Self { table: TableOptions { columns, ..TableOptions::default() }, ..Self::default() }
    }
}
