//! `phugoid view`.

use std::path::PathBuf;

use clap::Args;

use super::help::examples_and_exit_codes;

/// Shows a finished result on the web page of the live estimation: parameters with bounds, signals, residuals and
/// events
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid estimate flight.csv --model jet.toml --json --history > result.json
  phugoid view result.json                         serve the page and print its address
  phugoid view result.json --html result.html      write it to a file
  phugoid view flight.phugoid-live                 a recording of `phugoid live`, estimated again"
))]
pub(crate) struct View {
    /// Output of `phugoid estimate --json --history`, or the JSON lines of `phugoid live`, or a recording of `phugoid
    /// live`
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    /// Write the page and its data to this file instead of serving it; the file opens without a server or a network
    #[arg(long, value_name = "FILE", required = cfg!(not(feature = "live")))]
    pub(crate) html: Option<PathBuf>,
    #[cfg(feature = "live")]
    #[command(flatten)]
    pub(crate) address: super::address::Address,
}
