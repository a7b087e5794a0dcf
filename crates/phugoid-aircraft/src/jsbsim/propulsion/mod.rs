//! Engines: where their thrust acts, and how much of it there is.

mod balance;
mod given;
mod piston;
mod propeller;
mod turboprop;

use roxmltree::Node;

use balance::Engine as Turning;
pub(super) use balance::Guess;
pub(crate) use given::{GivenPropeller, GivenTables};
use piston::Air;
use propeller::{Inflow, Power, Propeller};

use super::aerodynamics::cross;
use super::error::{JsbsimError, Omission};
use super::files::{Files, Kind};
use super::function::{self, Op};
use super::mass::{Masses, arm_ft, give};
use super::model::{Lookup, Model};
use super::source::{Source as File, child, children, shortened, tag};
use super::table::Table;
use super::units::{POUND_FORCE, PSF, Unit};
use crate::xml;

/// A smaller `p_factor` is none.
const LEAST_P_FACTOR: f64 = 1e-4;
/// Most values that an engine reads.
pub(super) const INPUTS: usize = 17;

/// Where a value that an engine reads comes from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Source {
    /// A property.
    Property(usize),
    /// A function.
    Function(usize),
}

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
    drive: Drive,
}

/// What makes the thrust of an engine.
#[derive(Debug, Clone)]
enum Drive {
    None,
    Turbine(Turbine),
    Propeller(Box<Propelled>),
}

/// A propeller and what turns it.
#[derive(Debug, Clone)]
struct Propelled {
    power: Power,
    propeller: Propeller,
    /// 1 for one that turns to the right as seen from behind, -1 to the left.
    sense: f64,
    p_factor: f64,
    throttle: usize,
    lever: usize,
    /// The mixture lever of a piston engine; the function of a turboprop's power over pressure and speed.
    factor: Option<Source>,
    inflow: [usize; 14],
}

/// What the file of an engine describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum EngineKind {
    /// A turbine: its thrust follows from throttle, Mach number and height, without delay.
    Turbine,
    /// A propeller: it turns as fast as the power of its engine turns it at the throttle, without delay. That of a piston engine
    /// follows from the pressure behind the throttle and from the mixture lever (`fcs/mixture-pos-norm[k]`, which begins at 1), that of a
    /// turboprop from its tables at the speed of the gas generator that the throttle sets; an electric one's is in proportion to the
    /// throttle.
    Propeller,
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
    /// Share of the thrust that is lost to air for other uses.
    bleed: f64,
    injected: bool,
}

/// What an engine does: force and moment in body axes, the moment about the centre of gravity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    /// Pounds.
    pub(super) force_lb: [f64; 3],
    /// Foot pounds.
    pub(super) moment_ft_lb: [f64; 3],
    /// Thrust, pounds.
    pub(super) thrust_lb: f64,
    /// Speed of its propeller, turns per minute; 0 without one.
    pub(super) rpm: f64,
}

impl Engine {
    /// The most of its throttle (`fcs/throttle-pos-norm`) that does not light an afterburner.
    pub(crate) fn dry_throttle(&self) -> f64 {
        match &self.drive {
            Drive::Turbine(turbine) if turbine.wet.is_some() && turbine.augmentation == 1.0 => 0.99,
            _ => 1.0,
        }
    }

    /// Whether its thrust acts beside its axis where the air comes from the side (`p_factor`).
    pub(crate) fn has_p_factor(&self) -> bool {
        matches!(&self.drive, Drive::Propeller(propelled) if propelled.p_factor > LEAST_P_FACTOR)
    }

