//! `phugoid tune`, as a user runs it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use std::process::{Command, Stdio};
use std::time::Duration;

use common::{Folder, phugoid};

/// A small task: two flights of ten seconds without noise.
const SMALL: [&str; 9] =
    ["tune", "smpe", "--scenario", "f16-thesis-sine", "--hold-out", "f16-thesis-doublet", "--runs", "2", "--json"];

#[test]
fn what_is_written_can_be_used_and_what_was_gained_is_said() {
    let folder = Folder::new("tune");
    let run = phugoid(&folder.0, &[&SMALL[..], &["--budget", "36"]].concat());
    let document = run.json();
    assert_eq!(document["method"], "smpe");
    assert_eq!(document["evaluations"], 36);
    assert_eq!(document["held_out"]["pairs"].as_array().unwrap().len(), 2);
    let conclusion = document["conclusion"].as_str().unwrap();
    assert!(conclusion.contains("held-out runs"), "{conclusion}");
    assert!(document["training_tuned"].as_f64().unwrap() <= document["training_rule"].as_f64().unwrap());
    // The written section makes a model file that estimates.
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-thesis-model"]).out;
    folder.file("tuned-model.toml", &format!("{model}\n{}", folder.read("phugoid-tuned.toml")));
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-thesis-doublet", "--out", "."]).code, Some(0));
    let estimate = |model: &str| {
        phugoid(&folder.0, &["estimate", "measured.csv", "--model", model, "--no-report", "--json"]).json()
    };
    let (tuned, rule) = (estimate("tuned-model.toml"), estimate("f16-thesis-model"));
    let prior = |document: &serde_json::Value| document["parameters"][0]["value"].as_f64().unwrap();
    assert!((prior(&tuned) / prior(&rule) - 1.0).abs() < 1e-3);
    // As text, the same.
    let text: Vec<&str> = SMALL[..8].iter().copied().chain(["--budget", "36"]).collect();
    let text = phugoid(&folder.0, &text).out;
    for word in ["reaching_limit", "Where the rule comes from", "Held-out runs", "f16-thesis-doublet", conclusion] {
        assert!(text.contains(word), "{word}: {text}");
    }
}

#[test]
fn a_killed_command_goes_on_where_it_was() {
    let folder = Folder::new("tune-killed");
    let arguments = |state: &'static str, out: &'static str| {
        [&SMALL[..], &["--budget", "60", "--state", state, "--out", out]].concat()
    };
    let whole = phugoid(&folder.0, &arguments("whole.state", "whole.toml")).json();
    let mut child = Command::new(env!("CARGO_BIN_EXE_phugoid"))
        .args(arguments("cut.state", "cut.toml"))
        .current_dir(&folder.0)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // Until the first generation has been written; a machine that does all of it in between only makes the test weaker.
    while !folder.0.join("cut.state").exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(2));
    }
    let _ = child.kill();
    child.wait().unwrap();
    let mut resumed = phugoid(&folder.0, &arguments("cut.state", "cut.toml")).json();
    resumed["settings_path"] = whole["settings_path"].clone();
    assert_eq!(resumed, whole);
    for (a, b) in [("cut.state", "whole.state"), ("cut.toml", "whole.toml")] {
        assert_eq!(folder.read(a), folder.read(b));
    }
    // Another seed is another problem.
    let run = phugoid(&folder.0, &[&arguments("cut.state", "cut.toml")[..], &["--seed", "7"]].concat());
    let message = run.fails(3);
    assert!(message.contains("another problem") && message.contains("its seed is `1`, here it is `7`"), "{message}");
}

#[test]
fn the_rule_alone_is_said_with_its_origin() {
    let folder = Folder::new("tune-rule");
    let run = phugoid(&folder.0, &["tune", "thesis-law", "--scenario", "first-order/1", "--runs", "2", "--rule-only"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    for word in ["thesis-law by rule", "lambda h = 0.5", "first-order/1", "phugoid-tuned.toml"] {
        assert!(run.out.contains(word), "{word}: {}", run.out);
    }
    assert!(folder.read("phugoid-tuned.toml").contains("lambda = 500.0"));
}

#[test]
fn mistakes_are_told() {
    let folder = Folder::new("tune-mistakes");
    let tune = |arguments: &[&str]| phugoid(&folder.0, &[&["tune"], arguments].concat());
    assert!(tune(&["smpe", "--scenario", "f16-clam"]).fails(3).contains("`f16-calm`"));
    let run = tune(&["smpe", "--scenario", "f16-thesis-sine", "--runs", "1", "--budget", "5"]);
    assert!(run.fails(3).contains("at least 24"), "{}", run.err);
    assert!(tune(&["smpe", "--scenario", "first-order/1"]).fails(3).contains("this is a plant"));
    assert!(tune(&["thesis-law", "--scenario", "second-order/1"]).fails(3).contains("carries one parameter"));
    assert!(tune(&["thesis-law", "--scenario", "f16-calm"]).fails(3).contains("this is a scenario"));
    tune(&["smpe", "--rule-only", "--budget", "50"]).fails(2);
    tune(&["sliding"]).fails(2);
    folder.file("broken.toml", "title = \"x\"\n[plant]\ntype = \"third-order\"\n");
    assert!(tune(&["thesis-law", "--scenario", "broken.toml"]).fails(3).contains("broken.toml:3"));
    folder.file("state.toml", "nothing");
    let run = tune(&["smpe", "--scenario", "f16-thesis-sine", "--runs", "1", "--state", "state.toml"]);
    assert!(run.fails(3).contains("is no state file"), "{}", run.err);
    // A state that was changed by hand: nothing is built on it.
    let small = [&SMALL[1..], &["--budget", "24", "--state", "search.state"]].concat();
    tune(&small).json();
    let state = folder.read("search.state");
    let evaluations = state.lines().find(|line| line.starts_with("evaluations = ")).unwrap();
    let point = state.lines().rfind(|line| line.starts_with("point = [")).unwrap();
    for (right, wrong, words) in [
        (evaluations, "evaluations = 25", "do not belong together"),
        ("generation = 2", "generation = 999999", "do not belong together"),
        (point, &point.replace("[", "[7"), "outside 0 to 1"),
        ("\nscore = -", "\nscore = -9", "best score"),
    ] {
        assert!(state.contains(right), "{right}: {state}");
        folder.file("search.state", &state.replace(right, wrong));
        assert!(tune(&small).fails(3).contains(words), "{wrong}");
    }
    let run =
        tune(&["smpe", "--scenario", "f16-thesis-sine", "--runs", "1", "--rule-only", "--out", "no/such/folder.toml"]);
    assert!(run.fails(4).contains("folder.toml"), "{}", run.err);
}
