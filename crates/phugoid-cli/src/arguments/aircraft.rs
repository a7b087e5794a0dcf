//! Options that name an aircraft and the flight condition in which it is trimmed.

use clap::{Args, ValueEnum};
use phugoid_aircraft::transport::Damage;
use phugoid_simulation::quantity::{Angle, AngularRate, Force, Length, Speed};

/// Digitisations of the F-16 wind-tunnel tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TablesName {
    /// Stevens, Lewis & Johnson, 3rd edition
    Book,
    /// Morelli's digitisation, as in NASA's DAVE-ML model
    Morelli,
}

/// The aircraft, and what its file leaves open.
#[derive(Debug, Args)]
pub(crate) struct AircraftChoice {
    /// Aircraft: f16 (Stevens & Lewis), a model file, the name of a built-in model (hfb320), the file or folder of an
    /// aircraft of JSBSim, a model in DAVE-ML (.dml), or the folder of NASA's Generic Transport Model or
    /// of the F-16 of NASA TP-1538
    #[arg(long, value_name = "NAME|FILE", default_value = "f16")]
    pub(crate) aircraft: String,
    /// Aerodynamic tables of the F-16 [default: book]
    #[arg(long, value_enum)]
    pub(crate) tables: Option<TablesName>,
    /// Centre of gravity of the F-16, as a fraction of the mean aerodynamic chord [default: 0.35]
    #[arg(long, value_parser = fraction, allow_negative_numbers = true)]
    pub(crate) cg: Option<f64>,
    /// Damage of the Generic Transport Model, for example left-stabiliser-off
    #[arg(long, value_name = "DAMAGE", value_parser = damage)]
    pub(crate) damaged: Option<Damage>,
    /// Further file of an aircraft in DAVE-ML: mass and inertia, engine; may be repeated
    #[arg(long = "with", value_name = "FILE")]
    pub(crate) with: Vec<std::path::PathBuf>,
    /// Property of an aircraft of JSBSim, in its units, for example fcs/flap-pos-deg=10; in DAVE-ML a variable in the unit of its
    /// file, or mass, inertia or a size that no file has, in SI, for example totalMass=9300; of the F-16 of
    /// NASA TP-1538 cg; may be repeated
    #[arg(long = "property", value_name = "NAME=VALUE", value_parser = property)]
    pub(crate) properties: Vec<(String, f64)>,
    /// Thrust at full throttle of an aircraft of JSBSim or in DAVE-ML, along body x, in place of its engines
    #[arg(long, value_name = "FORCE")]
    pub(crate) largest_thrust: Option<Force>,
}

fn damage(text: &str) -> Result<Damage, String> {
    Damage::from_word(text).ok_or_else(|| format!("there are {}", Damage::ALL.map(Damage::word).join(", ")))
}

fn property(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, as in fcs/flap-pos-deg=10")?;
    match value.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && !name.trim().is_empty() => Ok((name.trim().to_owned(), value)),
        _ => Err("write NAME=VALUE with a number, as in fcs/flap-pos-deg=10".to_owned()),
    }
}

/// Aircraft and steady flight condition of `trim`, `linearize` and `export-fmu`.
#[derive(Debug, Args)]
pub(crate) struct FlightCondition {
    #[command(flatten)]
    pub(crate) aircraft: AircraftChoice,
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
