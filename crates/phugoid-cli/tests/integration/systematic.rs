//! The two parts of a bound: what a longer flight makes smaller, and what only a calibration does.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};
use serde_json::Value;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../phugoid-evaluation/tests/field/develop/pc7");

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// A trainer of the field, about whose instruments its model file says nothing.
fn estimate(more: &[&str]) -> common::Run {
    let folder = Folder::new("systematic");
    let flight = std::fs::read_dir(FOLDER)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|extension| extension == "csv"))
        .unwrap();
    let model = format!("{FOLDER}/longitudinal.toml");
    phugoid(&folder.0, &[&["estimate", flight.to_str().unwrap(), "--model", &model, "--no-report"], more].concat())
}

#[test]
fn each_bound_is_the_sum_of_its_two_parts_and_the_shares_add_up() {
    let document = estimate(&["--json"]).json_of_any_result();
    let mut with_parts = 0;
    for p in document["parameters"].as_array().unwrap() {
        let (whole, systematic) = (number(&p["corrected_std_error"]), number(&p["systematic_std"]));
        let parts = p["systematic_parts"].as_array().unwrap();
        assert!(systematic <= whole * (1.0 + 1e-12), "{p}");
        // A constant is found whatever the scales are.
        assert_eq!(parts.is_empty(), p["name"].as_str().unwrap().ends_with("_0"), "{p}");
        if parts.is_empty() {
            assert_eq!(systematic, 0.0);
            continue;
        }
        with_parts += 1;
        let shares: Vec<f64> = parts.iter().map(|part| number(&part["share"])).collect();
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12 && shares.is_sorted_by(|a, b| a >= b), "{p}");
    }
    assert!(with_parts >= 6);
    // CL_alpha goes with the square of the airspeed (1.5 %), the vane (3 %) and the mass (3 %): a third each.
    let slope = document["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "CL_alpha").unwrap();
    let expected = 0.03 * 3_f64.sqrt() * number(&slope["value"]);
    assert!((number(&slope["systematic_std"]) / expected - 1.0).abs() < 1e-9, "{slope}");
    assert!((number(&slope["systematic_parts"][0]["share"]) - 1.0 / 3.0).abs() < 1e-9);
}

#[test]
fn the_text_shows_the_parts_and_says_what_would_help() {
    let text = estimate(&[]).out;
    assert!(text.contains("Parts of the bounds, +- 2 sigma"), "{text}");
    assert!(text.contains("airspeed 33 %, flow angles 33 %, mass 33 %"), "{text}");
    assert!(text.contains("A longer flight will not make the bounds of") && text.contains("would help most"), "{text}");
}

#[test]
fn the_declared_uncertainties_are_shown_with_their_origin() {
    let folder = Folder::new("uncertainty");
    let shown = |model: &str| {
        let run = phugoid(&folder.0, &["estimate", "--model", model, "--show-uncertainty"]);
        assert_eq!(run.code, Some(0), "{}", run.err);
        run.out
    };
    let default = shown(&format!("{FOLDER}/longitudinal.toml"));
    assert!(default.contains("airspeed_scale") && default.contains("14 CFR 25.1323"), "{default}");
    assert!(default.contains("6.0 %") && default.contains("not measured"), "{default}");
    let given = shown("hfb320");
    assert!(given.contains("the model file") && !given.contains("default"), "{given}");
    assert!(shown("f16").contains("none declared"));
}
