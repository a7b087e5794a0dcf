//! The variables of an FMU: names, value references, units, and where each stands in the simulation. Every aircraft has the
//! same ones.

use std::sync::OnceLock;

use phugoid_flight_dynamics::increments::Increments;
use phugoid_simulation::signals::{Signal, signal};

pub use phugoid_flight_dynamics::aircraft::STATES;

/// Value reference of the time.
pub const TIME: u32 = 0;
/// Longest integration step of co-simulation where nothing else is set, s: that of scenarios with 100 samples per second.
pub const INTEGRATION_STEP_S: f64 = 0.005;
/// Usual sizes of the states, in their order and units, for the tolerances of solvers.
pub const NOMINALS: [f64; STATES] = [100.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 1e3, 1e3, 1e3, 100.0];

/// Where the numbers of a group begin: those of inputs, parameters, states, their rates and outputs.
const INPUTS: u32 = 1;
const PARAMETERS: u32 = 100;
const STATE: u32 = 200;
const RATE: u32 = 300;
const OUTPUTS: u32 = 400;

/// Units as they are written into a model description; all are SI, with angles in radians.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)] // the names are those of the units
pub enum Unit {
    None,
    Second,
    Metre,
    MetrePerSecond,
    MetrePerSecondSquared,
    Radian,
    RadianPerSecond,
    RadianPerSecondSquared,
    PerRadian,
    Percent,
    PercentPerSecond,
    Newton,
    Pascal,
    KilogramPerCubicMetre,
}

/// What a variable is.
#[derive(Clone, Copy, Debug)]
pub enum Role {
    /// The time, s.
    Time,
    /// Throttle, elevator, aileron and rudder, in this order.
    Control(usize),
    /// Velocity of the air along body x, y and z, then its rotation about these axes.
    Air(usize),
    /// An increment, by its name in [`Increments`].
    Increment(&'static str),
    /// Longest integration step of co-simulation.
    Step,
    /// A state, by its place in [`State`](phugoid_flight_dynamics::aircraft::State).
    State(usize),
    /// The rate of that state.
    Rate(usize),
    /// What is read off the flight.
    Output(Signal),
}

/// How a variable may change, with the words of FMI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// At any time.
    Continuous,
    /// Between steps of co-simulation, and in event mode of model exchange.
    Tunable,
    /// Until the end of the initialisation.
    Fixed,
}

/// Whether a variable comes from outside or goes there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The independent variable.
    Independent,
    /// An input.
    Input,
    /// A parameter.
    Parameter,
    /// A state or its rate.
    Local,
    /// An output.
    Output,
}

/// A variable of an FMU.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name, in the structured naming convention of FMI.
    pub name: String,
    /// Its number in the C functions.
    pub reference: u32,
    /// What it is.
    pub role: Role,
    /// Its unit.
    pub unit: Unit,
    /// Quantity, axis and sign, for people.
    pub description: String,
}

impl Variable {
    /// Where it comes from or goes to.
    pub fn direction(&self) -> Direction {
        match self.role {
            Role::Time => Direction::Independent,
            Role::Control(_) | Role::Air(_) => Direction::Input,
            Role::Increment(_) | Role::Step => Direction::Parameter,
            Role::State(_) | Role::Rate(_) => Direction::Local,
            Role::Output(_) => Direction::Output,
        }
    }

    /// How it may change.
    pub fn variability(&self) -> Variability {
        match self.role {
            Role::Increment(_) => Variability::Tunable,
            Role::Step => Variability::Fixed,
            _ => Variability::Continuous,
        }
    }
}

/// All variables, in the order of their references.
pub fn variables() -> &'static [Variable] {
    static ALL: OnceLock<Vec<Variable>> = OnceLock::new();
    ALL.get_or_init(all)
}

/// The variable with a reference.
pub fn variable(reference: u32) -> Option<&'static Variable> {
    let all = variables();
    all.binary_search_by_key(&reference, |variable| variable.reference).ok().map(|place| &all[place])
}

/// Name, unit and description of a group whose variables have no more of their own.
type Plain = (&'static str, Unit, &'static str);

const CONTROLS: [Plain; 4] = [
    ("throttle", Unit::None, "Throttle lever, 0 (closed) to 1 (full)"),
    ("elevator", Unit::Radian, "Elevator position, positive trailing edge down (pitches the nose down)"),
    ("aileron", Unit::Radian, "Aileron position, positive rolls to the left"),
    ("rudder", Unit::Radian, "Rudder position, positive trailing edge to the left (yaws to the left)"),
];

