//! The lateral-directional motion and all six coefficients of the F-16 against the Cramer-Rao bound.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_studies::accuracy::{AccuracyStudy, accuracy};
use phugoid_studies::scenario::built_in;

fn study(name: &str, runs: usize, at: &[f64]) -> AccuracyStudy {
    let runs = std::env::var("PHUGOID_RUNS").ok().and_then(|n| n.parse().ok()).unwrap_or(runs);
    let scenario = built_in(name).unwrap().unwrap();
    let model = ModelFile::built_in(name).unwrap().unwrap();
    let study =
        accuracy(&scenario, &model, &EstimateOptions::default(), runs, at, || ()).unwrap_or_else(|e| panic!("{e}"));
    for checkpoint in &study.checkpoints {
        println!("{name}, {runs} runs, {:.1} s: truth, bound, RMSE/bound, bias/bound, coverage", checkpoint.time_s);
        for p in &checkpoint.parameters {
            println!(
                "{:14} {:8.4} {:9.5} {:6.3} {:6.3} {:6.3}",
                p.name,
                p.truth,
                p.cramer_rao,
                p.rmse_over_cramer_rao,
                p.bias / p.cramer_rao,
                p.coverage
            );
        }
    }
    println!("re-reaching in {} of {} runs", study.runs_with_re_reaching, study.runs);
    study
}

#[test]
fn eighteen_lateral_derivatives_are_found_as_well_as_they_can_be() {
    let study = study("f16-lateral", 24, &[10.0, 20.0]);
    assert!(study.checkpoints.iter().all(|c| c.parameters.len() == 18));
    assert!(study.checkpoints[1].parameters.iter().all(|p| p.cramer_rao.is_finite()));
}

#[test]
fn all_six_coefficients_are_found_together() {
    let study = study("f16-six", 8, &[15.0, 30.0]);
    assert!(study.checkpoints.iter().all(|c| c.parameters.len() == 24));
}
