//! A second aircraft, with nothing in common with the F-16: a light four-seater of constant derivatives, constant mass and a
//! propeller of constant thrust. It is what an implementation of `Aircraft` amounts to, and what the tests fly to show that
//! trim, linearisation, simulation and estimation are not made for the F-16.
//!
//! The numbers are those of the Navion in R. C. Nelson, *Flight Stability and Automatic Control*, 2nd ed., 1998, appendix B
//! (sea level, 176 ft/s), in SI units. Its derivatives by the rate of the angle of attack are added to those by the pitch rate.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)] // shared by tests, none of which needs everything

use phugoid_flight_dynamics::actuator::{Actuator, Actuators};
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

/// True airspeed of the published condition, m/s.
pub const SPEED: f64 = 176.0 * 0.3048;
/// Lift coefficient at zero angle of attack.
pub const CL_0: f64 = 0.41;
pub const CL_ALPHA: f64 = 4.44;
pub const CL_Q: f64 = 3.8;
pub const CL_ELEVATOR: f64 = 0.355;
pub const CD_0: f64 = 0.05;
pub const CD_ALPHA: f64 = 0.33;
pub const CM_ALPHA: f64 = -0.683;
pub const CM_Q: f64 = -9.96 - 4.36;
pub const CM_ELEVATOR: f64 = -0.923;

/// Largest thrust of the propeller, N.
const THRUST: f64 = 3000.0;
/// Time constant of the engine, s.
const ENGINE_LAG: f64 = 0.5;

/// The aircraft.
#[derive(Clone, Debug)]
pub struct LightAircraft {
    geometry: Geometry,
    mass: MassProperties,
    actuators: Actuators,
}

impl LightAircraft {
    pub fn new() -> Self {
        const FOOT: f64 = 0.3048;
        const SLUG_FOOT_2: f64 = 1.355_817_95;
        let inertia = [1048.0, 3000.0, 3530.0].map(|j| j * SLUG_FOOT_2);
        let tensor = [[inertia[0], 0.0, 0.0], [0.0, inertia[1], 0.0], [0.0, 0.0, inertia[2]]];
        let actuator = Actuator::new(0.4, 1.0, 0.1);
        Self {
            geometry: Geometry {
                wing_area: 184.0 * FOOT * FOOT,
                span: 33.4 * FOOT,
                mean_chord: 5.7 * FOOT,
                cg: 0.295,
                cg_reference: 0.295,
            },
            mass: MassProperties::from_tensor(2750.0 * 0.453_592_37, tensor, 0.0).unwrap(),
            actuators: Actuators { elevator: actuator, aileron: actuator, rudder: actuator },
        }
    }

    /// Pitching moment of inertia, kg m^2.
    pub fn pitch_inertia(&self) -> f64 {
        self.mass.pitch_inertia()
    }
}

impl Aircraft for LightAircraft {
    fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    fn mass_properties(&self) -> &MassProperties {
        &self.mass
    }

    fn gravity(&self) -> f64 {
        9.80665
    }

    fn atmosphere(&self) -> Atmosphere {
        Atmosphere::Standard
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let (alpha, beta) = (air.alpha, air.beta);
        let time = (air.speed * 2.0).recip();
        let (p, q, r) = (
            rates[0] * time * self.geometry.span,
            rates[1] * time * self.geometry.mean_chord,
            rates[2] * time * self.geometry.span,
        );
        let Controls { elevator, aileron, rudder, .. } = *controls;
        let lift = alpha * CL_ALPHA + q * CL_Q + elevator * CL_ELEVATOR + CL_0;
        let drag = alpha * CD_ALPHA + CD_0;
        let (sine, cosine) = alpha.sin_cos();
        Coefficients {
            cx: lift * sine - drag * cosine,
            cy: beta * -0.564 + rudder * 0.157,
            cz: -(lift * cosine) - drag * sine,
            cl: beta * -0.074 + p * -0.41 + r * 0.107 + aileron * -0.134 + rudder * 0.0118,
            cm: alpha * CM_ALPHA + q * CM_Q + elevator * CM_ELEVATOR,
            cn: beta * 0.071 + p * -0.0575 + r * -0.125 + aileron * 0.0035 + rudder * -0.072,
        }
    }

    fn propulsion<T: Scalar>(&self, power: T, _altitude: T, _mach: T) -> Propulsion<T> {
        let zero = T::from(0.0);
        Propulsion { force: [power * (THRUST / 100.0), zero, zero], moment: [zero; 3] }
    }

    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        (throttle * 100.0 - power) / ENGINE_LAG
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        throttle * 100.0
    }

    fn actuators(&self) -> &Actuators {
        &self.actuators
    }

    fn data_range(&self) -> DataRange {
        DataRange { alpha: [-0.15, 0.25], ..DataRange::UNSTATED }
    }
}
