//! `phugoid compare` as a user runs it.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests

use crate::common;

use common::{Folder, phugoid};

#[test]
fn methods_are_compared_and_the_result_is_written() {
    let folder = Folder::new("compare");
    let arguments = ["compare", "outliers", "--methods", "smpe,rls", "--seeds", "1", "--json", "--out", "x"];
    let result = phugoid(&folder.0, &arguments).json();
    assert_eq!(result["methods"], serde_json::json!(["smpe", "rls"]));
    let ours = &result["entries"][0]["methods"][0];
    assert!(ours["failed"] == 0 && ours["checkpoints"][2]["accuracy"].as_f64().unwrap() < 5.0, "{ours}");
    let page = folder.read("x/report.html");
    assert!(page.contains("Outliers") && page.contains("phugoid compare outliers --methods smpe,rls --seeds 1"));
    assert_eq!(folder.read("x/comparison.csv").lines().count(), 1 + 2 * 3 * 5);
    let again = phugoid(&folder.0, &arguments).json();
    assert_eq!(ours["checkpoints"], again["entries"][0]["methods"][0]["checkpoints"]);
}

#[test]
fn a_scenario_of_ones_own_needs_a_model_and_gets_a_table() {
    let folder = Folder::new("compare-own");
    let calm =
        include_str!("../../../../scenarios/f16-calm.toml").replace("duration = \"20 s\"", "duration = \"22 s\"");
    folder.file("mine.toml", &calm);
    let message = phugoid(&folder.0, &["compare", "mine.toml"]);
    assert!(message.fails(3).contains("--model"));
    let text = phugoid(
        &folder.0,
        &["compare", "mine.toml", "--model", "f16-model", "--methods", "smpe,rls", "--seeds", "1", "--out", "x"],
    );
    assert_eq!(text.code, Some(0), "{}", text.err);
    assert!(text.out.lines().all(|line| line.chars().count() <= 120), "{}", text.out);
    for words in ["smpe", "rls", "(mine)", "Where each method wins and loses"] {
        assert!(text.out.contains(words), "{words}: {}", text.out);
    }
    folder.file(
        "late.toml",
        "extends = \"calm\"\ntitle = \"Later\"\n[scenario.sensors]\nalpha = { delay = \"50 ms\" }\n",
    );
    let text = phugoid(&folder.0, &["compare", "late.toml", "--methods", "smpe", "--seeds", "1", "--out", "x"]);
    assert!(text.code == Some(0) && text.out.contains("Later (late)"), "{}{}", text.out, text.err);
}

/// Errors that residuals are silent about: the estimate is the same with and without what the model file declares, and the bounds are not.
#[test]
fn silent_errors_are_held_by_bounds_that_declare_them() {
    let folder = Folder::new("compare-silent");
    let arguments =
        ["compare", "silent-mass", "calm", "--methods", "smpe,equation-error", "--seeds", "1", "--out", "x"];
    let text = phugoid(&folder.0, &arguments);
    assert_eq!(text.code, Some(0), "{}", text.err);
    assert!(text.out.lines().all(|line| line.chars().count() <= 120), "{}", text.out);
    assert!(
        text.out.contains("over the parameters. without:")
            && folder.read("x/report.html").contains("With and without declared errors")
    );
    let result = phugoid(&folder.0, &[&arguments[..], &["--json"]].concat()).json();
    let (silent, calm) = (&result["entries"][0], &result["entries"][1]);
    assert!(silent["silent"] == true && calm["silent"] == false);
    for method in silent["methods"].as_array().unwrap() {
        let last = &method["checkpoints"][2];
        let of = |key: &str| last[key].as_f64().unwrap();
        assert!(of("claimed_over_actual") > 2.0 * of("undeclared_over_actual"), "{last}");
    }
    assert!(calm["methods"][0]["checkpoints"][2]["undeclared_coverage"].is_null());
}

#[test]
fn mistakes_are_told_in_words() {
    let folder = Folder::new("compare-mistakes");
    let told = |arguments: &[&str]| phugoid(&folder.0, arguments).fails(3).to_owned();
    assert!(told(&["compare", "clam"]).contains("did you mean `calm`"));
    assert!(told(&["compare", "calm", "--methods", "smpee"]).contains("`smpe`"));
    assert!(told(&["compare", "calm", "--methods", "smpe,smpe"]).contains("twice"));
    assert!(told(&["compare", "calm", "calm"]).contains("two scenarios are called `calm`"));
    let list = phugoid(&folder.0, &["compare", "--list"]);
    assert!(list.out.contains("everything ") && list.out.contains("smpe "), "{}", list.out);
}
