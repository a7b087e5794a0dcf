//! `phugoid compare`.

use std::path::PathBuf;

use clap::Args;
use phugoid_simulation::quantity::Time;

use super::delivery::PictureFormat;
use super::help::examples_and_exit_codes;
use super::keeping::Keeping;
use super::number::above_zero;

/// Runs several estimators on the same simulated flights and compares their errors, bounds and speed of convergence
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid compare                                    all scenarios; writes phugoid-comparison/
  phugoid compare --quick                            four flights each, for a first look
  phugoid compare calm everything --seeds 100        two scenarios, smaller statistical errors
  phugoid compare silent --methods smpe,ekf          what declared errors do to the bounds
  phugoid compare my.toml --model jet.toml --methods smpe,ekf
  phugoid compare --list                             names of the scenarios and methods

A method that fails on a flight is reported as a result: the exit code stays 0."
))]
pub(crate) struct Compare {
    /// Scenarios: names of built-in entries of the arena, "silent" for all whose errors leave no trace in residuals, files in the same
    /// format, or scenario files of your own together with --model [default: the whole arena]
    #[arg(value_name = "ENTRY|FILE.toml", conflicts_with = "list")]
    pub(crate) scenarios: Vec<String>,
    /// Model that the methods use in scenarios that name no model: a model file, or the name of a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Methods, separated by commas; the others are compared with the first one. --list names them [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) methods: Vec<String>,
    /// Flights per scenario, each with its own noise, gusts and pilot input [default: 20]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) seeds: Option<u32>,
    /// Fly four flights per scenario, for a first look
    #[arg(long, conflicts_with = "seeds")]
    pub(crate) quick: bool,
    /// Period of the short-period mode, in which times are counted in scenarios of your own
    #[arg(long, value_name = "TIME", default_value = "4.17s", allow_hyphen_values = true, value_parser = above_zero::<Time>)]
    pub(crate) cycle: Time,
    /// List the scenarios and methods, and fly nothing
    #[arg(long)]
    pub(crate) list: bool,
    /// Folder for report.html, comparison.json and comparison.csv
    #[arg(long, value_name = "DIR", default_value = "phugoid-comparison")]
    pub(crate) out: PathBuf,
    /// Also write each figure to a file in the folder of --out
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) figures: Option<PictureFormat>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) keeping: Keeping,
}
