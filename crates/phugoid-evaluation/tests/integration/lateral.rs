//! The lateral-directional motion and all six coefficients of the F-16 against the Cramer-Rao bound.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use phugoid_evaluation::accuracy::{AccuracyStudy, accuracy};
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::scenario::built_in;

use crate::studies::size;

/// The built-in scenario of this name against a model, printed.
fn study(name: &str, model: &ModelFile, runs: usize, at: &[f64]) -> AccuracyStudy {
    let scenario = built_in(name).unwrap().unwrap();
    let options = EstimateOptions::default();
    let study = accuracy(&scenario, model, &options, runs, at, &|| ()).unwrap_or_else(|e| panic!("{e}"));
    for checkpoint in &study.checkpoints {
        println!("{name}, {runs} runs, {:.1} s: truth, bound, RMSE/bound, bias/bound, coverage", checkpoint.time_s);
        for p in &checkpoint.parameters {
            println!(
                "{:14} {:8.4} {:9.6} {:6.3} {:6.3} {:6.3}",
                p.name,
                p.truth,
                p.cramer_rao,
                p.rmse_over_cramer_rao,
                p.bias / p.cramer_rao,
                p.coverage
            );
        }
    }
    println!("changes adopted in {} of {} runs", study.runs_with_changes, study.runs);
    study
}

fn model(name: &str) -> ModelFile {
    ModelFile::named(name).unwrap()
}

/// Three and a half relative standard errors of the RMSE of so many runs above what is aimed at, and 3.3 of a coverage of 90 % below it:
/// beyond once in some thousand.
fn limits(aim: f64, runs: usize) -> [f64; 2] {
    let error = |variance: f64| (variance / runs as f64).sqrt();
    [aim * (1.0 + 3.5 * error(0.5)), 0.9 - 3.3 * error(0.9 * 0.1)]
}

/// The target is 1.2 times the bound for each of the eighteen (200 runs: 1.13 at most).
#[test]
fn eighteen_lateral_derivatives_are_found_as_well_as_they_can_be() {
    let runs = size(20, 60);
    let study = study("f16-lateral", &model("f16-lateral"), runs, &[20.0]);
    let [most, least] = limits(1.2, runs);
    let found = &study.checkpoints[0].parameters;
    assert_eq!(found.len(), 18);
    for p in found {
        assert!(p.rmse_over_cramer_rao < most, "{}: {}", p.name, p.rmse_over_cramer_rao);
        assert!(p.coverage > least, "{}: {}", p.name, p.coverage);
    }
    let mean = found.iter().map(|p| p.rmse_over_cramer_rao).sum::<f64>() / 18.0;
    assert!(mean < 1.1, "{mean}");
}

#[test]
fn all_six_coefficients_are_found_together() {
    let runs = size(12, 40);
    let study = study("f16-six", &model("f16-six"), runs, &[30.0]);
    let [most, least] = limits(1.3, runs);
    let found = &study.checkpoints[0].parameters;
    assert_eq!(found.len(), 24);
    for p in found {
        assert!(p.rmse_over_cramer_rao < most, "{}: {}", p.name, p.rmse_over_cramer_rao);
        assert!(p.coverage > least, "{}: {}", p.name, p.coverage);
    }
    let mean = found.iter().map(|p| p.rmse_over_cramer_rao).sum::<f64>() / 24.0;
    assert!(mean < 1.15, "{mean}");
}

/// The lateral axes alone take noisy measurements as inputs. Without process noise their bounds are too small, several times for
/// C_l_r; with the adaptive one that a file gets that says nothing they hold, and the errors are larger still.
#[test]
fn the_noise_of_measured_inputs_is_covered_by_adaptive_process_noise() {
    let text = include_str!("../../../../data/models/f16-lateral.toml");
    let text = text.replace("axes = [\"longitudinal\", \"lateral\"]", "axes = [\"lateral\"]");
    let symmetric = ["true_airspeed = ", "alpha = ", "theta = ", "q = ", "ax = ", "az = "];
    let text: String =
        text.lines().filter(|l| !symmetric.iter().any(|s| l.starts_with(s))).map(|l| format!("{l}\n")).collect();
    let exact = ModelFile::parse("exact", &text).unwrap();
    let adaptive = ModelFile::parse("adaptive", text.split("[process_noise]").next().unwrap()).unwrap();
    let worst = |study: &AccuracyStudy| study.checkpoints[0].parameters.iter().map(|p| p.coverage).fold(1.0, f64::min);
    let (exact, adaptive) = (study("f16-lateral", &exact, 40, &[20.0]), study("f16-lateral", &adaptive, 40, &[20.0]));
    assert!(worst(&exact) < 0.7, "the noise of the inputs has stopped to matter: say so in docs/methods.md");
    assert!(worst(&adaptive) > 0.75, "{}", worst(&adaptive));
}
