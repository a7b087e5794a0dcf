//! The quantities of a flight that models in DAVE-ML may ask for.

use phugoid_flight_dynamics::aircraft::{AirData, Controls};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::scalar::{Dual, Scalar};

use super::feed::{FEEDS, Feed, Flow};
use crate::jsbsim::altitude_of_density_m;

/// Speed (m/s), angle of attack and sideslip (rad), density (kg/m3), Mach number, p, q, r (rad/s), elevator, aileron, rudder
/// (rad, in the signs of the equations of motion), throttle (0 to 1), rate of the angle of attack (rad/s).
pub(super) const VARIABLES: usize = 13;
/// Place of the rate of the angle of attack among the variables.
pub(super) const ALPHA_RATE: usize = 12;
/// Gas constant of air, J/(kg K), its ratio of specific heats, and its density at sea level, kg/m3.
const GAS: f64 = 8314.32 / 28.9644;
const RATIO_OF_HEATS: f64 = 1.4;
const SEA_DENSITY: f64 = 1.225;

/// The variables of a flight without a rate of the angle of attack.
pub(super) fn variables<T: Scalar>(air: &AirData<T>, [p, q, r]: [T; 3], controls: &Controls<T>) -> [T; VARIABLES] {
    let Controls { throttle, elevator, aileron, rudder } = *controls;
    let none = T::from(0.0);
    [air.speed, air.alpha, air.beta, air.density, air.mach, p, q, r, elevator, aileron, rudder, throttle, none]
}

/// What the aerodynamics may ask for.
pub(super) fn flow<T: Scalar>(x: &[T; VARIABLES], with_altitude: bool) -> Flow<T> {
    let &[speed, alpha, beta, density, mach, p, q, r, elevator, aileron, rudder, throttle, alpha_rate] = x;
    let zero = T::from(0.0);
    let sound = speed / mach;
    let temperature = sound * sound / (RATIO_OF_HEATS * GAS);
    let mut flow = [zero; FEEDS];
    for (feed, value) in [
        (Feed::Speed, speed),
        (Feed::EquivalentAirspeed, speed * (density / SEA_DENSITY).sqrt()),
        (Feed::Alpha, alpha),
        (Feed::Beta, beta),
        (Feed::AlphaRate, alpha_rate),
        (Feed::RollRate, p),
        (Feed::PitchRate, q),
        (Feed::YawRate, r),
        (Feed::PitchAngle, alpha),
        (Feed::Mach, mach),
        (Feed::DynamicPressure, density * speed * speed * 0.5),
        (Feed::Pressure, density * temperature * GAS),
        (Feed::Temperature, temperature),
        (Feed::Density, density),
        (Feed::SpeedOfSound, sound),
        (Feed::Altitude, if with_altitude { altitude(density) } else { zero }),
        (Feed::Elevator, elevator),
        (Feed::Aileron, aileron),
        (Feed::Rudder, rudder),
        (Feed::Throttle, throttle),
    ] {
        flow[feed as usize] = value;
    }
    flow
}

/// What the thrust may ask for, in axial flow: power (percent), altitude (m) and Mach number.
pub(super) fn flow_of_thrust<T: Scalar>([power, altitude, mach]: [T; 3]) -> Flow<T> {
    let zero = T::from(0.0);
    let air = Atmosphere::Standard.at(altitude);
    let speed = mach * air.speed_of_sound;
    let mut flow = [zero; FEEDS];
    for (feed, value) in [
        (Feed::Speed, speed),
        (Feed::EquivalentAirspeed, speed * (air.density / SEA_DENSITY).sqrt()),
        (Feed::Mach, mach),
        (Feed::DynamicPressure, air.density * speed * speed * 0.5),
        (Feed::Pressure, air.pressure),
        (Feed::Temperature, air.temperature),
        (Feed::Density, air.density),
        (Feed::SpeedOfSound, air.speed_of_sound),
        (Feed::Altitude, altitude),
        (Feed::Throttle, power * 0.01),
    ] {
        flow[feed as usize] = value;
    }
    flow
}

/// Altitude that a density has in the standard atmosphere of the equations of motion, m: a step of Newton from the geometric
/// height, which has the derivative too, after one for the value.
fn altitude<T: Scalar>(density: T) -> T {
    let mut height = altitude_of_density_m(density.real());
    let at = |height: f64| {
        let Dual { value, derivatives: [slope] } = Atmosphere::Standard.at(Dual::<1>::variable(height, 0)).density;
        (value, slope)
    };
    for _ in 0..3 {
        let (value, slope) = at(height);
        height -= (value - density.real()) / slope;
    }
    let (value, slope) = at(height);
    T::from(height) + (density - value) / slope
}