    /// What it reads, at most [`INPUTS`].
    pub(super) fn sources(&self) -> impl Iterator<Item = Source> {
        let mut sources = [None; INPUTS];
        match &self.drive {
            Drive::None => {}
            Drive::Turbine(turbine) => {
                let functions = [Some(turbine.idle), Some(turbine.dry), turbine.wet];
                sources[0] = Some(Source::Property(turbine.throttle));
                for (source, function) in sources[1..].iter_mut().zip(functions) {
                    *source = function.map(Source::Function);
                }
            }
            Drive::Propeller(propelled) => {
                let properties = propelled.inflow.into_iter().chain([propelled.throttle, propelled.lever]);
                let read = properties.map(Source::Property).chain(propelled.factor);
                for (source, read) in sources.iter_mut().zip(read) {
                    *source = Some(read);
                }
            }
        }
        sources.into_iter().flatten()
    }

    /// What it does about a centre of gravity, in inches in the structural frame. `inputs` are the values of its sources, and `set`
    /// is what was set from outside: a thrust, N, or the speed of a propeller, turns per minute.
    pub(super) fn push(
        &self,
        inputs: &[f64; INPUTS],
        set: Option<f64>,
        centre_in: [f64; 3],
        guess: &mut Guess,
    ) -> Push {
        let thrust_lb = match &self.drive {
            Drive::None => set.unwrap_or(0.0) / POUND_FORCE,
            Drive::Turbine(turbine) => turbine.thrust_lb(inputs),
            Drive::Propeller(propelled) => return self.propelled(propelled, inputs, set, centre_in, guess),
        };
        let force_lb = self.direction.map(|part| part * thrust_lb);
        Push { force_lb, moment_ft_lb: cross(arm_ft(self.location_in, centre_in), force_lb), thrust_lb, rpm: 0.0 }
    }

    fn propelled(
        &self,
        propelled: &Propelled,
        inputs: &[f64; INPUTS],
        rpm: Option<f64>,
        centre_in: [f64; 3],
        guess: &mut Guess,
    ) -> Push {
        let &[u, v, w, p, q, r, density, sound, pi, qi, ri, pressure, temperature, qbar, throttle, lever, factor] =
            inputs;
        let arm = arm_ft(self.location_in, centre_in);
        let turning = cross([p, q, r], arm);
        let local = [u + turning[0], v + turning[1], w + turning[2]];
        let axis = self.direction;
        let along_ft_s = (0..3).map(|k| local[k] * axis[k]).sum();
        let inflow = Inflow { along_ft_s, density, sound_ft_s: sound };
        let work = match rpm {
            Some(rpm) => propelled.propeller.at(&inflow, rpm.max(0.0), propelled.propeller.fine_pitch_deg()),
            None => {
                let air = Air { pressure_pa: pressure * PSF, temperature_k: temperature / 1.8, ram_pa: qbar * PSF };
                let engine = Turning::new(&propelled.power, throttle, factor, &air);
                propelled.propeller.balance(&inflow, &engine, lever, guess)
            }
        };
        let mut place = self.location_in;
        let across = local[1].hypot(local[2]);
        if propelled.p_factor > LEAST_P_FACTOR && across > 1e-4 {
            // The blade that goes down meets more air: thrust acts beside the axis.
            let factor = propelled.sense * propelled.p_factor * across.atan2(along_ft_s) / across;
            place[1] += factor * local[2];
            place[2] += factor * local[1];
        }
        let force_lb = axis.map(|part| part * work.thrust_lb);
        let lever = cross(arm_ft(place, centre_in), force_lb);
        let spin = propelled.sense * propelled.propeller.inertia * work.rpm / 60.0 * 2.0 * std::f64::consts::PI;
        let gyroscopic = cross([pi, qi, ri], axis.map(|part| part * spin * propelled.propeller.gyroscopic));
        let mut moment_ft_lb = [0.0; 3];
        for k in 0..3 {
            moment_ft_lb[k] = lever[k] - propelled.sense * work.torque_ft_lb * axis[k] + gyroscopic[k];
        }
        Push { force_lb, moment_ft_lb, thrust_lb: work.thrust_lb, rpm: work.rpm }
    }
}

