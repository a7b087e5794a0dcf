//! The lateral axes, alone and with the longitudinal ones, as a user meets them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

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
    let six = include_str!("../../../../scenarios/f16-six.toml");
    // The manoeuvres of rudder and aileron with an amplitude of zero, so that their channels are recorded.
    let still: Vec<String> = six
        .split("[[manoeuvre]]")
        .map(|part| {
            let lateral = part.contains("surface = \"rudder\"") || part.contains("surface = \"aileron\"");
            let (before, after) = part.split_once("amplitude = \"").filter(|_| lateral).unwrap_or((part, ""));
            let rest = after.split_once('"').map_or("", |(_, rest)| rest);
            if lateral { format!("{before}amplitude = \"0 deg\"{rest}") } else { part.to_owned() }
        })
        .collect();
    folder.file("elevator.toml", &still.join("[[manoeuvre]]"));
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

/// Derivatives of one flight in body and in stability axes, each turned back by hand: the estimates and their standard errors
/// again, the latter with all covariances (Klein & Morelli, Aircraft System Identification, section 3.3). Numbers go through
/// JSON with all their digits: 1e-9 is room for rounding alone.
#[test]
fn derivatives_turned_into_other_axes_turn_back() {
    let folder = Folder::new("axes-form");
    phugoid(&folder.0, &["simulate", "f16-six", "--out", "flight"]);
    let in_axes = |axes: &str| {
        let estimate = ["estimate", "flight/measured.csv", "--model", "f16-six", "--no-report", "--json"];
        phugoid(&folder.0, &[&estimate[..], &["--axes-form", axes]].concat()).json()
    };
    let (body, stability) = (in_axes("body"), in_axes("stability"));
    let (sin, cos) = number(&body["turned"]["alpha_reference_rad"]).sin_cos();
    // A sum of turned derivatives: value and variance.
    let sum = |turned: &Value, parts: &[(String, f64)]| -> [f64; 2] {
        let names = turned["derivatives"].as_array().unwrap();
        let place =
            |wanted: &str| names.iter().position(|d| d["name"] == wanted).unwrap_or_else(|| panic!("no {wanted}"));
        let at: Vec<(usize, f64)> = parts.iter().map(|(name, factor)| (place(name), *factor)).collect();
        let covariance = |i: usize, j: usize| number(&turned["covariance"][i][j]);
        for (i, _) in &at {
            let claimed = number(&names[*i]["std_error"]);
            assert!((claimed - covariance(*i, *i).sqrt()).abs() <= 1e-12 * claimed, "{}", names[*i]);
        }
        let value = at.iter().map(|(i, f)| f * number(&names[*i]["value"])).sum();
        [value, at.iter().flat_map(|(i, f)| at.iter().map(move |(j, g)| f * g * covariance(*i, *j))).sum()]
    };
    let named = |parts: &[(&str, f64)]| parts.iter().map(|(n, f)| ((*n).to_owned(), *f)).collect::<Vec<_>>();
    let (mut compared, mut by_covariance) = (0, 0);
    for p in body["parameters"].as_array().unwrap() {
        let name = p["name"].as_str().unwrap();
        let (symbol, argument) = name.split_once('_').unwrap();
        // From body axes: CL = CX sin a - CZ cos a, CD = -CX cos a - CZ sin a; all else is there as it was.
        let from_body = match symbol {
            "dCL" => vec![(format!("dCX_{argument}"), sin), (format!("dCZ_{argument}"), -cos)],
            "dCD" => vec![(format!("dCX_{argument}"), -cos), (format!("dCZ_{argument}"), -sin)],
            _ => vec![(name.to_owned(), 1.0)],
        };
        // From stability axes: l = ls cos a - ns sin a, n = ls sin a + ns cos a; ps = p cos a + r sin a, rs = r cos a - p sin a.
        let symbols = match symbol {
            "dCl" => named(&[("dCls", cos), ("dCns", -sin)]),
            "dCn" => named(&[("dCls", sin), ("dCns", cos)]),
            _ => named(&[(symbol, 1.0)]),
        };
        let arguments = match argument {
            "p" => named(&[("ps", cos), ("rs", -sin)]),
            "r" => named(&[("ps", sin), ("rs", cos)]),
            _ => named(&[(argument, 1.0)]),
        };
        let from_stability: Vec<_> =
            symbols.iter().flat_map(|(s, f)| arguments.iter().map(move |(a, g)| (format!("{s}_{a}"), f * g))).collect();
        for (turned, parts) in [(&body["turned"], from_body), (&stability["turned"], from_stability)] {
            let [value, variance] = sum(turned, &parts);
            let (wanted, sigma) = (number(&p["value"]), number(&p["corrected_std_error"]));
            assert!((value - wanted).abs() <= 1e-9 * wanted.abs(), "{name}: {value} {wanted}");
            assert!((variance.sqrt() - sigma).abs() <= 1e-9 * sigma, "{name}: {} {sigma}", variance.sqrt());
            compared += 1;
            let alone: f64 = parts.iter().map(|part| sum(turned, std::slice::from_ref(part))[1]).sum();
            by_covariance += usize::from((alone / variance - 1.0).abs() > 0.01);
        }
    }
    // The covariances matter: without them these standard errors would be others.
    assert!(compared == 48 && by_covariance >= 8, "{compared} {by_covariance}");
}
