//! Noise levels and process noise that are learnt, on foreign flights.

use std::path::Path;

use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, StructureSearch, estimate};
use phugoid_identification::estimation::{Estimation, ParameterResult};
use phugoid_identification::model_file::ModelFile;

fn run(record: &Record, model: &str) -> Estimation {
    let options = EstimateOptions { structure: StructureSearch::Never, ..EstimateOptions::default() };
    estimate(record, &ModelFile::parse("model.toml", model).unwrap(), &options, &mut |_| ()).unwrap()
}

/// One sigma of the random part of a bound.
fn random(p: &ParameterResult) -> f64 {
    (p.corrected_std_error.powi(2) - p.systematic_std.powi(2)).max(0.0).sqrt()
}

/// Where the levels begin says little of where they end: with every level given up to two decades too small or too large no value differs by
/// more than its random error, and most of these errors by 15 % at most. Of the aim of 15 % for each the worst misses: 86 % (`CL_q` of the `OV10`, whose
/// flight takes eleven seconds).
#[test]
fn the_values_do_not_depend_on_where_the_levels_begin() {
    let develop = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/field/develop");
    for (flight, model) in [
        ("OV10/calm-short", "OV10/longitudinal"),
        ("pc7/light-stick", "pc7/longitudinal"),
        ("T38/lat-light-stick", "T38/lateral"),
    ] {
        let record = Record::open(develop.join(format!("{flight}.csv"))).unwrap();
        let text = std::fs::read_to_string(develop.join(format!("{model}.toml"))).unwrap();
        let usual = run(&record, &text);
        for factor in [0.01, 0.1, 10.0, 100.0] {
            let levels = usual.noise.iter().map(|level| format!("{} = {:e}\n", level.name, factor * level.values[0]));
            let other = run(&record, &format!("{text}\n[noise]\nlearn = true\n{}", levels.collect::<String>()));
            assert_eq!(other.status, usual.status);
            let mut ratios = Vec::new();
            for (a, b) in usual.parameters.iter().zip(&other.parameters) {
                let shift = (a.value - b.value).abs() / random(a);
                println!("{flight}, levels times {factor}, {}: {shift:.2} of its random error", a.name);
                assert!(shift < 1.0, "{flight} {factor}: {} {shift}", a.name);
                ratios.push((random(b) / random(a)).ln().abs());
            }
            ratios.sort_by(f64::total_cmp);
            assert!(ratios[ratios.len() / 2] < 0.15, "{flight} {factor}: {ratios:?}");
        }
    }
}
