//! A simulated fleet whose truth is known: airframes of one type with errors of their own sensors, and a drift to be found.
//!
//! It is what the findings of [`tell`](crate::statistics::tell) are measured against, and a way to ask beforehand how small
//! a drift your fleet would show.

use phugoid_flight_data::record::Record;
use phugoid_identification::aircraft::{ModelAircraft, ModelAircraftError};
use phugoid_identification::model_file::{ModelError, ModelFile};
use phugoid_simulation::flight::{FlightError, fly_aircraft};
use phugoid_simulation::scenario::{Scenario, ScenarioError};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The flights of one type of aircraft, the HFB-320 of the built-in model `hfb320`.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedFleet {
    /// Seed of everything random.
    pub seed: u64,
    /// One sigma of the scale errors of each airframe's sensors: airspeed, angle of attack, and position of the elevator, as a
    /// part of what they measure. They stay the same over all flights of an airframe.
    pub sensor_scale: f64,
    /// Samples per second of a log, Hz.
    pub sample_rate_hz: f64,
    /// Number of 3-2-1-1 in a flight, one every twelve seconds.
    pub manoeuvres: u32,
    /// What changes from flight to flight; nothing where it is empty.
    pub drifts: Vec<Drift>,
    /// Sensors that are exchanged for others; none where it is empty.
    pub exchanges: Vec<Exchange>,
}

/// A sensor of one airframe that is exchanged for another one.
#[derive(Clone, Debug, PartialEq)]
pub struct Exchange {
    /// The airframe, counted from 0.
    pub airframe: usize,
    /// The first flight with the other sensor, counted from 0.
    pub flight: usize,
    /// The channel, `alpha`.
    pub channel: String,
    /// How much more than the former one the other one shows, as a part of what it measures.
    pub scale: f64,
    /// The same of its zero, in the SI unit of the channel: of an angle in radians.
    pub zero: f64,
}

/// A parameter of one airframe that changes with each of its flights.
#[derive(Clone, Debug, PartialEq)]
pub struct Drift {
    /// The airframe, counted from 0.
    pub airframe: usize,
    /// Name of the parameter, `Cm_alpha`.
    pub parameter: String,
    /// What it gains with each flight, as a part of its value: `0.01 / 50.0` is one percent in 50 flights.
    pub part_per_flight: f64,
}

/// Why a flight of the fleet cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum SimulatedError {
    /// The built-in model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model makes no aircraft.
    #[error(transparent)]
    Aircraft(#[from] ModelAircraftError),
    /// The scenario.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The flight.
    #[error(transparent)]
    Flight(#[from] FlightError),
    /// The type has no parameter of this name.
    #[error("the simulated aircraft has no parameter `{name}`")]
    NoParameter {
        /// The name that was given.
        name: String,
    },
    /// Its flights have no channel of this name.
    #[error("the flights of the simulated fleet have no channel `{name}`")]
    NoChannel {
        /// The name that was given.
        name: String,
    },
}

/// The first lines and the manoeuvres of a scenario stand before this.
const SCENARIO: &str = r#"
[aircraft]
file = "hfb320"
[condition]
altitude = "4300 m"
speed = "104.67 m/s"
[sensors]
true_airspeed = { noise = "0.13 m/s" }
alpha = { noise = "0.057 deg" }
theta = { noise = "0.025 deg" }
q = { noise = "0.033 deg/s" }
qdot = { noise = "0.32 deg/s^2" }
ax = { noise = "0.002 g" }
az = { noise = "0.0145 g" }
"#;

impl SimulatedFleet {
    /// What the sensors of an airframe record of one of its flights, both counted from 0.
    ///
    /// ```
    /// use phugoid_fleet::simulated::{Drift, SimulatedFleet};
    /// let drifts = vec![Drift { airframe: 1, parameter: "Cm_alpha".to_owned(), part_per_flight: 0.01 / 50.0 }];
    /// let fleet = SimulatedFleet { seed: 1, sensor_scale: 0.015, sample_rate_hz: 25.0, manoeuvres: 1, drifts, exchanges: Vec::new() };
    /// let record = fleet.record(1, 30)?;
    /// assert_eq!(record.len(), 351); // 14 s at 25 Hz
    /// assert_eq!(record, fleet.record(1, 30)?);
    /// # Ok::<(), phugoid_fleet::simulated::SimulatedError>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulatedError`].
    pub fn record(&self, airframe: usize, flight: usize) -> Result<Record, SimulatedError> {
        let mut model = ModelFile::named("hfb320")?;
        for drift in self.drifts.iter().filter(|drift| drift.airframe == airframe) {
            let parameter = model.parameters.iter_mut().find(|parameter| parameter.name == drift.parameter);
            let parameter = parameter.ok_or_else(|| SimulatedError::NoParameter { name: drift.parameter.clone() })?;
            parameter.start *= 1.0 + drift.part_per_flight * flight as f64;
        }
        let mut scenario = Scenario::parse(&self.scenario(), "a flight of a fleet")?;
        scenario.seed = self.generator(airframe, flight as u64 + 1).random();
        let mut record = fly_aircraft(&ModelAircraft::new(&model)?, &scenario, &|_| ())?.measured;
        let mut scales = self.generator(airframe, 0);
        for name in ["true_airspeed", "alpha", "elevator"] {
            let scale = 1.0 + self.sensor_scale * normal(&mut scales);
            if let Some(channel) = record.channels.iter_mut().find(|channel| channel.name == name) {
                channel.values.iter_mut().for_each(|value| *value *= scale);
            }
        }
        for exchange in self.exchanges.iter().filter(|e| e.airframe == airframe && flight >= e.flight) {
            let channel = record.channels.iter_mut().find(|channel| channel.name == exchange.channel);
            let channel = channel.ok_or_else(|| SimulatedError::NoChannel { name: exchange.channel.clone() })?;
            channel.values.iter_mut().for_each(|value| *value = (1.0 + exchange.scale) * *value + exchange.zero);
        }
        Ok(record)
    }

    /// Each manoeuvre comes after three quiet seconds.
    fn scenario(&self) -> String {
        let duration = 12 * self.manoeuvres + 2;
        let head = format!(
            "name = \"a flight of a fleet\"\nduration = \"{duration} s\"\nsample_rate = \"{} Hz\"\n",
            self.sample_rate_hz
        );
        let manoeuvre = |number: u32| {
            format!(
                "[[manoeuvre]]\ntype = \"3-2-1-1\"\nsurface = \"elevator\"\nunit = \"0.7 s\"\namplitude = \"0.8 deg\"\n\
                 start = \"{} s\"\n",
                12 * number + 3
            )
        };
        head + SCENARIO + &(0..self.manoeuvres).map(manoeuvre).collect::<String>()
    }

    fn generator(&self, airframe: usize, flight: u64) -> Pcg64Mcg {
        let key = crate::key::key(&[
            ("seed", &self.seed.to_string()),
            ("airframe", &airframe.to_string()),
            ("flight", &flight.to_string()),
        ]);
        Pcg64Mcg::seed_from_u64(u64::from_str_radix(key.get(..16).unwrap_or("0"), 16).unwrap_or(0))
    }
}

/// A number from the standard normal distribution (Box and Muller).
pub(crate) fn normal(generator: &mut Pcg64Mcg) -> f64 {
    let (first, second): (f64, f64) = (generator.random(), generator.random());
    // One less a number of [0, 1) is above zero.
    libm::sqrt(-2.0 * libm::log(1.0 - first)) * libm::cos(std::f64::consts::TAU * second)
}
