//! `phugoid trim`.

use clap::Args;

use super::aircraft::FlightCondition;
use super::delivery::Delivery;
use super::help::examples_and_exit_codes;

/// Computes the controls and the attitude that hold an aircraft in steady flight
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid trim --aircraft f16 --altitude 20000ft --speed 675ft/s --cg 0.30 --json
  phugoid trim --altitude 3000m --speed 180m/s --flight-path 5deg
  phugoid trim --altitude 0ft --speed 502ft/s --cg 0.30 --turn-rate 0.3rad/s"
))]
pub(crate) struct Trim {
    #[command(flatten)]
    pub(crate) condition: FlightCondition,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}
