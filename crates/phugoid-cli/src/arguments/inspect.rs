//! `phugoid inspect`.

use std::path::PathBuf;

use clap::Args;

use super::delivery::Delivery;
use super::help::examples_and_exit_codes;

/// Says what a flight holds: channels, gaps, doubts, manoeuvres, and which derivatives they could tell
///
/// Nothing is estimated and no model is needed. Manoeuvres are numbered for `phugoid estimate --segment`. Where nothing can be estimated
/// it says why; that is a result, and the exit code stays 0.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid inspect flight.csv
  phugoid inspect flight.csv --model jet.toml      what the flight lacks for this model, read with its column names
  phugoid inspect yesterday.ulg                    topics and rates first, then the flight that they make
  phugoid inspect flight.csv --json --out flight.json"
))]
pub(crate) struct Inspect {
    /// The flight: a table (CSV with units in its headers), or a log of PX4 (ULog) or ArduPilot (DataFlash)
    #[arg(value_name = "FLIGHT")]
    pub(crate) flight: PathBuf,
    /// The aircraft: a model file, or the name of a built-in one; without it, all built-in ones are gone through
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}
