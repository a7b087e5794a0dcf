//! Reads a log of any format, recognised by its content.

use std::fs::File;
use std::io::Read;
use std::path::Path;

#[cfg(feature = "parquet")]
use super::flight_review;
#[cfg(feature = "mcap")]
use super::mcap;
use super::sink::{Head, Sink, Stop, into_log};
use super::survey::{Survey, into_survey};
use super::survey_and_tables::SurveyAndTables;
use super::{Log, LogError, Selection, dataflash, tlog, ulog};
use crate::format::Format;
use crate::memory::{Account, Memory};
use crate::printable;

/// Reads a log from the disk; otherwise as [`read()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn read_path(path: &Path, selection: &Selection) -> Result<Log, LogError> {
    let account = Account::new(selection.max_memory);
    let (format, reader, source) = open(path, &account)?;
    read_as(Input { format, reader, path }, &source, selection, &account)
}

/// Surveys a log on the disk; otherwise as [`survey()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn survey_path(path: &Path) -> Result<Survey, LogError> {
    let account = Account::new(Memory::default());
    let (format, reader, source) = open(path, &account)?;
    survey_as(Input { format, reader, path }, &source, &account)
}

/// Reads the selected part of a log of any format that this build reads. `source` is its name in messages and reports.
///
/// # Errors
/// [`LogError`]: it cannot be read, is no log of a format that is read, holds no sample, or needs more memory than the
/// selection allows. Damage within the log is no error; `quality` names what was skipped.
pub fn read(reader: impl Read, source: &str, selection: &Selection) -> Result<Log, LogError> {
    let (format, reader) = sniff(reader, source)?;
    let path = Path::new(source);
    read_as(Input { format, reader, path }, source, selection, &Account::new(selection.max_memory))
}

/// Surveys a log of any format that this build reads, in memory that does not grow with the log.
///
/// # Errors
/// As [`read()`].
pub fn survey(reader: impl Read, source: &str) -> Result<Survey, LogError> {
    let (format, reader) = sniff(reader, source)?;
    survey_as(Input { format, reader, path: Path::new(source) }, source, &Account::new(Memory::default()))
}

/// The content of a log whose format is known: a stream, or for a format that is a folder its path.
pub(crate) struct Input<'p, R> {
    pub(crate) format: Format,
    pub(crate) reader: R,
    #[cfg_attr(
        not(feature = "parquet"),
        expect(dead_code, reason = "the one format that is a folder needs the feature")
    )]
    pub(crate) path: &'p Path,
}

/// As [`read()`], for a format that is known already.
pub(crate) fn read_as(
    input: Input<'_, impl Read>,
    source: &str,
    selection: &Selection,
    account: &Account,
) -> Result<Log, LogError> {
    into_log(source, selection, account, |sink| run(input, source, sink, account))
}

/// As [`survey()`], for a format that is known already.
pub(crate) fn survey_as(input: Input<'_, impl Read>, source: &str, account: &Account) -> Result<Survey, LogError> {
    into_survey(source, account, |sink| run(input, source, sink, account))
}

/// Surveys the whole log and reads the selected part of it in one pass. If that part exceeds the bound of the
/// selection, only its own result is an error.
pub(crate) fn survey_and_read_as(
    input: Input<'_, impl Read>,
    source: &str,
    selection: &Selection,
    account: &Account,
) -> Result<(Survey, Result<Log, LogError>), LogError> {
    let mut sink = SurveyAndTables::new(selection, account);
    match run(input, source, &mut sink, account) {
        Ok(head) => Ok(sink.finish(head, source, account)),
        Err(stop) => Err(stop.into_error(source, account)),
    }
}

/// Reads a log of this format into a sink.
fn run<S: Sink>(input: Input<'_, impl Read>, source: &str, sink: &mut S, account: &Account) -> Result<Head, Stop> {
    let Input { format, reader, .. } = input;
    match format {
        #[cfg(feature = "parquet")]
        Format::FlightReview => flight_review::run(input.path, source, sink, account),
        Format::Ulog => ulog::run(reader, source, sink, account),
        Format::DataFlash => dataflash::run(reader, source, sink),
        Format::Tlog => tlog::run(reader, source, sink),
        #[cfg(feature = "mcap")]
        Format::Mcap => mcap::run(reader, source, sink, account),
        other => Err(no_log(source, other).into()),
    }
}

fn open(path: &Path, account: &Account) -> Result<(Format, Box<dyn Read>, String), LogError> {
    let source_name = printable::path(path);
    if is_flight_review(path) {
        return Ok((Format::FlightReview, Box::new(std::io::empty()), source_name));
    }
    match File::open(path) {
        Ok(file) => {
            let (format, reader) = sniff(account.follow(file), &source_name)?;
            Ok((format, Box::new(reader), source_name))
        }
        Err(error) => Err(LogError::Io { source_name, error }),
    }
}

/// Whether this is a folder as Flight Review 2 writes it for a log: by the file `metadata.json` in it, whatever that says.
pub fn is_flight_review(path: &Path) -> bool {
    path.join("metadata.json").is_file()
}

fn sniff<R: Read>(reader: R, source: &str) -> Result<(Format, impl Read + use<R>), LogError> {
    Format::of(reader).map_err(|error| LogError::Io { source_name: source.to_owned(), error })
}

fn no_log(source: &str, format: Format) -> LogError {
    let (words, feature) = (format.in_words(), format.feature());
    let problem = match feature.filter(|_| matches!(format, Format::Mcap | Format::FlightReview)) {
        Some(feature) => {
            format!("it is {words}, which this build does not read; {}", crate::format::build_with(feature))
        }
        None => format!("it is {words}; logs that are read are PX4 ULog, ArduPilot DataFlash (.BIN) and MCAP"),
    };
    LogError::NotThisFormat { source_name: source.to_owned(), format: "log of an autopilot", problem }
}
