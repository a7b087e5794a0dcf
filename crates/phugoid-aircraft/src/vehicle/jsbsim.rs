//! Aircraft of JSBSim in flight.

use phugoid_flight_dynamics::globe::condition::Condition;
use phugoid_flight_dynamics::globe::loads::{ForcesAndMoments, Loads};
use phugoid_flight_dynamics::globe::vector::Vector;
use phugoid_flight_dynamics::mass::MassProperties;

use super::Schedule;
use crate::jsbsim::{Aircraft, Evaluator, FlightCondition, ForceMoment};

/// An aircraft of JSBSim in flight: its aerodynamics and engines at every instant, its surfaces as scheduled in time or set,
/// its flight control in steps if asked for.
///
/// Rates of angle of attack and sideslip, which many of these aircraft use, are solved together with the accelerations;
/// JSBSim itself takes those of its step before. Mass and inertia are those of the tanks when the vehicle is made. The ground
/// is at altitude zero and is never touched.
#[derive(Clone, Debug)]
pub struct JsbsimVehicle<'a> {
    evaluator: Evaluator<'a>,
    mass: MassProperties,
    scheduled: Vec<(usize, Schedule)>,
    /// Force in place of the engines, body axes, N.
    thrust: Option<Vector>,
    control_step: Option<f64>,
}

impl<'a> JsbsimVehicle<'a> {
    /// From an evaluator whose properties (tanks, gear, flaps) are as the flight begins; none if the mass or the inertia are
    /// not positive.
    pub fn new(mut evaluator: Evaluator<'a>) -> Option<Self> {
        let masses = evaluator.mass_properties();
        let mass = MassProperties::from_tensor(masses.mass_kg, masses.inertia_kg_m2, 0.0)?;
        Some(Self { evaluator, mass, scheduled: Vec::new(), thrust: None, control_step: None })
    }

    /// The aircraft.
    pub fn aircraft(&self) -> &'a Aircraft {
        self.evaluator.aircraft()
    }

    /// The values of its properties, to be set or read.
    pub fn evaluator(&mut self) -> &mut Evaluator<'a> {
        &mut self.evaluator
    }

    /// Lets a property follow a schedule, in the unit of the property; `false` where no file mentions it.
    pub fn schedule(&mut self, property: &str, schedule: Schedule) -> bool {
        let found = self.aircraft().property(property);
        if let Some(index) = found {
            self.scheduled.retain(|(other, _)| *other != index);
            self.scheduled.push((index, schedule));
        }
        found.is_some()
    }

    /// A constant force through the centre of gravity, body axes, N, in place of the engines of the files.
    pub fn replace_engines(&mut self, force: Vector) {
        self.thrust = Some(force);
    }

    /// Lets systems, autopilots and flight control of the files run at the start of every step, for steps of this length (s).
    /// Without it surfaces are where they are set or scheduled.
    pub fn run_channels(&mut self, step: f64) {
        self.control_step = Some(step);
    }

    fn set_condition(&mut self, c: &Condition) {
        let euler = c.euler;
        self.evaluator.set_flight(&FlightCondition {
            airspeed_m_s: c.air.speed,
            alpha_rad: c.air.alpha,
            beta_rad: c.air.beta,
            alphadot_rad_s: c.angle_rates[0],
            betadot_rad_s: c.angle_rates[1],
            rates_rad_s: c.rates_to_earth,
            attitude_rad: [euler.roll, euler.pitch, euler.yaw],
            height_m: c.place.altitude,
            height_above_ground_m: c.place.altitude,
            density_kg_m3: c.atmosphere.density,
            pressure_pa: c.atmosphere.pressure,
            temperature_k: c.atmosphere.temperature,
            sound_speed_m_s: c.atmosphere.speed_of_sound,
        });
        for (index, schedule) in &self.scheduled {
            self.evaluator.set_index(*index, schedule.at(c.time));
        }
    }
}

impl Loads for JsbsimVehicle<'_> {
    fn mass_properties(&mut self, _: &Condition) -> MassProperties {
        self.mass
    }

    fn loads(&mut self, condition: &Condition) -> ForcesAndMoments {
        self.set_condition(condition);
        let aerodynamic = self.evaluator.aerodynamic_force_moment();
        let other = match self.thrust {
            Some(force_n) => ForceMoment { force_n, ..ForceMoment::default() },
            None => self.evaluator.propulsive_force_moment(),
        };
        ForcesAndMoments {
            aerodynamic_force: aerodynamic.force_n,
            aerodynamic_moment: aerodynamic.moment_n_m,
            other_force: other.force_n,
            other_moment: other.moment_n_m,
        }
    }

    fn uses_angle_rates(&self) -> bool {
        true
    }

    fn update(&mut self, condition: &Condition) {
        if let Some(step) = self.control_step {
            self.set_condition(condition);
            self.evaluator.step_channels(step);
        }
    }
}
