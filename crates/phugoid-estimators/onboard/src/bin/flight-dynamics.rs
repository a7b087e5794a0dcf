//! The equations of motion without the standard library, as numbers and with derivatives, for the F-16.
#![no_std]
#![no_main]

use core::hint::black_box;

use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::f16::F16;
use phugoid_flight_dynamics::gust::{Gust, total_velocity};
use phugoid_flight_dynamics::integrate::{DormandPrince, rk4_step};
use phugoid_flight_dynamics::longitudinal::{LongitudinalLoads, LongitudinalState, longitudinal_motion};
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use phugoid_flight_dynamics::table::UniformAxis;
// Its panic handler.
use phugoid_onboard as _;

/// Flies an aircraft of which the compiler knows nothing.
fn fly<T: Scalar>(aircraft: &F16, disturbance: &Disturbance, number: impl Fn() -> T) {
    let state = black_box(State::from_array(core::array::from_fn(|_| number())));
    let controls = Controls { throttle: number(), elevator: number(), aileron: number(), rudder: number() };
    black_box(motion(aircraft, &state, &controls, disturbance));
    black_box((
        aircraft.longitudinal_coefficients(number(), number(), number()),
        aircraft.power_rate(number(), number()),
        aircraft.steady_power(number()),
    ));
    let longitudinal = LongitudinalState { speed: number(), alpha: number(), theta: number(), q: number() };
    let loads = LongitudinalLoads { force_x: number(), force_z: number(), pitching_moment: number() };
    black_box(longitudinal_motion(&longitudinal, &loads, black_box(1.0), black_box(1.0), black_box(1.0)));
}

/// Where the linker begins. The name has to be this one, which Rust calls unsafe. Nothing is known of the arguments.
#[unsafe(no_mangle)]
pub extern "C" fn _start(aircraft: &F16, disturbance: &Disturbance, gust: &Gust, times: &[f64; 3]) {
    fly::<f64>(aircraft, disturbance, || black_box(1.0));
    fly::<Dual<4>>(aircraft, disturbance, || black_box(Dual::variable(1.0, black_box(0))));
    let controls = || black_box(Controls { throttle: 0.5, elevator: 0.0, aileron: 0.0, rudder: 0.0 });
    let positions = || black_box([0.0; 3]);
    black_box((
        aircraft.actuators.rates(&controls(), positions()),
        aircraft.actuators.controls(&controls(), positions()),
        aircraft.actuators.reachable(&controls()),
    ));
    black_box(total_velocity(core::slice::from_ref(gust), black_box(1.0)));
    let increments = disturbance.increments;
    black_box((
        increments.about(black_box(0.1), 0.0, 0.0).towards(&increments, black_box(0.5)),
        increments.named_longitudinal(),
        increments.is_lateral(),
        increments.is_longitudinal(),
    ));
    black_box((
        MassProperties::from_tensor(black_box(1.0), black_box([[1.0; 3]; 3]), black_box(0.0)),
        MassProperties::from_stevens_lewis_constants(black_box(1.0), black_box([1.0; 9]), black_box(0.0)),
    ));
    let rates = |t: f64, x: &[f64; 4]| *black_box(&x.map(|x| t * x));
    black_box(rk4_step(rates, times[0], &[1.0; 4], times[1]));
    let method = black_box(DormandPrince::<4>::with_tolerances(1e-6, 1e-6));
    black_box(method.integrate_to_times(rates, times[0], &black_box([1.0; 4]), times, |t, x| {
        black_box((t, x));
    }))
    .ok();
    black_box((UniformAxis::<9>::new(times[0], times[1]), UniformAxis::<3>::from_points(times)));
}
