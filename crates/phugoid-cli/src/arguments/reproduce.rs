//! `phugoid reproduce`.

use std::path::PathBuf;

use clap::Args;

use super::delivery::PictureFormat;
use super::help::examples_and_exit_codes;

/// Runs the cases of the thesis that this project grew from, and writes one report: published, reconstructed, found
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid reproduce                                everything; writes phugoid-reproduction/report.html
  phugoid reproduce --list                         ids and titles
  phugoid reproduce second-order/3                 one case, told in full
  phugoid reproduce first-order noise/2 --json     a group and a case, as JSON
  phugoid reproduce my-case.toml --figures svg     a case file of your own

A requirement that is not met is a result, and told: the exit code stays 0. A case that cannot be run is a failure: the
others are still reported, and the exit code is 1."
))]
pub(crate) struct Reproduce {
    /// Cases: an id, a group of them, or a case file of your own [default: everything]
    #[arg(value_name = "ID|GROUP|FILE.toml", conflicts_with = "list")]
    pub(crate) cases: Vec<String>,
    /// List the ids with their titles
    #[arg(long)]
    pub(crate) list: bool,
    /// Folder for report.html, reproduction.json and a CSV per case
    #[arg(long, value_name = "DIR", default_value = "phugoid-reproduction")]
    pub(crate) out: PathBuf,
    /// Write the figures to the folder too, one file each
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) figures: Option<PictureFormat>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Put the curves of all figures into the JSON document
    #[arg(long, requires = "json")]
    pub(crate) charts: bool,
}
