//! The thesis's law: its rest points, its forms, and what its loop needs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::{Estimator, ParameterStatus, Phase, Sample};
use phugoid_thesis::laws::{
    Evaluation, LawSign, SurfaceChannel, SurfaceDerivative, ThesisError, ThesisForm, ThesisLaw, ThesisSettings,
};
use phugoid_thesis::plants::{FirstOrder, FirstOrderNonlinear};
use plants::*;

fn first_order_settings(start: f64, bounds: [f64; 2], form: ThesisForm) -> ThesisSettings<1, 1, 1> {
    let channel = SurfaceChannel { state: 0, output: 0, scale: 1.0, derivative: SurfaceDerivative::Output(1) };
    let mut settings = ThesisSettings::new(0, [start], bounds, [channel]);
    settings.form = form;
    settings.lambda = 10.0;
    settings.eta = 0.01;
    settings
}

/// Estimates over a noise-free step response of `seconds` at 1 kHz.
fn first_order(a: f64, settings: ThesisSettings<1, 1, 1>, seconds: f64, x0: f64) -> Vec<(f64, f64)> {
    let n = (seconds * 1000.0) as usize;
    let flight = fly(&FirstOrder, &regular(n, 0.001), [x0], |_| [a], |_| [1.0], [0.0; 2], &mut seeded(1));
    let mut law = ThesisLaw::<_, 1, 2, 1, 1>::new(FirstOrder, settings).unwrap();
    flight.iter().map(|sample| (sample.time_s, law.update(sample).parameters[0])).collect()
}

/// First time after which the estimate stays within 5 % of the truth.
fn settled(history: &[(f64, f64)], truth: f64) -> Option<f64> {
    match history.iter().rposition(|(_, value)| (value / truth - 1.0).abs() > 0.05) {
        None => Some(0.0),
        Some(last) => history.get(last + 1).map(|(t, _)| *t),
    }
}

/// Theory section 0: `eta` is a bias. Reduced and printed law rest at `E = theta eta/lambda`: for u = 1 the estimate
/// stands at 4.516 for a = 5 and 2.924 for a = 3 (eta = 0.01, lambda = 10). Closed form: with x = 1/a, xm = 1/theta,
/// (1/theta^2 - 1/a^2)/2 = theta eta/lambda.
#[test]
fn eta_biases_the_printed_and_the_reduced_law_and_not_the_damped_one() {
    for (a, rest) in [(5.0, 4.516), (3.0, 2.924)] {
        for form in [ThesisForm::Reduced, ThesisForm::Printed] {
            let history = first_order(a, first_order_settings(4.0, [1.0, 16.0], form), 20.0, 0.0);
            let end = history.last().unwrap().1;
            assert!((end - rest).abs() < 1e-3, "{form:?}, a = {a}: {end}");
            let theta = end;
            let balance = (1.0 / (theta * theta) - 1.0 / (a * a)) / 2.0 - theta * 0.001;
            assert!(balance.abs() < 1e-6, "{balance}");
        }
        let history = first_order(a, first_order_settings(4.0, [1.0, 16.0], ThesisForm::Damped), 20.0, 0.0);
        assert!((history.last().unwrap().1 - a).abs() < 1e-6 * a);
    }
}

/// Thesis table 4.1: 0.5 s for a = 3, 1.5 s for a = 5, 0.1 s for a = -1 (unstable: the run ends while it is finite).
#[test]
fn the_damped_form_is_faster_than_the_published_runs() {
    for (a, bounds, published) in [(3.0, [1.0, 9.0], 0.5), (5.0, [1.0, 16.0], 1.5), (-1.0, [-1.5, -0.5], 0.1)] {
        let start = if a > 0.0 { 4.0 } else { -0.8 };
        let mut settings = first_order_settings(start, bounds, ThesisForm::Damped);
        settings.eta = 1e-4;
        let history = first_order(a, settings, 3.0, 0.0);
        let time = settled(&history, a).expect("settles");
        println!("a = {a}: within 5 % after {time} s, published {published}");
        assert!(time < published, "a = {a}: {time}");
    }
}

#[test]
fn without_a_measured_derivative_the_condition_is_integrated() {
    let mut settings = first_order_settings(4.0, [1.0, 16.0], ThesisForm::Damped);
    settings.channels[0].derivative = SurfaceDerivative::Integrated;
    settings.eta = 1e-4;
    let history = first_order(5.0, settings, 3.0, 0.0);
    let time = settled(&history, 5.0).expect("settles");
    println!("integrated: within 5 % after {time} s");
    assert!(time < 0.5);
    // Exact: no lag of half a sample.
    assert!((history.last().unwrap().1 - 5.0).abs() < 1e-6);
}

