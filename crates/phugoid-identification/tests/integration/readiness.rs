//! The verdict on parameters of simulated flights: what is ready, what is not, and what would help.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::f16::{TRIM, channel, fly, model, unbiased};
use phugoid_flight_data::record::Quantity;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::{Estimation, ParameterReadiness};
use phugoid_identification::model_file::ModelFile;

fn readiness<'a>(estimation: &'a Estimation, name: &str) -> &'a ParameterReadiness {
    estimation.parameters.iter().find(|p| p.name == name).unwrap().readiness.as_ref().unwrap()
}

/// The 3-2-1-1 of 1.5 deg makes every parameter of the built-in model ready, moments before drag.
#[test]
fn a_good_input_makes_parameters_ready_and_says_since_when() {
    let estimation = estimate(&fly(20.0, 0.026, 31), &model(), &EstimateOptions::default(), &mut |_| {}).unwrap();
    for p in &estimation.parameters {
        let found = p.readiness.as_ref().unwrap();
        println!(
            "{:14} {} since {:?}, inflation {:.1}",
            p.name, found.verdict, found.ready_since_s, found.variance_inflation
        );
        assert_eq!(found.verdict.word(), "ready", "{}: {}", p.name, found.reason);
        assert!(found.advice.is_none());
        // Not before the input, and not long after it has ended at 4 s.
        assert!((0.5..8.0).contains(&found.ready_since_s.unwrap()), "{}", p.name);
        assert!(found.excitation <= found.bound_over_prior);
    }
}

#[test]
fn without_an_input_nothing_is_identifiable() {
    let estimation = estimate(&fly(10.0, 0.0, 32), &model(), &EstimateOptions::default(), &mut |_| {}).unwrap();
    for p in &estimation.parameters {
        let found = p.readiness.as_ref().unwrap();
        assert_eq!((found.verdict.word(), found.ready_since_s), ("not_identifiable", None), "{}", p.name);
        assert!(found.advice.as_ref().unwrap().contains("elevator"));
    }
}

/// A flap that moves with the elevator: neither can be told, the rest is ready, and the advice is to move them apart.
#[test]
fn two_controls_that_move_together_are_told_apart_by_moving_them_apart() {
    let mut record = fly(20.0, 0.026, 33);
    let elevator = record.channel("elevator").unwrap().values.clone();
    let flap = elevator.iter().map(|e| 0.5 * (e - TRIM[1])).collect();
    record.channels.push(channel("flap", Quantity::Angle, flap));
    let text = unbiased()
        .replace("Cm = [\"alpha\", \"q_hat\", \"elevator\"]", "Cm = [\"alpha\", \"q_hat\", \"elevator\", \"flap\"]")
        .replace("input = \"held\"", "inputs = [\"flap\"]\ninput = \"held\"")
        .replace("dCm_elevator =", "dCm_flap = { bounds = [-0.8, 0.8] }\ndCm_elevator =");
    let model = ModelFile::parse("flap", &text).unwrap_or_else(|e| panic!("{e}"));
    let estimation = estimate(&record, &model, &EstimateOptions::default(), &mut |_| {}).unwrap();
    for (name, other) in [("dCm_elevator", "dCm_flap"), ("dCm_flap", "dCm_elevator")] {
        let found = readiness(&estimation, name);
        assert_eq!(found.verdict.word(), "not_identifiable", "{name}: {found:?}");
        assert!(found.reason.contains(other), "{}", found.reason);
        assert!(found.advice.as_ref().unwrap().contains("one after the other"));
        // Their prior standard deviations are 0.2 and 0.4 and act as 0.2 and 0.2: together half of each variance is left.
        assert!((found.bound_over_prior - 0.5_f64.sqrt()).abs() < 0.1, "{}", found.bound_over_prior);
        assert!(found.variance_inflation > 10.0);
    }
    assert_eq!(readiness(&estimation, "dCm_alpha").verdict.word(), "ready");
    let told = estimation.verdict.iter().find(|s| s.contains("one after the other")).unwrap();
    assert!(told.starts_with("For ") && told.contains("dCm_flap") && told.contains("dCm_elevator"), "{told}");
}
