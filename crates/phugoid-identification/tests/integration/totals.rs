//! Total derivatives: increments with the slopes of their database.

use crate::common;

use common::f16::{TRIM, TRUTH, fly, model};
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
use phugoid_identification::estimation::TotalDerivative;
use phugoid_identification::model_file::ModelFile;

/// CL, CD and Cm of the book's aircraft.
fn coefficients(aircraft: &F16, alpha: f64, q_hat: f64, elevator: f64) -> [f64; 3] {
    let (cx, cz, cm) = aircraft.longitudinal_coefficients(alpha, q_hat, elevator);
    let (sin, cos) = alpha.sin_cos();
    [cx * sin - cz * cos, -cx * cos - cz * sin, cm]
}

/// The secant of a coefficient over the range of a total derivative.
fn secant(aircraft: &F16, total: &TotalDerivative) -> f64 {
    let at = |value: f64| {
        let [mut alpha, mut q_hat, mut elevator] = [total.reference_alpha, 0.0, total.reference_elevator];
        match total.variable.as_str() {
            "alpha" => alpha = value,
            "q_hat" => q_hat = value,
            "elevator" => elevator = value,
            other => panic!("{other}"),
        }
        let row = ["CL", "CD", "Cm"].iter().position(|c| total.name.starts_with(c)).unwrap();
        coefficients(aircraft, alpha, q_hat, elevator)[row]
    };
    let [from, to] = total.range;
    (at(to) - at(from)) / (to - from)
}

#[test]
fn totals_are_the_secant_of_the_tables_and_the_increment() {
    let (record, model) = (fly(20.0, 0.035, 5), model());
    let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() }).unwrap();
    for method in [Method::Smpe, Method::OutputError, Method::FilterError, Method::EquationError] {
        let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
        let estimation = estimate(&record, &model, &options, &mut |_| {}).unwrap();
        let names: Vec<&str> = estimation.totals.iter().map(|t| t.name.as_str()).collect();
        assert_eq!(names.len(), 5, "{names:?}");
        for (increment, truth) in TRUTH {
            let total = estimation.totals.iter().find(|t| t.increment == increment).unwrap();
            assert_eq!(total.name, increment[1..]);
            assert!((total.reference_alpha - TRIM[0]).abs() < 1e-4, "{total:?}");
            let table = secant(&aircraft, total);
            assert!((total.database - table).abs() < 1e-9 * table.abs().max(1.0), "{total:?} {table}");
            let found = estimation.parameter(increment).unwrap();
            assert_eq!(total.value, total.database + found.value);
            assert_eq!(total.std_error, found.corrected_std_error);
            assert!(total.increment_std_error >= total.std_error);
            // Four of its errors: what is far beyond it would be a mistake of sign or axes.
            let apart = (total.value - table - truth).abs() / total.std_error;
            assert!(apart < 4.0 || method == Method::EquationError, "{method} {}: {apart} errors off", total.name);
        }
    }
}

#[test]
fn a_derivative_with_a_square_beside_it_has_no_total() {
    let record = fly(20.0, 0.035, 5);
    let bent = common::f16::unbiased().replace("Cm = [\"alpha\",", "Cm = [\"alpha\", \"alpha^2\",");
    let bent = bent.replace("[parameters] ", "[parameters]\ndCm_alpha2 = { bounds = [-6, 6] }\n#");
    let bent = ModelFile::parse("bent", &bent).unwrap_or_else(|e| panic!("{e}"));
    let estimation = estimate(&record, &bent, &EstimateOptions::default(), &mut |_| {}).unwrap();
    assert!(!estimation.totals.iter().any(|t| t.name == "Cm_alpha"), "{:?}", estimation.totals);
    assert!(estimation.totals.iter().any(|t| t.name == "CL_alpha"));
}
