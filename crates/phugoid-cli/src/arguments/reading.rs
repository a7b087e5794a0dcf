//! Options of all commands that read a recorded flight.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use phugoid_flight_data::deletion::Deletion;
use phugoid_flight_data::format::Format;
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::printable;
use phugoid_flight_data::reader::ReadOptions;
use phugoid_flight_data::record::{Record, time_of_day};
use phugoid_simulation::quantity::{QuantityError, Time};

use super::number::above_zero;
use crate::failure::Failure;

/// The help text of a flight that is read: the formats that this build knows by their content.
pub(super) fn flight() -> String {
    let excel = if cfg!(feature = "excel") { ", Excel" } else { "" };
    let gzip = if cfg!(feature = "gzip") { ", .csv.gz" } else { "" };
    let matlab = if cfg!(feature = "matlab") { ", MATLAB" } else { "" };
    let parquet = if cfg!(feature = "parquet") { ", Parquet, Arrow" } else { "" };
    let folder = if cfg!(feature = "parquet") { ", a folder of Flight Review" } else { "" };
    let mcap = if cfg!(feature = "mcap") { ", or MCAP" } else { "" };
    format!(
        "The flight: a table with units in its headers such as alpha_deg (CSV{gzip}{matlab}{excel}{parquet}), or a log of \
         PX4 (ULog), ArduPilot (DataFlash) or a ground station (.tlog){folder}{mcap}; - reads standard input"
    )
}

/// The help text of the table that is read of a file with several.
fn variable() -> String {
    let excel = match cfg!(feature = "excel") {
        true => ", or the sheet of a workbook of Excel",
        false => ". Workbooks of Excel and their sheets need a build with --features excel",
    };
    format!("The variable to read of a MATLAB file that holds several tables (`flight2`, `data.flight2`){excel}")
}

/// How flights are read.
#[derive(Debug, Args)]
pub(crate) struct Reading {
    /// The most memory that reading a flight may take; a flight that needs more is refused, and the message says how
    /// much
    #[arg(long, value_name = "SIZE", allow_hyphen_values = true, default_value_t = Memory::default())]
    pub(crate) max_memory: Memory,
    /// Names and units of the columns in the order of the file, for a table without a header line or in place of it:
    /// `time_s,alpha_deg,elevator_deg`. Parquet, Arrow and logs name their columns themselves
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) columns: Vec<String>,
    /// Time from one row to the next, such as 0.02s, for a table without times or with bad ones: the rows are counted
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = above_zero::<Time>)]
    pub(crate) sample_time: Option<Time>,
    /// The table to read of a file with several.
    #[arg(long, value_name = "NAME", help = variable())]
    #[cfg_attr(feature = "excel", arg(visible_alias = "sheet"))]
    #[cfg_attr(not(feature = "excel"), arg(alias = "sheet"))]
    pub(crate) variable: Option<String>,
}

impl Reading {
    /// The options of the reader that the command line gives, for this flight.
    ///
    /// # Errors
    /// [`Failure::Input`]: `--variable` for a file that holds one table alone.
    pub(crate) fn options(&self, flight: &Path) -> Result<ReadOptions, Failure> {
        check_variable("--variable", self.variable.as_deref(), flight)?;
        let mut options = ReadOptions::default().with_max_memory(self.max_memory);
        options.table.column_names.clone_from(&self.columns);
        options.table.sample_time_s = self.sample_time.map(|time| time.si());
        options.table.variable.clone_from(&self.variable);
        Ok(options)
    }
}

/// Refuses the name of a variable for a file of which the reader would not look for it.
pub(crate) fn check_variable(option: &str, variable: Option<&str>, flight: &Path) -> Result<(), Failure> {
    // What cannot be opened is told by whoever reads it; standard input is read once.
    let known = variable.filter(|_| flight.is_file()).zip(File::open(flight).ok());
    let Some((variable, file)) = known else { return Ok(()) };
    match Format::of(file).map(|(format, _)| format) {
        Err(_) | Ok(Format::Mat5 | Format::Hdf5 | Format::Zip) => Ok(()),
        Ok(format) => Err(Failure::input(format!(
            "{option} {variable}: `{}` is {}, which holds one table: a variable is for a MATLAB file, a sheet for a workbook \
             of Excel. Leave it out",
            printable::path(flight),
            format.in_words()
        ))),
    }
}

/// A moment of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Moment {
    /// A time of the record, s.
    Time(f64),
    /// A time of day that its clock shows, s from midnight.
    Clock(f64),
}

impl Moment {
    /// The time of the record, s; `option` is named in the message where the record has no such time.
    pub(crate) fn of(self, record: &Record, option: &str) -> Result<f64, Failure> {
        match self {
            Self::Time(seconds) => Ok(seconds),
            Self::Clock(seconds) => {
                record.at_time_of_day(seconds).map_err(|error| Failure::input(format!("{option}: {error}")))
            }
        }
    }
}

impl FromStr for Moment {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        time_of_day(text).map_or_else(|| text.parse::<Time>().map(|time| Self::Time(time.si())), |s| Ok(Self::Clock(s)))
    }
}

/// A further flight: a file, and which table in it. `flights.mat:second` is the variable `second`, unless a file is called so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Further {
    pub(crate) file: PathBuf,
    /// The variable of a MATLAB file or the sheet of a workbook; `None` where the command line names none behind the file.
    pub(crate) variable: Option<String>,
}

impl Further {
    /// Takes a word of the command line apart.
    pub(crate) fn of(word: &Path) -> Self {
        let whole = || Self { file: word.to_owned(), variable: None };
        if word.exists() {
            return whole();
        }
        let parts = word.to_str().and_then(|word| word.rsplit_once(':'));
        let parts = parts.filter(|(file, variable)| !variable.is_empty() && Path::new(file).is_file());
        parts.map_or_else(whole, |(file, variable)| Self { file: file.into(), variable: Some(variable.to_owned()) })
    }
}

/// Values of the flight that are known to be bad.
#[derive(Debug, Args)]
pub(crate) struct Deleting {
    /// Take values that are known to be bad for missing, and list them with the reason in every result. Of one channel or
    /// several at one time, `alpha,beta@12.34s: bird strike`, or in a span, `alpha@12.3s..12.8s: ice`; without a channel,
    /// `12.5s..12.8s: dropout`, of all. Of the flight named first; may be repeated
    #[arg(long, value_name = "[CHANNEL@]TIME[..TIME]: REASON", allow_hyphen_values = true)]
    pub(crate) delete: Vec<Deletion>,
    /// The same from a TOML file: `[[delete]]` tables with `channel`, `at` (or `from` and `to`), `reason`, and `flight` (the
    /// name of its file) for another flight than the first
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) deletions: Option<PathBuf>,
}
