//! `phugoid compatibility`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use phugoid_identification::compatibility::HeldError;
use phugoid_simulation::quantity::Length;

use super::help::examples_and_exit_codes;
use super::reading::{Deleting, Reading, flight};

/// Checks a flight for kinematic consistency and estimates the errors of its sensors
///
/// Airspeed, flow angles, attitude and altitude are predicted from the accelerometers and rate gyroscopes by kinematics
/// alone, without an aerodynamic model. The differences from the measured signals give biases, scale factors, delays and
/// wind, each with its standard error; a value that the manoeuvre does not determine is marked. An error is corrected if
/// it is beyond three sigma and makes samples more likely that it was not fitted to. The command writes the corrected
/// record, the corrections, and a page with figures.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid compatibility flight.csv
  phugoid compatibility flight.csv --model jet.toml --elevator-skew
  phugoid compatibility flight.csv --alpha-vane 4.2m --estimate inertial-scales
  phugoid compatibility flight.csv --unknowns bias_az,scale_alpha,delay_alpha
  phugoid compatibility flight.csv --without scale_theta --hold bias_q=0.06deg/s
  phugoid compatibility first.csv --with second.csv --with third.csv
  phugoid estimate flight.csv --model jet.toml --correct phugoid-compatibility/corrections.json"
))]
pub(crate) struct Compatibility {
    /// The flight.
    #[arg(value_name = "FLIGHT", help = flight())]
    pub(crate) flight: PathBuf,
    /// A further flight of the same installation: the errors of the sensors are the same in all; may be repeated. Of
    /// a file with several tables FILE:VARIABLE, such as flights.mat:second
    #[arg(long, value_name = "FLIGHT")]
    pub(crate) with: Vec<PathBuf>,
    /// Model file, or the name of a built-in one; only its column names are used, and its acceleration of gravity where
    /// that is not 9.80665 m/s^2
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Also estimate the delay of the elevator relative to all other channels, with the aerodynamic model of --model
    #[arg(long, requires = "model")]
    pub(crate) elevator_skew: bool,
    /// The flight comes from a simulator over a flat Earth, as `phugoid simulate` is: straight flight does not turn with
    /// the horizon
    #[arg(long)]
    pub(crate) flat_earth: bool,
    /// Distance of the angle-of-attack vane ahead of the centre of gravity, for example 4.2m
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) alpha_vane: Option<Length>,
    /// Distance of the sideslip vane ahead of the centre of gravity, for example 4.2m
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) beta_vane: Option<Length>,
    /// Further groups of sensor errors to estimate, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', value_name = "GROUP")]
    pub(crate) estimate: Vec<SensorGroup>,
    /// Estimate these errors alone, separated by commas, for example bias_az,scale_alpha,delay_alpha; what is not named is
    /// taken for zero
    #[arg(long, value_delimiter = ',', value_name = "NAMES", conflicts_with = "estimate")]
    pub(crate) unknowns: Vec<String>,
    /// Do not estimate these errors, separated by commas, and take them for zero
    #[arg(long, value_delimiter = ',', value_name = "NAMES", conflicts_with = "unknowns")]
    pub(crate) without: Vec<String>,
    /// Hold an error that is known, from a calibration for example, at its value, for example bias_q=0.06deg/s or
    /// scale_alpha=3%. It becomes part of the corrections, and is taken for exact; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = HeldError::parse)]
    pub(crate) hold: Vec<HeldError>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) deleting: Deleting,
    /// Folder for the corrected record, the corrections and the page
    #[arg(long, value_name = "DIR", default_value = "phugoid-compatibility")]
    pub(crate) out: PathBuf,
    /// Also write the figures to this folder, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document (SI units) instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Groups of sensor errors that are estimated on request, in addition to those that always are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SensorGroup {
    /// Scale factors of the accelerometers and rate gyroscopes
    InertialScales,
    /// Distances of the vanes ahead of the centre of gravity
    VanePositions,
    /// Position of the accelerometers relative to the centre of gravity
    AccelerometerPosition,
    /// Upwash at the angle-of-attack vane, in proportion to lift
    Upwash,
}
