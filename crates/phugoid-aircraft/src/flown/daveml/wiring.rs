//! Where each input of models in DAVE-ML gets its value, and the evaluation of all models in turn.

use std::path::Path;

use phugoid_flight_dynamics::scalar::Scalar;

use super::super::error::FlownError;
use super::feed::{Feed, Flow};
use crate::daveml::{Evaluator, Model, Role, Unit, Variable};
use crate::vehicle::VehicleError;
use crate::vehicle::named::{LENGTH, NUMBER, Output, PRESSURE, RATE, SPEED, any_unit, unit};

/// Quantities of the flight by their names, compared without regard to capitals.
const QUANTITIES: [(&str, [i8; 5], Feed); 19] = [
    ("trueAirspeed", SPEED, Feed::Speed),
    ("equivalentAirspeed", SPEED, Feed::EquivalentAirspeed),
    ("angleOfAttack", NUMBER, Feed::Alpha),
    ("angleOfSideslip", NUMBER, Feed::Beta),
    ("angleOfAttackRate", RATE, Feed::AlphaRate),
    // As `phugoid estimate --export daveml` writes it.
    ("alpha_dot", RATE, Feed::AlphaRate),
    ("angleOfSideslipRate", RATE, Feed::BetaRate),
    ("bodyAngularRate_Roll", RATE, Feed::RollRate),
    ("bodyAngularRate_Pitch", RATE, Feed::PitchRate),
    ("bodyAngularRate_Yaw", RATE, Feed::YawRate),
    ("eulerAngle_Pitch", NUMBER, Feed::PitchAngle),
    ("mach", NUMBER, Feed::Mach),
    ("dynamicPressure", PRESSURE, Feed::DynamicPressure),
    ("ambientPressure", PRESSURE, Feed::Pressure),
    ("ambientTemperature", [0, 0, 0, 1, 0], Feed::Temperature),
    ("airDensity", [-3, 1, 0, 0, 0], Feed::Density),
    ("speedOfSound", SPEED, Feed::SpeedOfSound),
    ("altitudeMsl", LENGTH, Feed::Altitude),
    ("geometricAltitude", LENGTH, Feed::Altitude),
];

/// Controls by their names; a surface has that of the standard and that of Phugoid's own files.
const CONTROLS: [(&str, Feed); 9] = [
    ("elevatorDeflection", Feed::Elevator),
    ("elevator", Feed::Elevator),
    ("aileronDeflection", Feed::Aileron),
    ("aileron", Feed::Aileron),
    ("rudderDeflection", Feed::Rudder),
    ("rudder", Feed::Rudder),
    ("powerLeverAngle", Feed::Throttle),
    ("throttlePosition", Feed::Throttle),
    ("pilotControl_throttle", Feed::Throttle),
];

/// What files write of the direction that is positive where it is against the signs of the equations of motion: elevator with
/// its trailing edge up, aileron that rolls to the right, rudder with its trailing edge to the right. Compared without capitals,
/// blanks and plus signs.
const AGAINST: [(Feed, &[&str]); 3] = [
    (Feed::Elevator, &["trailingedgeup", "teu", "noseup", "anu", "nu"]),
    (Feed::Aileron, &["rightroll", "rollright", "rwd", "rightwingdown", "rteu", "lted"]),
    (Feed::Rudder, &["trailingedgeright", "ter", "noseright", "anr", "nr"]),
];

#[derive(Clone, Copy, Debug)]
enum Source {
    Feed(Feed),
    /// An output of a model before.
    Output(Output),
}

/// An input of a model: in its unit it is `offset + slope` times the source in SI.
#[derive(Clone, Copy, Debug)]
struct Link {
    position: usize,
    source: Source,
    slope: f64,
    offset: f64,
}

/// The models in an order in which each comes after those whose variables it uses, and where their inputs come from.
#[derive(Clone, Debug)]
pub(super) struct Wiring {
    models: Vec<Model>,
    links: Vec<Vec<Link>>,
    /// Numbers that were given, by position, of each model.
    given: Vec<Vec<(usize, f64)>>,
    /// For each model, which models it needs, itself among them.
    needs: Vec<Vec<bool>>,
}

/// Where a control enters the models, for its limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry<'a> {
    pub(super) model: &'a Model,
    pub(super) position: usize,
    slope: f64,
    offset: f64,
}

impl Entry<'_> {
    /// The variable.
    pub(super) fn variable(&self) -> &Variable {
        &self.model.variables()[self.position]
    }

    /// A value in the unit of the file in SI, in the sign of the equations of motion.
    pub(super) fn si(&self, value: f64) -> f64 {
        (value - self.offset) / self.slope
    }
}

