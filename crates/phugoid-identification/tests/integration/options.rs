//! What a model file can switch on: sensor biases, fixed parameters, change detection off.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::f16::{TRUTH, fly, unbiased};
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::model_file::ModelFile;

#[test]
fn biases_are_found_beside_the_parameters() {
    let biases = [("true_airspeed", 0.6), ("alpha", 0.0035), ("theta", 0.0009), ("q", 0.0009), ("az", 0.098)];
    let mut record = fly(20.0, 0.026, 21);
    for (name, bias) in biases {
        let channel = record.channels.iter_mut().find(|c| c.name == name).unwrap();
        channel.values.iter_mut().for_each(|v| *v += bias);
    }
    // The biases are those that the built-in model allows for.
    let text = format!("{}\n[process_noise]\n", include_str!("../../../../data/models/f16.toml"));
    let model = ModelFile::parse("biased", &text).unwrap();
    let estimation = estimate(&record, &model, &EstimateOptions::default(), &mut |_| {}).unwrap();
    assert_eq!(estimation.parameters.len(), 11);
    for (i, p) in estimation.parameters.iter().enumerate() {
        let truth = match p.name.strip_prefix("bias_") {
            Some(output) => biases.iter().find(|(n, _)| *n == output).map_or(0.0, |(_, b)| *b),
            None => TRUTH.iter().find(|(n, _)| *n == p.name).unwrap().1,
        };
        println!("{:18} {truth:9.5} {:9.5} +- {:.5}", p.name, p.value, p.corrected_std_error);
        assert_eq!(p.nuisance, i >= 5);
        assert!((p.value - truth).abs() < 4.0 * p.corrected_std_error, "{}: {} for {truth}", p.name, p.value);
    }
    // Without the bias columns the same record misleads.
    let plain = ModelFile::parse("plain", &format!("{}\n[process_noise]\n", unbiased())).unwrap();
    let misled = estimate(&record, &plain, &EstimateOptions::default(), &mut |_| {}).unwrap();
    let worst =
        misled.parameters.iter().zip(TRUTH).map(|(p, (_, t))| (p.value - t).abs() / p.std_error).fold(0.0, f64::max);
    println!("without bias columns the worst parameter is {worst:.1} claimed standard errors off");
    assert!(worst > 4.0);
}

#[test]
fn fixed_parameters_stay_and_the_others_allow_for_them() {
    let text = unbiased().replace("dCm_q = { bounds = [-6, 6] }", "dCm_q = { start = -2, fixed = true }");
    let model = ModelFile::parse("fixed", &text).unwrap();
    let options = EstimateOptions {
        truth: [("dCm_elevator".to_owned(), 0.15)].into(),
        change_detection: Some(false),
        ..EstimateOptions::default()
    };
    let mut fractions = Vec::new();
    let estimation = estimate(&fly(12.0, 0.026, 22), &model, &options, &mut |f| fractions.push(f)).unwrap();
    assert!(fractions.is_sorted() && fractions.last() == Some(&1.0));
    let named = |name: &str| estimation.parameters.iter().find(|p| p.name == name).unwrap();
    let fixed = named("dCm_q");
    assert_eq!((fixed.value, fixed.std_error, fixed.status.word()), (-2.0, 0.0, "fixed"));
    for (name, truth) in TRUTH.iter().filter(|(n, _)| *n != "dCm_q") {
        let p = named(name);
        assert!((p.value - truth).abs() < 4.0 * p.corrected_std_error, "{name}: {} for {truth}", p.value);
    }
    assert_eq!(named("dCm_elevator").truth, Some(0.15));
    let i = estimation.parameters.iter().position(|p| p.name == "dCm_q").unwrap();
    assert!(estimation.correlation[i].iter().enumerate().all(|(j, r)| *r == f64::from(i == j)));
}
