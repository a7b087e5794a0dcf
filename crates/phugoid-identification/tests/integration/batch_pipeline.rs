//! The batch methods from a record and a model file to the result, as the command line runs them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::f16::{TRUTH, fly, model};
use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
use phugoid_identification::estimation::Estimation;
use phugoid_identification::options::FlowAngles;

fn run(method: Method, options: EstimateOptions) -> Estimation {
    let options = EstimateOptions { method: Some(method), ..options };
    estimate(&fly(12.0, 0.026, 31), &model(), &options, &mut |_| {}).unwrap()
}

/// Within four of their own corrected standard errors; equation error is biased by noise in the states and gets ten per cent
/// of the prior beside.
#[test]
fn every_batch_method_finds_the_f16() {
    for method in [Method::EquationError, Method::OutputError, Method::FilterError] {
        let found = run(method, EstimateOptions::default());
        assert_eq!(found.method, method);
        let samples = found.history.time_s.len();
        for (name, truth) in TRUTH {
            let p = found.parameters.iter().find(|p| p.name == name).unwrap();
            println!("{method} {name}: {:.4} +- {:.4}, truth {truth}, {}", p.value, p.corrected_std_error, p.status);
            let allowed = if method == Method::EquationError { 0.1 * p.prior_std } else { 0.0 };
            assert!((p.value - truth).abs() < 4.0 * p.corrected_std_error + allowed, "{method} {name}: {}", p.value);
            assert!(p.corrected_std_error >= p.std_error && p.converged_at_s.is_none());
            let history = found.history.parameters.iter().find(|h| h.name == name).unwrap();
            assert!(history.value.len() == samples && history.value.iter().all(|v| *v == p.value), "constant");
        }
        let batch = found.batch.as_ref().unwrap();
        assert!(batch.prediction.is_none() && batch.iterations > 0);
        assert_eq!(batch.equations.is_empty(), method != Method::EquationError);
        for fit in &batch.manoeuvres[0].1 {
            assert!((0.0..1.0).contains(&fit.theil), "{fit:?}");
        }
        for sentence in &found.verdict {
            println!("- {sentence}");
        }
    }
}

/// In gusts output error takes airspeed and flow angles as measured, and says so; a simulation that was asked for names the method that
/// has gusts in it. In calm air neither is said.
#[test]
fn output_error_in_gusts_says_where_its_air_data_are_from() {
    let mut record = fly(12.0, 0.026, 31);
    let said = |record: &_, flow_angles| {
        let options = EstimateOptions { method: Some(Method::OutputError), flow_angles, ..EstimateOptions::default() };
        let found = estimate(record, &model(), &options, &mut |_| {}).unwrap();
        assert!(found.verdict.iter().all(|sentence| !sentence.contains("NaN")), "{:?}", found.verdict);
        let is_followed = found.batch.unwrap().measured_angles;
        let about = |sentence: &String| sentence.contains("as measured") || sentence.starts_with("Alpha simulated");
        (is_followed, found.verdict.into_iter().find(about))
    };
    for flow_angles in [FlowAngles::Auto, FlowAngles::Simulated] {
        assert_eq!(said(&record, flow_angles), (false, None));
    }
    // What the vane shows of gusts that the aircraft is too slow to follow.
    let time = record.time.clone();
    let alpha = record.channels.iter_mut().find(|channel| channel.name == "alpha").unwrap();
    alpha.values.iter_mut().zip(time).for_each(|(alpha, t)| *alpha += 0.01 * (4.0 * t).sin());
    let (is_followed, sentence) = said(&record, FlowAngles::Simulated);
    let sentence = sentence.unwrap();
    assert!(!is_followed && sentence.contains("times their noise") && sentence.contains("filter-error"), "{sentence}");
    let (is_followed, sentence) = said(&record, FlowAngles::Auto);
    let sentence = sentence.unwrap();
    assert!(is_followed && sentence.starts_with("True_airspeed, alpha and theta taken as measured"), "{sentence}");
}

#[test]
fn further_records_sharpen_the_bounds_and_a_prediction_is_judged() {
    let alone = run(Method::OutputError, EstimateOptions::default());
    let options = EstimateOptions {
        further: vec![fly(12.0, 0.026, 32)],
        predict: Some(fly(10.0, 0.02, 33)),
        ..EstimateOptions::default()
    };
    let together = run(Method::OutputError, options);
    for (a, b) in alone.parameters.iter().zip(&together.parameters) {
        // Twice the information: 0.71 times the standard error, with noise estimated from other samples.
        assert!((b.std_error / a.std_error / 0.5_f64.sqrt() - 1.0).abs() < 0.1, "{}", a.name);
    }
    let batch = together.batch.as_ref().unwrap();
    assert_eq!(batch.manoeuvres.len(), 2);
    let prediction = batch.prediction.as_ref().unwrap();
    assert_eq!(prediction.time_s.len(), 500);
    assert!(prediction.fit.iter().all(|f| f.theil < 0.3 && f.white), "{:?}", prediction.fit);
    assert!(together.verdict.iter().any(|s| s.contains("The estimate predicts")), "{:?}", together.verdict);
    assert!(!together.verdict.iter().any(|s| s.contains("The bounds do not hold")), "{:?}", together.verdict);
    assert!(prediction.intervals.iter().all(|i| (0.9..=0.99).contains(&i.within)), "{:?}", prediction.intervals);
    let json = serde_json::to_value(&together).unwrap();
    assert!(json["batch"]["prediction"]["fit"][0]["theil"].is_f64(), "{json}");
}

