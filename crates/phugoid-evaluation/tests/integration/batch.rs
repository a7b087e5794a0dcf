//! The batch methods against the Cramer-Rao bound that another part of this program computes.
#![allow(clippy::unwrap_used, clippy::expect_used)] // in helpers of tests: what goes wrong there fails the test

use phugoid_evaluation::accuracy::{accuracy, bound};
use phugoid_evaluation::published::{CALM_MODEL, CALM_SCENARIO, DAMAGE_MODEL};
use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

use crate::studies::size;

fn output_error() -> EstimateOptions {
    EstimateOptions { method: Some(Method::OutputError), ..EstimateOptions::default() }
}

/// Parameters with their scenario and model: without and with an elevator effectiveness that is unknown, and changed by 0.15.
fn cases() -> [(Scenario, ModelFile); 2] {
    let five = CALM_SCENARIO.replace("dCD_alpha = 0.1\n", "dCD_alpha = 0.1\ndCm_elevator = 0.15\n");
    [(CALM_SCENARIO.to_owned(), CALM_MODEL), (five, DAMAGE_MODEL)].map(|(scenario, model)| {
        (Scenario::parse(&scenario, "calm").unwrap(), ModelFile::parse("model", model).unwrap())
    })
}

/// The two informations are the same sums: same model, initial states free, no prior. The bound takes the sensors' noise on the
/// true motion, the method the noise that it finds on the estimated one: 1/sqrt(2 n) = 1.6 % each (n = 2000), three of them.
#[test]
fn standard_errors_are_the_bound() {
    for (scenario, model) in cases() {
        let flight = fly(&scenario).unwrap();
        let bounds = bound(&flight, &model, &[19.99]).unwrap();
        let measured = phugoid_simulation::flight::sense(&flight.truth, &scenario, 5).unwrap();
        let found = estimate(&measured, &model, &output_error(), &mut |_| {}).unwrap();
        for (p, bound) in found.parameters.iter().zip(&bounds[0].std_error) {
            println!("{}: standard error {:.3e}, bound {bound:.3e}", p.name, p.std_error);
            assert!((p.std_error / bound - 1.0).abs() < 0.05, "{}: {} {bound}", p.name, p.std_error);
        }
    }
}

/// Calm air, 3-2-1-1, p = 4 and 5: RMSE over the bound, and two-sigma coverage.
#[test]
fn output_error_reaches_the_bound() {
    let runs = size(30, 100);
    // The RMSE of n normal errors has the relative standard error 1/sqrt(2n), a coverage of 95.4 % that of sqrt(pq/n): four
    // of each.
    let ratio_error = 4.0 / (2.0 * runs as f64).sqrt();
    let coverage_error = 4.0 * (0.954 * 0.046 / runs as f64).sqrt();
    for (scenario, model) in cases() {
        let study = accuracy(&scenario, &model, &output_error(), runs, &[19.99], &|| ()).unwrap();
        for p in &study.checkpoints[0].parameters {
            let (ratio, coverage) = (p.rmse_over_cramer_rao, p.coverage);
            println!("{}: RMSE/CRB {ratio:.3}, bias {:.2e}, coverage {coverage:.3}", p.name, p.bias);
            assert!((ratio - 1.0).abs() < ratio_error, "{}: {ratio}", p.name);
            assert!(coverage > 0.954 - coverage_error, "{}: {coverage}", p.name);
        }
    }
}
