//! `phugoid compare`.

use std::path::PathBuf;

use clap::Args;
use phugoid_simulation::quantity::Time;

use super::delivery::PictureFormat;
use super::help::examples_and_exit_codes;

/// Runs every method on the same samples of the same flights, and says where each of them wins and loses
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid compare                                    every scenario of the arena; writes phugoid-comparison/
  phugoid compare --quick                            four flights each, for a first look
  phugoid compare calm everything --seeds 100        two scenarios, told more exactly
  phugoid compare my.toml --model jet.toml --methods smpe,ekf
  phugoid compare --list                             what there is to fly and to compare

A method that fails is a result, and told: the exit code stays 0."
))]
pub(crate) struct Compare {
    /// Scenarios: entries of the arena, files like them, or scenarios of your own with --model [default: the whole arena]
    #[arg(value_name = "ENTRY|FILE.toml", conflicts_with = "list")]
    pub(crate) scenarios: Vec<String>,
    /// What the methods are told of the aircraft in scenarios without a model of their own: a model file, or a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Methods, separated by commas; the first one is the one compared with [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) methods: Vec<String>,
    /// Flights per scenario, each with its own noise, gusts, pilot [default: 20]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) seeds: Option<u32>,
    /// Four flights per scenario
    #[arg(long, conflicts_with = "seeds")]
    pub(crate) quick: bool,
    /// Period in which times are counted in scenarios of your own: the short period
    #[arg(long, value_name = "TIME", default_value = "4.17s")]
    pub(crate) cycle: Time,
    /// List the scenarios and methods
    #[arg(long)]
    pub(crate) list: bool,
    /// Folder for report.html, comparison.json and comparison.csv
    #[arg(long, value_name = "DIR", default_value = "phugoid-comparison")]
    pub(crate) out: PathBuf,
    /// Write the figures to the folder too, one file each
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) figures: Option<PictureFormat>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}
