//! The sensors of a scenario, read one sample after another.

use phugoid_flight_dynamics::sensors::{Sensor, SensorError};
use phugoid_flight_dynamics::simulate::TrajectorySample;
use phugoid_simulation::scenario::Scenario;
use phugoid_simulation::sensing::specification;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type Get = fn(&TrajectorySample) -> f64;

/// What the sensors measure, SI, and whether it comes in a frame that may be missing as a whole.
const CHANNELS: [(&str, Get, bool); 16] = [
    ("true_airspeed", |s| s.air.speed, true),
    ("alpha", |s| s.air.alpha, true),
    ("beta", |s| s.air.beta, true),
    ("phi", |s| s.state.phi, true),
    ("theta", |s| s.state.theta, true),
    ("p", |s| s.state.p, true),
    ("q", |s| s.state.q, true),
    ("r", |s| s.state.r, true),
    ("ax", |s| s.specific_force[0], true),
    ("ay", |s| s.specific_force[1], true),
    ("az", |s| s.specific_force[2], true),
    ("altitude", |s| s.state.altitude, false),
    ("elevator", |s| s.surfaces.elevator, false),
    ("aileron", |s| s.surfaces.aileron, false),
    ("rudder", |s| s.surfaces.rudder, false),
    ("thrust", |s| s.thrust(), false),
];

/// The sensors of one flight.
pub struct Sensors {
    sensors: Vec<Sensor>,
    drops: f64,
    random: Pcg64,
}

/// What was measured at one instant, SI; NaN where a value is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading([f64; CHANNELS.len()]);

impl Reading {
    /// The value of a channel by its canonical name; NaN for one that is missing or not measured.
    pub fn channel(&self, name: &str) -> f64 {
        let place = CHANNELS.iter().position(|(channel, ..)| *channel == name);
        place.and_then(|i| self.0.get(i)).copied().unwrap_or(f64::NAN)
    }
}

impl Sensors {
    /// The sensors of a scenario whose constant errors are drawn ([`Scenario::drawn`]).
    ///
    /// # Errors
    /// [`SensorError`]: a specification that cannot be.
    pub fn new(scenario: &Scenario) -> Result<Self, SensorError> {
        let sensor = |(index, (name, ..)): (usize, &(&str, Get, bool))| {
            Sensor::new(specification(&scenario.sensors, name).unwrap_or_default(), scenario.seed, index)
        };
        Ok(Self {
            sensors: CHANNELS.iter().enumerate().map(sensor).collect::<Result<_, _>>()?,
            drops: scenario.sensors.drops,
            random: Pcg64::seed_from_u64(scenario.seed ^ 0x6672_616d_6573),
        })
    }

    /// What they measure of this instant; times must increase.
    ///
    /// # Errors
    /// [`SensorError::TimeBackwards`].
    pub fn read(&mut self, sample: &TrajectorySample) -> Result<Reading, SensorError> {
        let dropped = self.random.random::<f64>() < self.drops;
        let mut values = [f64::NAN; CHANNELS.len()];
        for ((value, sensor), (_, get, framed)) in values.iter_mut().zip(&mut self.sensors).zip(CHANNELS) {
            let measured = sensor.measure(sample.time, get(sample))?;
            if !(framed && dropped) {
                *value = measured;
            }
        }
        Ok(Reading(values))
    }
}
