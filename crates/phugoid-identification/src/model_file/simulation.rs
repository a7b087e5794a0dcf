//! The table `[simulation]`: what a simulation of the aircraft needs beside what an estimation needs.

use phugoid_flight_data::quantity::Dimension;
use phugoid_flight_dynamics::actuator::Actuator;
use phugoid_flight_dynamics::aircraft::DataRange;

use super::error::ModelFileError;
use super::section::Section;

const KEYS: [&str; 6] = ["largest_thrust", "engine_lag", "alpha", "elevator", "aileron", "rudder"];
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// What a simulation needs: engine, surfaces, and the range of flight that the model is good for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationData {
    /// Thrust at full throttle, N, the same at every speed and altitude; none: half the weight.
    pub largest_thrust: Option<f64>,
    /// Time constant of the thrust behind the throttle, s.
    pub engine_lag_s: f64,
    /// Lowest and highest angle of attack that the model is good for, rad.
    pub alpha: [f64; 2],
    /// Actuators of elevator, aileron and rudder.
    pub actuators: [Actuator; 3],
}

impl Default for SimulationData {
    /// Engine lag of 1 s; surfaces that move to 30 deg, at up to 60 deg/s behind a lag of 0.05 s; the range of angle of
    /// attack of an aircraft that says nothing about it.
    fn default() -> Self {
        let actuator = Actuator { limit: 30.0 * DEGREE, rate_limit: 60.0 * DEGREE, lag: 0.05 };
        Self { largest_thrust: None, engine_lag_s: 1.0, alpha: DataRange::UNSTATED.alpha, actuators: [actuator; 3] }
    }
}

/// The table `[simulation]`; the default without one.
pub(super) fn simulation(top: &Section) -> Result<SimulationData, ModelFileError> {
    let standard = SimulationData::default();
    let Some(section) = top.section("simulation")? else { return Ok(standard) };
    section.allow("key", KEYS.iter().copied())?;
    let actuator = |key: &str, standard: Actuator| -> Result<Actuator, ModelFileError> {
        let Some(inner) = section.section(key)? else { return Ok(standard) };
        inner.allow("key", ["limit", "rate_limit", "lag"].into_iter())?;
        Ok(Actuator {
            limit: inner.positive("limit", Dimension::ANGLE)?.unwrap_or(standard.limit),
            rate_limit: inner.positive("rate_limit", Dimension::ANGULAR_RATE)?.unwrap_or(standard.rate_limit),
            lag: inner.positive("lag", Dimension::TIME)?.unwrap_or(standard.lag),
        })
    };
    let [elevator, aileron, rudder] = standard.actuators;
    Ok(SimulationData {
        largest_thrust: section.positive("largest_thrust", Dimension::FORCE)?,
        engine_lag_s: section.positive("engine_lag", Dimension::TIME)?.unwrap_or(standard.engine_lag_s),
        alpha: section.pair_of("alpha", Dimension::ANGLE)?.unwrap_or(standard.alpha),
        actuators: [actuator("elevator", elevator)?, actuator("aileron", aileron)?, actuator("rudder", rudder)?],
    })
}
