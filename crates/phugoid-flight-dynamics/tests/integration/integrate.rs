//! The integrators against known solutions, their orders of convergence and their conserved quantities.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests

use std::f64::consts::PI;

use phugoid_flight_dynamics::integrate::{DormandPrince, IntegrationError, rk4_step};
use proptest::prelude::*;

/// Two bodies, eccentricity 0.6, period 2 pi, from the pericentre: `[x, y, x', y']` (Hairer I, section II.0).
const KEPLER: [f64; 4] = [0.4, 0.0, 0.0, 2.0];

fn kepler(_: f64, x: &[f64; 4]) -> [f64; 4] {
    let r3 = (x[0] * x[0] + x[1] * x[1]).powf(1.5);
    [x[2], x[3], -x[0] / r3, -x[1] / r3]
}

fn kepler_energy(x: &[f64; 4]) -> f64 {
    0.5 * (x[2] * x[2] + x[3] * x[3]) - 1.0 / x[0].hypot(x[1])
}

fn distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn rk4(f: impl Fn(f64, &[f64; 2]) -> [f64; 2], start: [f64; 2], end: f64, steps: usize) -> [f64; 2] {
    let h = end / steps as f64;
    (0..steps).fold(start, |x, i| rk4_step(&f, i as f64 * h, &x, h))
}

/// `x' = y + cos t, y' = -x`: the resonant oscillator `x = t cos(t)/2 + sin(t)/2, y = -t sin(t)/2`, explicit in time.
fn resonant(t: f64, x: &[f64; 2]) -> [f64; 2] {
    [x[1] + t.cos(), -x[0]]
}

fn resonant_solution(t: f64) -> [f64; 2] {
    [0.5 * (t * t.cos() + t.sin()), -0.5 * t * t.sin()]
}

#[test]
fn rk4_converges_with_order_four() {
    let errors: Vec<f64> =
        [50, 100, 200, 400].map(|n| distance(&rk4(resonant, [0.0; 2], 5.0, n), &resonant_solution(5.0))).to_vec();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 4.0).abs() < 0.1, "order {order} from errors {errors:?}");
    }
}

#[test]
fn rk4_is_exact_for_cubics() {
    // A method of order four integrates x' = t^3 (Simpson's rule) without error.
    let x = rk4_step(|t, _: &[f64; 1]| [t * t * t], 1.0, &[0.25], 2.0);
    assert!((x[0] - 81.0 / 4.0).abs() < 1e-13);
}

#[test]
fn dormand_prince_meets_its_tolerance_with_order_five() {
    // One orbit of the two-body problem. Error per unit of cost: with order five, 1/1024 the error costs about 4 times.
    let run = |tolerance: f64| {
        let mut end = KEPLER;
        let cost = DormandPrince::with_tolerances(tolerance, tolerance)
            .integrate_to_times(kepler, 0.0, &KEPLER, &[2.0 * PI], |_, x| end = *x)
            .unwrap();
        (distance(&end, &KEPLER), cost)
    };
    let (coarse, coarse_cost) = run(1e-6);
    let (fine, fine_cost) = run(1e-10);
    assert!(coarse < 1e-3 && fine < 1e-7, "{coarse:e} {fine:e}");
    let order = (coarse / fine).ln() / (fine_cost.accepted_steps as f64 / coarse_cost.accepted_steps as f64).ln();
    assert!((4.3..6.0).contains(&order), "order {order}, {coarse_cost:?}, {fine_cost:?}");
    assert!(coarse_cost.evaluations < 800, "{coarse_cost:?}");
}

