//! Reads a file of any format, recognised by its content, into a flight record.
//!
//! Tables (CSV, and under features Parquet, Arrow and MATLAB) become a record by their headers. Logs of autopilots
//! become one by a [`Profile`], which says which fields are which channels (for MCAP the names of the fields say it),
//! and [`crate::align::Aligner`] puts the channels on one time base. Mappings of the caller come before both: their
//! `header` is a column of the table, or `topic.field` or `topic#instance.field` of the log.
//!
//! ```
//! use phugoid_flight_data::reader::{ReadOptions, read_path};
//! use phugoid_flight_data::table::ColumnMapping;
//! // The log knows the command of the elevator servo; that command 1 is -20 deg only the user knows.
//! let elevator = ColumnMapping::new("elevator", "elevator_command").with_scale(-20.0).with_unit("deg");
//! let flight = read_path("examples/flight.ulg".as_ref(), &ReadOptions::with_columns(vec![elevator]))?;
//! let largest = flight.require("elevator")?.values.iter().copied().fold(0.0, f64::max);
//! assert!((largest.to_degrees() - 2.0).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! To add a format, add it to [`Format`]. A log also needs a reader in [`crate::log`] and, unless the names of its
//! fields say which channels they are, a profile in `built_in`; a table needs an arm in `table`.

mod by_field_names;
mod error;
mod from_log;
mod mapped;
mod options;
#[cfg(feature = "gzip")]
mod packed;
mod signals;
mod surfaces;
mod vehicle;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

pub use error::{FieldProblem, ReadError};
pub use from_log::{record, selection};
pub use options::ReadOptions;

use crate::csv::{self, CsvOptions};
use crate::format::Format;
use crate::log::survey::Survey;
use crate::log::{self, Input};
use crate::memory::Account;
use crate::printable;
use crate::profile::{Profile, ProfileError};
use crate::record::Record;
use crate::table::TableOptions;

