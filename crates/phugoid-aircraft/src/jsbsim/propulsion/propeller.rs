//! A propeller: thrust and torque at a speed and a pitch, and the power that turns it.

use roxmltree::Node;

use super::super::error::JsbsimError;
use super::super::source::{Source, children, parse, shortened, tag};
use super::super::table::Table;
use super::super::units::Unit;
use super::piston::{Air, Piston};

/// Foot pounds per second in a horsepower.
const HORSEPOWER: f64 = 550.0;
/// Watts in a horsepower.
const WATTS: f64 = 745.7;

/// Power of an engine.
#[derive(Debug, Clone)]
pub(super) enum Power {
    /// A piston engine.
    Piston(Box<Piston>),
    /// In proportion to the throttle: foot pounds per second at full throttle at the sea, and whether it breathes air.
    Constant {
        /// Foot pounds per second.
        full: f64,
        /// Whether thinner air takes some of it.
        breathes: bool,
    },
}

impl Power {
    /// Reads the power of an engine; refused for one that has none of a simple form.
    pub(super) fn read(source: &Source, root: Node<'_, '_>) -> Result<Self, JsbsimError> {
        let power = |name: &str, otherwise: f64| -> Result<f64, JsbsimError> {
            let found = children(root).find(|part| tag(*part).eq_ignore_ascii_case(name));
            let found = found.ok_or_else(|| source.refuse(root, format!("the engine has no <{name}>")))?;
            let unit = match found.attribute("unit").map(str::trim) {
                Some("WATTS") => 1.0 / WATTS,
                Some("HP") => 1.0,
                _ => otherwise,
            };
            Ok(source.number(found)? * unit * HORSEPOWER)
        };
        match tag(root) {
            "piston_engine" => Ok(Self::Piston(Box::new(Piston::read(source, root)?))),
            "electric_engine" => Ok(Self::Constant { full: power("power", 1.0 / WATTS)?, breathes: false }),
            "turboprop_engine" => Ok(Self::Constant { full: power("maxpower", 1.0)?, breathes: true }),
            other => Err(source.refuse(root, format!("<{}> is not supported", shortened(other)))),
        }
    }

    /// Foot pounds per second at a throttle from 0 to 1 and a speed of the engine.
    pub(super) fn at(&self, throttle: f64, rpm: f64, air: &Air) -> f64 {
        match self {
            Self::Piston(piston) => piston.power(throttle, rpm, air),
            Self::Constant { full, breathes } => {
                let density_ratio = air.pressure_pa / 101_325.0 * 288.15 / air.temperature_k.max(1.0);
                let left = if *breathes { density_ratio.clamp(0.0, 1.2) } else { 1.0 };
                full * throttle.clamp(0.0, 1.0) * left
            }
        }
    }

    /// Speed above which the engine is not asked to run, turns per minute.
    pub(super) fn most_rpm(&self) -> f64 {
        match self {
            Self::Piston(piston) => piston.most_rpm(),
            Self::Constant { .. } => 10_000.0,
        }
    }

    /// A loss, foot pounds per second, not negative, with which the power over the speed nowhere rises with the speed; none where
    /// that cannot be said.
    pub(super) fn constant_loss(&self, throttle: f64) -> Option<f64> {
        match self {
            Self::Piston(piston) => piston.constant_loss(throttle),
            Self::Constant { full, .. } => (*full >= 0.0).then_some(0.0),
        }
    }
}

/// A propeller: tables over the advance ratio, and over the pitch where that can change.
#[derive(Debug, Clone)]
pub(super) struct Propeller {
    diameter_ft: f64,
    /// Inertia about its axis, slug ft2.
    pub(super) inertia: f64,
    pub(super) gear: f64,
    pub(super) pitch_deg: [f64; 2],
    pub(super) rpm: [f64; 2],
    pub(super) constant_speed: bool,
    thrust: Table,
    pub(super) power: Table,
    thrust_mach: Option<Table>,
    pub(super) power_mach: Option<Table>,
    pub(super) factors: [f64; 2],
    /// Sign of its spin in the gyroscopic moment: files before version 1.01 have the opposite one.
    pub(super) gyroscopic: f64,
}

/// What a propeller meets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inflow {
    /// Speed of the air along its axis, ft/s.
    pub(super) along_ft_s: f64,
    /// Density, slug/ft3.
    pub(super) density: f64,
    /// Speed of sound, ft/s.
    pub(super) sound_ft_s: f64,
}

/// What a propeller does.
#[derive(Debug, Clone, Copy)]
pub(super) struct Work {
    /// Thrust, pounds.
    pub(super) thrust_lb: f64,
    /// Torque that it takes, foot pounds.
    pub(super) torque_ft_lb: f64,
    /// Turns per minute.
    pub(super) rpm: f64,
}