#[test]
fn energy_and_dense_output_along_the_orbit() {
    let solver = DormandPrince::with_tolerances(1e-10, 1e-10);
    let times: Vec<f64> = (0..=200).map(|i| i as f64 * 0.05).collect();
    let mut worst_energy: f64 = 0.0;
    let mut worst_interpolation: f64 = 0.0;
    let mut seen = Vec::new();
    solver
        .integrate_to_times(kepler, 0.0, &KEPLER, &times, |t, x| {
            seen.push(t);
            worst_energy = worst_energy.max((kepler_energy(x) - kepler_energy(&KEPLER)).abs());
            // The same time landed on instead of interpolated.
            let landed = solver.integrate(kepler, 0.0, &KEPLER, t).unwrap();
            worst_interpolation = worst_interpolation.max(distance(x, &landed));
        })
        .unwrap();
    assert_eq!(seen, times);
    assert!(worst_energy < 2e-8, "{worst_energy:e}");
    assert!(worst_interpolation < 1e-7, "{worst_interpolation:e}");
}

#[test]
fn the_right_hand_side_is_never_asked_beyond_the_end() {
    let mut latest: f64 = 0.0;
    let f = |t: f64, x: &[f64; 1]| {
        latest = latest.max(t);
        [-x[0]]
    };
    let x = DormandPrince::with_tolerances(1e-9, 1e-12).integrate(f, 0.0, &[1.0], 3.0).unwrap();
    assert!(latest <= 3.0 + 1e-15, "{latest}");
    assert!((x[0] - (-3.0_f64).exp()).abs() < 1e-9);
}

#[test]
fn errors_carry_numbers() {
    let solver = DormandPrince::<1>::with_tolerances(1e-8, 1e-8);
    // x' = x^2, x(0) = 1 has its pole at t = 1.
    match solver.integrate(|_, x| [x[0] * x[0]], 0.0, &[1.0], 2.0) {
        Err(IntegrationError::StepSizeTooSmall { time, .. }) => assert!((time - 1.0).abs() < 1e-6, "{time}"),
        other => panic!("{other:?}"),
    }
    assert_eq!(
        solver.integrate(|_, _| [f64::NAN], 0.5, &[1.0], 2.0),
        Err(IntegrationError::NotFinite { time: 0.5, component: 0 })
    );
    assert_eq!(
        solver.integrate(|_, x| *x, 1.0, &[1.0], 0.0),
        Err(IntegrationError::TimeNotIncreasing { time: 0.0, previous: 1.0 })
    );
    let few = DormandPrince { maximum_steps: 3, ..solver };
    assert!(matches!(
        few.integrate(|t, _| [(50.0 * t).cos()], 0.0, &[0.0], 10.0),
        Err(IntegrationError::TooManySteps { steps: 3, .. })
    ));
    let none = DormandPrince::<1>::with_tolerances(0.0, 0.0);
    assert_eq!(none.integrate(|_, x| *x, 0.0, &[1.0], 1.0), Err(IntegrationError::InvalidTolerance { component: 0 }));
}

#[test]
fn a_step_as_short_as_rounding_is_no_error() {
    let solver = DormandPrince::<1>::with_tolerances(1e-8, 1e-8);
    let start = 1000.0;
    let end = start + 2.0 * f64::EPSILON * start;
    assert!((solver.integrate(|_, x| *x, start, &[1.0], end).unwrap()[0] - 1.0).abs() < 1e-11);
}

proptest! {
    /// The adaptive method follows a damped oscillation of any frequency to within a known factor of its tolerance.
    #[test]
    fn damped_oscillation_for_any_frequency(w in 0.1..20.0_f64, zeta in 0.0..0.95_f64, end in 0.0..10.0_f64) {
        let f = |_: f64, x: &[f64; 2]| [x[1], -w * w * x[0] - 2.0 * zeta * w * x[1]];
        let x = DormandPrince::with_tolerances(1e-10, 1e-10).integrate(f, 0.0, &[1.0, 0.0], end).unwrap();
        let wd = w * (1.0 - zeta * zeta).sqrt();
        let exact = (-zeta * w * end).exp() * ((wd * end).cos() + zeta * w / wd * (wd * end).sin());
        prop_assert!((x[0] - exact).abs() < 1e-6, "{} {}", x[0], exact);
    }
}