const AIR: [Plain; 6] = [
    ("gust.x", Unit::MetrePerSecond, "Velocity of the air along body x (forward): positive is a tail wind"),
    ("gust.y", Unit::MetrePerSecond, "Velocity of the air along body y (to the right)"),
    ("gust.z", Unit::MetrePerSecond, "Velocity of the air along body z (down): negative is an updraught"),
    ("gust.p", Unit::RadianPerSecond, "Rotation of the air about body x; the aerodynamics see p less this"),
    ("gust.q", Unit::RadianPerSecond, "Rotation of the air about body y; the aerodynamics see q less this"),
    ("gust.r", Unit::RadianPerSecond, "Rotation of the air about body z; the aerodynamics see r less this"),
];

/// The first states, where they are something else than the outputs of the same name: gusts are no part of them.
const STILL_AIR: [Plain; 3] = [
    ("speed", Unit::MetrePerSecond, "Speed of the centre of gravity relative to the undisturbed air"),
    ("alpha", Unit::Radian, "Angle of attack relative to the undisturbed air, positive nose up"),
    ("beta", Unit::Radian, "Sideslip angle relative to the undisturbed air, positive with the wind from the right"),
];

/// States that are outputs too.
const ATTITUDE: [Plain; 6] = [
    ("phi", Unit::Radian, "Bank angle, positive right wing down"),
    ("theta", Unit::Radian, "Pitch angle of body x above the horizon, positive nose up"),
    ("psi", Unit::Radian, "Heading from north, positive to the east"),
    ("p", Unit::RadianPerSecond, "Roll rate about body x, positive right wing down"),
    ("q", Unit::RadianPerSecond, "Pitch rate about body y, positive nose up"),
    ("r", Unit::RadianPerSecond, "Yaw rate about body z, positive nose right"),
];
const ALTITUDE: Plain = ("altitude", Unit::Metre, "Altitude above mean sea level, positive up");

/// The last states.
const PLACE: [Plain; 4] = [
    ("north", Unit::Metre, "Position north of the start, in undisturbed air over a flat earth"),
    ("east", Unit::Metre, "Position east of the start, in undisturbed air over a flat earth"),
    ALTITUDE,
    ("power", Unit::Percent, "Power level of the engine, the aircraft's own engine state"),
];

fn states() -> impl Iterator<Item = Plain> {
    STILL_AIR.into_iter().chain(ATTITUDE).chain(PLACE)
}

/// Outputs that records of flights have too, under the same names: these, the attitude, and the others.
const MOVING_AIR: [Plain; 3] = [
    ("true_airspeed", Unit::MetrePerSecond, "True airspeed, relative to the moving air"),
    ("alpha", Unit::Radian, "Angle of attack relative to the moving air, positive nose up"),
    ("beta", Unit::Radian, "Sideslip angle relative to the moving air, positive with the wind from the right"),
];
const MEASURED: [Plain; 13] = [
    ("pdot", Unit::RadianPerSecondSquared, "Rate of the roll rate, body x"),
    ("qdot", Unit::RadianPerSecondSquared, "Rate of the pitch rate, body y"),
    ("rdot", Unit::RadianPerSecondSquared, "Rate of the yaw rate, body z"),
    ("ax", Unit::MetrePerSecondSquared, "Specific force along body x at the centre of gravity, positive forward"),
    ("ay", Unit::MetrePerSecondSquared, "Specific force along body y at the centre of gravity, positive to the right"),
    (
        "az",
        Unit::MetrePerSecondSquared,
        "Specific force along body z at the centre of gravity, positive down: about -9.8 in level flight",
    ),
    ALTITUDE,
    ("north", Unit::Metre, "Position north of the start, over a flat earth"),
    ("east", Unit::Metre, "Position east of the start, over a flat earth"),
    ("air_density", Unit::KilogramPerCubicMetre, "Density of the air at the aircraft"),
    ("dynamic_pressure", Unit::Pascal, "Dynamic pressure, half the density times the square of the true airspeed"),
    ("mach", Unit::None, "Mach number"),
    ("thrust", Unit::Newton, "Size of the propulsive force, negative where it points backwards along body x"),
];

fn signals() -> impl Iterator<Item = Plain> {
    MOVING_AIR.into_iter().chain(ATTITUDE).chain(MEASURED)
}

/// Coefficients, which records do not have.
const COEFFICIENTS: [(&str, Signal, &str); 6] = [
    ("CX", |s| s.coefficients.cx, "Axial force coefficient, body x, positive forward; without thrust"),
    ("CY", |s| s.coefficients.cy, "Side force coefficient, body y, positive to the right"),
    ("CZ", |s| s.coefficients.cz, "Normal force coefficient, body z, positive down"),
    (
        "Cl",
        |s| s.coefficients.cl,
        "Rolling moment coefficient about the centre of gravity, referred to the span, positive right wing down",
    ),
    (
        "Cm",
        |s| s.coefficients.cm,
        "Pitching moment coefficient about the centre of gravity, referred to the mean chord, positive nose up",
    ),
    (
        "Cn",
        |s| s.coefficients.cn,
        "Yawing moment coefficient about the centre of gravity, referred to the span, positive nose right",
    ),
];

