//! The Cramer-Rao bound of the F-16 case against the published figures (docs/theory.md, computed by another program).

use phugoid_identification::model_file::ModelFile;
use phugoid_studies::accuracy::bound;
use phugoid_studies::flight::fly;
use phugoid_studies::scenario::built_in;

/// Percent of each coefficient one and two short-period cycles (4.17 s) after the input starts at 0.5 s, and at the end,
/// printed to two or three digits.
#[test]
fn the_calm_case_has_the_published_bound() {
    let flight = fly(&built_in("f16-calm").unwrap().unwrap()).unwrap();
    let model = ModelFile::parse("f16-model.toml", include_str!("../../../scenarios/f16-model.toml")).unwrap();
    let names: Vec<&str> = model.estimated().map(|p| p.name.as_str()).collect();
    let bounds = bound(&flight, &model, &[0.5 + 4.17, 0.5 + 8.34, 19.99]).unwrap();
    let published = [
        ("dCm_alpha", [0.11, 0.10, 0.07]),
        ("dCm_q", [0.56, 0.50, 0.35]),
        ("dCL_alpha", [1.14, 1.06, 0.70]),
        ("dCD_alpha", [3.2, 3.1, 2.2]),
    ];
    for (name, percents) in published {
        let index = names.iter().position(|n| *n == name).unwrap();
        for (bound, percent) in bounds.iter().zip(percents) {
            let own = 100.0 * bound.std_error[index] / flight.true_parameters[name].abs();
            println!("{name} at {:.2} s: {own:.4} %, published {percent} %", bound.time_s);
            // One unit of the last printed digit.
            let digit: f64 = if percent >= 2.0 { 0.1 } else { 0.01 };
            assert!((own - percent).abs() <= digit, "{name} at {} s: {own} {percent}", bound.time_s);
        }
    }
}
