//! `phugoid compatibility`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use phugoid_simulation::quantity::Length;

use super::help::examples_and_exit_codes;

/// Checks a flight for kinematic consistency and estimates the errors of its sensors
///
/// Accelerometers and rate gyroscopes give airspeed, flow angles, attitude and altitude by kinematics alone, whatever the aircraft.
/// From the difference to what was measured follow biases, scale factors, delays and wind, each with its standard error, or that
/// the manoeuvre does not tell it. Written are the corrected record, the corrections, and a page with figures.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid compatibility flight.csv
  phugoid compatibility flight.csv --model jet.toml --elevator-skew
  phugoid compatibility flight.csv --alpha-vane 4.2m --estimate inertial-scales
  phugoid estimate flight.csv --model jet.toml --correct phugoid-compatibility/corrections.json"
))]
pub(crate) struct Compatibility {
    /// The flight, a CSV file with units in its headers
    #[arg(value_name = "FLIGHT.csv")]
    pub(crate) flight: PathBuf,
    /// Model file, or the name of a built-in one, for the names of the columns and the acceleration of gravity
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Find the delay of the elevator against all else with the model of --model
    #[arg(long, requires = "model")]
    pub(crate) elevator_skew: bool,
    /// Distance of the vane of the angle of attack ahead of the centre of gravity
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) alpha_vane: Option<Length>,
    /// Distance of the vane of the sideslip ahead of the centre of gravity
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) beta_vane: Option<Length>,
    /// Estimate these too, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', value_name = "GROUP")]
    pub(crate) estimate: Vec<SensorGroup>,
    /// Folder for the corrected record, the corrections and the page
    #[arg(long, value_name = "DIR", default_value = "phugoid-compatibility")]
    pub(crate) out: PathBuf,
    /// Write the figures to this folder too, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document (SI units) instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Groups of sensor errors beside those that are always estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SensorGroup {
    /// Scale factors of accelerometers and rate gyroscopes
    InertialScales,
    /// Distances of the vanes ahead of the centre of gravity
    VanePositions,
    /// Position of the accelerometers
    AccelerometerPosition,
}
