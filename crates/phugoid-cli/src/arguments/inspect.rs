//! `phugoid inspect`.

use std::path::PathBuf;

use clap::Args;

use super::delivery::Delivery;
use super::help::examples_and_exit_codes;
use super::reading::{Deleting, Reading, flight};

/// Lists what a flight contains: channels, gaps, doubtful units and signs, manoeuvres, and which derivatives can be
/// estimated
///
/// Nothing is estimated and no model is needed. The coherence of a surface and an output is the part of the output's
/// spectrum that is linear in the surface. The numbers of the manoeuvres are those that `phugoid estimate
/// --segment` takes. If nothing can be estimated from the flight, the reason is printed; that is a result, and the exit
/// code stays 0.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid inspect flight.csv
  phugoid inspect flight.csv --model jet.toml      what the flight lacks for this model
  phugoid inspect yesterday.ulg                    a log: its topics and rates, then the flight
  phugoid inspect flight.csv --figures figures     the coherence of surfaces and outputs
  phugoid inspect flight.csv --json --out flight.json"
))]
pub(crate) struct Inspect {
    /// The flight.
    #[arg(value_name = "FLIGHT", help = flight())]
    pub(crate) flight: PathBuf,
    /// The aircraft: a model file, or the name of a built-in one. Without it, the flight is checked against every
    /// built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) deleting: Deleting,
    /// Also write the coherence of the surfaces that were moved and the outputs as figures to this folder, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}
