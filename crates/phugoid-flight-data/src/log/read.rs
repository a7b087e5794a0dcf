//! Reads a log of any format, by content.

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

#[cfg(feature = "mcap")]
use super::mcap;
use super::survey::Survey;
use super::{Log, LogError, Selection, dataflash, ulog};
use crate::format::{Format, SNIFFED};

/// Reads a log from the disk; otherwise as [`read()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn read_path(path: &Path, selection: &Selection) -> Result<Log, LogError> {
    let (file, source) = open(path)?;
    read(file, &source, selection)
}

/// Surveys a log on the disk; otherwise as [`survey()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn survey_path(path: &Path) -> Result<Survey, LogError> {
    let (file, source) = open(path)?;
    survey(file, &source)
}

/// Reads a log in whatever format it is. `source` is its name in messages and reports.
///
/// # Errors
/// [`LogError`] if it is no log of a known format, or as the reader of its format says.
pub fn read(reader: impl Read, source: &str, selection: &Selection) -> Result<Log, LogError> {
    let (format, reader) = sniff(reader, source)?;
    match format {
        Format::Ulog => ulog::read(reader, source, selection),
        Format::DataFlash => dataflash::read(reader, source, selection),
        #[cfg(feature = "mcap")]
        Format::Mcap => mcap::read(reader, source, selection),
        other => Err(no_log(source, other)),
    }
}

/// What is in a log of whatever format, in memory that does not grow with it.
///
/// # Errors
/// As [`read()`].
pub fn survey(reader: impl Read, source: &str) -> Result<Survey, LogError> {
    let (format, reader) = sniff(reader, source)?;
    match format {
        Format::Ulog => ulog::survey(reader, source),
        Format::DataFlash => dataflash::survey(reader, source),
        #[cfg(feature = "mcap")]
        Format::Mcap => mcap::survey(reader, source),
        other => Err(no_log(source, other)),
    }
}

fn open(path: &Path) -> Result<(File, String), LogError> {
    let source_name = path.display().to_string();
    match File::open(path) {
        Ok(file) => Ok((file, source_name)),
        Err(error) => Err(LogError::Io { source_name, error }),
    }
}

fn sniff<R: Read>(mut reader: R, source: &str) -> Result<(Format, impl Read), LogError> {
    let mut start = Vec::with_capacity(SNIFFED);
    let read = reader.by_ref().take(SNIFFED as u64).read_to_end(&mut start);
    read.map_err(|error| LogError::Io { source_name: source.to_owned(), error })?;
    Ok((Format::sniff(&start), Cursor::new(start).chain(reader)))
}

fn no_log(source: &str, format: Format) -> LogError {
    let (words, feature) = (format.in_words(), format.feature());
    let problem = match feature.filter(|_| format == Format::Mcap) {
        Some(feature) => {
            format!("it is {words}, which this build does not read; {}", crate::format::build_with(feature))
        }
        None => format!("it is {words}; logs that are read are PX4 ULog, ArduPilot DataFlash (.BIN) and MCAP"),
    };
    LogError::NotThisFormat { source_name: source.to_owned(), format: "log of an autopilot", problem }
}
