//! Aircraft in DAVE-ML in flight: models that are joined by the standard names of their variables.

use std::collections::HashMap;

use phugoid_flight_dynamics::globe::condition::Condition;
use phugoid_flight_dynamics::globe::loads::{ForcesAndMoments, Loads};
use phugoid_flight_dynamics::globe::vector::{Vector, add, cross, scale};
use phugoid_flight_dynamics::mass::MassProperties;

use super::Schedule;
use super::error::VehicleError;
use super::named::{
    ABOUT, ALONG, FORCE, LENGTH, MOMENT, NUMBER, Names, Output, PRESSURE, RATE, SPEED, any_unit, missing, unit,
};
use crate::daveml::{Evaluator, Model, Unit};

/// Where an input comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// A quantity of the flight by its place in [`QUANTITIES`].
    Flight(usize),
    /// An output of an earlier model, both in SI.
    Output(Output),
    /// A number that was given, by its place, in the unit of the variable.
    Given(usize),
}

#[derive(Clone, Debug)]
struct Input {
    position: usize,
    unit: Unit,
    source: Source,
}

#[derive(Clone, Debug)]
struct Part {
    evaluator: Evaluator,
    inputs: Vec<Input>,
}

type Quantity = fn(&Condition) -> f64;

/// Quantities of the flight by the names of S-119, compared without regard to capitals.
const QUANTITIES: [(&str, [i8; 5], Quantity); 23] = [
    ("trueAirspeed", SPEED, |c| c.air.speed),
    ("equivalentAirspeed", SPEED, |c| c.equivalent_airspeed()),
    ("angleOfAttack", NUMBER, |c| c.air.alpha),
    ("angleOfSideslip", NUMBER, |c| c.air.beta),
    ("angleOfAttackRate", RATE, |c| c.angle_rates[0]),
    ("angleOfSideslipRate", RATE, |c| c.angle_rates[1]),
    ("bodyAngularRate_Roll", RATE, |c| c.rates_to_earth[0]),
    ("bodyAngularRate_Pitch", RATE, |c| c.rates_to_earth[1]),
    ("bodyAngularRate_Yaw", RATE, |c| c.rates_to_earth[2]),
    ("eulerAngle_Roll", NUMBER, |c| c.euler.roll),
    ("eulerAngle_Pitch", NUMBER, |c| c.euler.pitch),
    ("eulerAngle_Yaw", NUMBER, |c| c.euler.yaw),
    ("mach", NUMBER, |c| c.air.mach),
    ("dynamicPressure", PRESSURE, |c| c.air.dynamic_pressure),
    ("ambientPressure", PRESSURE, |c| c.atmosphere.pressure),
    ("ambientTemperature", [0, 0, 0, 1, 0], |c| c.atmosphere.temperature),
    ("airDensity", [-3, 1, 0, 0, 0], |c| c.atmosphere.density),
    ("speedOfSound", SPEED, |c| c.atmosphere.speed_of_sound),
    ("altitudeMsl", LENGTH, |c| c.place.altitude),
    ("geLatitude", NUMBER, |c| c.place.latitude),
    ("geLongitude", NUMBER, |c| c.place.longitude),
    ("geometricAltitude", LENGTH, |c| c.place.altitude),
    ("time", [0, 0, 1, 0, 0], |c| c.time),
];

/// How the aerodynamic force is stated.
#[derive(Clone, Copy, Debug)]
enum Force {
    /// Coefficients along the body axes.
    Body([Output; 3]),
    /// Coefficients of lift, drag and side force.
    LiftDrag([Output; 3]),
}

/// An aircraft of one or more models in DAVE-ML that use the standard names of ANSI/AIAA S-119.
///
/// Every input of a model is, in this order: a number that was given; an output of a model before it with the same name, such
/// as `elevatorDeflection` of a control law; a quantity of the flight, such as `angleOfAttack`; or the value that the file
/// gives. Numbers are converted by the units of the files.
///
/// The aerodynamic force is that of `aeroBodyForceCoefficient_X`, `_Y` and `_Z`; or drag (`totalCoefficientOfDrag`) against the
/// motion through the air, lift (`totalCoefficientOfLift`) normal to it in the plane of symmetry, and `aeroBodyForceCoefficient_Y`.
/// Forces and moments (`aeroBodyMomentCoefficient_Roll`, `_Pitch`, `_Yaw`) act at the moment reference point, from which the
/// centre of gravity is away by `bodyPositionOfCmWrtMrc_X`, `_Y` and `_Z`. Thrust (`thrustBodyForce_X` and others) acts at the
/// centre of gravity. Body rates are those relative to the rotating earth.
///
/// Mass and inertia (`totalMass`, `bodyMomentOfInertia_Roll` and others) and the sizes (`referenceWingArea`, `referenceWingSpan`,
/// `referenceWingChord`) are taken once, when the vehicle is made. Rates of angle of attack and sideslip are solved with the
/// accelerations if a model takes one.
#[derive(Clone, Debug)]
pub struct DavemlVehicle {
    parts: Vec<Part>,
    names: HashMap<String, usize>,
    given: Vec<f64>,
    scheduled: Vec<(usize, Schedule)>,
    force: Force,
    moment: [Output; 3],
    thrust: [Option<Output>; 3],
    thrust_moment: [Option<Output>; 3],
    mass: MassProperties,
    area: f64,
    span: f64,
    chord: f64,
    arm: Vector,
    uses_angle_rates: bool,
}