impl Turbine {
    /// Thrust at the throttle and the values of its functions, pounds.
    fn thrust_lb(&self, &[throttle, idle, dry, wet, ..]: &[f64; INPUTS]) -> f64 {
        let throttle = throttle.max(0.0);
        let idle = self.dry_lb * idle;
        let span = (self.dry_lb - idle) * dry;
        let spool = throttle.min(1.0);
        let dry = idle + span * spool * spool;
        if self.wet.is_some() {
            let full = self.wet_lb * wet;
            if self.augmentation == 1.0 && throttle > 0.99 {
                return full;
            }
            // The throttle beyond 1 is that of the afterburner.
            if self.augmentation == 2.0 && throttle > 1.0 {
                return dry + (full - dry) * (throttle - 1.0).min(1.0);
            }
        }
        // With the afterburner, no air is taken for other uses.
        dry * (1.0 - self.bleed)
    }
}

/// Reads `<propulsion>`.
pub(super) fn read(
    model: &mut Model,
    masses: &mut Masses,
    files: &mut Files,
    source: &File,
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
            "documentation" | "description" | "limitation" | "note" | "property" | "function" => {}
            other => omitted.push(source.omit(part, format!("<{}> is left out", shortened(other)))),
        }
    }
    Ok(engines)
}

fn read_engine(
    model: &mut Model,
    files: &mut Files,
    source: &File,
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
        drive: Drive::None,
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
    let inside = File::new(path.clone(), &text);
    let document = xml::parse(&text).map_err(|source| JsbsimError::Xml { file: path, source })?;
    let root = document.root_element();
    // JSBSim makes a property of each named function of an engine, whatever becomes of the engine here.
    for part in root.descendants().filter(|part| tag(*part) == "function") {
        let name = part.attribute("name").unwrap_or_default().replace('#', &number.to_string());
        if function::is_property_name(&name) {
            let made = model.property(&name);
            model.properties[made].left_out = true;
        }
    }
    let read = drive(model, files, source, node, &inside, root, number);
    let note = match read {
        Ok(Drive::Turbine(turbine)) => {
            let injected = if turbine.injected { ", and without injection of water" } else { "" };
            (engine.kind, engine.drive) = (EngineKind::Turbine, Drive::Turbine(turbine));
            format!("engine {number}: its thrust follows the throttle without delay{injected}")
        }
        Ok(drive) => {
            let runs = match &drive {
                Drive::Propeller(propelled) => match propelled.power {
                    Power::Piston(_) => {
                        " at the mixture of its lever (fcs/mixture-pos-norm, 1 unless it is set: full rich)"
                    }
                    Power::Turboprop(_) => " at the speed of the gas generator that the throttle sets",
                    Power::Constant(_) => "",
                },
                Drive::None | Drive::Turbine(_) => "",
            };
            (engine.kind, engine.drive) = (EngineKind::Propeller, drive);
            format!("engine {number}: it runs steadily{runs}; the propeller turns at once as fast as it is turned")
        }
        Err(error) => format!("engine {number}: its thrust is what is set, a constant force: {error}"),
    };
    omitted.push(source.omit(node, note));
    Ok(engine)
}

