//! The table `[simulation]`: what a simulation of the aircraft needs beside what an estimation needs.

mod engine;
mod fuel;
mod numbers;

use phugoid_flight_data::quantity::Dimension;
use phugoid_flight_dynamics::actuator::Actuator;
use phugoid_flight_dynamics::aircraft::DataRange;

pub use self::engine::{EngineData, PropelledData, Slipstream};
pub use self::fuel::{FuelData, FuelFlow};

use super::aircraft::{AircraftData, Base};
use super::error::ModelFileError;
use super::parameter::Parameter;
use super::section::Section;

const KEYS: [&str; 9] =
    ["largest_thrust", "thrust", "propeller", "engine_lag", "fuel", "alpha", "elevator", "aileron", "rudder"];
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// What a simulation needs: engine, fuel, surfaces, and the range of flight that the model is good for.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationData {
    /// What makes the thrust; none: the engine of the base, or half the weight at full throttle.
    pub engine: Option<EngineData>,
    /// Time constant of the engine behind the throttle, s.
    pub engine_lag_s: f64,
    /// Fuel that is burnt; none: the mass stays as it is.
    pub fuel: Option<FuelData>,
    /// Lowest and highest angle of attack that the model is good for, rad.
    pub alpha: [f64; 2],
    /// Actuators of elevator, aileron and rudder.
    pub actuators: [Actuator; 3],
}

impl Default for SimulationData {
    /// Engine lag of 1 s; surfaces that move to 30 deg, at up to 60 deg/s behind a lag of 0.05 s, without delay and play; the range
    /// of angle of attack of an aircraft that says nothing about it.
    fn default() -> Self {
        let actuator = Actuator::new(30.0 * DEGREE, 60.0 * DEGREE, 0.05);
        Self { engine: None, engine_lag_s: 1.0, fuel: None, alpha: DataRange::UNSTATED.alpha, actuators: [actuator; 3] }
    }
}

/// The table `[simulation]`; the default without one.
pub(super) fn simulation(
    top: &Section,
    base: Base,
    aircraft: &AircraftData,
    parameters: &[Parameter],
) -> Result<SimulationData, ModelFileError> {
    let standard = SimulationData::default();
    let Some(section) = top.section("simulation")? else { return Ok(standard) };
    section.allow("key", KEYS.iter().copied())?;
    let actuator = |key: &str, standard: Actuator| -> Result<Actuator, ModelFileError> {
        let Some(inner) = section.section(key)? else { return Ok(standard) };
        inner.allow("key", ["limit", "rate_limit", "lag", "delay", "play"].into_iter())?;
        let delay = inner.not_negative("delay", Dimension::TIME)?.unwrap_or(standard.delay);
        if delay > Actuator::LONGEST_DELAY {
            let most = Actuator::LONGEST_DELAY;
            let message =
                format!("`delay` is {delay} s: expected {most} s at most, e.g. \"20 ms\" for 20 milliseconds");
            return Err(inner.error("delay", message));
        }
        Ok(Actuator {
            limit: inner.positive("limit", Dimension::ANGLE)?.unwrap_or(standard.limit),
            rate_limit: inner.positive("rate_limit", Dimension::ANGULAR_RATE)?.unwrap_or(standard.rate_limit),
            lag: inner.positive("lag", Dimension::TIME)?.unwrap_or(standard.lag),
            delay,
            play: inner.not_negative("play", Dimension::ANGLE)?.unwrap_or(standard.play),
        })
    };
    if base != Base::None
        && let Some(key) = ["elevator", "aileron", "rudder"].into_iter().find(|key| section.get(key).is_some())
    {
        let message =
            format!("`{key}`: the surfaces are those of the base, and nothing here changes them: leave it out");
        return Err(section.error(key, message));
    }
    if base != Base::None
        && section.get("engine_lag").is_some()
        && !["largest_thrust", "thrust"].iter().any(|key| section.get(key).is_some())
    {
        let message =
            "`engine_lag`: the engine is that of the base, which has its own: leave it out, or give `thrust` too";
        return Err(section.error("engine_lag", message));
    }
    let [elevator, aileron, rudder] = standard.actuators;
    let engine = engine::engine(&section, base, parameters)?;
    Ok(SimulationData {
        engine_lag_s: section.positive("engine_lag", Dimension::TIME)?.unwrap_or(standard.engine_lag_s),
        fuel: fuel::fuel(&section, aircraft, engine.as_ref())?,
        alpha: section.pair_of("alpha", Dimension::ANGLE)?.unwrap_or(standard.alpha),
        actuators: [actuator("elevator", elevator)?, actuator("aileron", aileron)?, actuator("rudder", rudder)?],
        engine,
    })
}
