//! Speed of the F-16: `cargo bench -p phugoid-flight-dynamics`. Every row is one operation on one core.

#![allow(clippy::expect_used, missing_docs)] // a bench may stop, and criterion makes its own public items

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::integrate::rk4_step;
use phugoid_flight_dynamics::longitudinal::{LongitudinalLoads, LongitudinalState, longitudinal_motion};
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use std::hint::black_box;

/// A turning, slightly sideslipping flight at 20,000 ft: nothing is zero, so nothing can be left out.
fn flight() -> (State, Controls) {
    let state = State {
        speed: 205.74,
        alpha: 0.06,
        beta: 0.02,
        phi: 0.4,
        theta: 0.05,
        psi: 1.0,
        p: 0.02,
        q: 0.03,
        r: 0.04,
        north: 100.0,
        east: 200.0,
        altitude: 6096.0,
        power: 20.0,
    };
    (state, Controls { throttle: 0.3, elevator: -0.034, aileron: 0.003, rudder: -0.002 })
}

/// Rates of the plane of symmetry, air data and coefficients included.
fn plane<T: Scalar>(aircraft: &F16, state: &LongitudinalState<T>, elevator: f64) -> LongitudinalState<T> {
    let geometry = aircraft.geometry();
    let mass = aircraft.mass_properties();
    let density = Atmosphere::Book.at(6096.0).density;
    let force = state.speed * state.speed * (0.5 * density * geometry.wing_area);
    let q_hat = state.q * (0.5 * geometry.mean_chord) / state.speed;
    let (cx, cz, cm) = aircraft.longitudinal_coefficients(state.alpha, q_hat, T::from(elevator));
    let loads = LongitudinalLoads {
        force_x: force * cx + 9900.0,
        force_z: force * cz,
        pitching_moment: force * cm * geometry.mean_chord,
    };
    longitudinal_motion(state, &loads, mass.mass(), mass.pitch_inertia(), aircraft.gravity()).rates
}

fn flight_dynamics(criterion: &mut Criterion) {
    let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() }).expect("embedded data");
    let (state, controls) = flight();
    let still = Disturbance::default();
    let gusty = Disturbance {
        gust: [1.0, 2.0, 3.0],
        increments: Increments { dCm_alpha: -0.2, dCL_alpha: 0.4, dCn_beta: 0.01, ..Increments::NONE },
        ..Disturbance::default()
    };
    let mut group = criterion.benchmark_group("f16");
    group.throughput(Throughput::Elements(1));

    group.bench_function("rk4_step_6dof", |bencher| {
        let mut x = state.to_array();
        let start = x;
        let mut steps = 0_u32;
        bencher.iter(|| {
            // Begin again every 10 s of flight, so that the aircraft stays where aircraft fly.
            steps += 1;
            if steps == 1000 {
                (x, steps) = (black_box(start), 0);
            }
            x = rk4_step(
                |_, x| motion(&aircraft, &State::from_array(*x), &controls, &still).rates.to_array(),
                0.0,
                &x,
                0.01,
            );
            x[0]
        });
    });
    group.bench_function("motion_6dof", |bencher| {
        bencher.iter(|| motion(&aircraft, black_box(&state), black_box(&controls), &still));
    });
    group.bench_function("motion_6dof_gust_and_increments", |bencher| {
        bencher.iter(|| motion(&aircraft, black_box(&state), black_box(&controls), black_box(&gusty)));
    });
    group.bench_function("motion_6dof_dual13", |bencher| {
        let x = state.to_array();
        let duals = State::from_array(core::array::from_fn(|i| Dual::<13>::variable(x[i], i)));
        let controls = Controls {
            throttle: Dual::from(controls.throttle),
            elevator: Dual::from(controls.elevator),
            aileron: Dual::from(controls.aileron),
            rudder: Dual::from(controls.rudder),
        };
        bencher.iter(|| motion(&aircraft, black_box(&duals), &controls, &still).rates);
    });
    group.bench_function("longitudinal", |bencher| {
        let x = LongitudinalState { speed: 205.74, alpha: 0.042, theta: 0.042, q: 0.01 };
        bencher.iter(|| plane(&aircraft, black_box(&x), black_box(-0.034)));
    });
    group.bench_function("longitudinal_dual4", |bencher| {
        let x = LongitudinalState {
            speed: Dual::<4>::variable(205.74, 0),
            alpha: Dual::variable(0.042, 1),
            theta: Dual::variable(0.042, 2),
            q: Dual::variable(0.01, 3),
        };
        bencher.iter(|| plane(&aircraft, black_box(&x), black_box(-0.034)));
    });
    group.finish();
}

criterion_group!(benches, flight_dynamics);
criterion_main!(benches);