/// What a fit weighs by is said, in the numbers of the result: the noise of the outputs, and the process noise where that is found too.
#[test]
fn the_noise_of_a_fit_is_said() {
    for (method, finds_process_noise) in [(Method::OutputError, false), (Method::FilterError, true)] {
        let found = run(method, EstimateOptions::default());
        let said = found.verdict.iter().find(|s| s.starts_with("Noise of the outputs, one sigma: ")).unwrap();
        for noise in &found.noise {
            let level = format!("{} {:.3e} {}", noise.name, noise.values[0], noise.unit);
            assert!(said.contains(&level), "{method}: {said} without {level}");
        }
        assert_eq!(said.contains("process noise that was found: true_airspeed"), finds_process_noise, "{said}");
    }
    let equations = run(Method::EquationError, EstimateOptions::default());
    assert!(equations.verdict.iter().all(|s| !s.starts_with("Noise of the outputs")), "{:?}", equations.verdict);
}

/// Parameters from a weak and short manoeuvre predict a strong one: the intervals are several times the noise, and hold.
#[test]
fn prediction_intervals_hold_what_is_measured() {
    for method in [Method::OutputError, Method::FilterError] {
        let (mut count, mut within, mut widest) = (0.0, 0.0, 0.0_f64);
        for seed in 0..10 {
            let options = EstimateOptions {
                method: Some(method),
                predict: Some(fly(10.0, 0.05, 100 + seed)),
                ..EstimateOptions::default()
            };
            let found = estimate(&fly(5.0, 0.0015, 200 + seed), &model(), &options, &mut |_| {}).unwrap();
            let prediction = found.batch.as_ref().and_then(|b| b.prediction.as_ref()).unwrap();
            assert_eq!(prediction.intervals.len(), prediction.measured.len());
            for (i, fit) in prediction.intervals.iter().zip(&prediction.fit) {
                assert_eq!((i.name.as_str(), i.std_error.len()), (fit.name.as_str(), prediction.time_s.len()));
                let noise = i.std_error.iter().fold(f64::INFINITY, |a, b| a.min(*b));
                let largest = i.std_error.iter().fold(0.0_f64, |a, b| a.max(*b));
                widest = widest.max(largest / noise);
                count += 1.0;
                within += i.within;
            }
        }
        println!("{method}: {:.3} within two sigma; widest {widest:.1} times the noise", within / count);
        // The error of the parameters is the same all along a record, so that there are ten independent ones.
        assert!((0.9..=0.995).contains(&(within / count)), "{method}: {}", within / count);
        assert!(widest > 3.0, "{method}: {widest}");
    }
}

/// A surface that moves a quarter more than it did in the estimation: the bounds do not hold, and the result says so.
#[test]
fn a_prediction_that_leaves_its_intervals_is_said() {
    let mut other = fly(10.0, 0.02, 40);
    let elevator = other.channels.iter_mut().find(|c| c.name == "elevator").unwrap();
    let trim = elevator.values[0];
    elevator.values.iter_mut().for_each(|v| *v = trim + 0.8 * (*v - trim));
    let found = run(Method::OutputError, EstimateOptions { predict: Some(other), ..EstimateOptions::default() });
    let said = found.verdict.iter().any(|s| s.contains("The bounds do not hold for simulated"));
    assert!(said, "{:?}", found.verdict);
    let found = run(Method::EquationError, EstimateOptions { predict: Some(fly(5.0, 0.02, 41)), ..Default::default() });
    let prediction = found.batch.as_ref().and_then(|b| b.prediction.as_ref()).unwrap();
    assert!(prediction.intervals.is_empty(), "equation error knows no noise of the outputs");
}

#[test]
fn what_a_method_cannot_do_is_said() {
    let options = EstimateOptions { predict: Some(fly(5.0, 0.02, 34)), ..EstimateOptions::default() };
    let message = estimate(&fly(5.0, 0.026, 35), &model(), &options, &mut |_| {}).unwrap_err().to_string();
    assert!(message.contains("smpe takes one record") && message.contains("output-error"), "{message}");
    // Nothing moves: nothing can be told, and no number is given.
    let options = EstimateOptions { method: Some(Method::EquationError), ..EstimateOptions::default() };
    let message = estimate(&fly(5.0, 0.0, 36), &model(), &options, &mut |_| {}).unwrap_err().to_string();
    assert!(message.contains("no excitation"), "{message}");
}
