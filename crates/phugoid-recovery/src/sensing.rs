//! The sensors of a scenario, read one sample after another.

use phugoid_flight_dynamics::sensors::{Sensor, SensorError};
use phugoid_flight_dynamics::simulate::TrajectorySample;
use phugoid_simulation::scenario::Scenario;
use phugoid_simulation::sensing::{frame_stream, is_framed, specification};
use phugoid_simulation::signals::signal;
use rand::RngExt;
use rand_pcg::Pcg64;

/// What the sensors measure: the channels that a model of the whole motion may ask for.
const CHANNELS: [&str; 16] = [
    "true_airspeed",
    "alpha",
    "beta",
    "phi",
    "theta",
    "p",
    "q",
    "r",
    "ax",
    "ay",
    "az",
    "altitude",
    "elevator",
    "aileron",
    "rudder",
    "thrust",
];

/// The sensors of one flight.
pub struct Sensors {
    sensors: Vec<Sensor>,
    drops: f64,
    frames: Pcg64,
}

/// What was measured at one instant, SI; NaN where a value is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading([f64; CHANNELS.len()]);

impl Reading {
    /// The value of a channel by its canonical name; NaN for one that is missing or not measured.
    pub fn channel(&self, name: &str) -> f64 {
        let place = CHANNELS.iter().position(|channel| *channel == name);
        place.and_then(|i| self.0.get(i)).copied().unwrap_or(f64::NAN)
    }
}

impl Sensors {
    /// The sensors of a scenario whose constant errors are drawn ([`Scenario::drawn`]).
    ///
    /// # Errors
    /// [`SensorError`]: a specification that cannot be.
    pub fn new(scenario: &Scenario) -> Result<Self, SensorError> {
        let sensor = |(index, name): (usize, &&str)| {
            Sensor::new(specification(&scenario.sensors, name).unwrap_or_default(), scenario.seed, index)
        };
        Ok(Self {
            sensors: CHANNELS.iter().enumerate().map(sensor).collect::<Result<_, _>>()?,
            drops: scenario.sensors.drops,
            frames: frame_stream(scenario.seed),
        })
    }

    /// What they measure of this instant; times must increase.
    ///
    /// # Errors
    /// [`SensorError::TimeBackwards`].
    pub fn read(&mut self, sample: &TrajectorySample) -> Result<Reading, SensorError> {
        let dropped = self.frames.random::<f64>() < self.drops;
        let mut values = [f64::NAN; CHANNELS.len()];
        for ((value, sensor), name) in values.iter_mut().zip(&mut self.sensors).zip(CHANNELS) {
            let Some(truth) = signal(name) else { continue };
            let measured = sensor.measure(sample.time, truth(sample))?;
            if !(dropped && is_framed(name)) {
                *value = measured;
            }
        }
        Ok(Reading(values))
    }
}
