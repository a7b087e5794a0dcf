//! A propeller at the speed at which it takes the power that its engine gives.

use roxmltree::Node;

use super::super::error::JsbsimError;
use super::super::source::{Source, children, shortened, tag};
use super::super::table::Table;
use super::super::units::Unit;

/// Foot pounds per second in a horsepower.
const HORSEPOWER: f64 = 550.0;
/// Watts in a horsepower.
const WATTS: f64 = 745.7;

/// Power of an engine at full throttle at the sea, and how it falls.
#[derive(Debug, Clone)]
pub(super) struct Power {
    /// Foot pounds per second.
    full: f64,
    /// Speed of the engine at which it is given, turns per minute, for one whose torque does not depend on its speed.
    at_rpm: Option<f64>,
    /// Whether it breathes air.
    breathes: bool,
}

impl Power {
    /// Reads the power of an engine; refused for one that has none of a simple form.
    pub(super) fn read(source: &Source, root: Node<'_, '_>) -> Result<Self, JsbsimError> {
        let find = |name: &str| children(root).find(|part| tag(*part).eq_ignore_ascii_case(name));
        let power = |name: &str| -> Result<f64, JsbsimError> {
            let found = find(name).ok_or_else(|| source.refuse(root, format!("the engine has no <{name}>")))?;
            let number = source.number(found)?;
            Ok(match found.attribute("unit").map(str::trim) {
                Some("WATTS") => number / WATTS * HORSEPOWER,
                _ => number * HORSEPOWER,
            })
        };
        match tag(root) {
            "piston_engine" => {
                let at_rpm = find("maxrpm").map(|found| source.number(found)).transpose()?.unwrap_or(2800.0);
                Ok(Self { full: power("maxhp")?, at_rpm: Some(at_rpm.max(1.0)), breathes: true })
            }
            "electric_engine" => {
                let watts = find("power").map(|found| found.attribute("unit").is_none());
                // Without a unit, the power is in watts.
                let scale = if watts == Some(true) { 1.0 / WATTS } else { 1.0 };
                Ok(Self { full: scale * power("power")?, at_rpm: None, breathes: false })
            }
            "turboprop_engine" => Ok(Self { full: power("maxpower")?, at_rpm: None, breathes: true }),
            other => Err(source.refuse(root, format!("<{}> is not supported", shortened(other)))),
        }
    }

    /// Foot pounds per second at a throttle from 0 to 1, a speed of the engine, and a density over that at the sea.
    fn at(&self, throttle: f64, rpm: f64, density_ratio: f64) -> f64 {
        // What is left of the power of an engine without a supercharger (Gagg and Farrar).
        let air = if self.breathes { (density_ratio - (1.0 - density_ratio) / 7.55).clamp(0.0, 1.2) } else { 1.0 };
        let speed = self.at_rpm.map_or(1.0, |at| (rpm / at).min(1.2));
        self.full * throttle.clamp(0.0, 1.0) * air * speed
    }
}

/// A propeller: tables over the advance ratio, and over the pitch where that can change.
#[derive(Debug, Clone)]
pub(super) struct Propeller {
    diameter_ft: f64,
    /// Inertia about its axis, slug ft2.
    pub(super) inertia: f64,
    gear: f64,
    pitch_deg: [f64; 2],
    rpm: [f64; 2],
    constant_speed: bool,
    thrust: Table,
    power: Table,
    thrust_mach: Option<Table>,
    power_mach: Option<Table>,
    factors: [f64; 2],
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
        })
    }

    /// Thrust and torque at a speed and a pitch.
    pub(super) fn at(&self, inflow: &Inflow, rpm: f64, pitch_deg: f64) -> Work {
        let turns = rpm / 60.0;
        let advance = inflow.along_ft_s / (self.diameter_ft * if turns > 0.0 { turns } else { 1.0 });
        let tip = turns * self.diameter_ft * std::f64::consts::PI;
        let tip_mach = if inflow.sound_ft_s > 0.0 { tip.hypot(inflow.along_ft_s) / inflow.sound_ft_s } else { 0.0 };
        let mach = |table: &Option<Table>| table.as_ref().map_or(1.0, |table| table.value([tip_mach, 0.0, 0.0]));
        let thrust = self.factors[0] * mach(&self.thrust_mach) * self.thrust.value([advance, pitch_deg, 0.0]);
        let power = self.factors[1] * mach(&self.power_mach) * self.power.value([advance, pitch_deg, 0.0]);
        let diameter4 = self.diameter_ft.powi(4);
        let square = inflow.density * turns * turns * diameter4;
        Work {
            thrust_lb: thrust * square,
            torque_ft_lb: power * square * self.diameter_ft / (2.0 * std::f64::consts::PI),
            rpm,
        }
    }

    /// Pitch at one end of its range.
    pub(super) fn fine_pitch_deg(&self) -> f64 {
        self.pitch_deg[0]
    }

    /// The work at which engine and propeller are in balance. `lever` from 0 to 1 asks for a speed between the least and the most.
    pub(super) fn balance(
        &self,
        inflow: &Inflow,
        engine: &Power,
        throttle: f64,
        lever: f64,
        density_ratio: f64,
    ) -> Work {
        let surplus = |rpm: f64, pitch: f64| {
            let work = self.at(inflow, rpm, pitch);
            engine.at(throttle, rpm * self.gear, density_ratio)
                - work.torque_ft_lb * rpm / 60.0 * 2.0 * std::f64::consts::PI
        };
        let [fine, coarse] = self.pitch_deg;
        if self.constant_speed && fine < coarse {
            let wanted = self.rpm[0] + (self.rpm[1] - self.rpm[0]) * lever.clamp(0.0, 1.0);
            if wanted > 0.0 {
                if surplus(wanted, fine) <= 0.0 {
                    return self.at(inflow, self.free_rpm(|rpm| surplus(rpm, fine), wanted), fine);
                }
                if surplus(wanted, coarse) >= 0.0 {
                    return self.at(inflow, self.free_rpm(|rpm| surplus(rpm, coarse), 4.0 * wanted), coarse);
                }
                let (mut low, mut high) = (fine, coarse);
                for _ in 0..50 {
                    let middle = 0.5 * (low + high);
                    *(if surplus(wanted, middle) > 0.0 { &mut low } else { &mut high }) = middle;
                }
                return self.at(inflow, wanted, low);
            }
        }
        self.at(inflow, self.free_rpm(|rpm| surplus(rpm, fine), 10_000.0), fine)
    }

    /// The speed at which there is no power to spare, below a bound.
    fn free_rpm(&self, surplus: impl Fn(f64) -> f64, most: f64) -> f64 {
        let (mut low, mut high) = (1.0, most.max(1.0));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if surplus(middle) > 0.0 { &mut low } else { &mut high }) = middle;
        }
        low
    }
}
