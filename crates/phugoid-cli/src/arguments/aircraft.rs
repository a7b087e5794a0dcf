//! Options that name an aircraft and the flight condition in which it is trimmed.

use clap::{Args, ValueEnum};
use phugoid_simulation::quantity::{Angle, AngularRate, Length, Speed};

/// Built-in aircraft that `trim` and `linearize` know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AircraftName {
    /// F-16 of Stevens & Lewis, Aircraft Control and Simulation
    F16,
}

/// Digitisations of the F-16 wind-tunnel tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TablesName {
    /// Stevens, Lewis & Johnson, 3rd edition
    Book,
    /// Morelli's digitisation, as in NASA's DAVE-ML model
    Morelli,
}

/// Aircraft and steady flight condition of `trim` and `linearize`.
#[derive(Debug, Args)]
pub(crate) struct FlightCondition {
    /// Aircraft to trim
    #[arg(long, value_enum, default_value = "f16")]
    pub(crate) aircraft: AircraftName,
    /// Aerodynamic tables of the aircraft
    #[arg(long, value_enum, default_value = "book")]
    pub(crate) tables: TablesName,
    /// Position of the centre of gravity, as a fraction of the mean aerodynamic chord
    #[arg(long, default_value_t = 0.35, value_parser = fraction, allow_negative_numbers = true)]
    pub(crate) cg: f64,
    /// Altitude above sea level, for example 20000ft or 6096m
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) altitude: Length,
    /// True airspeed, for example 675ft/s, 400kt or 205.74m/s
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub(crate) speed: Speed,
    /// Flight-path angle, positive in a climb, for example 3deg
    #[arg(long, value_name = "ANGLE", default_value = "0deg", allow_hyphen_values = true)]
    pub(crate) flight_path: Angle,
    /// Rate of turn about the vertical, positive to the right, for example 3deg/s
    #[arg(long, value_name = "RATE", default_value = "0deg/s", allow_hyphen_values = true)]
    pub(crate) turn_rate: AngularRate,
}

fn fraction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        Ok(_) => Err("a fraction of the mean chord lies between 0 and 1, as in 0.30".to_owned()),
        Err(_) => Err("write a fraction of the mean chord, as in 0.30".to_owned()),
    }
}