/// The pitching moment from the pitch-rate energy of the short period, noise free, 100 Hz, no derivative measured.
#[test]
fn pitch_stiffness_from_the_pitch_rate_energy() {
    let truth: [f64; 4] = core::array::from_fn(|j| JET_TRUTH[j]);
    let flight = fly(&JET, &regular(1000, 0.01), [0.0; 2], |_| truth, |t| [elevator_3211(t)], [0.0; 3], &mut seeded(1));
    let channel = SurfaceChannel { state: 1, output: 1, scale: 0.05, derivative: SurfaceDerivative::Integrated };
    let mut start = truth;
    start[0] = -0.35;
    let mut settings = ThesisSettings::<2, 4, 1>::new(0, start, [-1.2, -0.1], [channel]);
    settings.follow = [true, false];
    settings.eta = 1e-3;
    let mut law = ThesisLaw::<_, 2, 3, 4, 1>::new(JET, settings).unwrap();
    let mut history = Vec::new();
    for sample in &flight {
        let estimate = law.update(sample);
        history.push((sample.time_s, estimate.parameters[0]));
        assert!(estimate.std_error[0].is_infinite());
        if sample.time_s < 0.9 {
            // Level flight says nothing about stiffness.
            assert_eq!(estimate.parameter_status[0], ParameterStatus::NotExcited);
        }
    }
    let time = settled(&history, truth[0]).expect("settles");
    println!("Cma within 5 % at {time} s, elevator from 1 s; end {}", history.last().unwrap().1);
    assert!(time < 3.0);
}

#[test]
fn missing_values_backward_time_and_gaps_do_no_harm() {
    let mut settings = first_order_settings(4.0, [1.0, 16.0], ThesisForm::Damped);
    settings.eta = 1e-4;
    let mut flight = fly(&FirstOrder, &regular(3000, 0.001), [0.0], |_| [5.0], |_| [1.0], [0.0; 2], &mut seeded(1));
    for (k, sample) in flight.iter_mut().enumerate() {
        match k % 7 {
            0 => sample.outputs[0] = f64::NAN,
            3 => sample.outputs[1] = f64::INFINITY,
            _ => {}
        }
    }
    flight[500].time_s = 0.1;
    flight[600].input = [f64::NAN];
    let mut law = ThesisLaw::<_, 1, 2, 1, 1>::new(FirstOrder, settings).unwrap();
    let mut refused = 0;
    for sample in &flight {
        let estimate = law.update(sample);
        assert!(estimate.parameters[0].is_finite());
        if estimate.status.phase == Phase::Rejected {
            refused += 1;
        }
    }
    assert!(refused >= 1);
    assert!((law.update(&Sample { time_s: 3.0, ..flight[2999] }).parameters[0] - 5.0).abs() < 0.01);
    // After a long pause the model starts again on the measurement.
    let late = Sample { time_s: 100.0, input: [1.0], outputs: [0.2, 0.0] };
    law.update(&late);
    assert_eq!(law.state()[0], 0.2);
}

#[test]
fn impossible_settings_are_refused() {
    let good = first_order_settings(4.0, [1.0, 16.0], ThesisForm::Printed);
    let refuse = |settings| ThesisLaw::<_, 1, 2, 1, 1>::new(FirstOrder, settings).err().unwrap();
    let mut wrong = good;
    wrong.lower = -1.0;
    assert_eq!(refuse(wrong), ThesisError::Bounds { lower: -1.0, upper: 16.0 });
    let mut wrong = good;
    wrong.parameter = 1;
    assert_eq!(refuse(wrong), ThesisError::Parameter { index: 1, count: 1 });
    let mut wrong = good;
    wrong.channels[0].derivative = SurfaceDerivative::Output(2);
    assert_eq!(refuse(wrong), ThesisError::Channel { index: 0 });
    let mut wrong = good;
    wrong.eta = 0.0;
    wrong.input_hold = InputHold::Linear;
    assert_eq!(refuse(wrong), ThesisError::Setting { name: "eta", value: 0.0 });
    assert!(refuse(wrong).to_string().contains("eta"));
}

