//! Why a file does not make an aircraft that can be flown.

use std::path::PathBuf;

use crate::daveml::DavemlError;
use crate::jsbsim::JsbsimError;
use crate::tp1538::Tp1538Error;
use crate::transport::TransportError;
use crate::vehicle::VehicleError;
use crate::xml::XmlError;

/// Why a file does not make an aircraft that can be flown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FlownError {
    /// The files of an aircraft of JSBSim cannot be read.
    #[error(transparent)]
    Jsbsim(#[from] JsbsimError),
    /// A file is no XML.
    #[error("{}: {source}", file.display())]
    NoXml {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        source: XmlError,
    },
    /// The tables of the Generic Transport Model cannot be read.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// A model in DAVE-ML cannot be read; the message names the file.
    #[error(transparent)]
    Daveml(#[from] DavemlError),
    /// A variable of models in DAVE-ML is missing or has a unit that does not suit it.
    #[error("{}: {source}", file.display())]
    Vehicle {
        /// The first file of the aircraft.
        file: PathBuf,
        /// Which variable, and what is wrong with it.
        source: VehicleError,
    },
    /// Models in DAVE-ML lack numbers without which there is no flight.
    #[error(
        "{}: no model says {names}. Name a further file that does (--with FILE; `with` in a scenario), or give the numbers in SI \
         (--property totalMass=9300; `properties` in a scenario)",
        file.display()
    )]
    Lacking {
        /// The first file of the aircraft.
        file: PathBuf,
        /// The standard names with their units.
        names: String,
    },
    /// A size or a mass of models in DAVE-ML is not positive.
    #[error("{}: {name} is {value} {unit}; it has to be positive", file.display())]
    NotPositive {
        /// The first file of the aircraft.
        file: PathBuf,
        /// Standard name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A size or a mass of models in DAVE-ML depends on the flight or on an input without a value.
    #[error(
        "{}: {name} is not a number before the flight: it follows the flight, or an input without a value. Give that input a \
         number (--property NAME=VALUE; `properties` in a scenario)",
        file.display()
    )]
    Follows {
        /// The first file of the aircraft.
        file: PathBuf,
        /// Standard name.
        name: String,
    },
    /// Inputs of models in DAVE-ML are known neither from the flight nor from another model.
    #[error(
        "{}: nothing says what {} is: no quantity of the flight, control, or variable of another model has this name. Give it a \
         number in the unit of the file (--property {}=VALUE; `properties` in a scenario), or name the file that computes it \
         (--with FILE; `with` in a scenario)",
        file.display(), names.join(", "), names.first().map_or("NAME", String::as_str)
    )]
    Open {
        /// The first file of the aircraft.
        file: PathBuf,
        /// Names of the inputs.
        names: Vec<String>,
    },
    /// Models in DAVE-ML need each other's variables in a circle.
    #[error("{}: each of these models needs a variable of another: {}", file.display(), models.join(", "))]
    Circle {
        /// The first file of the aircraft.
        file: PathBuf,
        /// Names of the models.
        models: Vec<String>,
    },
    /// A folder in which there are models in DAVE-ML and nothing else that flies.
    #[error(
        "{}: the folder has models in DAVE-ML, and which of them make an aircraft it does not say: name the file with the \
         aerodynamics, and the others with --with FILE (`with` in a scenario)",
        folder.display()
    )]
    Models {
        /// The folder.
        folder: PathBuf,
    },
    /// The F-16 of NASA TP-1538 cannot be made.
    #[error(transparent)]
    Tp1538(#[from] Tp1538Error),
    /// An option that the aircraft of this file does not have.
    #[error("{}: `{option}` has no meaning for {aircraft}", file.display())]
    Option {
        /// The file or folder.
        file: PathBuf,
        /// The option.
        option: &'static str,
        /// What the aircraft is.
        aircraft: &'static str,
    },
    /// There is no flight control system that could fly the aircraft of this file.
    #[error(
        "{}: `flight_control` lets the flight control system of an aircraft of JSBSim move the surfaces, and {why}: leave it out",
        file.display()
    )]
    NoFlightControl {
        /// The file or folder.
        file: PathBuf,
        /// Why there is none.
        why: String,
    },
    /// Flight control reads what JSBSim computes in flight and this crate does not.
    #[error(
        "{}: line {line}: flight control moves the surfaces by {property}, which JSBSim computes in flight and nothing gives here.          Give it a constant value (`properties` in a scenario), or leave `flight_control` out",
        file.display()
    )]
    Unfed {
        /// The file.
        file: PathBuf,
        /// Line where the property is first named, from 1.
        line: u32,
        /// The property.
        property: String,
    },
    /// Flight control does not come to rest in steady flight.
    #[error(
        "{}: flight control does not come to rest in the trim of the flight: after {after_s:.0} s its {surface} still moves by          {rate_deg_s:.3} deg/s. Begin in a condition that it holds, or leave `flight_control` out",
        file.display()
    )]
    Restless {
        /// The file.
        file: PathBuf,
        /// `elevator`, `aileron` or `rudder`.
        surface: &'static str,
        /// How long it was given, s.
        after_s: f64,
        /// How fast the surface moves still, deg/s.
        rate_deg_s: f64,
    },
    /// The file is of no kind that is known.
    #[error("{}: the file begins with <{root}>; aircraft of JSBSim begin with <fdm_config>, models in DAVE-ML with \
             <DAVEfunc>", file.display())]
    UnknownKind {
        /// The file.
        file: PathBuf,
        /// Name of its outermost element.
        root: String,
    },
    /// The aerodynamics move with something that cannot be made of the angle of a surface.
    #[error(
        "{}: line {line}: the aerodynamics read {property}, which cannot be made of the angle of the {surface}: no \
         <aerosurface_scale> or <kinematic> of flight control says how far the {surface} goes. Add one that writes \
         fcs/{surface}-pos-rad, with the ends of the {surface} in its <range>, or let the aerodynamics read the angle",
        file.display()
    )]
    Surface {
        /// The file.
        file: PathBuf,
        /// Line where the property is first named, from 1.
        line: u32,
        /// `elevator`, `aileron` or `rudder`.
        surface: &'static str,
        /// The property.
        property: String,
    },
    /// A property that was to be set is not in the files.
    #[error("no file mentions the property {name}; what can be set is {settable}")]
    Property {
        /// Its name.
        name: String,
        /// Names of properties that can be set.
        settable: String,
    },
    /// A property that was to be set changes nothing, or not for long.
    #[error("setting {name} changes nothing: {why}; what can be set is {settable}")]
    WithoutEffect {
        /// Its name.
        name: String,
        /// Why it changes nothing.
        why: &'static str,
        /// Names of properties that can be set.
        settable: String,
    },
    /// A number is out of its range.
    #[error("{what} is {value}; it has to be {expected}")]
    Number {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it has to be.
        expected: &'static str,
    },
    /// Mass or inertia are not positive.
    #[error(
        "{}: the mass is {mass_kg} kg and the moments of inertia are {}, {} and {} kg m2; the mass has \
         to be positive, and so has the tensor of inertia",
        file.display(), inertia_kg_m2[0], inertia_kg_m2[1], inertia_kg_m2[2]
    )]
    Mass {
        /// The file.
        file: PathBuf,
        /// Mass, kg.
        mass_kg: f64,
        /// Moments of inertia about the centre of gravity, kg m2.
        inertia_kg_m2: [f64; 3],
    },
    /// A size of the wing is not positive.
    #[error("{}: <metrics>: the {what} is {value}; <{element}> has to give a positive one", file.display())]
    Size {
        /// The file.
        file: PathBuf,
        /// What it is, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The element that gives it.
        element: &'static str,
    },
}
