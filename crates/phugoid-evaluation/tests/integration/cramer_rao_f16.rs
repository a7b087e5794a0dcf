//! The Cramer-Rao bound of the F-16 case against the published figures (docs/theory.md, computed by another program).
#![allow(clippy::unwrap_used)] // in helpers of tests: what goes wrong there fails the test

use phugoid_evaluation::accuracy::bound;
use phugoid_evaluation::published::{CALM_MODEL, CALM_SCENARIO, DAMAGE_MODEL};
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

/// Compares the bound of the calm flight, in percent of each coefficient, with published figures one and two short-period
/// cycles (4.17 s, taken as 4.2 s: the end of the 3-2-1-1) after the input starts at 0.5 s, and at the end. They are
/// printed to two or three digits.
fn compare(scenario: &str, model: &str, published: &[(&str, [&str; 3])]) {
    let flight = fly(&Scenario::parse(scenario, "scenario").unwrap()).unwrap();
    let model = ModelFile::parse("model", model).unwrap();
    let names: Vec<&str> = model.estimated().map(|p| p.name.as_str()).collect();
    let bounds = bound(&flight, &model, &[0.5 + 4.2, 0.5 + 8.4, 19.99]).unwrap();
    assert_eq!(names.len(), published.len());
    for (name, percents) in published {
        let index = names.iter().position(|n| n == name).unwrap();
        for (bound, percent) in bounds.iter().zip(percents) {
            let own = 100.0 * bound.std_error[index] / flight.true_parameters[*name].abs();
            println!("{name} at {:.2} s: {own:.4} %, published {percent} %", bound.time_s);
            // One unit of the last printed digit.
            let decimals = percent.split('.').nth(1).map_or(0, str::len) as i32;
            let error = (own - percent.parse::<f64>().unwrap()).abs();
            assert!(error <= 10.0_f64.powi(-decimals), "{name} at {} s: {own} {percent}", bound.time_s);
        }
    }
}

#[test]
fn four_increments_have_the_published_bound() {
    let published = [
        ("dCm_alpha", ["0.11", "0.10", "0.07"]),
        ("dCm_q", ["0.56", "0.50", "0.35"]),
        ("dCL_alpha", ["1.14", "1.06", "0.70"]),
        ("dCD_alpha", ["3.2", "3.1", "2.2"]),
    ];
    compare(CALM_SCENARIO, CALM_MODEL, &published);
}

/// The elevator's effectiveness unknown too, and changed by 0.15.
#[test]
fn five_increments_have_the_published_bound() {
    let published = [
        ("dCm_alpha", ["0.16", "0.14", "0.10"]),
        ("dCm_q", ["1.6", "1.3", "0.87"]),
        ("dCL_alpha", ["1.6", "1.5", "1.1"]),
        ("dCD_alpha", ["4.4", "4.3", "2.9"]),
        ("dCm_elevator", ["0.53", "0.43", "0.30"]),
    ];
    let scenario = CALM_SCENARIO.replace("dCD_alpha = 0.1\n", "dCD_alpha = 0.1\ndCm_elevator = 0.15\n");
    compare(&scenario, DAMAGE_MODEL, &published);
}
