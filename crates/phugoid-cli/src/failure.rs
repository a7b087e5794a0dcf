//! How a command fails: one screen of text on standard error and an exit code that scripts can tell apart.

use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue};
use phugoid_flight_data::printable;
use phugoid_identification::batch::BatchError;
use phugoid_identification::error::EstimateError;
use phugoid_identification::estimation::{Estimation, EstimationStatus, ReasonCode};

use crate::commands;

/// Exit code of `phugoid monitor` where the aircraft has diverged from what is expected: a result, not a failure of the
/// command.
pub(crate) const DIVERGED: u8 = 10;

/// Exit code of an estimation whose result is refused: it is printed and written, but nobody may use its numbers.
pub(crate) const REFUSED: u8 = 1;

/// Exit code of a command line that is wrong.
const USAGE: u8 = 2;

/// Exit code where the flight holds nothing that could be estimated.
const NO_DATA: u8 = 5;

/// The exit code of an estimation whose result is printed and written: a script must not take a refused one for a result, nor what was
/// known beforehand where nothing has moved.
pub(crate) fn of_result(estimation: &Estimation) -> ExitCode {
    let is_unmoved = estimation.reasons.iter().any(|reason| reason.code == ReasonCode::NoExcitation);
    match estimation.status {
        EstimationStatus::Refused => ExitCode::from(REFUSED),
        _ if is_unmoved => ExitCode::from(NO_DATA),
        _ => ExitCode::SUCCESS,
    }
}

/// Commands that not every build has, with the feature that brings them.
const OF_FEATURES: [(&str, &str, bool); 2] =
    [("fleet", "fleet", cfg!(feature = "fleet")), ("campaign", "fleet", cfg!(feature = "fleet"))];

/// Prints why a command line cannot be understood, or the help that it asks for. A command that this build lacks is named with
/// the way to build the program with it.
pub(crate) fn of_command_line(error: &clap::Error) -> ExitCode {
    let unknown =
        [ContextKind::InvalidSubcommand, ContextKind::InvalidArg].into_iter().find_map(|kind| error.get(kind));
    let lacking = OF_FEATURES.iter().find(|(command, _, is_there)| {
        !is_there && matches!(unknown, Some(ContextValue::String(word)) if word == command)
    });
    if let Some((command, feature, _)) = lacking {
        // Nobody is left to tell when standard error is closed.
        let _ = writeln!(
            io::stderr(),
            "error: this build has no `phugoid {command}`; build it with \
             cargo install --path crates/phugoid-cli --features {feature}"
        );
        return ExitCode::from(USAGE);
    }
    let _ = error.print();
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(USAGE))
}

impl From<phugoid::Error> for Failure {
    /// A task that has no answer, or else an input that is wrong.
    fn from(error: phugoid::Error) -> Self {
        match error {
            phugoid::Error::Flight(error) => commands::simulate::failure(error),
            phugoid::Error::Study(error) => commands::study::failure(error),
            phugoid::Error::Estimate(error) => error.into(),
            phugoid::Error::Trim(_) | phugoid::Error::Aircraft(_) | phugoid::Error::Modes(_) => Self::impossible(error),
            other => Self::input(other),
        }
    }
}

impl From<EstimateError> for Failure {
    /// What the flight cannot give and what a search did not find are told apart from an input that is wrong.
    fn from(error: EstimateError) -> Self {
        match &error {
            EstimateError::TooShort { .. }
            | EstimateError::NoExcitation { .. }
            | EstimateError::EmptyChannel(_)
            | EstimateError::EmptyInput(_)
            | EstimateError::Noise(_)
            | EstimateError::Batch(BatchError::Singular { .. }) => Self::NoData(error.to_string()),
            EstimateError::Batch(
                BatchError::NotConverged { .. } | BatchError::Diverged { .. } | BatchError::Unstable { .. },
            ) => Self::NotConverged(error.to_string()),
            _ => Self::Input(error.to_string()),
        }
    }
}

/// Why a command ends without a result. Wrong command lines end with code 2 before anything runs.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The task is clear and has no answer: no trim, nothing to estimate. Exit code 1.
    Impossible(String),
    /// An input file cannot be read or is wrong. Exit code 3.
    Input(String),
    /// A result cannot be written. Exit code 4.
    Output(String),
    /// The flight can be read and holds nothing that could be estimated: too few samples, nothing that moves. Exit code 5.
    NoData(String),
    /// The search of a batch method found no minimum. Exit code 6.
    NotConverged(String),
    /// The reader of standard output went away, as `head` does: nothing went wrong. Exit code 0.
    ReaderLeft,
}

impl Failure {
    pub(crate) fn impossible(message: impl Display) -> Self {
        Self::Impossible(message.to_string())
    }

    pub(crate) fn input(message: impl Display) -> Self {
        Self::Input(message.to_string())
    }

    /// Writing to a file or folder of `--out` failed.
    pub(crate) fn writing(path: &Path, error: impl Display) -> Self {
        Self::writing_of("--out", path, error)
    }

    /// An option asks for Parquet, which this build does not write.
    pub(crate) fn no_parquet(option: &str, path: &Path, instead: &str) -> Self {
        Self::Input(format!(
            "{option} {}: this build does not write Parquet; {instead}, or build it with \
             cargo install --path crates/phugoid-cli --features parquet",
            path.display()
        ))
    }

    /// A build without the feature `excel` was asked for a workbook.
    pub(crate) fn no_excel(option: &str, path: &Path, instead: &str) -> Self {
        Self::Input(format!(
            "{option} {}: this build does not write workbooks of Excel; {instead}, or build it with \
             cargo install --path crates/phugoid-cli --features excel",
            path.display()
        ))
    }

    /// Writing to the file or folder that an option names failed.
    pub(crate) fn writing_of(option: &str, path: &Path, error: impl Display) -> Self {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        let there =
            folder.map_or_else(String::new, |f| format!("There is no folder `{}`: make it, or choose", f.display()));
        let choose = if there.is_empty() { "Choose".to_owned() } else { there };
        Self::Output(format!("cannot write `{}`: {error}\n{choose} another place with {option}.", path.display()))
    }

    /// Writing to standard output failed.
    pub(crate) fn standard_output(error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::ReaderLeft,
            _ => Self::Output(format!("cannot write to standard output: {error}")),
        }
    }

    /// Prints the message and gives the exit code.
    pub(crate) fn report(&self) -> ExitCode {
        let (message, code) = match self {
            Self::Impossible(message) => (message, 1),
            Self::Input(message) => (message, 3),
            Self::Output(message) => (message, 4),
            Self::NoData(message) => (message, NO_DATA),
            Self::NotConverged(message) => (message, 6),
            Self::ReaderLeft => return ExitCode::SUCCESS,
        };
        // Nobody is left to tell when standard error is closed.
        let _ = writeln!(io::stderr(), "error: {}", printable::lines(&printable::brief(message)));
        ExitCode::from(code)
    }
}
