//! The extended law: what is said about it in its documentation, on the code itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Phase, Sample};
use phugoid_thesis::laws::{ExtendedLaw, ExtendedSettings, ThesisError};
use phugoid_thesis::plants::{SecondOrder, SecondOrderNonlinear};
use plants::*;
use rand::RngExt;

const P: usize = 3;

/// `x' = U theta` with the rows of `U` as the input, held between samples: the trapezoid is exact.
struct Rows;

impl Model<2, 2, P> for Rows {
    type Input = [f64; 6];

    fn parameter_count(&self) -> usize {
        P
    }

    fn rates(&self, _: &[f64; 2], theta: &[f64; P], u: &[f64; 6]) -> [f64; 2] {
        core::array::from_fn(|i| (0..P).map(|j| u[P * i + j] * theta[j]).sum())
    }

    fn linearized_rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 6], out: &mut LinearizedRates<2, P>) {
        *out = LinearizedRates { rates: self.rates(x, theta, u), ..LinearizedRates::ZERO };
        for i in 0..2 {
            out.regressors[i].copy_from_slice(&u[P * i..P * (i + 1)]);
        }
    }

    fn linearized_outputs(&self, x: &[f64; 2], _: &[f64; P], _: &[f64; 6], out: &mut LinearizedOutputs<2, 2, P>) {
        *out = LinearizedOutputs { outputs: *x, state_jacobian: [[1.0, 0.0], [0.0, 1.0]], ..LinearizedOutputs::ZERO };
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        Some(state)
    }
}

/// Rows of every size and rank, gains from timid to overwhelming: `V = |phi - phi_true|^2/2` never increases.
#[test]
fn the_lyapunov_function_never_increases_at_any_rank_and_gain() {
    let (mut reaching, mut sliding) = (0, 0);
    for seed in 0..200 {
        let mut rng = seeded(seed);
        let truth: [f64; P] = core::array::from_fn(|_| rng.random_range(-1.0..1.0));
        let mut settings = ExtendedSettings::<2, P>::new([0.0; P], [[-1.0, 1.0]; P], [1.0; 2]);
        settings.reaching_time_s = [0.02, 1.0, 50.0][seed as usize % 3];
        settings.memory_s = if seed % 2 == 0 { f64::INFINITY } else { 0.3 };
        let mut law = ExtendedLaw::<_, _, 2, P>::new(Rows, settings).unwrap();
        let mut v = 0.5 * truth.iter().map(|t| t * t).sum::<f64>();
        let v0 = v;
        let mut x = [0.0; 2];
        let rank = 1 + seed as usize % P;
        for k in 0..200 {
            let size = 10.0_f64.powf(rng.random_range(-2.0..1.0));
            let input: [f64; 6] = core::array::from_fn(|i| if i % P < rank { size * normal(&mut rng) } else { 0.0 });
            let estimate = law.update(&Sample { time_s: 0.01 * f64::from(k), input, outputs: x });
            let rates = Rows.rates(&x, &truth, &input);
            x = core::array::from_fn(|i| x[i] + 0.01 * rates[i]);
            let next = 0.5 * (0..P).map(|j| (estimate.parameters[j] - truth[j]).powi(2)).sum::<f64>();
            assert!(next <= v + 1e-12 * v0, "seed {seed}, sample {k}: V rose from {v} to {next}");
            v = next;
            match estimate.status.phase {
                Phase::Reaching => reaching += 1,
                Phase::Sliding => sliding += 1,
                _ => assert!(k == 0),
            }
        }
        if rank == P && settings.reaching_time_s < 0.1 {
            assert!(v < 1e-12 * v0, "seed {seed}: {v}");
        }
    }
    println!("{reaching} reaching and {sliding} sliding steps");
    assert!(reaching > 1000 && sliding > 1000, "the trials must exercise both phases");
}