/// Reads what makes the thrust of an engine.
fn drive(
    model: &mut Model,
    files: &mut Files,
    source: &File,
    node: Node<'_, '_>,
    inside: &File,
    root: Node<'_, '_>,
    number: usize,
) -> Result<Drive, JsbsimError> {
    let thruster = child(node, "thruster").ok_or_else(|| source.refuse(node, "the engine has no <thruster>"))?;
    let name = thruster.attribute("file").unwrap_or_default();
    let (path, text) = files.text(source, thruster, name, Kind::Engine)?;
    let thruster_source = File::new(path.clone(), &text);
    let document = xml::parse(&text).map_err(|source| JsbsimError::Xml { file: path, source })?;
    let made = document.root_element();
    if tag(root) == "turbine_engine" {
        if tag(made) != "direct" {
            let what = format!("a turbine that turns a <{}> is not supported", shortened(tag(made)));
            return Err(thruster_source.refuse(made, what));
        }
        return turbine(model, inside, root, number).map(Drive::Turbine);
    }
    let mut power = Power::read(inside, root)?;
    let propeller = Propeller::read(&thruster_source, made)?;
    let factor = match &mut power {
        Power::Piston(_) => {
            // JSBSim starts its engines, and trims with them, at full rich.
            for end in ["cmd", "pos"] {
                let lever = model.property(&format!("fcs/mixture-{end}-norm[{number}]"));
                model.begin(lever, 1.0);
            }
            Some(Source::Property(model.property(&format!("fcs/mixture-pos-norm[{number}]"))))
        }
        Power::Turboprop(turboprop) => {
            turboprop.set_gear(propeller.gear);
            let name = "EnginePowerVC";
            let made = factor(model, inside, root, name)?;
            let made = made.ok_or_else(|| inside.refuse(root, format!("the turboprop has no function {name}")))?;
            Some(Source::Function(made))
        }
        Power::Constant(_) => None,
    };
    let sense = source.child_number(thruster, "sense")?.unwrap_or(1.0);
    let throttle = model.property(&format!("fcs/throttle-pos-norm[{number}]"));
    let lever = model.property(&format!("fcs/advance-pos-norm[{number}]"));
    let inflow = [
        "velocities/u-aero-fps",
        "velocities/v-aero-fps",
        "velocities/w-aero-fps",
        "velocities/p-aero-rad_sec",
        "velocities/q-aero-rad_sec",
        "velocities/r-aero-rad_sec",
        "atmosphere/rho-slugs_ft3",
        "atmosphere/a-fps",
        "velocities/pi-rad_sec",
        "velocities/qi-rad_sec",
        "velocities/ri-rad_sec",
        "atmosphere/P-psf",
        "atmosphere/T-R",
        "aero/qbar-psf",
    ]
    .map(|name| model.property(name));
    Ok(Drive::Propeller(Box::new(Propelled {
        power,
        propeller,
        sense: if sense >= 0.0 { 1.0 } else { -1.0 },
        p_factor: source.child_number(thruster, "p_factor")?.unwrap_or(0.0),
        throttle,
        lever,
        factor,
        inflow,
    })))
}

fn turbine(model: &mut Model, source: &File, root: Node<'_, '_>, number: usize) -> Result<Turbine, JsbsimError> {
    let value = |name: &str| source.child_number(root, name).map(|found| found.unwrap_or(0.0));
    let pounds = |name: &str| source.child_quantity(root, name, Unit::Pound).map(|found| found.unwrap_or(0.0));
    let (dry_lb, wet_lb) = (pounds("milthrust")?, pounds("maxthrust")?);
    let missing = |name: &str| source.refuse(root, format!("the turbine has no function {name}"));
    let idle = factor(model, source, root, "IdleThrust")?.ok_or_else(|| missing("IdleThrust"))?;
    let dry = factor(model, source, root, "MilThrust")?.ok_or_else(|| missing("MilThrust"))?;
    let wet = factor(model, source, root, "AugThrust")?;
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
        bleed: value("bleed")?,
        injected: value("injected")? == 1.0,
    })
}

/// The function of an engine with a name, from its `<function>` or its `<table>`; none where there is neither.
fn factor(model: &mut Model, source: &File, root: Node<'_, '_>, name: &str) -> Result<Option<usize>, JsbsimError> {
    for part in children(root).filter(|part| part.attribute("name").is_some_and(|found| found.trim() == name)) {
        match tag(part) {
            "function" => return function::read_without_name(model, source, part).map(Some),
            "table" => return internal(model, source, part).map(Some),
            _ => {}
        }
    }
    Ok(None)
}

/// A table over Mach number and density altitude.
fn internal(model: &mut Model, source: &File, node: Node<'_, '_>) -> Result<usize, JsbsimError> {
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