impl Record {
    /// Opens a flight of any format that this build reads, with the default options.
    ///
    /// The format is known by the content of the file, not by its name: CSV, PX4 ULog, ArduPilot DataFlash and
    /// telemetry logs (`.tlog`), and under features MATLAB 5, MCAP, Parquet and Arrow. Values are in SI units and radians, NaN where one is missing.
    /// For mappings of columns, a profile of one's own or other bounds use [`read_path`].
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

/// Reads a flight of any format from the disk into a record in SI units; `-` is the standard input, for every format but
/// Parquet and MCAP. The times of a table that begin more than a second from zero count from its first row; those of a log are
/// the vehicle's own.
///
/// # Errors
/// [`ReadError`]: the file cannot be read or is damaged as a whole; this build does not read its format
/// ([`ReadError::NotRead`]); a table has no time or contradicts itself ([`ReadError::Table`]); a log has nothing that
/// the profile or the mappings name ([`ReadError::NothingUsable`]).
pub fn read_path(path: &Path, options: &ReadOptions) -> Result<Record, ReadError> {
    let account = Account::new(options.table.max_memory);
    let (format, mut reader, source) = open(path, &account)?;
    check_names(format, &source, options)?;
    if !format.is_log() {
        return table(format, &mut reader, path, options, &account);
    }
    match profile(format, options)? {
        Some(profile) => {
            let log = log::read_as(Input { format, reader, path }, &source, &selection(&profile, options), &account)?;
            from_log::record_counted(&log, &profile, options, &account)
        }
        None => {
            record_by_field_names(&log::survey_as(Input { format, reader, path }, &source, &account)?, path, options)
        }
    }
}

/// What is in a file, and the flight record that it makes.
#[derive(Debug)]
pub struct Surveyed {
    /// The topics of a log with their rates, ranges and gaps; `None` for a table.
    pub survey: Option<Survey>,
    /// The flight record, or why none can be made of the log.
    pub record: Result<Record, ReadError>,
}

/// Reads a flight as [`read_path`] does and surveys a log at the same time, in one pass over the file (in two for a log
/// such as MCAP, whose fields have to be known before the channels are). Only the values that the record needs are
/// kept, within the bound of the options; the survey keeps no values.
///
/// ```
/// use phugoid_flight_data::reader::{ReadOptions, survey_path};
/// let surveyed = survey_path("examples/flight.ulg".as_ref(), &ReadOptions::default())?;
/// let survey = surveyed.survey.expect("it is a log");
/// let attitude = survey.topic("vehicle_attitude", 0).expect("it is in the log");
/// assert_eq!((attitude.samples, attitude.gaps), (81, 0));
/// assert!(surveyed.record?.channel("theta").is_some());
/// # Ok::<(), phugoid_flight_data::reader::ReadError>(())
/// ```
///
/// # Errors
/// As [`read_path`] for a table and for a log that cannot be read at all. If no record can be made of a log, that error
/// is in [`Surveyed::record`].
pub fn survey_path(path: &Path, options: &ReadOptions) -> Result<Surveyed, ReadError> {
    let account = Account::new(options.table.max_memory);
    let (format, mut reader, source) = open(path, &account)?;
    check_names(format, &source, options)?;
    if !format.is_log() {
        return Ok(Surveyed { survey: None, record: Ok(table(format, &mut reader, path, options, &account)?) });
    }
    let Some(profile) = profile(format, options)? else {
        let survey = log::survey_as(Input { format, reader, path }, &source, &account)?;
        let record = record_by_field_names(&survey, path, options);
        return Ok(Surveyed { survey: Some(survey), record });
    };
    let selection = selection(&profile, options);
    let (survey, log) = log::survey_and_read_as(Input { format, reader, path }, &source, &selection, &account)?;
    let made = |log: log::Log| from_log::record_counted(&log, &profile, options, &account);
    let record = log.map_err(ReadError::from).and_then(made);
    Ok(Surveyed { survey: Some(survey), record })
}

/// The name that stands for the standard input in place of a file.
const STANDARD_INPUT: &str = "-";

fn open(path: &Path, account: &Account) -> Result<(Format, Box<dyn Read>, String), ReadError> {
    let source_name = printable::path(path);
    if log::is_flight_review(path) {
        let nothing: Box<dyn Read> = Box::new(io::empty());
        return Ok((Format::FlightReview, nothing, source_name));
    }
    let opened: io::Result<Box<dyn Read>> = match path.as_os_str() == STANDARD_INPUT {
        true => Ok(Box::new(io::stdin())),
        false => File::open(path).map(|file| Box::new(account.follow(file)) as Box<dyn Read>),
    };
    match opened.and_then(Format::of) {
        Ok((format @ (Format::Parquet | Format::Mcap), ..)) if path.as_os_str() == STANDARD_INPUT => {
            let error = io::Error::new(io::ErrorKind::Unsupported, "this format is read from a file, not from a pipe");
            let source_name = format!("{source_name} ({})", format.in_words());
            Err(ReadError::Io { source_name, error })
        }
        Ok((format, reader)) => Ok((format, Box::new(reader), source_name)),
        Err(error) if path.is_dir() => {
            let error = io::Error::new(error.kind(), "it is a folder; name a file in it");
            Err(ReadError::Io { source_name, error })
        }
        Err(error) => Err(ReadError::Io { source_name, error }),
    }
}

/// Names of columns are for tables that may lack them. They are not silently left aside for a file that has its own.
fn check_names(format: Format, source: &str, options: &ReadOptions) -> Result<(), ReadError> {
    let has_its_own = format.is_log() || matches!(format, Format::Parquet | Format::Arrow);
    if has_its_own && !options.table.column_names.is_empty() {
        return Err(ReadError::NamedInTheFile { source_name: source.to_owned(), format });
    }
    Ok(())
}

/// The profile of the options, else the built-in one; `None` for a log whose fields are channels by their names.
fn profile(format: Format, options: &ReadOptions) -> Result<Option<Profile>, ProfileError> {
    match &options.profile {
        Some(profile) => Ok(Some(profile.clone())),
        None => built_in(format).transpose(),
    }
}

/// The built-in profile of a format of logs; `None` if it has none.
fn built_in(format: Format) -> Option<Result<Profile, ProfileError>> {
    match format {
        Format::Ulog | Format::FlightReview => Some(Profile::px4()),
        Format::DataFlash => Some(Profile::ardupilot()),
        Format::Tlog => Some(Profile::telemetry_log()),
        _ => None,
    }
}

/// The record of a log whose fields are channels by their names. The survey is needed first: it says which fields to
/// keep.
fn record_by_field_names(survey: &Survey, path: &Path, options: &ReadOptions) -> Result<Record, ReadError> {
    let profile = by_field_names::profile(survey);
    let account = Account::new(options.table.max_memory);
    let (format, reader, source) = open(path, &account)?;
    let log = log::read_as(Input { format, reader, path }, &source, &selection(&profile, options), &account)?;
    from_log::record_counted(&log, &profile, options, &account)
}

/// Reads a file that is no log.
fn table(
    format: Format,
    reader: &mut dyn Read,
    path: &Path,
    options: &ReadOptions,
    account: &Account,
) -> Result<Record, ReadError> {
    let source = printable::path(path);
    let options =
        &ReadOptions { table: TableOptions { count_from_first: true, ..options.table.clone() }, ..options.clone() };
    match format {
        // The reader of CSV has the best messages for files that are no text.
        Format::Csv | Format::Utf16 => {
            Ok(csv::read_counted(reader, &source, &CsvOptions::of(options.table.clone(), options.delimiter), account)?)
        }
        // Parquet has its table of contents at the end, so that it needs the file and not a stream.
        #[cfg(feature = "parquet")]
        Format::Parquet => Ok(crate::parquet::read_path(path, &options.table)?),
        #[cfg(feature = "parquet")]
        Format::Arrow => Ok(crate::columnar::ipc::read(reader, &source, &options.table, account)?),
        #[cfg(feature = "gzip")]
        Format::Gzip => packed::read(reader, path, options, account),
        #[cfg(feature = "excel")]
        Format::Zip => Ok(crate::excel::read_counted(reader, &source, &options.table, account)?),
        #[cfg(feature = "matlab")]
        Format::Mat5 => Ok(crate::matlab::read_counted(reader, &source, &options.table, account)?),
        other => Err(ReadError::NotRead { source_name: source, format: other }),
    }
}
