//! `phugoid check`.

use std::path::PathBuf;

use clap::Args;

use super::delivery::Delivery;
use super::help::examples_and_exit_codes;

/// Runs the check data that a DAVE-ML model carries with it (ANSI/AIAA S-119)
///
/// Each static shot of the file states inputs, internal values, outputs and tolerances. The model is evaluated at the inputs,
/// and every value that is not within its tolerance is listed. A model passes when all outputs do.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid check F16_aero.dml F16_prop.dml
  phugoid check model.dml --json"
))]
pub(crate) struct Check {
    /// The models
    #[arg(value_name = "MODEL.dml", required = true)]
    pub(crate) models: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}
