//! The printed two-parameter law: what it finds, and why it cannot find more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::{Estimator, Phase, Sample};
use phugoid_thesis::laws::{Evaluation, ThesisError, TwoParameterLaw, TwoParameterSettings};
use phugoid_thesis::plants::SecondOrder;
use plants::*;

type Law = TwoParameterLaw<SecondOrder, 2>;

/// Table 4.3, case 1: a1 = 8, a2 = 6, unit step, eta = 0.001; start values and bounds are ours.
const TRUTH: [f64; 2] = [8.0, 6.0];
const BOUNDS: [[f64; 2]; 2] = [[4.0, 16.0], [3.0, 12.0]];
const START: [f64; 2] = [5.0, 9.0];

fn settings(lambda: [f64; 2], evaluation: Evaluation) -> TwoParameterSettings<2> {
    TwoParameterSettings::as_printed(START, BOUNDS, lambda, 1e-3, evaluation)
}

fn step_response(samples: usize) -> Vec<Sample<[f64; 1], 3>> {
    fly(&SecondOrder, &regular(samples, 0.001), [0.0; 2], |_| TRUTH, |_| [1.0], [0.0; 3], &mut seeded(1))
}

#[test]
fn solved_the_law_holds_at_every_sample_and_still_does_not_find_two_parameters() {
    let flight = step_response(6000);
    for lambda in [[1.0, 1.0], [10.0, 1.0], [1.0, 10.0], [5.0, 20.0]] {
        let mut law = Law::new(SecondOrder, settings(lambda, Evaluation::Implicit)).unwrap();
        let mut estimate = law.update(&flight[0]);
        for sample in &flight[1..] {
            estimate = law.update(sample);
            let d = law.diagnostics();
            assert_eq!(estimate.status.phase, Phase::Sliding);
            for i in 0..2 {
                // The printed equation itself.
                let error = estimate.parameters[i] * d.denominator[i] - d.surface_rate[i];
                assert!(error.abs() < 1e-9, "surface {i}: {error}");
            }
            // The data are of rank one at every instant; what the loop has beyond that it has from eta and k.
            assert_eq!(d.information[1], 0.0);
        }
        let [a1, a2] = estimate.parameters;
        println!("lambda {lambda:?}: a1 = {a1:.3}, a2 = {a2:.3} after 6 s (true {TRUTH:?})");
        assert!((a1 / TRUTH[0] - 1.0).abs() > 0.05 || (a2 / TRUTH[1] - 1.0).abs() > 0.05);
    }
}

/// `sdot_1 - sdot_2 = (lambda_1 - lambda_2)(x x' - xm xm')` holds no parameter: the lines on which the surfaces rest are
/// parallel and equally far apart whatever the estimates are, and one line for equal lambdas.
#[test]
fn both_surfaces_ask_for_parallel_lines() {
    let flight = step_response(2);
    let distance = |start: [f64; 2], lambda| {
        let mut settings = settings(lambda, Evaluation::Implicit);
        settings.parameters = start;
        settings.bounds = [[0.1, 100.0]; 2];
        let mut law = Law::new(SecondOrder, settings).unwrap();
        // Away from the plant, so that F is not zero.
        law.update(&Sample { time_s: 0.0, input: [1.0], outputs: [0.3, 0.5, 0.0] });
        law.update(&flight[1]);
        let d = *law.diagnostics();
        assert!(d.information[0] > 0.1 && d.information[1] == 0.0);
        let [x, v] = *law.state();
        let f = x * v - flight[1].outputs[0] * flight[1].outputs[1];
        (d.level[1] - d.level[0], f)
    };
    for start in [[5.0, 9.0], [30.0, 1.0], [0.2, 60.0]] {
        let (apart, f) = distance(start, [7.0, 2.0]);
        assert!((apart - (7.0 - 2.0) * f).abs() < 1e-12 && f > 0.1);
        assert!(distance(start, [3.0, 3.0]).0.abs() < 1e-12);
    }
}

/// With equal lambdas the damped form moves both estimates by the same amount: their difference is what it was.
#[test]
fn the_damped_form_with_one_lambda_never_learns_the_difference() {
    let mut law = Law::new(SecondOrder, settings([1.0, 1.0], Evaluation::Implicit).damped()).unwrap();
    let mut moved = 0.0_f64;
    for sample in &step_response(1500) {
        let [a1, a2] = law.update(sample).parameters;
        assert!((a2 - a1 - (START[1] - START[0])).abs() < 1e-9);
        moved = moved.max((a1 - START[0]).abs());
    }
    assert!(moved > 1.0);
}

#[test]
fn with_a_delayed_sample_the_law_diverges_and_says_so() {
    for lambda in [[1.0, 1.0], [10.0, 1.0], [1.0, 10.0]] {
        let mut law = Law::new(SecondOrder, settings(lambda, Evaluation::Delayed)).unwrap();
        let flight = step_response(6000);
        let phases: Vec<_> = flight.iter().map(|sample| law.update(sample).status.phase).collect();
        let stopped = phases.iter().position(|phase| *phase == Phase::Diverged).expect("diverges");
        println!("lambda {lambda:?}: not a number from {stopped} ms on");
        assert!(phases[stopped..].iter().all(|phase| *phase == Phase::Diverged));
    }
}

#[test]
fn impossible_settings_are_refused() {
    let good = settings([1.0, 1.0], Evaluation::Implicit);
    let refuse = |settings| Law::new(SecondOrder, settings).err().unwrap();
    let mut wrong = good;
    wrong.bounds[1] = [-1.0, 2.0];
    assert_eq!(refuse(wrong), ThesisError::Bounds { lower: -1.0, upper: 2.0 });
    let mut wrong = good;
    wrong.acceleration = 3;
    assert_eq!(refuse(wrong), ThesisError::Channel { index: 0 });
    let mut wrong = good;
    wrong.lambda[1] = 0.0;
    assert_eq!(refuse(wrong), ThesisError::Setting { name: "lambda", value: 0.0 });
}
