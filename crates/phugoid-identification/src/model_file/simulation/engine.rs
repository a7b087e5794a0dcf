//! `largest_thrust`, `thrust` and `propeller`: what makes the thrust in a simulation.

use phugoid_aircraft::engine::{Along, Propeller, PropellerData, Schedule};
use phugoid_flight_data::quantity::Dimension;

use super::super::aircraft::Base;
use super::super::error::ModelFileError;
use super::super::parameter::{Parameter, Role};
use super::super::section::Section;
use crate::core::term::{Coefficient, Variable};

/// What makes the thrust of an aircraft that is flown.
#[derive(Clone, Debug, PartialEq)]
pub enum EngineData {
    /// A thrust, N, along the thrust line.
    Thrust(Schedule),
    /// A propeller.
    Propeller(Box<PropelledData>),
}

/// A propeller, the power that turns it, and what it does to the aircraft.
#[derive(Clone, Debug, PartialEq)]
pub struct PropelledData {
    /// The propeller.
    pub propeller: Propeller,
    /// Power of the engine at its shaft, W.
    pub power: Schedule,
    /// 1 where it turns to the right (clockwise) as seen from behind, -1 to the left.
    pub sense: f64,
    /// Terms of the aerodynamics that the slipstream makes larger.
    pub slipstream: Vec<Slipstream>,
}

/// A term of the aerodynamics whose surface stands in the slipstream.
#[derive(Clone, Debug, PartialEq)]
pub struct Slipstream {
    /// Name of the parameter of the term.
    pub parameter: String,
    /// What of the rise of the dynamic pressure in the slipstream the term feels, 0 to 1.
    pub share: f64,
}

/// The engine of the table `[simulation]`; none if it says nothing of it.
pub(super) fn engine(
    section: &Section,
    base: Base,
    parameters: &[Parameter],
) -> Result<Option<EngineData>, ModelFileError> {
    let given: Vec<&str> =
        ["largest_thrust", "thrust", "propeller"].into_iter().filter(|key| section.get(key).is_some()).collect();
    if let [first, second, ..] = given[..] {
        let message = format!("`{first}` and `{second}` both say what makes the thrust: give one of them");
        return Err(section.error(second, message));
    }
    if let Some(largest) = section.positive("largest_thrust", Dimension::FORCE)? {
        return Ok(Some(EngineData::Thrust(Schedule::constant(largest))));
    }
    if section.get("thrust").is_some() {
        return Ok(Some(EngineData::Thrust(schedule(section, "thrust", Dimension::FORCE)?)));
    }
    let Some(inner) = section.section("propeller")? else { return Ok(None) };
    if base != Base::None {
        let message = "`propeller`: the aircraft of the base has engines of its own; with a base give `thrust` at most";
        return Err(section.error("propeller", message));
    }
    propelled(&inner, parameters).map(|data| Some(EngineData::Propeller(Box::new(data))))
}

/// A quantity at full throttle, or a table over throttle, Mach number or speed, and altitude.
fn schedule(section: &Section, key: &str, dimension: Dimension) -> Result<Schedule, ModelFileError> {
    if !section.get(key).is_some_and(|value| value.get_ref().is_table()) {
        return section.required_positive(key, dimension).map(Schedule::constant);
    }
    let Some(table) = section.section(key)? else { return Err(section.missing(key, "a table")) };
    let words = Along::ALL.map(Along::name);
    table.allow("key", words.into_iter().chain(["values"]))?;
    if table.get("mach").is_some() && table.get("speed").is_some() {
        return Err(table.error("speed", "`mach` and `speed` say the same at an altitude: give one of them"));
    }
    let mut axes = Vec::new();
    for along in Along::ALL {
        let of = match along {
            Along::Throttle | Along::Mach => Dimension::NUMBER,
            Along::Speed => Dimension::SPEED,
            Along::Altitude => Dimension::LENGTH,
        };
        if let Some(points) = table.list_of(along.name(), of)? {
            axes.push((along, points));
        }
    }
    if axes.is_empty() {
        let expected = "one or more axes of throttle, mach or speed, altitude; without an axis it is a plain quantity";
        return Err(table.missing("mach", expected));
    }
    let shape: Vec<(&str, usize)> = axes.iter().map(|(along, points)| (along.name(), points.len())).collect();
    let expected = format!("{} as lists of lists, one for each axis", dimension.si_unit());
    let values = table.table_of("values", dimension, &shape)?.ok_or_else(|| table.missing("values", &expected))?;
    Schedule::new(axes, values).map_err(|error| table.error("values", format!("`{key}`: {error}")))
}

