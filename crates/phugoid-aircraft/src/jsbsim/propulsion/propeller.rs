//! A propeller: thrust and torque at a speed and a pitch, and the power that turns it.

use roxmltree::Node;

use super::super::error::JsbsimError;
use super::super::source::{Source, children, parse, shortened, tag};
use super::super::table::{Column, Table};
use super::super::units::Unit;
use super::piston::{Air, Piston, RunningPiston};
use super::turboprop::{RunningTurboprop, Turboprop};

/// Foot pounds per second in a horsepower.
const HORSEPOWER: f64 = 550.0;
/// Watts in a horsepower.
const WATTS: f64 = 745.7;

/// Power of an engine.
#[derive(Debug, Clone)]
pub(super) enum Power {
    /// A piston engine.
    Piston(Box<Piston>),
    /// In proportion to the throttle: foot pounds per second at full throttle.
    Constant(f64),
    /// A turboprop.
    Turboprop(Box<Turboprop>),
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
            "electric_engine" => Ok(Self::Constant(power("power", 1.0 / WATTS)?)),
            "turboprop_engine" => {
                Ok(Self::Turboprop(Box::new(Turboprop::read(source, root, power("maxpower", 1.0)?)?)))
            }
            other => Err(source.refuse(root, format!("<{}> is not supported", shortened(other)))),
        }
    }

    /// It at a throttle from 0 to 1 in some air. `factor` is the mixture lever of a piston engine, and of a turboprop what its power
    /// is multiplied by for pressure and speed.
    pub(super) fn running(&self, throttle: f64, factor: f64, air: &Air) -> Running<'_> {
        match self {
            Self::Piston(piston) => Running::Piston(piston.running(throttle, factor, air)),
            Self::Constant(full) => Running::Constant(full * throttle.clamp(0.0, 1.0)),
            Self::Turboprop(turboprop) => Running::Turboprop(turboprop.running(throttle, factor)),
        }
    }

    /// Speed above which the engine is not asked to run, turns per minute.
    pub(super) fn most_rpm(&self) -> f64 {
        match self {
            Self::Piston(piston) => piston.most_rpm(),
            Self::Constant(_) => 10_000.0,
            Self::Turboprop(turboprop) => turboprop.most_rpm(),
        }
    }

    /// A loss, foot pounds per second, not negative, with which the power over the speed nowhere rises with the speed; none where
    /// that cannot be said.
    pub(super) fn constant_loss(&self, throttle: f64) -> Option<f64> {
        match self {
            Self::Piston(piston) => piston.constant_loss(throttle),
            Self::Constant(full) => (*full >= 0.0).then_some(0.0),
            // Its table may rise faster than the speed.
            Self::Turboprop(_) => None,
        }
    }
}

/// An engine at a throttle in some air.
#[derive(Debug, Clone, Copy)]
pub(super) enum Running<'a> {
    /// A piston engine.
    Piston(RunningPiston<'a>),
    /// The same at every speed, foot pounds per second.
    Constant(f64),
    /// A turboprop.
    Turboprop(RunningTurboprop<'a>),
}

impl Running<'_> {
    /// Foot pounds per second at a speed of the engine, turns per minute.
    #[inline]
    pub(super) fn at(&self, rpm: f64) -> f64 {
        match self {
            Self::Piston(piston) => piston.power(rpm),
            Self::Constant(power) => *power,
            Self::Turboprop(turboprop) => turboprop.power(rpm),
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

    /// One of numbers: its tables are over the advance ratio and the pitch (degrees).
    pub(super) fn of_numbers(
        diameter_ft: f64,
        pitch_deg: [f64; 2],
        most_rpm: f64,
        [thrust, power]: [Table; 2],
    ) -> Self {
        Self {
            diameter_ft,
            inertia: 0.0,
            gear: 1.0,
            pitch_deg,
            rpm: [most_rpm; 2],
            constant_speed: pitch_deg[0] < pitch_deg[1],
            thrust,
            power,
            thrust_mach: None,
            power_mach: None,
            factors: [1.0; 2],
            gyroscopic: 1.0,
        }
    }

    /// Thrust and torque at a speed and a pitch.
    pub(super) fn at(&self, inflow: &Inflow, rpm: f64, pitch_deg: f64) -> Work {
        self.taking(inflow, pitch_deg, Rows::default()).work(rpm, &mut Rows::default())
    }

    /// Advance ratio at a speed.
    pub(super) fn advance(&self, inflow: &Inflow, rpm: f64) -> f64 {
        let turns = rpm / 60.0;
        inflow.along_ft_s / (self.diameter_ft * if turns > 0.0 { turns } else { 1.0 })
    }

    /// What it takes at a pitch, to be asked at several speeds.
    pub(super) fn taking<'a>(&'a self, inflow: &'a Inflow, pitch_deg: f64, rows: Rows) -> Taking<'a> {
        let scale = self.factors[1] * inflow.density * self.diameter_ft.powi(5) / 60.0_f64.powi(3);
        Taking {
            propeller: self,
            inflow,
            pitch_deg,
            coefficients: self.power.at_column(pitch_deg, rows.power),
            scale,
            rows,
        }
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

/// Rows of tables to look at first.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rows {
    power: usize,
    thrust: usize,
}

/// A propeller of a pitch in some air.
#[derive(Debug)]
pub(super) struct Taking<'a> {
    propeller: &'a Propeller,
    inflow: &'a Inflow,
    pitch_deg: f64,
    rows: Rows,
    coefficients: Column<'a>,
    /// Power for a coefficient of 1 and each turn per minute cubed, foot pounds per second.
    scale: f64,
}

impl Taking<'_> {
    /// What it does at a speed; the rows that were found go into `rows`.
    pub(super) fn work(&self, rpm: f64, rows: &mut Rows) -> Work {
        let Self { propeller, inflow, .. } = self;
        let (turns, advance) = (rpm / 60.0, propeller.advance(inflow, rpm));
        let square = inflow.density * turns * turns * propeller.diameter_ft.powi(4);
        let thrusts = propeller.thrust.at_column(self.pitch_deg, self.rows.thrust);
        let of_mach = |table: &Option<Table>| propeller.of_mach(table, inflow, turns);
        let thrust = propeller.factors[0] * of_mach(&propeller.thrust_mach) * thrusts.value(advance);
        let power = propeller.factors[1] * of_mach(&propeller.power_mach) * self.coefficients.value(advance);
        let torque_ft_lb = power * square * propeller.diameter_ft / (2.0 * std::f64::consts::PI);
        *rows = Rows { power: self.coefficients.row(), thrust: thrusts.row() };
        Work { thrust_lb: thrust * square, torque_ft_lb, rpm }
    }
    /// Whether its coefficient is nowhere between two advance ratios less than at the second.
    pub(super) fn is_least_at_end(&self, advances: [f64; 2]) -> bool {
        self.coefficients.is_least_at_end(advances)
    }

    /// Power that it takes at a speed, foot pounds per second.
    #[inline]
    pub(super) fn at(&self, rpm: f64) -> f64 {
        let coefficient = self.coefficients.value(self.propeller.advance(self.inflow, rpm));
        let power = coefficient * self.scale * rpm * rpm * rpm;
        match &self.propeller.power_mach {
            None => power,
            table => power * self.propeller.of_mach(table, self.inflow, rpm / 60.0),
        }
    }
}
