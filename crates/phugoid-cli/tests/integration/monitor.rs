//! `phugoid monitor`: what it prints, its exit code, and mistakes.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};

#[test]
fn a_failure_is_flagged_with_its_onset_and_its_own_exit_code() {
    let folder = Folder::new("monitor-failure");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-failure", "--out", "."]).code, Some(0));
    let run = phugoid(&folder.0, &["monitor", "measured.csv", "--model", "f16-health-model"]);
    assert_eq!(run.code, Some(10), "{}{}", run.out, run.err);
    for word in ["DIVERGED", "diverged from expected 0 +-", "(flag), onset", "at most once in 100 flight hours"] {
        assert!(run.out.contains(word), "{word}: {}", run.out);
    }
    let run = phugoid(
        &folder.0,
        &["monitor", "measured.csv", "--model", "f16-health-model", "--json", "--history", "--out", "health"],
    );
    assert_eq!(run.code, Some(10), "{}", run.err);
    let json: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(json["condition"], "diverged");
    assert_eq!(json["promise"]["holds"], true, "{}", json["promise"]);
    assert!(json["evidence_hours"].as_f64().unwrap() >= 100.0);
    let failure = &json["failure"];
    let (flag, onset) = (failure["flagged_at_s"].as_f64().unwrap(), failure["onset_s"].as_f64().unwrap());
    assert!((10.0..11.0).contains(&flag) && (onset - 10.0).abs() < 0.5, "{failure}");
    assert_eq!(json["history"]["time_s"].as_array().unwrap().len(), 2001);
    assert!(folder.read("health/health.json").contains("onset_interval_s"));
    assert!(folder.read("health/report.html").contains("<html"));
}

/// On a foreign flight the noise levels are learnt from the flight that they judge: no rate is promised, in no output.
#[test]
fn no_rate_is_promised_where_its_assumptions_were_not_checked() {
    let folder = Folder::new("monitor-foreign");
    let flights = concat!(env!("CARGO_MANIFEST_DIR"), "/../phugoid-evaluation/tests/field/develop/OV10");
    let (flight, model) = (format!("{flights}/calm-short.csv"), format!("{flights}/longitudinal.toml"));
    folder.file("expected.toml", "[expected]\nCm_alpha = { value = -0.3, tolerance = 5.0 }\n");
    let arguments = ["monitor", &flight, "--model", &model, "--expected", "expected.toml"];
    let run = phugoid(&folder.0, &arguments);
    assert!(run.out.contains("No rate of false alarms is promised"), "{}{}", run.out, run.err);
    assert!(run.out.contains("not promised\n") && run.out.contains("not given but learnt"), "{}", run.out);
    assert!(!run.out.contains("at most once"), "{}", run.out);
    let run = phugoid(&folder.0, &[&arguments[..], &["--json", "--out", "health"]].concat());
    let json: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(json["promise"]["holds"], false);
    assert!(json["promise"]["reason"].as_str().unwrap().contains("learnt in flight"));
    assert!(json["evidence_hours"].is_null());
    assert!(folder.read("health/health.json").contains("\"holds\": false"));
}

#[test]
fn mistakes_are_told() {
    let folder = Folder::new("monitor-mistakes");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let monitor = |more: &[&str]| {
        phugoid(&folder.0, &[&["monitor", "measured.csv", "--model", "f16-health-model"], more].concat())
    };
    assert!(monitor(&["--false-alarms-per-hour", "0"]).fails(2).contains("one in a hundred hours"));
    assert!(monitor(&["--false-alarms-per-hour", "often"]).fails(2).contains("as in 0.01"));
    assert!(monitor(&["--expected", "nothing.toml"]).fails(3).contains("nothing.toml"));
    folder.file("expected.toml", "[expected]\ndCm_qq = { tolerance = 0.1 }\n");
    let message = monitor(&["--expected", "expected.toml"]).fails(3).to_owned();
    assert!(message.contains("expected.toml:2") && message.contains("did you mean `dCm_q`"), "{message}");
    folder.file("occupied", "");
    assert!(monitor(&["--out", "occupied"]).fails(4).contains("occupied"));
}
