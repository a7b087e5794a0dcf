//! Power of a turboprop that runs steadily, from the speed of its gas generator that the throttle sets.

use roxmltree::Node;

use super::super::error::JsbsimError;
use super::super::source::{Source, children, tag};
use super::super::table::Table;

/// Foot pounds per second in a horsepower.
const HORSEPOWER: f64 = 550.0;
/// Speed above which a propeller is not asked to turn, turns per minute.
const MOST_PROPELLER_RPM: f64 = 10_000.0;

/// A turboprop.
#[derive(Debug, Clone)]
pub(super) struct Turboprop {
    /// Speed of the gas generator at idle and at full throttle, percent.
    n1: [f64; 2],
    /// The most power, foot pounds per second.
    most: f64,
    /// The torque of the propeller that the limiter of the engine holds, foot pounds; none where there is no limiter.
    most_torque: Option<f64>,
    /// Horsepower over the speed of the engine, turns per minute, and that of the gas generator.
    power: Table,
    /// Turns of the engine for one of the propeller.
    gear: f64,
}

impl Turboprop {
    /// Reads a `<turboprop_engine>` of which the most power is known, foot pounds per second; what it does not say is as JSBSim takes
    /// it. It turns a propeller without a gear until [`Turboprop::set_gear`].
    pub(super) fn read(source: &Source, root: Node<'_, '_>, most: f64) -> Result<Self, JsbsimError> {
        let number = |name: &str, otherwise: f64| -> Result<f64, JsbsimError> {
            Ok(source.child_number(root, name)?.unwrap_or(otherwise))
        };
        let named = |part: &Node<'_, '_>| {
            tag(*part) == "table" && part.attribute("name").is_some_and(|name| name.trim() == "EnginePowerRPM_N1")
        };
        let found = children(root).find(named);
        let found = found.ok_or_else(|| source.refuse(root, "the turboprop has no table EnginePowerRPM_N1"))?;
        let torque = number("ielumaxtorque", 0.0)?;
        Ok(Self {
            n1: [number("idlen1", 30.0)?, number("maxn1", 100.0)?],
            most,
            most_torque: (torque > 0.0).then_some(torque),
            power: Table::read(source, found, 2)?,
            gear: 1.0,
        })
    }

    /// Sets the turns of the engine for one of the propeller; positive.
    pub(super) fn set_gear(&mut self, gear: f64) {
        self.gear = gear;
    }

    /// Speed above which the engine is not asked to run, turns per minute.
    pub(super) fn most_rpm(&self) -> f64 {
        MOST_PROPELLER_RPM * self.gear
    }

    /// It at a throttle from 0 to 1, with what its power is multiplied by for pressure and speed.
    pub(super) fn running(&self, throttle: f64, factor: f64) -> RunningTurboprop<'_> {
        let [idle, full] = self.n1;
        RunningTurboprop { turboprop: self, n1: idle + (full - idle) * throttle.clamp(0.0, 1.0), factor }
    }
}

/// A turboprop at a throttle in some air.
#[derive(Debug, Clone, Copy)]
pub(super) struct RunningTurboprop<'a> {
    turboprop: &'a Turboprop,
    n1: f64,
    factor: f64,
}

impl RunningTurboprop<'_> {
    /// Power at a speed of the engine, foot pounds per second.
    #[inline]
    pub(super) fn power(&self, rpm: f64) -> f64 {
        let turboprop = self.turboprop;
        let power = (turboprop.power.value([rpm, self.n1, 0.0]) * self.factor * HORSEPOWER).min(turboprop.most);
        // The limiter closes the throttle until the propeller takes no more than its torque: in balance that is a limit of power.
        let turning = rpm / turboprop.gear / 60.0 * 2.0 * std::f64::consts::PI;
        turboprop.most_torque.map_or(power, |torque| power.min(torque * turning))
    }
}
