//! Reads a log of any format, recognised by its content.

use std::fs::File;
use std::io::Read;
use std::path::Path;

#[cfg(feature = "mcap")]
use super::mcap;
use super::sink::{Head, Sink, Stop, into_log};
use super::survey::{Survey, into_survey};
use super::survey_and_tables::SurveyAndTables;
use super::{Log, LogError, Selection, dataflash, tlog, ulog};
use crate::format::Format;
use crate::memory::{Account, Followed, Memory};
use crate::printable;

/// Reads a log from the disk; otherwise as [`read()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn read_path(path: &Path, selection: &Selection) -> Result<Log, LogError> {
    let account = Account::new(selection.max_memory);
    let (file, source) = open(path, &account)?;
    let (format, reader) = sniff(file, &source)?;
    read_as(format, reader, &source, selection, &account)
}

/// Surveys a log on the disk; otherwise as [`survey()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn survey_path(path: &Path) -> Result<Survey, LogError> {
    let account = Account::new(Memory::default());
    let (file, source) = open(path, &account)?;
    let (format, reader) = sniff(file, &source)?;
    survey_as(format, reader, &source, &account)
}

/// Reads the selected part of a log of any format that this build reads. `source` is its name in messages and reports.
///
/// # Errors
/// [`LogError`]: it cannot be read, is no log of a format that is read, holds no sample, or needs more memory than the
/// selection allows. Damage within the log is no error; `quality` names what was skipped.
pub fn read(reader: impl Read, source: &str, selection: &Selection) -> Result<Log, LogError> {
    let (format, reader) = sniff(reader, source)?;
    read_as(format, reader, source, selection, &Account::new(selection.max_memory))
}

/// Surveys a log of any format that this build reads, in memory that does not grow with the log.
///
/// # Errors
/// As [`read()`].
pub fn survey(reader: impl Read, source: &str) -> Result<Survey, LogError> {
    let (format, reader) = sniff(reader, source)?;
    survey_as(format, reader, source, &Account::new(Memory::default()))
}

/// As [`read()`], for a format that is known already.
pub(crate) fn read_as(
    format: Format,
    reader: impl Read,
    source: &str,
    selection: &Selection,
    account: &Account,
) -> Result<Log, LogError> {
    into_log(source, selection, account, |sink| run(format, reader, source, sink, account))
}

/// As [`survey()`], for a format that is known already.
pub(crate) fn survey_as(
    format: Format,
    reader: impl Read,
    source: &str,
    account: &Account,
) -> Result<Survey, LogError> {
    into_survey(source, account, |sink| run(format, reader, source, sink, account))
}

/// Surveys the whole log and reads the selected part of it in one pass. If that part exceeds the bound of the
/// selection, only its own result is an error.
pub(crate) fn survey_and_read_as(
    format: Format,
    reader: impl Read,
    source: &str,
    selection: &Selection,
    account: &Account,
) -> Result<(Survey, Result<Log, LogError>), LogError> {
    let mut sink = SurveyAndTables::new(selection, account);
    match run(format, reader, source, &mut sink, account) {
        Ok(head) => Ok(sink.finish(head, source, account)),
        Err(stop) => Err(stop.into_error(source, account)),
    }
}

/// Reads a log of this format into a sink.
fn run<S: Sink>(
    format: Format,
    reader: impl Read,
    source: &str,
    sink: &mut S,
    account: &Account,
) -> Result<Head, Stop> {
    match format {
        Format::Ulog => ulog::run(reader, source, sink, account),
        Format::DataFlash => dataflash::run(reader, source, sink),
        Format::Tlog => tlog::run(reader, source, sink),
        #[cfg(feature = "mcap")]
        Format::Mcap => mcap::run(reader, source, sink, account),
        other => Err(no_log(source, other).into()),
    }
}

fn open(path: &Path, account: &Account) -> Result<(Followed, String), LogError> {
    let source_name = printable::path(path);
    match File::open(path) {
        Ok(file) => Ok((account.follow(file), source_name)),
        Err(error) => Err(LogError::Io { source_name, error }),
    }
}

fn sniff<R: Read>(reader: R, source: &str) -> Result<(Format, impl Read), LogError> {
    Format::of(reader).map_err(|error| LogError::Io { source_name: source.to_owned(), error })
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
