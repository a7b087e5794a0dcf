//! The two parts of a bound: what a longer flight makes smaller, and what only a calibration does.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};
use serde_json::Value;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../phugoid-evaluation/tests/field/develop/pc7");

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// A trainer of the field, about whose instruments its model file says nothing but what `section` adds.
fn estimate(section: &str, more: &[&str]) -> common::Run {
    let folder = Folder::new("systematic");
    let flight = std::fs::read_dir(FOLDER)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|extension| extension == "csv"))
        .unwrap();
    let model = folder.0.join("model.toml");
    let text = std::fs::read_to_string(format!("{FOLDER}/longitudinal.toml")).unwrap();
    std::fs::write(&model, format!("{text}\n{section}\n")).unwrap();
    let arguments = ["estimate", flight.to_str().unwrap(), "--model", model.to_str().unwrap(), "--no-report"];
    phugoid(&folder.0, &[&arguments, more].concat())
}

/// The usual sizes, by the powers of the scales and not followed through the estimation.
const BY_POWERS: &str = "[uncertainty]\nclass = \"unstated\"\npropagation = \"powers\"";

/// Checks what holds for every way of working it out; gives the parameters.
fn checked(document: &Value) -> Vec<Value> {
    let mut with_parts = 0;
    let parameters = document["parameters"].as_array().unwrap();
    for p in parameters {
        let (whole, systematic) = (number(&p["corrected_std_error"]), number(&p["systematic_std"]));
        let parts = p["systematic_parts"].as_array().unwrap();
        assert!(systematic <= whole * (1.0 + 1e-12), "{p}");
        if parts.is_empty() {
            assert_eq!(systematic, 0.0);
            continue;
        }
        with_parts += 1;
        let shares: Vec<f64> = parts.iter().map(|part| number(&part["share"])).collect();
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12 && shares.is_sorted_by(|a, b| a >= b), "{p}");
        let effects = parts.iter().map(|part| number(&part["effect"]).powi(2)).sum::<f64>().sqrt();
        assert!((effects / systematic - 1.0).abs() < 1e-9, "{p}");
    }
    assert!(with_parts >= 6);
    parameters.clone()
}

#[test]
fn each_bound_is_the_sum_of_its_two_parts_and_the_shares_add_up() {
    let parameters = checked(&estimate(BY_POWERS, &["--json"]).json_of_any_result());
    for p in &parameters {
        // A constant is found whatever the scales are.
        let parts = p["systematic_parts"].as_array().unwrap();
        assert_eq!(parts.is_empty(), p["name"].as_str().unwrap().ends_with("_0"), "{p}");
    }
    // CL_alpha goes with the square of the airspeed (1.5 %), the vane (3 %), the mass (3 %), the density (2 %) and the square of the
    // lengths (0.5 %): of 32 parts of the variance nine each, four and one.
    let slope = parameters.iter().find(|p| p["name"] == "CL_alpha").unwrap();
    let expected = 0.01 * 32_f64.sqrt() * number(&slope["value"]);
    assert!((number(&slope["systematic_std"]) / expected - 1.0).abs() < 1e-9, "{slope}");
    assert!((number(&slope["systematic_parts"][0]["share"]) - 9.0 / 32.0).abs() < 1e-9);
}

/// Errors that are followed are also those that are no scales, and go into the constants. The estimates are the same to the
/// last digit.
#[test]
fn followed_errors_leave_the_estimate_alone_and_know_of_more_than_scales() {
    let (followed, powers) = (estimate("", &["--json"]), estimate(BY_POWERS, &["--json"]));
    let followed = checked(&followed.json_of_any_result());
    for (a, b) in followed.iter().zip(&checked(&powers.json_of_any_result())) {
        assert_eq!((&a["value"], &a["std_error"]), (&b["value"], &b["std_error"]));
    }
    let quantities = |name: &str| -> Vec<String> {
        let p = followed.iter().find(|p| p["name"] == name).unwrap();
        p["systematic_parts"].as_array().unwrap().iter().map(|q| q["quantity"].as_str().unwrap().to_owned()).collect()
    };
    // A filter, a batch method and the powers of the scales agree on the direction: a sensor that shows too much makes a derivative too
    // small, and so does a mass or an inertia that is larger than the model file says.
    let output_error = checked(&estimate("", &["--json", "--method", "output-error"]).json_of_any_result());
    let by_powers = checked(&powers.json_of_any_result());
    let effect = |of: &[Value], name: &str, quantity: &str| {
        let p = of.iter().find(|p| p["name"] == name).unwrap();
        let part = p["systematic_parts"].as_array().unwrap().iter().find(|q| q["quantity"] == quantity).unwrap();
        number(&part["effect"]) / number(&p["value"])
    };
    for (name, quantities) in [
        ("CL_alpha", ["airspeed_scale", "flow_angle_scale", "mass"]),
        ("Cm_elevator", ["airspeed_scale", "surface_scale", "inertia"]),
    ] {
        for quantity in quantities {
            let effects = [&followed, &output_error, &by_powers].map(|of| effect(of, name, quantity));
            assert!(effects.iter().all(|effect| *effect < 0.0), "{name} {quantity}: {effects:?}");
        }
    }
    for quantity in ["centre_of_gravity", "surface_skew", "flow_angle_lag", "inertia"] {
        assert!(quantities("Cm_alpha").iter().any(|q| q == quantity), "{quantity}");
    }
    assert!(quantities("Cm_0").iter().any(|q| q == "centre_of_gravity"));
}

#[test]
fn the_text_shows_the_parts_and_says_what_would_help() {
    // Sentences are wrapped.
    let words = |section: &str| estimate(section, &[]).out.split_whitespace().collect::<Vec<_>>().join(" ");
    let (text, by_powers) = (words(""), words(BY_POWERS));
    for text in [&text, &by_powers] {
        assert!(text.contains("Parts of the bounds, +- 2 sigma"), "{text}");
        assert!(text.contains("A longer flight will not make the bounds of"), "{text}");
        assert!(text.contains("would help most"), "{text}");
    }
    assert!(by_powers.contains("airspeed 28 %, flow angles 28 %, mass 28 %, others 16 %"), "{by_powers}");
    // What the powers of the scales do not know is not said to be in the bounds.
    assert!(text.contains("timing of surfaces 10 ms") && !text.contains("They do not contain"), "{text}");
    let (inside, outside) = by_powers.split_once("They do not contain").unwrap();
    assert!(!inside.contains("timing of surfaces") && outside.contains("timing of surfaces 10 ms"), "{by_powers}");
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
    assert!(
        default.contains("20 ms") && default.contains("0.15 %/deg") && default.contains("1.0 % of the chord"),
        "{default}"
    );
    let given = shown("hfb320");
    assert!(given.contains("the model file") && !given.contains("default"), "{given}");
    assert!(shown("f16").contains("none declared"));
}