impl Wiring {
    /// Connects models, with numbers for variables by name or identifier; a number for a name that no model has is left out.
    pub(super) fn new(
        models: Vec<Model>,
        properties: &[(String, f64)],
        file: &Path,
        notes: &mut Vec<String>,
    ) -> Result<Self, FlownError> {
        let models = ordered(models, properties, file)?;
        let vehicle = |source| FlownError::Vehicle { file: file.into(), source };
        let mut wiring = Self { links: Vec::new(), given: Vec::new(), needs: Vec::new(), models };
        let mut open = Vec::new();
        for (part, model) in wiring.models.iter().enumerate() {
            let given: Vec<(usize, f64)> = properties
                .iter()
                .filter_map(|(name, value)| Some((model.input_position(name).ok()?, *value)))
                .collect();
            let mut links = Vec::new();
            let mut needs: Vec<bool> = (0..=part).map(|other| other == part).collect();
            for (&position, variable) in model.input_positions().iter().zip(model.inputs()) {
                if given.iter().any(|(other, _)| *other == position) {
                    continue;
                }
                let name = variable.name.as_str();
                if let Some(feed) = control(name) {
                    let (slope, offset) = scale_of_control(feed, model, position).map_err(vehicle)?;
                    links.push(Link { position, source: Source::Feed(feed), slope, offset });
                } else if let Some(output) = before(&wiring.models[..part], name, any_unit(&variable.units)) {
                    for (need, of) in needs.iter_mut().zip(&wiring.needs[output.part]) {
                        *need |= *of;
                    }
                    let own = any_unit(&variable.units);
                    let (slope, offset) = line(own, 1.0);
                    links.push(Link { position, source: Source::Output(output), slope, offset });
                } else if let Some((_, dimension, feed)) =
                    QUANTITIES.iter().find(|(known, ..)| name.eq_ignore_ascii_case(known))
                {
                    let own = unit(name, &variable.units, *dimension).map_err(vehicle)?;
                    let (slope, offset) = line(own, 1.0);
                    links.push(Link { position, source: Source::Feed(*feed), slope, offset });
                } else if let Some(value) = variable.initial {
                    notes.push(format!("{name} stays at {value} {}, as in its file.", variable.units.trim()));
                } else {
                    open.push(name.to_owned());
                }
            }
            wiring.given.push(given);
            wiring.links.push(links);
            wiring.needs.push(needs);
        }
        if open.is_empty() { Ok(wiring) } else { Err(FlownError::Open { file: file.into(), names: open }) }
    }

    /// The same with another model in the place of one, which has the same variables.
    pub(super) fn with_model(mut self, part: usize, model: Model) -> Self {
        self.models[part] = model;
        self
    }

    pub(super) fn models(&self) -> &[Model] {
        &self.models
    }

    /// Whether a model reads a quantity.
    pub(super) fn reads(&self, feed: Feed) -> bool {
        self.entry(feed).is_some()
    }

    /// Where a quantity enters first.
    pub(super) fn entry(&self, feed: Feed) -> Option<Entry<'_>> {
        self.entries(feed).next()
    }

    /// Everywhere that a quantity enters.
    pub(super) fn entries(&self, feed: Feed) -> impl Iterator<Item = Entry<'_>> {
        let all = self.models.iter().zip(&self.links).flat_map(|(model, links)| links.iter().map(move |l| (model, l)));
        all.filter(move |(_, link)| matches!(link.source, Source::Feed(other) if other == feed))
            .map(|(model, link)| Entry { model, position: link.position, slope: link.slope, offset: link.offset })
    }

    /// What evaluates the models, one for each, with the numbers that were given.
    pub(super) fn evaluators<T: Scalar>(&self) -> Vec<Evaluator<T>> {
        let with = |(model, given): (&Model, &Vec<(usize, f64)>)| {
            let mut evaluator = model.evaluator_of::<T>();
            for (position, value) in given {
                evaluator.set(*position, T::from(*value));
            }
            evaluator
        };
        self.models.iter().zip(&self.given).map(with).collect()
    }

    /// Which models have to be evaluated for these outputs.
    pub(super) fn parts_of(&self, outputs: &[Output]) -> u64 {
        let needs = outputs.iter().filter_map(|output| self.needs.get(output.part));
        needs
            .flat_map(|needs| needs.iter().enumerate().filter(|(_, need)| **need))
            .fold(0, |parts, (k, _)| parts | 1 << k)
    }

    /// Evaluates those models whose bits are set, in turn.
    pub(super) fn run<T: Scalar>(&self, evaluators: &mut [Evaluator<T>], flow: &Flow<T>, parts: u64) {
        for (part, links) in self.links.iter().enumerate().filter(|(part, _)| parts >> part & 1 == 1) {
            let (before, rest) = evaluators.split_at_mut(part);
            let Some(evaluator) = rest.first_mut() else { break };
            for link in links {
                let si = match link.source {
                    Source::Feed(feed) => flow[feed as usize],
                    Source::Output(output) => value(before, output),
                };
                evaluator.set(link.position, si * link.slope + link.offset);
            }
            evaluator.run();
        }
    }
}