/// Where the printed two-parameter law has rank one at every instant: both parameters, within 5 % and to stay, no later
/// than the thesis says. Start values and bounds are ours.
#[test]
fn both_parameters_of_the_second_order_plants_are_found() {
    let settle = |history: &[[f64; 2]], truth: [f64; 2]| {
        let outside = |e: &[f64; 2]| (0..2).any(|j| (e[j] / truth[j] - 1.0).abs() > 0.05);
        history.iter().rposition(outside).map_or(0, |k| k + 1)
    };
    // Table 4.3 case 1 and table 4.4 case 2.
    let linear = {
        let flight =
            fly(&SecondOrder, &regular(3000, 0.001), [0.0; 2], |_| [8.0, 6.0], |_| [1.0], [0.0; 3], &mut seeded(1));
        let settings = ExtendedSettings::new([5.0, 9.0], [[4.0, 16.0], [3.0, 12.0]], [0.1, 0.2]);
        let mut law = ExtendedLaw::<_, _, 2, 2>::new(SecondOrder, settings).unwrap();
        let history: Vec<[f64; 2]> = flight.iter().map(|sample| law.update(sample).parameters).collect();
        let [a, b] = *law.eigenvalues();
        println!("eigenvalues {a:.2e} and {b:.2e}");
        assert!(a.min(b) > 1e-3 * a.max(b), "full rank");
        (settle(&history, [8.0, 6.0]), history[2999])
    };
    let quadratic = {
        let plant = SecondOrderNonlinear;
        let flight =
            fly(&plant, &regular(3000, 0.001), [0.0; 2], |_| [13.0, 10.0], |_| [20.0], [0.0; 3], &mut seeded(1));
        let settings = ExtendedSettings::new([40.0, 30.0], [[4.0, 42.0], [3.0, 33.0]], [1.0, 2.0]);
        let mut law = ExtendedLaw::<_, _, 2, 2>::new(plant, settings).unwrap();
        let history: Vec<[f64; 2]> = flight.iter().map(|sample| law.update(sample).parameters).collect();
        (settle(&history, [13.0, 10.0]), history[2999])
    };
    println!("linear: {} ms, {:?}; quadratic: {} ms, {:?}", linear.0, linear.1, quadratic.0, quadratic.1);
    assert!(linear.0 < 500 && quadratic.0 < 1500);
    for (found, truth) in [(linear.1, [8.0, 6.0]), (quadratic.1, [13.0, 10.0])] {
        // The trapezoid leaves parts in a million.
        assert!((0..2).all(|j| (found[j] / truth[j] - 1.0).abs() < 1e-4), "{found:?}");
    }
}

#[test]
fn gaps_missing_values_and_backward_time_leave_exact_rows_exact() {
    let mut flight =
        fly(&SecondOrder, &regular(2000, 0.001), [0.0; 2], |_| [8.0, 6.0], |_| [1.0], [0.0; 3], &mut seeded(1));
    for k in (100..200).chain(300..320) {
        flight[k].outputs[k % 2] = f64::NAN;
    }
    flight[500].time_s = 0.1;
    let settings = ExtendedSettings::new([5.0, 9.0], [[4.0, 16.0], [3.0, 12.0]], [0.1, 0.2]);
    let mut law = ExtendedLaw::<_, _, 2, 2>::new(SecondOrder, settings).unwrap();
    let mut last = [0.0; 2];
    for sample in &flight {
        last = law.update(sample).parameters;
        assert!(last.iter().all(|value| value.is_finite()));
    }
    assert!((last[0] - 8.0).abs() < 1e-3 && (last[1] - 6.0).abs() < 1e-3, "{last:?}");
}

/// Equal bounds hold a parameter; the other is found.
#[test]
fn a_held_parameter_stays() {
    let flight =
        fly(&SecondOrder, &regular(1000, 0.001), [0.0; 2], |_| [8.0, 6.0], |_| [1.0], [0.0; 3], &mut seeded(1));
    let settings = ExtendedSettings::new([8.0, 9.0], [[8.0, 8.0], [3.0, 12.0]], [0.1, 0.2]);
    let mut law = ExtendedLaw::<_, _, 2, 2>::new(SecondOrder, settings).unwrap();
    let last = flight.iter().map(|sample| law.update(sample)).last().unwrap();
    assert_eq!(last.parameters[0], 8.0);
    assert!((last.parameters[1] - 6.0).abs() < 1e-3 && last.std_error == [0.0, f64::INFINITY]);
}

#[test]
fn impossible_settings_are_refused() {
    let good = ExtendedSettings::new([5.0, 9.0], [[4.0, 16.0], [3.0, 12.0]], [0.1, 0.2]);
    let refuse = |settings| ExtendedLaw::<_, _, 2, 2>::new(SecondOrder, settings).err().unwrap();
    let mut wrong = good;
    wrong.scale[1] = 0.0;
    assert_eq!(refuse(wrong), ThesisError::Setting { name: "scale", value: 0.0 });
    let mut wrong = good;
    wrong.bounds[0] = [4.0, f64::INFINITY];
    assert_eq!(refuse(wrong), ThesisError::Bounds { lower: 4.0, upper: f64::INFINITY });
}
