//! Trim, linearisation and simulation of an aircraft that is not the F-16.
#![allow(clippy::unwrap_used, clippy::panic)] // tests may

use crate::light_aircraft;

use light_aircraft::{CL_0, CL_ALPHA, CL_ELEVATOR, CM_ALPHA, CM_ELEVATOR, CM_Q, LightAircraft, SPEED};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls};
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::simulate::{Simulation, still_air};
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, TrimError, trim};

fn trimmed(aircraft: &LightAircraft) -> Trim {
    trim(aircraft, &TrimCondition::steady(aircraft, SPEED, 0.0, 0.0, 0.0)).unwrap()
}

/// The published lift coefficient of the condition is 0.41 at zero angle of attack, its weight 2750 lb.
#[test]
fn it_trims_where_lift_is_weight() {
    let aircraft = LightAircraft::new();
    let t = trimmed(&aircraft);
    assert!(t.alpha_rad.abs() < 0.02 && (0.0..1.0).contains(&t.throttle), "{t:?}");
    // No moment: the elevator balances the angle of attack alone.
    assert!((t.elevator_rad + t.alpha_rad * CM_ALPHA / CM_ELEVATOR).abs() < 1e-12);
    let lift = CL_0 + CL_ALPHA * t.alpha_rad + CL_ELEVATOR * t.elevator_rad;
    let weight = aircraft.mass_properties().mass() * aircraft.gravity();
    let force = lift * t.dynamic_pressure_pa * aircraft.geometry().wing_area + t.thrust_n * t.alpha_rad.sin();
    assert!((force / weight - 1.0).abs() < 1e-9, "{force} {weight}");
    // Slower than its lift allows within the range of its data.
    let slow = TrimCondition::steady(&aircraft, 0.5 * SPEED, 0.0, 0.0, 0.0);
    let refused = trim(&aircraft, &slow).unwrap_err();
    assert!(!matches!(refused, TrimError::NoConvergence { .. }), "{refused}");
}

#[test]
fn its_linear_model_has_its_derivatives() {
    let aircraft = LightAircraft::new();
    let t = trimmed(&aircraft);
    let part = linearize(&aircraft, &t.state(), &t.controls(), &Disturbance::default()).longitudinal().unwrap();
    let g = aircraft.geometry();
    let moment = t.dynamic_pressure_pa * g.wing_area * g.mean_chord / aircraft.pitch_inertia();
    // States speed, alpha, theta, q; inputs elevator, throttle.
    let near = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
    near(part.a[3][1], moment * CM_ALPHA);
    near(part.a[3][3], moment * CM_Q * g.mean_chord / (2.0 * SPEED));
    near(part.b[3][0], moment * CM_ELEVATOR);
    assert_eq!(part.b[3][1], 0.0);
    assert!(part.modes.iter().all(|mode| mode.eigenvalue_real < 0.0), "a stable aircraft: {:?}", part.modes);
}

#[test]
fn it_stays_in_trim_and_answers_the_elevator() {
    let aircraft = LightAircraft::new();
    let t = trimmed(&aircraft);
    let simulation = Simulation::new(&aircraft, t.state(), t.controls(), 2.0);
    let at_rest = simulation.run(|_| t.controls(), still_air).unwrap();
    let last = at_rest.samples.last().unwrap();
    assert!((last.state.alpha - t.alpha_rad).abs() < 1e-9 && (last.state.speed - SPEED).abs() < 1e-9);
    let up = |_: f64| Controls { elevator: t.elevator_rad - 0.02, ..t.controls() };
    let pulled = simulation.run(up, still_air).unwrap();
    assert!(pulled.samples.last().unwrap().state.alpha > t.alpha_rad + 0.01, "the nose comes up");
}