fn propelled(section: &Section, parameters: &[Parameter]) -> Result<PropelledData, ModelFileError> {
    const KEYS: [&str; 9] = [
        "diameter",
        "most_speed",
        "rotation",
        "advance_ratio",
        "pitch",
        "thrust_coefficient",
        "power_coefficient",
        "power",
        "slipstream",
    ];
    section.allow("key", KEYS.into_iter())?;
    let list = |key: &str, dimension: Dimension| section.list_of(key, dimension);
    let advance_ratio = list("advance_ratio", Dimension::NUMBER)?
        .ok_or_else(|| section.missing("advance_ratio", "V/(n D) of the coefficients, two or more that increase"))?;
    let pitch_rad = list("pitch", Dimension::ANGLE)?;
    let mut shape = vec![("advance_ratio", advance_ratio.len())];
    shape.extend(pitch_rad.iter().map(|pitch| ("pitch", pitch.len())));
    let coefficient = |key: &str, formula: &str| {
        let values = section.table_of(key, Dimension::NUMBER, &shape)?;
        values.ok_or_else(|| section.missing(key, &format!("{formula}, one for each advance ratio")))
    };
    let data = PropellerData {
        diameter_m: section.required_positive("diameter", Dimension::LENGTH)?,
        most_turns_s: section.required_positive("most_speed", Dimension::TURNS)?,
        thrust_coefficient: coefficient("thrust_coefficient", "T/(rho n^2 D^4)")?,
        power_coefficient: coefficient("power_coefficient", "P/(rho n^3 D^5)")?,
        advance_ratio,
        pitch_rad: pitch_rad.unwrap_or_default(),
    };
    let rotation = section.word("rotation", &["right", "left"])?;
    let rotation = rotation.ok_or_else(|| section.missing("rotation", "\"right\" or \"left\", as seen from behind"))?;
    let propeller = Propeller::new(data).map_err(|error| {
        section.source.error(section.span.clone(), &section.path, format!("in [{}]: {error}", section.path))
    })?;
    Ok(PropelledData {
        propeller,
        power: schedule(section, "power", Dimension::POWER)?,
        sense: if rotation == "right" { 1.0 } else { -1.0 },
        slipstream: slipstream(section, parameters)?,
    })
}

/// The terms in the slipstream, by the names of their parameters.
fn slipstream(section: &Section, parameters: &[Parameter]) -> Result<Vec<Slipstream>, ModelFileError> {
    let Some(inner) = section.section("slipstream")? else { return Ok(Vec::new()) };
    // The rate of the angle of attack is solved for with the motion, in which the thrust is no unknown.
    let blown = |parameter: &&Parameter| match &parameter.role {
        Role::Term(_, term) => term.powers().all(|(variable, _)| variable != Variable::AlphaRate.index()),
        _ => false,
    };
    inner.allow("term", parameters.iter().filter(blown).map(|parameter| parameter.name.as_str()))?;
    let shares = inner.keys().into_iter().map(|(name, _)| {
        let share = inner.number(name, Dimension::NUMBER)?.unwrap_or(0.0);
        if !(0.0..=1.0).contains(&share) {
            let message = format!("`{name}` is {share}: expected the part of the slipstream that it feels, 0 to 1");
            return Err(inner.error(name, message));
        }
        Ok(Slipstream { parameter: name.to_owned(), share })
    });
    shares.collect()
}

impl EngineData {
    /// Where the schedule of thrust or power ends: along speed (m/s), Mach number, altitude (m).
    pub(crate) fn ends(&self, along: Along) -> Option<[f64; 2]> {
        match self {
            Self::Thrust(schedule) => schedule.ends(along),
            Self::Propeller(propelled) => propelled.power.ends(along),
        }
    }
}

impl PropelledData {
    /// The terms in the slipstream with their coefficient and share.
    pub(crate) fn blown<'a>(
        &'a self,
        parameters: &'a [Parameter],
    ) -> impl Iterator<Item = (Coefficient, &'a Parameter, f64)> {
        self.slipstream.iter().filter_map(|blown| {
            let parameter = parameters.iter().find(|parameter| parameter.name == blown.parameter)?;
            let Role::Term(coefficient, _) = &parameter.role else { return None };
            Some((*coefficient, parameter, blown.share))
        })
    }
}
