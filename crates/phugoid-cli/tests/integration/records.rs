//! Records as they come from real recorders: with gaps, rows in disorder, missing values, outliers, or nothing in them.

use crate::common;

use common::{Folder, Run, phugoid};

const TRUTH: [(&str, f64); 4] = [("dCm_alpha", -0.2), ("dCm_q", -2.0), ("dCL_alpha", 0.4), ("dCD_alpha", 0.1)];

/// Header and rows of the calm flight.
fn flight(folder: &Folder) -> (String, Vec<String>) {
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let text = folder.read("measured.csv");
    let mut lines = text.lines().map(str::to_owned);
    let header = lines.next().unwrap_or_default();
    (header, lines.collect())
}

/// Estimates the spoilt flight, and checks that the four increments are found all the same.
fn estimate(folder: &Folder, header: &str, rows: &[String]) -> (Run, serde_json::Value) {
    folder.file("spoilt.csv", &format!("{header}\n{}\n", rows.join("\n")));
    let command = ["estimate", "spoilt.csv", "--model", "f16-model", "--no-report"];
    let document = phugoid(&folder.0, &[&command[..], &["--json"]].concat()).json();
    for (name, truth) in TRUTH {
        let p = document["parameters"].as_array().into_iter().flatten().find(|p| p["name"] == name);
        let number = |key: &str| p.and_then(|p| p[key].as_f64()).unwrap_or(f64::NAN);
        let error = (number("value") - truth).abs();
        // One fixed seed; a right estimator is outside four sigmas in 1 of 16,000 cases.
        assert!(error < 4.0 * number("corrected_std_error"), "{name}: {p:?}");
        assert!(error < 0.1 * truth.abs(), "{name}: {p:?}");
    }
    (phugoid(&folder.0, &command), document)
}

#[test]
fn a_gap_is_told_and_survived() {
    let folder = Folder::new("gap");
    let (header, rows) = flight(&folder);
    let (run, document) = estimate(&folder, &header, &[&rows[..600], &rows[700..]].concat());
    assert!(run.out.contains("gap of 1.01 s"), "{}", run.out);
    assert!(document["events"].as_array().is_some_and(|e| e.iter().any(|e| e["kind"] == "gap")), "{document}");
}

#[test]
fn time_that_goes_back_and_rows_that_repeat_are_told_and_survived() {
    let folder = Folder::new("disorder");
    let (header, mut rows) = flight(&folder);
    rows.swap(500, 501);
    rows.insert(900, rows[900].clone());
    let (run, document) = estimate(&folder, &header, &rows);
    assert!(run.out.contains("line 503") && run.out.contains("line 903"), "{}", run.out);
    assert_eq!(document["quality"]["rows_read"], 2002);
    assert_eq!(document["samples"], 2000);
}

#[test]
fn missing_values_and_outliers_are_told_and_survived() {
    let folder = Folder::new("outliers");
    let (header, rows) = flight(&folder);
    let column = header.split(',').position(|h| h == "alpha_rad").unwrap_or_default();
    let spoilt: Vec<String> = rows
        .iter()
        .enumerate()
        .map(|(k, row)| {
            let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
            let value: f64 = cells[column].parse().unwrap_or(f64::NAN);
            // A twentieth missing and another one twenty sigmas away, to either side in turn; the start is spared neither.
            match k % 20 {
                3 => cells[column] = "nan".to_owned(),
                7 => {
                    let outlier = 20.0 * 0.1_f64.to_radians() * if k % 40 == 7 { 1.0 } else { -1.0 };
                    cells[column] = (value + outlier).to_string();
                }
                _ => {}
            }
            cells.join(",")
        })
        .collect();
    let (run, _) = estimate(&folder, &header, &spoilt);
    assert!(run.out.contains("alpha") && run.out.contains("outliers"), "{}", run.out);
}

#[test]
fn a_flight_without_excitation_leaves_the_bounds_where_they_were() {
    let folder = Folder::new("quiet");
    let text = phugoid(&folder.0, &["simulate", "f16-calm", "--show"]).out;
    let (before, after) = (text.find("[[manoeuvre]]"), text.find("[increments]"));
    let (Some(before), Some(after)) = (before, after) else { unreachable!("{text}") };
    folder.file("quiet.toml", &format!("{}{}", &text[..before], &text[after..]));
    assert_eq!(phugoid(&folder.0, &["simulate", "quiet.toml", "--out", "."]).code, Some(0));
    let command = ["estimate", "measured.csv", "--model", "f16-model", "--no-report"];
    let run = phugoid(&folder.0, &[&command[..], &["--json"]].concat());
    assert_eq!(run.code, Some(5));
    let document = run.json_of_any_result();
    for p in document["parameters"].as_array().into_iter().flatten() {
        assert_eq!(p["status"], "not_excited", "{p}");
        assert!(p["converged_at_s"].is_null(), "{p}");
        let (sigma, prior) = (p["corrected_std_error"].as_f64(), p["prior_std"].as_f64());
        assert!(sigma.zip(prior).is_some_and(|(s, prior)| s > 0.9 * prior), "{p}");
    }
    let run = phugoid(&folder.0, &command);
    assert_eq!(run.code, Some(5));
    assert!(run.out.contains("No excitation") || run.out.contains("Not excited"), "{}", run.out);
}