/// Step response of `a` under the printed law at 1 kHz for three seconds: estimates, and the law as it ends.
fn printed(a: f64, bounds: [f64; 2], evaluation: Evaluation) -> (Vec<f64>, ThesisLaw<FirstOrder, 1, 2, 1, 1>, Phase) {
    let start = if a > 0.0 { 4.0 } else { -0.8 };
    let settings = first_order_settings(start, bounds, ThesisForm::Printed).as_printed(evaluation);
    let flight = fly(&FirstOrder, &regular(3000, 0.001), [0.0], |_| [a], |_| [1.0], [0.0; 2], &mut seeded(1));
    let mut law = ThesisLaw::<_, 1, 2, 1, 1>::new(FirstOrder, settings).unwrap();
    let (mut estimates, mut phase) = (Vec::new(), Phase::Starting);
    for sample in &flight {
        let estimate = law.update(sample);
        estimates.push(estimate.parameters[0]);
        phase = estimate.status.phase;
    }
    (estimates, law, phase)
}

/// Theory section 0: with a delay of one sample in the loop the printed law diverges or chatters in 3 of 3 cases of the
/// first-order plant; solved at every sample it settles in all three (for a = 5 on a value that eta biases).
#[test]
fn a_delayed_sample_in_the_loop_makes_the_printed_law_chatter_or_diverge() {
    for (a, bounds) in [(3.0, [1.0, 9.0]), (5.0, [1.0, 16.0])] {
        let (estimates, _, _) = printed(a, bounds, Evaluation::Delayed);
        let jumps = estimates[2000..].windows(2).filter(|pair| (pair[1] - pair[0]).abs() > 0.2 * a).count();
        println!("a = {a}, delayed: {jumps} jumps of more than 20 % in the last second");
        assert!(jumps > 500);
    }
    let (estimates, _, phase) = printed(-1.0, [-1.5, -0.5], Evaluation::Delayed);
    let last = estimates.iter().position(|value| !value.is_finite()).expect("diverges");
    println!("a = -1, delayed: not a number from {last} ms on");
    assert!(phase == Phase::Diverged && last < 1000);

    for (a, bounds, rest) in [(3.0, [1.0, 9.0], 2.924), (5.0, [1.0, 16.0], 4.516), (-1.0, [-1.5, -0.5], -1.0)] {
        let (estimates, law, phase) = printed(a, bounds, Evaluation::Implicit);
        assert!((estimates[2999] - rest).abs() < 1e-3 * rest.abs() && phase == Phase::Sliding);
        // At rest D = 0 and lambda E = theta eta: the surface itself drifts away at that rate, and its reaching condition
        // does not hold. K, which the argument needs positive, is; `K theta < 1` is not needed for convergence.
        let d = law.diagnostics();
        assert!((d.surface_rate / (estimates[2999] * 0.01) - 1.0).abs() < 0.01, "{d:?}");
        assert!(d.reaching > 0.0 && d.gain > 0.0, "{d:?}");
        println!("a = {a}, implicit: rests at {}, K theta = {}", estimates[2999], d.gain * estimates[2999]);
    }
}

/// Plant 2 with the y terms: `y'` is not measured, but known; the unknown is not in it. Table 4.2, case 1: within 2 s.
#[test]
fn the_known_rate_of_a_second_state_enters_the_surface() {
    let plant = FirstOrderNonlinear::default();
    let channel = |state, derivative| SurfaceChannel { state, output: state, scale: 1.0, derivative };
    let channels = [channel(0, SurfaceDerivative::Output(2)), channel(1, SurfaceDerivative::Known)];
    let input = |t: f64| [3.0 * (0.7 * t).sin(), (0.7 * t).sin()];
    let flight = fly(&plant, &regular(4000, 0.001), [0.0; 2], |_| [7.0], input, [0.0; 3], &mut seeded(1));
    for sign in [LawSign::FromSlope, LawSign::AsPrinted] {
        let mut settings = ThesisSettings::<2, 1, 2>::new(0, [5.0], [3.0, 14.0], channels);
        settings.eta = 1e-4;
        settings.sign = sign;
        let mut law = ThesisLaw::<_, 2, 3, 1, 2>::new(plant, settings).unwrap();
        let history: Vec<_> = flight.iter().map(|sample| (sample.time_s, law.update(sample).parameters[0])).collect();
        let time = settled(&history, 7.0).expect("settles");
        println!("{sign:?}: within 5 % after {time} s, end {}", history[3999].1);
        // sin(y) > 0 for these four seconds, where both signs are one.
        assert!(time < 2.0 && (history[3999].1 - 7.0).abs() < 0.01);
    }
}
