//! `phugoid reproduce`.

use std::path::PathBuf;

use clap::Args;

use super::delivery::PictureFormat;
use super::help::examples_and_exit_codes;

/// Runs the cases of the thesis that this project is based on, and reports published, reconstructed and computed
/// results
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid reproduce                                everything; writes phugoid-reproduction/report.html
  phugoid reproduce --list                         ids and titles
  phugoid reproduce second-order/3                 one case, with all details
  phugoid reproduce first-order noise/2 --json     a group and a case, as JSON
  phugoid reproduce first-order/1 --show > my.toml the case as a file, to change it
  phugoid reproduce my.toml --figures svg          a case file of your own

A requirement that is not met is reported as a result: the exit code stays 0. If a case cannot be run,
the others are still reported, and the exit code is 1."
))]
pub(crate) struct Reproduce {
    /// Cases to run: the id of a case, the name of a group, or a case file of your own [default: all cases]
    #[arg(value_name = "ID|GROUP|FILE.toml", conflicts_with = "list")]
    pub(crate) cases: Vec<String>,
    /// List the ids and titles of the cases, and run nothing
    #[arg(long)]
    pub(crate) list: bool,
    /// Print the text of the case files (plant, true values, laws, gains, input, what was published) and run nothing: a
    /// start for a case of your own
    #[arg(long, conflicts_with_all = ["list", "json"])]
    pub(crate) show: bool,
    /// Folder for report.html, reproduction.json and one CSV file per case
    #[arg(long, value_name = "DIR", default_value = "phugoid-reproduction")]
    pub(crate) out: PathBuf,
    /// Also write each figure to a file in the folder of --out
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) figures: Option<PictureFormat>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Include the curves of all figures in the JSON document
    #[arg(long, requires = "json")]
    pub(crate) charts: bool,
}
