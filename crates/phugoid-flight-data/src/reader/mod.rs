//! One way to a flight record from a file of any format, which is known by its content.
//!
//! Tables (CSV, and under features Parquet, Arrow and MATLAB) become a record by their headers; logs of autopilots by a
//! [`Profile`] (MCAP: by the names of its fields) and on one time base, by [`crate::align::Aligner`]. In both, mappings of the caller come first: their `header` is a
//! column of the table, or `topic.field` or `topic#instance.field` of the log.
//!
//! To add a format: its place in [`Format`], an arm in [`read_path`], and, if it is a log, one in [`crate::log::read()`].

mod error;
mod from_log;
#[cfg(feature = "mcap")]
mod self_explained;
mod signals;
mod surfaces;
mod vehicle;

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

pub use error::ReadError;
pub use from_log::{record, selection};

use crate::csv::{self, CsvOptions};
use crate::format::{Format, SNIFFED};
use crate::log::{Log, LogError, dataflash, ulog};
use crate::profile::Profile;
use crate::record::Record;
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

/// Reads a flight from the disk into a record in SI units, whatever its format.
///
/// # Errors
/// [`ReadError`] as the reader of the format says; if the format is known, but not read by this build; if a log has nothing
/// that the profile or the mappings name.
pub fn read_path(path: &Path, options: &ReadOptions) -> Result<Record, ReadError> {
    let source = path.display().to_string();
    let io = |error| ReadError::Io { source_name: source.clone(), error };
    let mut file = File::open(path).map_err(io)?;
    let mut start = Vec::with_capacity(SNIFFED);
    file.by_ref().take(SNIFFED as u64).read_to_end(&mut start).map_err(io)?;
    let format = Format::sniff(&start);
    let reader = Cursor::new(start).chain(file);
    match format {
        Format::Csv | Format::Gzip | Format::Zip | Format::Utf16 => {
            Ok(csv::read(reader, &source, &csv_options(options))?)
        }
        Format::Ulog => from_log(Profile::px4, options, |selection| ulog::read(reader, &source, selection)),
        Format::DataFlash => {
            from_log(Profile::ardupilot, options, |selection| dataflash::read(reader, &source, selection))
        }
        #[cfg(feature = "mcap")]
        Format::Mcap => {
            use crate::log::mcap;
            // Twice through the file: what is in it has to be known before it is known what to keep.
            let names = || crate::log::survey_path(path).map(|survey| self_explained::profile(&survey));
            from_log(names, options, |selection| mcap::read(reader, &source, selection))
        }
        #[cfg(feature = "parquet")]
        Format::Parquet => Ok(crate::parquet::read_path(path, &options.table)?),
        #[cfg(feature = "parquet")]
        Format::Arrow => Ok(crate::arrow::read(reader, &source, &options.table)?),
        #[cfg(feature = "matlab")]
        Format::Mat5 => Ok(crate::matlab::read(reader, &source, &options.table)?),
        other => Err(ReadError::NotRead { source_name: source, format: other }),
    }
}

fn csv_options(options: &ReadOptions) -> CsvOptions {
    let TableOptions { columns, sample_time_s, gap_factor, max_values } = options.table.clone();
    CsvOptions { columns, delimiter: options.delimiter, sample_time_s, gap_factor, max_values }
}

/// Reads a log as far as it is needed, and makes a record of it.
fn from_log<E: Into<ReadError>>(
    built_in: impl Fn() -> Result<Profile, E>,
    options: &ReadOptions,
    read: impl FnOnce(&crate::log::Selection) -> Result<Log, LogError>,
) -> Result<Record, ReadError> {
    let built_in = match &options.profile {
        Some(profile) => profile.clone(),
        None => built_in().map_err(Into::into)?,
    };
    let log = read(&selection(&built_in, options))?;
    record(&log, &built_in, options)
}