impl Propeller {
    /// Reads a `<propeller>`.
    pub(super) fn read(source: &Source, root: Node<'_, '_>) -> Result<Self, JsbsimError> {
        if tag(root) != "propeller" {
            return Err(source.refuse(root, format!("<{}> is not supported", shortened(tag(root)))));
        }
        let number = |name: &str, otherwise: f64| -> Result<f64, JsbsimError> {
            Ok(source.child_number(root, name)?.unwrap_or(otherwise))
        };
        let table = |name: &str, dimensions: Option<usize>| -> Result<Option<Table>, JsbsimError> {
            let named =
                |part: &Node<'_, '_>| tag(*part) == "table" && part.attribute("name").map(str::trim) == Some(name);
            let found = children(root).find(named);
            found
                .map(|part| Table::read(source, part, dimensions.unwrap_or_else(|| Table::dimensions(part))))
                .transpose()
        };
        let needed = |name: &str| {
            table(name, None)?.ok_or_else(|| source.refuse(root, format!("the propeller has no table {name}")))
        };
        let pitch_deg = [number("minpitch", 0.0)?, number("maxpitch", 0.0)?];
        let diameter_ft = source.child_quantity(root, "diameter", Unit::Foot)?.unwrap_or(0.0);
        let gear = number("gearratio", 1.0)?;
        if diameter_ft <= 0.0 || gear <= 0.0 || pitch_deg[0] > pitch_deg[1] {
            return Err(source.refuse(root, "the diameter, the gear ratio or the pitch of the propeller cannot be"));
        }
        Ok(Self {
            diameter_ft,
            inertia: source.child_quantity(root, "ixx", Unit::SlugFoot2)?.unwrap_or(0.0),
            gear,
            pitch_deg,
            rpm: [number("minrpm", 0.0)?, number("maxrpm", 0.0)?],
            constant_speed: number("constspeed", if pitch_deg[0] == pitch_deg[1] { 0.0 } else { 1.0 })? != 0.0,
            thrust: needed("C_THRUST")?,
            power: needed("C_POWER")?,
            thrust_mach: table("CT_MACH", Some(1))?,
            power_mach: table("CP_MACH", Some(1))?,
            factors: [number("ct_factor", 1.0)?, number("cp_factor", 1.0)?],
            gyroscopic: if root.attribute("version").and_then(parse).is_some_and(|version| version >= 1.01) {
                -1.0
            } else {
                1.0
            },
        })
    }

    /// Thrust and torque at a speed and a pitch.
    pub(super) fn at(&self, inflow: &Inflow, rpm: f64, pitch_deg: f64) -> Work {
        let turns = rpm / 60.0;
        let advance = self.advance(inflow, rpm);
        let mach = self.of_mach(&self.thrust_mach, inflow, turns);
        let thrust = self.factors[0] * mach * self.thrust.value([advance, pitch_deg, 0.0]);
        let square = inflow.density * turns * turns * self.diameter_ft.powi(4);
        Work { thrust_lb: thrust * square, torque_ft_lb: self.torque_ft_lb(inflow, rpm, pitch_deg), rpm }
    }

    /// Torque that it takes at a speed and a pitch, foot pounds.
    pub(super) fn torque_ft_lb(&self, inflow: &Inflow, rpm: f64, pitch_deg: f64) -> f64 {
        let turns = rpm / 60.0;
        let advance = self.advance(inflow, rpm);
        let mach = self.of_mach(&self.power_mach, inflow, turns);
        let power = self.factors[1] * mach * self.power.value([advance, pitch_deg, 0.0]);
        let square = inflow.density * turns * turns * self.diameter_ft.powi(4);
        power * square * self.diameter_ft / (2.0 * std::f64::consts::PI)
    }

    /// Advance ratio at a speed.
    pub(super) fn advance(&self, inflow: &Inflow, rpm: f64) -> f64 {
        let turns = rpm / 60.0;
        inflow.along_ft_s / (self.diameter_ft * if turns > 0.0 { turns } else { 1.0 })
    }

    /// The value of a table over the Mach number of the tip; 1 without a table.
    fn of_mach(&self, table: &Option<Table>, inflow: &Inflow, turns: f64) -> f64 {
        let Some(table) = table else { return 1.0 };
        let tip = turns * self.diameter_ft * std::f64::consts::PI;
        let tip_mach = if inflow.sound_ft_s > 0.0 { tip.hypot(inflow.along_ft_s) / inflow.sound_ft_s } else { 0.0 };
        table.value([tip_mach, 0.0, 0.0])
    }

    /// Pitch at one end of its range.
    pub(super) fn fine_pitch_deg(&self) -> f64 {
        self.pitch_deg[0]
    }
}
