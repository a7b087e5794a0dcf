//! Engines: where their thrust acts, and how much of it there is.

use roxmltree::Node;

use super::aerodynamics::cross;
use super::error::{JsbsimError, Omission};
use super::files::{Files, Kind};
use super::function::{self, Op};
use super::mass::{Masses, arm_ft, give};
use super::model::{Lookup, Model, State};
use super::source::{Source, child, children, shortened, tag};
use super::table::Table;
use super::units::{POUND_FORCE, Unit};
use crate::xml;

/// An engine of an aircraft.
#[derive(Debug, Clone)]
pub struct Engine {
    /// What its file describes.
    pub kind: EngineKind,
    /// Name of its file.
    pub file: String,
    /// Where its thrust acts, in the structural frame (x aft, y right, z up), m.
    pub location_m: [f64; 3],
    /// Direction of its thrust in body axes (x forward, y right, z down), length 1.
    pub direction: [f64; 3],
    location_in: [f64; 3],
    turbine: Option<Turbine>,
}

/// What the file of an engine describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum EngineKind {
    /// A turbine: its thrust follows from throttle, Mach number and height, without delay.
    Turbine,
    /// Another engine: its thrust is what is set.
    ConstantForce,
}

/// Thrust of a turbine without its spool: pounds, and functions of the flight that multiply them.
#[derive(Debug, Clone)]
struct Turbine {
    dry_lb: f64,
    wet_lb: f64,
    idle: usize,
    dry: usize,
    wet: Option<usize>,
    /// How the afterburner is lit.
    augmentation: f64,
    throttle: usize,
    augment: usize,
    injected: bool,
}

impl Engine {
    /// Thrust of a turbine at the throttle and the flight that the properties hold, N; `None` for another engine.
    pub(super) fn turbine_thrust_n(&self, model: &Model, state: &mut State) -> Option<f64> {
        let turbine = self.turbine.as_ref()?;
        let throttle = state.read(model, turbine.throttle).max(0.0);
        let idle = turbine.dry_lb * state.call(model, turbine.idle);
        let span = (turbine.dry_lb - idle) * state.call(model, turbine.dry);
        // Method 2 uses the throttle beyond 1 for the afterburner.
        let spool = throttle.min(1.0);
        let mut pounds = idle + span * spool * spool;
        if let Some(wet) = turbine.wet {
            let full = turbine.wet_lb * state.call(model, wet);
            if turbine.augmentation == 1.0 && throttle > 0.99 {
                pounds = full;
            } else if turbine.augmentation == 2.0 {
                let part = (throttle - 1.0).max(state.read(model, turbine.augment)).clamp(0.0, 1.0);
                pounds += (full - pounds) * part;
            }
        }
        Some(pounds * POUND_FORCE)
    }

    /// Moment about a centre of gravity, in inches in the structural frame, of a thrust; body axes, N and N m.
    pub(super) fn force_moment(&self, thrust_n: f64, centre_in: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let force = self.direction.map(|part| part * thrust_n);
        let arm = arm_ft(self.location_in, centre_in).map(|feet| feet * super::units::FOOT);
        (force, cross(arm, force))
    }
}

/// Reads `<propulsion>`.
pub(super) fn read(
    model: &mut Model,
    masses: &mut Masses,
    files: &mut Files,
    source: &Source,
    node: Node<'_, '_>,
    omitted: &mut Vec<Omission>,
) -> Result<Vec<Engine>, JsbsimError> {
    let mut engines = Vec::new();
    for part in children(node) {
        match tag(part) {
            "engine" => {
                let engine = read_engine(model, files, source, part, engines.len(), omitted)?;
                engines.push(engine);
            }
            "tank" => masses.read_tank(model, source, part)?,
            "documentation" | "description" => {}
            "property" => super::declare(model, source, part)?,
            other => omitted.push(source.omit(part, format!("<{}> is left out", shortened(other)))),
        }
    }
    Ok(engines)
}