impl DavemlVehicle {
    /// From models, evaluated in this order, and numbers for variables by their names or identifiers, each in the unit of the
    /// file: controls, the position of the centre of gravity, or constants that are to be changed.
    ///
    /// # Errors
    ///
    /// [`VehicleError`] if a quantity is missing or an input is left open.
    pub fn new(models: &[Model], given: &[(&str, f64)]) -> Result<Self, VehicleError> {
        let mut names = HashMap::new();
        let mut parts: Vec<Part> = Vec::new();
        let mut uses_angle_rates = false;
        let settable = |name: &str| models.iter().any(|model| model.input_position(name).is_ok());
        for (place, (name, _)) in given.iter().enumerate() {
            if !settable(name) {
                return Err(VehicleError::NotSettable { name: (*name).to_owned() });
            }
            names.insert((*name).to_owned(), place);
        }
        for (part, model) in models.iter().enumerate() {
            let mut inputs = Vec::new();
            for (place, (name, _)) in given.iter().enumerate() {
                if let Ok(position) = model.input_position(name) {
                    let unit = any_unit(&model.variables()[position].units);
                    inputs.push(Input { position, unit, source: Source::Given(place) });
                }
            }
            for (&position, variable) in model.input_positions().iter().zip(model.inputs()) {
                if inputs.iter().any(|input| input.position == position) {
                    continue;
                }
                let flight = QUANTITIES.iter().position(|(name, ..)| variable.name.eq_ignore_ascii_case(name));
                let before = Names { models: &models[..part] };
                let own = any_unit(&variable.units);
                let (source, unit) = if let Some(output) = before.find(&variable.name, own.dimension)? {
                    (Source::Output(output), own)
                } else if let Some(quantity) = flight {
                    uses_angle_rates |= variable.name.to_ascii_lowercase().ends_with("rate");
                    (Source::Flight(quantity), unit(&variable.name, &variable.units, QUANTITIES[quantity].1)?)
                } else if variable.initial.is_some() {
                    continue;
                } else {
                    return Err(VehicleError::Open { name: variable.name.clone() });
                };
                inputs.push(Input { position, unit, source });
            }
            parts.push(Part { evaluator: model.evaluator(), inputs });
        }

        let all = Names { models };
        let force = match all.axes("aeroBodyForceCoefficient", ALONG, NUMBER)? {
            [Some(x), Some(y), Some(z)] => Force::Body([x, y, z]),
            [_, side, _] => Force::LiftDrag([
                all.need("totalCoefficientOfLift", NUMBER)?,
                all.need("totalCoefficientOfDrag", NUMBER)?,
                side.ok_or_else(|| missing("aeroBodyForceCoefficient_Y"))?,
            ]),
        };
        let [l, m, n] = ABOUT.map(|axis| all.need(&format!("aeroBodyMomentCoefficient_{axis}"), NUMBER));
        let moment = [l?, m?, n?];
        let thrust = all.axes("thrustBodyForce", ALONG, FORCE)?;
        let thrust_moment = all.axes("thrustBodyMoment", ABOUT, MOMENT)?;

        let mut values: Vec<Part> = parts.clone();
        run(&mut values, &given.iter().map(|(_, value)| *value).collect::<Vec<_>>(), None);
        let number = |name: &str, dimension| Ok(value(&values, all.need(name, dimension)?));
        let or_zero =
            |name: &str, dimension| Ok(all.find(name, dimension)?.map_or(0.0, |output| value(&values, output)));
        const INERTIA: [i8; 5] = [2, 1, 0, 0, 0];
        let [xx, yy, zz] = ABOUT.map(|axis| number(&format!("bodyMomentOfInertia_{axis}"), INERTIA));
        let [xy, yz, zx] = ["XY", "YZ", "ZX"].map(|axes| or_zero(&format!("bodyProductOfInertia_{axes}"), INERTIA));
        let (xx, yy, zz, xy, yz, zx) = (xx?, yy?, zz?, xy?, yz?, zx?);
        let tensor = [[xx, -xy, -zx], [-xy, yy, -yz], [-zx, -yz, zz]];
        let mass = MassProperties::from_tensor(number("totalMass", [0, 1, 0, 0, 0])?, tensor, 0.0);
        let [x, y, z] = ALONG.map(|axis| or_zero(&format!("bodyPositionOfCmWrtMrc_{axis}"), LENGTH));
        let area = number("referenceWingArea", [2, 0, 0, 0, 0])?;
        let span = all.find("referenceWingSpan", LENGTH)?.map_or(1.0, |output| value(&values, output));
        let chord = all.find("referenceWingChord", LENGTH)?.map_or(1.0, |output| value(&values, output));
        Ok(Self {
            mass: mass.ok_or(VehicleError::Mass)?,
            area,
            span,
            chord,
            arm: [-x?, -y?, -z?],
            parts,
            names,
            given: given.iter().map(|(_, value)| *value).collect(),
            scheduled: Vec::new(),
            force,
            moment,
            thrust,
            thrust_moment,
            uses_angle_rates,
        })
    }

