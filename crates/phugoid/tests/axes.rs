//! The lateral axes, alone and with the longitudinal ones, as a user meets them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

mod common;

use common::{Folder, phugoid};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Every derivative of the lateral motion from one simulated flight, with bounds that hold.
#[test]
fn a_lateral_flight_is_estimated_end_to_end() {
    let folder = Folder::new("lateral");
    phugoid(&folder.0, &["simulate", "f16-lateral", "--out", "flight"]);
    let estimate = ["estimate", "flight/measured.csv", "--model", "f16-lateral", "--no-report"];
    let result = phugoid(&folder.0, &[&estimate[..], &["--truth", "f16-lateral", "--json"]].concat()).json();
    let parameters = result["parameters"].as_array().unwrap();
    assert_eq!(parameters.len(), 18);
    for p in parameters.iter().filter(|p| !p["truth"].is_null()) {
        let errors = (number(&p["value"]) - number(&p["truth"])).abs() / number(&p["corrected_std_error"]);
        assert!(errors < 4.0, "{errors} standard errors: {p}");
    }
    // A recorder without aileron, and one that calls sideslip something else.
    let text = folder.read("flight/measured.csv");
    for (from, to, channel) in [("aileron_rad", "lever_rad", "aileron"), ("beta_rad", "betta_rad", "beta")] {
        assert!(text.contains(from), "the test itself is out of date: {from}");
        folder.file("flight/measured.csv", &text.replacen(from, to, 1));
        let run = phugoid(&folder.0, &estimate);
        let message = run.fails(3);
        assert!(message.contains(&format!("channel `{channel}` is missing")), "{message}");
    }
}

/// While only the elevator moves, sideslip and roll wander by their noise alone: nothing of the lateral axes is learnt from that.
#[test]
fn of_an_axis_that_has_not_moved_nothing_is_learnt() {
    let folder = Folder::new("six");
    let six = include_str!("../../../scenarios/f16-six.toml");
    let first_rudder = six.find("# A positive rudder").unwrap();
    let last = six.find("# What the aircraft has").unwrap();
    folder.file("elevator.toml", &format!("{}{}", &six[..first_rudder], &six[last..]));
    phugoid(&folder.0, &["simulate", "elevator.toml", "--out", "flight"]);
    let estimate = ["estimate", "flight/measured.csv", "--model", "f16-six", "--no-report", "--json"];
    let result = phugoid(&folder.0, &estimate).json();
    for p in result["parameters"].as_array().unwrap() {
        let name = p["name"].as_str().unwrap();
        let lateral = ["dCY", "dCl", "dCn"].iter().any(|c| name.starts_with(c));
        let untouched =
            p["status"] == "not_excited" && number(&p["value"]) == 0.0 && number(&p["observability"]) < 1e-9;
        if lateral {
            assert!(untouched, "{p}");
        } else if name == "dCm_alpha" {
            assert_eq!(p["status"], "converged", "{p}");
        }
    }
}
