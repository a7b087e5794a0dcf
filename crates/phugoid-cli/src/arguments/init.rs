//! `phugoid init`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use phugoid_flight_data::quantity::Dimension;
use phugoid_identification::draft::{AircraftClass, Answers, DraftedAxes};

use super::help::examples_and_exit_codes;
use super::number::is_above_zero;
use super::reading::{Reading, flight};

/// Begins a model file for the aircraft of a flight
///
/// It reads the flight, asks for the few numbers that no flight tells (on a terminal; else they are options), holds each
/// against the record, and writes a model file with comments. What is not known is estimated by class and size, and its
/// uncertainty goes into the bounds.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid init flight.csv --out mine.toml          asks for mass, wing and what else is not known
  phugoid init flight.csv --class drone --mass 2.1kg --wing-area 0.45m^2 --wing-span 1.8m > my.toml
  phugoid init log.ulg --class drone --elevator-travel -20deg   a log with commands of servos
  phugoid init flight.csv --class transport --mass 7472kg --iyy 91388kg*m^2 \\
               --wing-area 30.1m^2 --wing-span 14.5m --mean-chord 2.43m --out jet.toml
  phugoid estimate flight.csv --model mine.toml    what comes next"
))]
pub(crate) struct Init {
    /// The flight.
    #[arg(value_name = "FLIGHT", help = flight())]
    pub(crate) flight: PathBuf,
    #[command(flatten)]
    pub(crate) aircraft: AircraftAnswers,
    /// The model file to write; without it, it is printed
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// What is known of the aircraft, as options with units.
#[derive(Debug, Args)]
pub(crate) struct AircraftAnswers {
    /// What kind of aircraft it is: where typical numbers come from
    #[arg(long, value_enum)]
    pub(crate) class: Option<ClassName>,
    /// Name of the aircraft, for reports
    #[arg(long)]
    name: Option<String>,
    /// What is to be estimated [default: lateral where only ailerons or rudder were moved, else longitudinal]
    #[arg(long, value_enum)]
    axes: Option<AxesName>,
    /// Mass in flight, for example 1034kg or 2280lb
    #[arg(long, allow_hyphen_values = true, value_parser = mass)]
    pub(crate) mass: Option<f64>,
    /// Wing reference area, for example 16.2m^2
    #[arg(long, value_name = "AREA", allow_hyphen_values = true, value_parser = area)]
    pub(crate) wing_area: Option<f64>,
    /// Wing span, for example 10.9m
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, value_parser = size)]
    pub(crate) wing_span: Option<f64>,
    /// Mean aerodynamic chord [default: area over span]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, value_parser = size)]
    mean_chord: Option<f64>,
    /// Length of the fuselage; only estimated moments of inertia need it [default: typical of the class]
    #[arg(long, allow_hyphen_values = true, value_parser = size)]
    length: Option<f64>,
    /// Moment of inertia about body x, for example 948slug*ft^2 [default: estimated by class and size]
    #[arg(long, value_name = "INERTIA", allow_hyphen_values = true, value_parser = moment_of_inertia)]
    ixx: Option<f64>,
    /// Moment of inertia about body y [default: estimated by class and size]
    #[arg(long, value_name = "INERTIA", allow_hyphen_values = true, value_parser = moment_of_inertia)]
    iyy: Option<f64>,
    /// Moment of inertia about body z [default: estimated by class and size]
    #[arg(long, value_name = "INERTIA", allow_hyphen_values = true, value_parser = moment_of_inertia)]
    izz: Option<f64>,
    /// Product of inertia, the integral of x z dm [default: 0]
    #[arg(long, value_name = "INERTIA", value_parser = inertia, allow_hyphen_values = true)]
    ixz: Option<f64>,
    /// Constant thrust, for example 1200N [default: recorded, 0 of a glider, else from a typical lift over drag]
    #[arg(long, value_name = "FORCE", allow_hyphen_values = true, value_parser = force)]
    thrust: Option<f64>,
    /// Altitude of the flight, for example 5000ft, where the record has none
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub(crate) altitude: Option<f64>,
    /// Deflection of the elevator at full command (command 1), for example -20deg, negative where that moves the trailing edge
    /// up: of a log that has the autopilot's commands and not the positions of the surfaces
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    elevator_travel: Option<f64>,
    /// The same of the ailerons, negative where full command moves the right trailing edge up
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    aileron_travel: Option<f64>,
    /// The same of the rudder, negative where full command moves the trailing edge right
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    rudder_travel: Option<f64>,
}

impl AircraftAnswers {
    /// The answers that the options give; `class` stands for the one that was not said.
    pub(crate) fn answers(&self, class: AircraftClass) -> Answers {
        Answers {
            name: self.name.clone(),
            axes: self.axes.map(|axes| match axes {
                AxesName::Longitudinal => DraftedAxes::Longitudinal,
                AxesName::Lateral => DraftedAxes::Lateral,
                AxesName::Both => DraftedAxes::Both,
            }),
            mass_kg: self.mass,
            wing_area_m2: self.wing_area,
            wing_span_m: self.wing_span,
            mean_chord_m: self.mean_chord,
            length_m: self.length,
            ixx_kg_m2: self.ixx,
            iyy_kg_m2: self.iyy,
            izz_kg_m2: self.izz,
            ixz_kg_m2: self.ixz,
            thrust_n: self.thrust,
            altitude_m: self.altitude,
            elevator_travel_rad: self.elevator_travel,
            aileron_travel_rad: self.aileron_travel,
            rudder_travel_rad: self.rudder_travel,
            ..Answers::of(class)
        }
    }
}

/// Classes of aircraft on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ClassName {
    /// Single-engined light aircraft
    LightSingle,
    /// Transport or business jet
    Transport,
    /// Glider or motor glider
    Glider,
    /// Unmanned aircraft with fixed wings
    Drone,
    /// Fighter or jet trainer
    Fighter,
}

impl ClassName {
    pub(crate) fn class(self) -> AircraftClass {
        match self {
            Self::LightSingle => AircraftClass::LightSingle,
            Self::Transport => AircraftClass::Transport,
            Self::Glider => AircraftClass::Glider,
            Self::Drone => AircraftClass::Drone,
            Self::Fighter => AircraftClass::Fighter,
        }
    }
}

/// Axes on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum AxesName {
    /// Lift, drag and pitching moment
    Longitudinal,
    /// Side force, rolling and yawing moment
    Lateral,
    /// All six coefficients
    Both,
}

fn quantity(dimension: Dimension, text: &str) -> Result<f64, String> {
    dimension.parse(text).map_err(|error| error.to_string())
}

pub(crate) fn mass(text: &str) -> Result<f64, String> {
    is_above_zero(quantity(Dimension::MASS, text)?)
}

pub(crate) fn area(text: &str) -> Result<f64, String> {
    is_above_zero(quantity(Dimension::AREA, text)?)
}

/// A length of the aircraft.
pub(crate) fn size(text: &str) -> Result<f64, String> {
    is_above_zero(length(text)?)
}

pub(crate) fn length(text: &str) -> Result<f64, String> {
    quantity(Dimension::LENGTH, text)
}

pub(crate) fn angle(text: &str) -> Result<f64, String> {
    quantity(Dimension::ANGLE, text)
}

fn inertia(text: &str) -> Result<f64, String> {
    quantity(Dimension::INERTIA, text)
}

fn moment_of_inertia(text: &str) -> Result<f64, String> {
    is_above_zero(inertia(text)?)
}

fn force(text: &str) -> Result<f64, String> {
    quantity(Dimension::FORCE, text)
}
