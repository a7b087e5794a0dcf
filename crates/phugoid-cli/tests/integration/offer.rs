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
    // Without the term the model contradicts the flight, and with it nothing does. Here it bends every value.
    assert_eq!(first.code, Some(1), "{}", first.err);
    assert!(first.out.starts_with("REFUSED: the model lacks a term."), "{}", first.out);
    assert!(
        first.out.contains("The model lacks alpha^2 in Cm. That is what speaks against this result"),
        "{}",
        first.out
    );
    // The line of the coefficient and that of the parameter, to be copied.
    let heading = "\nTerms that the equations of motion ask for\n";
    let (before, section) = first.out.split_once(heading).unwrap_or_else(|| panic!("{}", first.out));
    assert!(before.contains("equations of motion ask for alpha^2 in Cm (dCm_alpha2 = "), "{before}");
    let lines: Vec<&str> = section.lines().map(str::trim).collect();
    let after = |word: &str| lines[lines.iter().position(|l| *l == word).unwrap() + 1];
    assert_eq!(after("[coefficients]"), "Cm = [\"alpha\", \"q_hat\", \"elevator\", \"alpha^2\"]");
    assert!(after("[parameters]").starts_with("dCm_alpha2 = { prior_std = "), "{section}");
    assert!(section.contains("Taken in, they would move") && section.contains("dCL_alpha"), "{section}");
    let page = folder.read("phugoid-report/report.html");
    assert!(page.contains("id=\"offer\"") && page.contains("dCm_alpha2 = { prior_std = "));

    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-damage-model"]).out;
    let old = model.lines().find(|l| l.starts_with("Cm = [")).unwrap();
    let mended = model.replace(old, after("[coefficients]"));
    let mended = mended.replace("[parameters]", &format!("[parameters]\n{}\n#", after("[parameters]")));
    folder.file("mended.toml", &mended);
    let second = by("mended.toml", &["--no-report"]);
    assert!(!second.out.contains("ask for") && !second.out.contains("adopted"), "{}{}", second.out, second.err);
    assert!(second.out.contains("dCm_alpha2"), "{}", second.out);

    // The same without copying: what was taken in stands in the model file that is written.
    let written = by("f16-damage-model", &["--structure", "auto", "--write-model", "found.toml", "--no-report"]);
    assert!(
        written.out.contains("the model file did not have alpha^2 in Cm; it does now"),
        "{}{}",
        written.out,
        written.err
    );
    let found = folder.read("found.toml");
    assert!(found.contains("\"alpha^2\"]") && found.contains("dCm_alpha2 = { start = "), "{found}");
    assert!(by("found.toml", &["--no-report"]).out.contains("dCm_alpha2"));
}

#[test]
fn terms_are_offered_taken_or_not_looked_for() {
    let folder = Folder::new("offer-when");
    fly(&folder);
    phugoid(&folder.0, &["simulate", "f16-calm", "--out", "calm"]);
    let by = |record: &str, model: &str, more: &[&str]| {
        let estimate = ["estimate", record, "--model", model, "--no-report", "--json"];
        phugoid(&folder.0, &[&estimate[..], more].concat()).json_of_any_result()
    };
    let squared = |more: &[&str]| by("flight/measured.csv", "f16-damage-model", more);
    let calm = |more: &[&str]| by("calm/measured.csv", "f16-model", more);
    // By default, by both spellings, and beside a batch method.
    for more in [&[][..], &["--structure", "offer"], &["--offer"], &["--method", "output-error"]] {
        let found = squared(more);
        let best = &found["offer"]["terms"][0];
        assert_eq!(
            (best["parameter"].as_str(), best["asked_for"].as_bool()),
            (Some("dCm_alpha2"), Some(true)),
            "{more:?}"
        );
        assert_eq!(found["offer"]["taken"], false);
        assert!(found["parameters"].as_array().unwrap().iter().all(|p| p["name"] != "dCm_alpha2"));
    }
    for more in [["--structure", "never"].as_slice(), &["--no-offer"]] {
        assert!(squared(more)["offer"].is_null());
    }
    let auto = squared(&["--structure", "auto", "--export", "csv=auto.csv"]);
    assert_eq!(auto["offer"]["taken"], true);
    assert!(auto["parameters"].as_array().unwrap().iter().any(|p| p["name"] == "dCm_alpha2"));
    assert!(folder.read("auto.csv").contains("dCm_alpha2"));
    // A right model lacks nothing, and nothing is taken in.
    let right = calm(&["--structure", "auto"]);
    assert_eq!(right["offer"]["taken"], false);
    assert!(right["offer"]["tried"].as_u64().unwrap() >= 20);
    assert!(right["offer"]["terms"].as_array().unwrap().iter().all(|t| t["asked_for"] == false), "{right}");
}

/// Of two straight lines the parameter that is named like the derivative is the slope before the bend, wherever the aircraft flew.
#[test]
fn the_slope_beyond_a_bend_is_said() {
    let folder = Folder::new("offer-bend");
    phugoid(&folder.0, &["simulate", "hfb320", "--out", "flight"]);
    let model = phugoid(&folder.0, &["estimate", "--show-model", "hfb320"]).out;
    let straight = "CL = [\"1\", \"v_hat\", \"alpha\"]";
    assert!(model.contains(straight), "{model}");
    let bent = "CL = [\"1\", \"v_hat\", \"alpha\", \"max(alpha - 0.1, 0)\"]";
    let prior = "[parameters]\nCL_alpha_above_0p1 = { start = 0, prior_std = 5 }";
    folder.file("bent.toml", &model.replace(straight, bent).replace("[parameters]", prior));
    let found =
        phugoid(&folder.0, &["estimate", "flight/measured.csv", "--model", "bent.toml", "--no-report", "--no-offer"]);
    let words = found.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("CL_alpha is the slope where alpha is below 5.7 deg. Above, the slope is CL_alpha + "),
        "{}",
        found.out
    );
    // The flight has one straight line, of the slope in the model file.
    let sum = words.split("CL_alpha + ").nth(1).and_then(|rest| rest.split("= ").nth(1)).unwrap();
    let numbers: Vec<f64> = sum.split(" (two").next().unwrap().split(" +- ").map(|n| n.parse().unwrap()).collect();
    assert!((numbers[0] - 5.376).abs() < numbers[1] && numbers[1] < 2.0, "{numbers:?}");
}
