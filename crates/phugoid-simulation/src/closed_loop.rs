//! The flight control system of an aircraft's files, which moves the surfaces of a flight.

use phugoid_aircraft::flown::{FlightControl, Sensed};
use phugoid_aircraft::jsbsim::FlightCondition;
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::standard_atmosphere::geopotential_altitude;

/// Least number of times that channels run in a second: JSBSim runs them 120 times unless it is told otherwise.
const LEAST_RATE_HZ: f64 = 100.0;

/// Flight control in a flight.
pub(crate) struct ClosedLoop<'a> {
    control: FlightControl<'a>,
    /// How often it runs in a sample.
    pub(crate) steps: usize,
    /// What it gave for this instant; none where it did not run yet.
    pub(crate) given: Option<Controls>,
    /// Where the surfaces were in the step before, rad, failures included; without actuators nobody else knows.
    pub(crate) surfaces: [f64; 3],
}

impl<'a> ClosedLoop<'a> {
    pub(crate) fn new(control: FlightControl<'a>, steps: usize, surfaces: [f64; 3]) -> Self {
        Self { control, steps, given: None, surfaces }
    }

    /// Runs it once.
    pub(crate) fn step(&mut self, sensed: &Sensed, commands: Controls) {
        let asked = [commands.elevator, commands.aileron, commands.rudder];
        let [elevator, aileron, rudder] = self.control.step(sensed, asked);
        self.given = Some(Controls { elevator, aileron, rudder, ..commands });
    }
}

/// How often channels run in a sample at this rate, Hz.
pub(crate) fn steps_per_sample(sample_rate: f64) -> usize {
    // A rate of 100 Hz may have come out of a conversion.
    (LEAST_RATE_HZ / sample_rate - 1e-9).ceil().max(1.0) as usize
}

/// What flight control senses of the motion of an aircraft whose surfaces are here.
pub(crate) fn sensed<A: Aircraft>(
    aircraft: &A,
    state: &State,
    controls: &Controls,
    disturbance: &Disturbance,
) -> Sensed {
    let now = motion(aircraft, state, controls, disturbance);
    let earth = disturbance.earth.as_ref();
    let height = earth.map_or(state.altitude, |_| geopotential_altitude(state.altitude));
    let air = aircraft.atmosphere().at(height);
    let [north, east] = earth.map_or([1.0; 2], |earth| earth.map);
    let (sine, cosine) = now.air.alpha.sin_cos();
    let lift = now.air.dynamic_pressure
        * aircraft.geometry().wing_area
        * (sine * now.coefficients.cx - cosine * now.coefficients.cz);
    Sensed {
        flight: FlightCondition {
            airspeed_m_s: now.air.speed,
            alpha_rad: now.air.alpha,
            beta_rad: now.air.beta,
            alphadot_rad_s: now.rates.alpha,
            betadot_rad_s: now.rates.beta,
            rates_rad_s: now.turning,
            attitude_rad: [state.phi, state.theta, state.psi],
            height_m: state.altitude,
            height_above_ground_m: state.altitude,
            density_kg_m3: air.density,
            pressure_pa: air.pressure,
            temperature_k: air.temperature,
            sound_speed_m_s: air.speed_of_sound,
        },
        velocity_m_s: [now.rates.north / north, now.rates.east / east, -now.rates.altitude],
        specific_force_m_s2: now.specific_force,
        angular_acceleration_rad_s2: [now.rates.p, now.rates.q, now.rates.r],
        lift_over_weight: lift / (aircraft.mass_properties().mass() * aircraft.gravity()),
        throttle: controls.throttle,
    }
}
