//! One way to a flight record from a file of any format, which is known by its content.
//!
//! Tables (CSV, and under features Parquet, Arrow and MATLAB) become a record by their headers; logs of autopilots by a
//! [`Profile`] (MCAP: by the names of its fields) and on one time base, by [`crate::align::Aligner`]. In both, mappings of the caller come first: their `header` is a
//! column of the table, or `topic.field` or `topic#instance.field` of the log.
//!
//! To add a format: its place in [`Format`]; of a log, its reader in [`crate::log`] and, unless its fields say themselves what they
//! are, its profile in `built_in`; of a table, an arm in `table`.

mod error;
mod from_log;
mod mapped;
mod options;
mod self_explained;
mod signals;
mod surfaces;
mod vehicle;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

pub use error::ReadError;
pub use from_log::{record, selection};
pub use options::ReadOptions;

use crate::csv::{self, CsvOptions};
use crate::format::Format;
use crate::log;
use crate::log::survey::Survey;
use crate::profile::{Profile, ProfileError};
use crate::record::Record;
use crate::table::TableOptions;

impl Record {
    /// Opens a flight of any format that this build reads, with the default options.
    ///
    /// The format is known by the content of the file, not by its name: CSV, PX4 ULog and ArduPilot DataFlash, and under
    /// features MATLAB 5, MCAP, Parquet and Arrow. Values are in SI units and radians, NaN where one is missing. For
    /// mappings of columns, a profile of one's own or other bounds use [`read_path`].
    ///
    /// ```
    /// use phugoid_flight_data::record::Record;
    /// let flight = Record::open("examples/flight.csv")?;
    /// let rate = flight.require("q")?; // pitch rate, rad/s
    /// assert_eq!(rate.values.len(), flight.time.len());
    /// assert!(Record::open("examples/no-such-flight.csv").is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`read_path`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        read_path(path.as_ref(), &ReadOptions::default())
    }
}

/// Reads a flight from the disk into a record in SI units, whatever its format.
///
/// # Errors
/// [`ReadError`] as the reader of the format says; if the format is known, but not read by this build; if a log has nothing
/// that the profile or the mappings name.
pub fn read_path(path: &Path, options: &ReadOptions) -> Result<Record, ReadError> {
    let (format, reader, source) = open(path)?;
    if !format.is_log() {
        return table(format, reader, path, options);
    }
    match profile(format, options)? {
        Some(profile) => {
            let log = log::read_as(format, reader, &source, &selection(&profile, options))?;
            record(&log, &profile, options)
        }
        None => of_named_fields(&log::survey_as(format, reader, &source)?, path, options),
    }
}

/// A file as it is, and the flight in it.
#[derive(Debug)]
pub struct Surveyed {
    /// Of a log: what is in it, topic by topic, as it was written.
    pub survey: Option<Survey>,
    /// The flight, or why the log makes none.
    pub record: Result<Record, ReadError>,
}

/// As [`read_path`], and of a log what is in it, in one pass over the file (of one whose fields have to be known before it is known
/// which are channels, two). Kept is what the record needs, within the bound of the options; the survey keeps no values.
///
/// # Errors
/// As [`read_path`] for a table, and for a log that cannot be read at all. That a log makes no flight is no error here.
pub fn survey_path(path: &Path, options: &ReadOptions) -> Result<Surveyed, ReadError> {
    let (format, reader, source) = open(path)?;
    if !format.is_log() {
        return Ok(Surveyed { survey: None, record: Ok(table(format, reader, path, options)?) });
    }
    let Some(profile) = profile(format, options)? else {
        let survey = log::survey_as(format, reader, &source)?;
        let record = of_named_fields(&survey, path, options);
        return Ok(Surveyed { survey: Some(survey), record });
    };
    let (survey, log) = log::survey_and_read_as(format, reader, &source, &selection(&profile, options))?;
    let record = log.map_err(ReadError::from).and_then(|log| record(&log, &profile, options));
    Ok(Surveyed { survey: Some(survey), record })
}

fn open(path: &Path) -> Result<(Format, impl Read, String), ReadError> {
    let source_name = path.display().to_string();
    match File::open(path).and_then(Format::of) {
        Ok((format, reader)) => Ok((format, reader, source_name)),
        Err(error) if path.is_dir() => {
            let error = io::Error::new(error.kind(), "it is a folder; name a file in it");
            Err(ReadError::Io { source_name, error })
        }
        Err(error) => Err(ReadError::Io { source_name, error }),
    }
}

/// The profile of the options, else the built-in one; none for a log whose fields say themselves what they are.
fn profile(format: Format, options: &ReadOptions) -> Result<Option<Profile>, ProfileError> {
    match &options.profile {
        Some(profile) => Ok(Some(profile.clone())),
        None => built_in(format).transpose(),
    }
}

/// The profile that a format of logs has by itself.
fn built_in(format: Format) -> Option<Result<Profile, ProfileError>> {
    match format {
        Format::Ulog => Some(Profile::px4()),
        Format::DataFlash => Some(Profile::ardupilot()),
        _ => None,
    }
}

/// The record of a log whose fields say themselves what they are. What is in it has to be known before it is known what to keep.
fn of_named_fields(survey: &Survey, path: &Path, options: &ReadOptions) -> Result<Record, ReadError> {
    let profile = self_explained::profile(survey);
    let log = log::read_path(path, &selection(&profile, options))?;
    record(&log, &profile, options)
}

/// Reads a table.
fn table(format: Format, reader: impl Read, path: &Path, options: &ReadOptions) -> Result<Record, ReadError> {
    let source = path.display().to_string();
    match format {
        // The reader of text says best what to do with these.
        Format::Csv | Format::Gzip | Format::Zip | Format::Utf16 => {
            Ok(csv::read(reader, &source, &csv_options(options))?)
        }
        // Its columns are found from its end.
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
