//! `phugoid view`.

use std::path::PathBuf;

use clap::Args;

use super::help::examples_and_exit_codes;

/// Shows a finished result on the page of the live estimation: parameters with their bounds, signals, residuals, events
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid estimate flight.csv --model jet.toml --json --history > result.json
  phugoid view result.json                         serve the page and say where
  phugoid view result.json --html result.html      write it to a file
  phugoid view flight.phugoid-live                 what `phugoid live` has recorded, estimated again"
))]
pub(crate) struct View {
    /// JSON of `phugoid estimate --json --history`, the documents that `phugoid live` has published, one per line, or what
    /// it has recorded
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    /// Write the page to this file, with the data inside, and serve nothing: it needs no server and no network
    #[arg(long, value_name = "FILE", required = cfg!(not(feature = "live")))]
    pub(crate) html: Option<PathBuf>,
    #[cfg(feature = "live")]
    #[command(flatten)]
    pub(crate) address: super::address::Address,
}