fn all() -> Vec<Variable> {
    let mut all = Vec::new();
    let mut push = |name: String, reference: u32, role: Role, unit: Unit, description: String| {
        all.push(Variable { name, reference, role, unit, description });
    };
    push("time".into(), TIME, Role::Time, Unit::Second, "Time since the start of the simulation".into());
    for (i, (name, unit, text)) in CONTROLS.into_iter().enumerate() {
        push(name.into(), INPUTS + i as u32, Role::Control(i), unit, text.into());
    }
    for (i, (name, unit, text)) in AIR.into_iter().enumerate() {
        push(name.into(), INPUTS + 4 + i as u32, Role::Air(i), unit, text.into());
    }
    let step = "Longest integration step of co-simulation: a communication step is divided into equal steps of the classical \
                Runge-Kutta method that are no longer than this";
    push("integration_step".into(), PARAMETERS, Role::Step, Unit::Second, step.into());
    for (i, (name, _)) in Increments::NONE.named().into_iter().enumerate() {
        let text = increment_text(name);
        push(name.into(), PARAMETERS + 1 + i as u32, Role::Increment(name), Unit::PerRadian, text);
    }
    for (i, (name, unit, text)) in states().enumerate() {
        push(format!("state.{name}"), STATE + i as u32, Role::State(i), unit, format!("State: {}", lower(text)));
    }
    for (i, (name, unit, text)) in states().enumerate() {
        let text = format!("Rate of the state: {}", lower(text));
        push(format!("der(state.{name})"), RATE + i as u32, Role::Rate(i), per_second(unit), text);
    }
    // A test sees to it that records know each of them.
    let of_records = signals().filter_map(|(name, unit, text)| Some((name, signal(name)?, unit, text)));
    let coefficients = COEFFICIENTS.into_iter().map(|(name, value, text)| (name, value, Unit::None, text));
    for (i, (name, value, unit, text)) in of_records.chain(coefficients).enumerate() {
        push(name.into(), OUTPUTS + i as u32, Role::Output(value), unit, text.into());
    }
    all
}

/// The unit of the rate of a state.
fn per_second(unit: Unit) -> Unit {
    match unit {
        Unit::Metre => Unit::MetrePerSecond,
        Unit::MetrePerSecond => Unit::MetrePerSecondSquared,
        Unit::Radian => Unit::RadianPerSecond,
        Unit::RadianPerSecond => Unit::RadianPerSecondSquared,
        Unit::Percent => Unit::PercentPerSecond,
        other => other,
    }
}

/// A sentence that goes on after a colon.
fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// What an increment is to: `dCm_alpha`, the pitching moment by the angle of attack.
fn increment_text(name: &str) -> String {
    let (coefficient, by) = name.split_once('_').unwrap_or((name, ""));
    let of = match coefficient {
        "dCL" => "lift coefficient",
        "dCD" => "drag coefficient",
        "dCm" => "pitching moment coefficient",
        "dCY" => "side force coefficient",
        "dCl" => "rolling moment coefficient",
        _ => "yawing moment coefficient",
    };
    let by = match by {
        "alpha" => "the angle of attack from that of the trim",
        "q" => "the pitch rate q cbar/2V from that of the trim",
        "elevator" => "the elevator from that of the trim",
        "beta" => "the sideslip angle",
        "p" => "the roll rate p b/2V",
        "r" => "the yaw rate r b/2V",
        "aileron" => "the aileron",
        _ => "the rudder",
    };
    format!("Increment to the derivative of the {of} by {by}: what the aircraft has more than its data say")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_rise_and_names_are_each_there_once() {
        let all = variables();
        assert!(all.windows(2).all(|pair| pair[0].reference < pair[1].reference));
        let mut names: Vec<&str> = all.iter().map(|variable| variable.name.as_str()).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
        assert_eq!(variable(STATE + 12).map(|v| v.name.as_str()), Some("state.power"));
        assert!(variable(99).is_none());
        for variable in all {
            let outputs = matches!(variable.role, Role::Output(_));
            assert_eq!(outputs, variable.reference >= OUTPUTS, "{}", variable.name);
            assert!(variable.description.len() > 5, "{}", variable.name);
        }
    }

    /// Outputs of the names of records are what records hold.
    #[test]
    fn every_signal_is_one_of_records() {
        let outputs = variables().iter().filter(|variable| variable.direction() == Direction::Output).count();
        assert_eq!(outputs, signals().count() + COEFFICIENTS.len());
        assert_eq!(states().count(), STATES);
    }
}
