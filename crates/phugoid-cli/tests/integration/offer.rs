//! Terms that the residuals ask for, as a user meets them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::{Folder, phugoid};

/// A minute of a pilot's stick in an F-16 whose pitching moment has a term in alpha^2 that no table has.
fn fly(folder: &Folder) {
    let text = include_str!("../../../../scenarios/f16-damage.toml");
    let (start, rest) = text.split_once("# Until the damage").unwrap();
    let (_, sensors) = rest.split_once("# White noise").unwrap();
    let start = start.replace("duration = \"20 s\"", "duration = \"60 s\"");
    let error = "\n[model_error]\nCm_alpha_squared = 0.5\n";
    folder.file("flight.toml", &format!("{start}# White noise{sensors}{error}"));
    phugoid(&folder.0, &["simulate", "flight.toml", "--out", "flight"]);
}

#[test]
fn a_missing_term_is_offered_and_the_printed_lines_mend_the_model() {
    let folder = Folder::new("offer");
    fly(&folder);
    let by = |model: &str, more: &[&str]| {
        phugoid(&folder.0, &[&["estimate", "flight/measured.csv", "--model", model][..], more].concat())
    };
    let first = by("f16-damage-model", &[]);
    // Without the term the model contradicts the flight; what it lacks is offered all the same.
    assert_eq!(first.code, Some(1), "{}", first.err);
    assert!(first.out.contains("REFUSED"), "{}", first.out);
    // The line of the coefficient and that of the parameter, to be copied.
    let heading = "\nTerms that the residuals ask for\n";
    let (before, section) = first.out.split_once(heading).unwrap_or_else(|| panic!("{}", first.out));
    assert!(before.contains("The residuals ask for alpha^2 in Cm: dCm_alpha2 = "), "{before}");
    let lines: Vec<&str> = section.lines().map(str::trim).collect();
    let after = |word: &str| lines[lines.iter().position(|l| *l == word).unwrap() + 1];
    assert_eq!(after("[coefficients]"), "Cm = [\"alpha\", \"q_hat\", \"elevator\", \"alpha^2\"]");
    assert!(after("[parameters]").starts_with("dCm_alpha2 = { bounds = [-"), "{section}");
    assert!(section.contains("left, asked for") || section.contains("asked for\n"), "{section}");
    let page = folder.read("phugoid-report/report.html");
    assert!(page.contains("id=\"offer\"") && page.contains("dCm_alpha2 = { bounds = [-"));

    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-damage-model"]).out;
    let old = model.lines().find(|l| l.starts_with("Cm = [")).unwrap();
    let mended = model.replace(old, after("[coefficients]"));
    let mended = mended.replace("[parameters]", &format!("[parameters]\n{}\n#", after("[parameters]")));
    folder.file("mended.toml", &mended);
    let second = by("mended.toml", &["--no-report"]);
    assert!(!second.out.contains("ask for") && !second.out.contains("adopted"), "{}{}", second.out, second.err);
    assert!(second.out.contains("dCm_alpha2"), "{}", second.out);
}

#[test]
fn terms_are_tried_for_a_reason_on_request_or_not_at_all() {
    let folder = Folder::new("offer-when");
    fly(&folder);
    phugoid(&folder.0, &["simulate", "f16-calm", "--out", "calm"]);
    let offer = |record: &str, model: &str, more: &[&str]| {
        let estimate = ["estimate", record, "--model", model, "--no-report", "--json"];
        phugoid(&folder.0, &[&estimate[..], more].concat()).json_of_any_result()["offer"].clone()
    };
    let damaged = |more: &[&str]| offer("flight/measured.csv", "f16-damage-model", more);
    let calm = |more: &[&str]| offer("calm/measured.csv", "f16-model", more);
    let best = &damaged(&[])["terms"][0];
    assert_eq!((best["parameter"].as_str(), best["asked_for"].as_bool()), (Some("dCm_alpha2"), Some(true)));
    assert!(damaged(&["--no-offer"]).is_null());
    // Sees the whole record at once.
    assert!(damaged(&["--method", "output-error", "--offer"]).is_null());
    assert!(calm(&[]).is_null());
    let forced = calm(&["--offer"]);
    assert!(forced["terms"].as_array().unwrap().len() >= 4 && forced["reasons"].as_array().unwrap().is_empty());
    assert!(forced["terms"].as_array().unwrap().iter().all(|t| t["asked_for"] == false), "{forced}");
    // Least squares have no density of the innovations.
    assert_eq!(calm(&["--offer", "--method", "rls"])["method"], "smpe");
    assert_eq!(calm(&["--offer", "--method", "ekf"])["method"], "ekf");
}