/// An output in SI.
pub(super) fn value<T: Scalar>(evaluators: &[Evaluator<T>], output: Output) -> T {
    let Some(evaluator) = evaluators.get(output.part) else { return T::from(f64::NAN) };
    evaluator.get(output.position) * output.unit.factor + output.unit.offset
}

fn control(name: &str) -> Option<Feed> {
    CONTROLS.iter().find(|(known, _)| name.eq_ignore_ascii_case(known)).map(|(_, feed)| *feed)
}

/// Slope and offset from SI to a unit.
fn line(unit: Unit, sign: f64) -> (f64, f64) {
    (sign / unit.factor, -unit.offset / unit.factor)
}

/// Slope and offset from a control to its variable.
fn scale_of_control(feed: Feed, model: &Model, position: usize) -> Result<(f64, f64), VehicleError> {
    let variable = &model.variables()[position];
    let own = unit(&variable.name, &variable.units, NUMBER)?;
    if feed != Feed::Throttle {
        let word: String = variable.sign.to_lowercase().chars().filter(|c| !" +-_/".contains(*c)).collect();
        let against = AGAINST.iter().any(|(of, words)| *of == feed && words.contains(&word.as_str()));
        return Ok(line(own, if against { -1.0 } else { 1.0 }));
    }
    // A share of full throttle; of a lever that turns, what its limits or its tables say.
    if own.factor == 1.0 && !variable.units.trim().starts_with('r') || own.factor == 0.01 {
        return Ok(line(own, 1.0));
    }
    let limits = variable.minimum.zip(variable.maximum).map(|(low, high)| [low, high]);
    match limits.or_else(|| model.table_ends(position)) {
        Some([low, high]) if low < high => Ok((high - low, low)),
        _ => Err(VehicleError::Unit { name: variable.name.clone(), units: variable.units.clone() }),
    }
}

/// The last variable of these models with this name that is computed or has a value, in a unit of the same kind.
fn before(models: &[Model], name: &str, own: Unit) -> Option<Output> {
    models.iter().enumerate().rev().find_map(|(part, model)| {
        let suits = |v: &&Variable| gives(v, name) && any_unit(&v.units).dimension == own.dimension;
        let variable = model.variables().iter().filter(suits).max_by_key(|variable| variable.is_output)?;
        Some(Output { part, position: model.position(&variable.id).ok()?, unit: any_unit(&variable.units) })
    })
}

fn gives(variable: &Variable, name: &str) -> bool {
    variable.role != Role::Input && variable.name.eq_ignore_ascii_case(name)
}

/// The models, each after those whose variables it uses.
fn ordered(models: Vec<Model>, properties: &[(String, f64)], file: &Path) -> Result<Vec<Model>, FlownError> {
    // A word of bits says which are evaluated.
    const MOST: usize = 64;
    if models.len() > MOST {
        return Err(FlownError::Number {
            what: "the number of files",
            value: models.len() as f64,
            expected: "64 or less",
        });
    }
    let given = |model: &Model, position: usize| {
        properties.iter().any(|(name, _)| model.input_position(name).is_ok_and(|other| other == position))
    };
    let needs = |user: &Model, other: &Model| {
        let mut inputs = user.input_positions().iter().zip(user.inputs());
        inputs.any(|(&position, input)| {
            control(&input.name).is_none()
                && !given(user, position)
                && other.variables().iter().any(|variable| gives(variable, &input.name))
        })
    };
    let mut waiting: Vec<Model> = models;
    let mut ordered = Vec::new();
    while !waiting.is_empty() {
        let free = (0..waiting.len())
            .find(|&k| waiting.iter().enumerate().all(|(other, model)| other == k || !needs(&waiting[k], model)));
        let Some(free) = free else {
            let names = waiting.iter().map(|model| model.header().name.clone()).collect();
            return Err(FlownError::Circle { file: file.into(), models: names });
        };
        ordered.push(waiting.remove(free));
    }
    Ok(ordered)
}