    /// Sets a number that was given when the vehicle was made, in the unit of the file; `false` if none had this name.
    pub fn set(&mut self, name: &str, value: f64) -> bool {
        let place = self.names.get(name);
        if let Some(&place) = place {
            self.given[place] = value;
        }
        place.is_some()
    }

    /// Lets a number that was given when the vehicle was made follow a schedule; `false` if none had this name.
    pub fn schedule(&mut self, name: &str, schedule: Schedule) -> bool {
        let place = self.names.get(name).copied();
        if let Some(place) = place {
            self.scheduled.retain(|(other, _)| *other != place);
            self.scheduled.push((place, schedule));
        }
        place.is_some()
    }
}

/// Evaluates all parts. Without a condition quantities of the flight keep what they had.
fn run(parts: &mut [Part], given: &[f64], condition: Option<&Condition>) {
    for index in 0..parts.len() {
        let (before, rest) = parts.split_at_mut(index);
        let Some(part) = rest.first_mut() else { break };
        for input in &part.inputs {
            let number = match (input.source, condition) {
                (Source::Given(place), _) => given[place],
                (Source::Output(output), _) => input.unit.from_si(value(before, output)),
                (Source::Flight(quantity), Some(condition)) => input.unit.from_si(QUANTITIES[quantity].2(condition)),
                (Source::Flight(_), None) => continue,
            };
            part.evaluator.set(input.position, number);
        }
        part.evaluator.run();
    }
}

fn value(parts: &[Part], output: Output) -> f64 {
    parts.get(output.part).map_or(f64::NAN, |part| output.unit.to_si(part.evaluator.get(output.position)))
}

impl Loads for DavemlVehicle {
    fn mass_properties(&mut self, _: &Condition) -> MassProperties {
        self.mass
    }

    fn loads(&mut self, c: &Condition) -> ForcesAndMoments {
        for (place, schedule) in &self.scheduled {
            self.given[*place] = schedule.at(c.time);
        }
        run(&mut self.parts, &self.given, Some(c));
        let of = |output: Output| value(&self.parts, output);
        let pressure = c.air.dynamic_pressure * self.area;
        let force = match self.force {
            Force::Body(axes) => axes.map(|axis| of(axis) * pressure),
            Force::LiftDrag([lift, drag, side]) => {
                let (s, cosine) = c.air.alpha.sin_cos();
                let [lift, drag, side] = [lift, drag, side].map(|coefficient| of(coefficient) * pressure);
                let backward = if c.air.speed > 0.0 { scale(c.air_velocity, -drag / c.air.speed) } else { [0.0; 3] };
                add(backward, [lift * s, side, -lift * cosine])
            }
        };
        let lengths = [self.span, self.chord, self.span];
        let about_reference = std::array::from_fn(|i| of(self.moment[i]) * pressure * lengths[i]);
        ForcesAndMoments {
            aerodynamic_force: force,
            aerodynamic_moment: add(about_reference, cross(self.arm, force)),
            other_force: self.thrust.map(|axis| axis.map_or(0.0, of)),
            other_moment: self.thrust_moment.map(|axis| axis.map_or(0.0, of)),
        }
    }

    fn uses_angle_rates(&self) -> bool {
        self.uses_angle_rates
    }
}
