//! `phugoid monitor`.

use std::path::PathBuf;

use clap::Args;

use super::help::examples_and_exit_codes;
use super::reading::{Deleting, Reading, flight};

/// Checks in a recorded flight whether the coefficients leave their expected ranges: an alarm with a stated false-alarm
/// rate, the onset time of the failure, and the coefficient that changed
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid simulate f16-failure --out flight
  phugoid monitor flight/measured.csv --model f16-health-model
  phugoid monitor flight.csv --model jet.toml --expected healthy.toml --false-alarms-per-hour 0.001
  phugoid monitor flight.csv --model jet.toml --json --out health"
))]
pub(crate) struct Monitor {
    /// The flight.
    #[arg(value_name = "FLIGHT", help = flight())]
    pub(crate) flight: PathBuf,
    /// The aircraft: a model file, or the name of a built-in one. Its table `expected` gives the healthy coefficients;
    /// without this table, healthy is within a tenth of the start values
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: String,
    /// A file with the table `expected`, used instead of the one in the model file
    #[arg(long, value_name = "EXPECTED.toml")]
    pub(crate) expected: Option<PathBuf>,
    /// Accepted false alarms per flight hour [default: 0.01]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = rate)]
    pub(crate) false_alarms_per_hour: Option<f64>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) deleting: Deleting,
    /// Folder for health.json, which contains all histories, and for the report of the estimation
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Include the history of every sample in the JSON document
    #[arg(long, requires = "json")]
    pub(crate) history: bool,
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (1e-9..60.0).contains(&value) => Ok(value),
        Ok(_) => Err("a rate per flight hour lies between 1e-9 and 60, as in 0.01: one in a hundred hours".to_owned()),
        Err(_) => Err("write false alarms per flight hour, as in 0.01: one in a hundred hours".to_owned()),
    }
}