fn read_engine(
    model: &mut Model,
    files: &mut Files,
    source: &Source,
    node: Node<'_, '_>,
    number: usize,
    omitted: &mut Vec<Omission>,
) -> Result<Engine, JsbsimError> {
    let file = node.attribute("file").unwrap_or_default().trim().to_owned();
    let thruster = child(node, "thruster");
    // The place of the thruster is that of the thrust; older files give only that of the engine.
    let within = |name: &str| thruster.and_then(|thruster| child(thruster, name)).or_else(|| child(node, name));
    let location_in = match within("location") {
        Some(place) => source.triplet(place, Unit::Inch)?,
        None => [0.0; 3],
    };
    let direction = match within("orient") {
        None => [1.0, 0.0, 0.0],
        Some(orient) => {
            let unit = orient.attribute("unit").unwrap_or("RAD").trim();
            let factor = Unit::Radian
                .factor_from(unit)
                .ok_or_else(|| source.refuse(orient, format!("the unit \"{}\" is not known", shortened(unit))))?;
            let pitch = factor * source.child_number(orient, "pitch")?.unwrap_or(0.0);
            let yaw = factor * source.child_number(orient, "yaw")?.unwrap_or(0.0);
            [pitch.cos() * yaw.cos(), pitch.cos() * yaw.sin(), -pitch.sin()]
        }
    };
    let mut engine = Engine {
        kind: EngineKind::ConstantForce,
        file: file.clone(),
        location_m: location_in.map(|inch| inch * super::units::INCH),
        direction,
        location_in,
        turbine: None,
    };
    let (path, text) = match files.text(source, node, &file, Kind::Engine) {
        Ok(found) => found,
        Err(error) => {
            omitted.push(
                source.omit(node, format!("engine {number}: its thrust is what is set, a constant force: {error}")),
            );
            return Ok(engine);
        }
    };
    let inside = Source::new(path.clone(), &text);
    let document = xml::parse(&text).map_err(|source| JsbsimError::Xml { file: path, source })?;
    let root = document.root_element();
    let direct = match thruster.and_then(|thruster| thruster.attribute("file")) {
        None => true,
        Some(name) => match files.text(source, node, name, Kind::Engine) {
            Err(_) => false,
            Ok((path, text)) => {
                let thruster = xml::parse(&text).map_err(|source| JsbsimError::Xml { file: path.clone(), source })?;
                tag(thruster.root_element()) == "direct"
            }
        },
    };
    let read = if tag(root) == "turbine_engine" && direct {
        turbine(model, &inside, root, number)
    } else {
        Err(inside.refuse(root, format!("<{}> is not supported", shortened(tag(root)))))
    };
    match read {
        Ok(turbine) => {
            let injected = if turbine.injected { ", and without injection of water" } else { "" };
            omitted.push(
                source.omit(node, format!("engine {number}: its thrust follows the throttle without delay{injected}")),
            );
            engine.turbine = Some(turbine);
            engine.kind = EngineKind::Turbine;
        }
        Err(error) => {
            omitted.push(
                source.omit(node, format!("engine {number}: its thrust is what is set, a constant force: {error}")),
            );
        }
    }
    Ok(engine)
}

fn turbine(model: &mut Model, source: &Source, root: Node<'_, '_>, number: usize) -> Result<Turbine, JsbsimError> {
    let value = |name: &str| source.child_number(root, name).map(|found| found.unwrap_or(0.0));
    let pounds = |name: &str| source.child_quantity(root, name, Unit::Pound).map(|found| found.unwrap_or(0.0));
    let (dry_lb, wet_lb) = (pounds("milthrust")?, pounds("maxthrust")?);
    let mut factor = |name: &str| -> Result<Option<usize>, JsbsimError> {
        for part in children(root).filter(|part| part.attribute("name").is_some_and(|found| found.trim() == name)) {
            match tag(part) {
                "function" => return function::read_without_name(model, source, part).map(Some),
                "table" => return internal(model, source, part).map(Some),
                _ => {}
            }
        }
        Ok(None)
    };
    let missing = |name: &str| source.refuse(root, format!("the turbine has no function {name}"));
    let idle = factor("IdleThrust")?.ok_or_else(|| missing("IdleThrust"))?;
    let dry = factor("MilThrust")?.ok_or_else(|| missing("MilThrust"))?;
    let wet = factor("AugThrust")?;
    let augmentation = if value("augmented")? == 1.0 { value("augmethod")? } else { 0.0 };
    let throttle = format!("fcs/throttle-pos-norm[{number}]");
    give(model, &throttle, 0.0);
    Ok(Turbine {
        dry_lb,
        wet_lb,
        idle,
        dry,
        wet: if augmentation == 0.0 { None } else { wet },
        augmentation,
        throttle: model.property(&throttle),
        augment: model.property(&format!("fcs/augment-cmd-norm[{number}]")),
        injected: value("injected")? == 1.0,
    })
}

/// A table over Mach number and density altitude.
fn internal(model: &mut Model, source: &Source, node: Node<'_, '_>) -> Result<usize, JsbsimError> {
    if child(node, "independentVar").is_some() {
        let table = function::read_table(model, source, node)?;
        return Ok(function::define(model, source, node, vec![Op::Table(table)], None));
    }
    let dimensions = Table::dimensions(node);
    let table = Table::read(source, node, dimensions)?;
    let variables = [
        Some((model.property("velocities/mach"), 1.0)),
        (dimensions > 1).then(|| (model.property("atmosphere/density-altitude"), 1.0)),
        None,
    ];
    model.tables.push(Lookup { table, variables });
    let made = model.tables.len() - 1;
    Ok(function::define(model, source, node, vec![Op::Table(made)], None))
}
