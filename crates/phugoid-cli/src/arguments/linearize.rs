//! `phugoid linearize`.

use clap::Args;

use super::aircraft::FlightCondition;
use super::delivery::Delivery;
use super::help::examples_and_exit_codes;

/// Computes the linear model of an aircraft about a trim, and its natural modes
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid linearize --aircraft f16 --altitude 20000ft --speed 675ft/s --cg 0.30
  phugoid linearize --altitude 6096m --speed 400kt --json --out model.json"
))]
pub(crate) struct Linearize {
    #[command(flatten)]
    pub(crate) condition: FlightCondition,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}
