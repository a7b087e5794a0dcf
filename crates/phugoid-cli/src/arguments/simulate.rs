//! `phugoid simulate`.

use std::path::PathBuf;

use clap::Args;

use super::help::examples_and_exit_codes;
use super::number::whole;

/// Simulates a flight and writes the measured signals and the true ones
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid simulate f16-damage                      a built-in scenario (see --list)
  phugoid simulate my-flight.toml --out flights    writes flights/measured.csv and flights/truth.csv
  phugoid simulate f16-calm --show > mine.toml     a scenario to start from"
))]
pub(crate) struct Simulate {
    /// Scenario file, or the name of a built-in one
    #[arg(value_name = "SCENARIO", required_unless_present = "list")]
    pub(crate) scenario: Option<String>,
    /// List the built-in scenarios
    #[arg(long)]
    pub(crate) list: bool,
    /// Print the text of the scenario instead of flying it
    #[arg(long, conflicts_with = "list")]
    pub(crate) show: bool,
    /// Seed of all random numbers, instead of the one in the scenario
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = whole::<u64>)]
    pub(crate) seed: Option<u64>,
    /// Folder for measured.csv and truth.csv
    #[arg(long, value_name = "DIR", default_value = "phugoid-flight")]
    pub(crate) out: PathBuf,
    /// Also write figures of the flight to this folder, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}
