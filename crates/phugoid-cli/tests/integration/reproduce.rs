//! `phugoid reproduce`: selection, files, exit codes, and that two runs give the same bytes.
#![allow(clippy::unwrap_used, clippy::panic)] // in what several tests share

use crate::common;

use std::path::Path;

use common::{Folder, phugoid};

/// A published case file, to start one's own from.
fn case_file(name: &str) -> String {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/thesis")).join(name);
    std::fs::read_to_string(path).unwrap()
}

/// Names of all files below a folder with their contents, in order.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(contents(&path).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            found.push((name, std::fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

#[test]
fn the_list_names_every_case_once() {
    let folder = Folder::new("reproduce-list");
    let list = phugoid(&folder.0, &["reproduce", "--list"]);
    assert_eq!(list.code, Some(0), "{}", list.err);
    let ids: Vec<&str> = list.out.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(ids.len() > 30 && ids.contains(&"second-order/3") && ids.contains(&"combined/1"), "{ids:?}");
    let json = phugoid(&folder.0, &["reproduce", "--list", "--json"]).json();
    let listed: Vec<&str> = json.as_array().unwrap().iter().map(|e| e["id"].as_str().unwrap()).collect();
    assert_eq!(ids, listed);
    let mut unique = ids.clone();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(unique.len(), ids.len());
    assert!(contents(&folder.0).is_empty(), "a list writes nothing");
}

#[test]
fn one_case_is_told_in_full() {
    let folder = Folder::new("reproduce-one");
    let run = phugoid(&folder.0, &["reproduce", "first-order/1", "--figures", "svg"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.err.is_empty(), "quiet in a pipe: {}", run.err);
    for words in [
        "Published",
        "Reconstructed",
        "Result",
        "Required",
        "What differs, and why",
        "Read beside it",
        "converges",
        "0.500 s",
        "Requirements: ",
        "phugoid-reproduction/report.html",
    ] {
        assert!(run.out.contains(words), "{words}: {}", run.out);
    }
    assert!(run.out.lines().all(|line| line.chars().count() < 160), "{}", run.out);
    let page = folder.read("phugoid-reproduction/report.html");
    assert!(page.contains("id=\"first-order/1\"") && page.contains("<svg"));
    let golden = folder.read("phugoid-reproduction/first-order-1.csv");
    assert!(golden.lines().count() > 10 && golden.lines().next().unwrap().contains('['), "{golden}");
    assert!(folder.read("phugoid-reproduction/figures/first-order-1-estimates.svg").starts_with("<svg"));
}

#[test]
fn two_runs_give_the_same_files() {
    let folder = Folder::new("reproduce-twice");
    for out in ["one", "two"] {
        let cases = ["reproduce", "trim", "first-order/4", "noise/2", "dcm-alpha/1", "--out", out, "--figures", "svg"];
        let run = phugoid(&folder.0, &cases);
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert!(run.out.contains("noise/2") && run.out.contains("dCm_alpha"), "{}", run.out);
    }
    let (one, two) = (contents(&folder.0.join("one")), contents(&folder.0.join("two")));
    let names: Vec<&String> = one.iter().map(|(name, _)| name).collect();
    for wanted in ["report.html", "reproduction.json", "noise-2.csv", "figures/noise-2-estimates.svg"] {
        assert!(names.iter().any(|name| *name == wanted), "{wanted} is not among {names:?}");
    }
    for ((name, bytes), other) in one.iter().zip(&two) {
        assert!((name, bytes) == (&other.0, &other.1), "{name} differs from {}", other.0);
    }
    assert_eq!(one.len(), two.len());
}

#[test]
fn json_is_one_document_with_or_without_curves() {
    let folder = Folder::new("reproduce-json");
    let short = phugoid(&folder.0, &["reproduce", "first-order", "--json"]).json();
    let cases = short["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 5);
    let counts = ["requirements", "requirements_met", "requirements_not_met"].map(|n| short[n].as_u64().unwrap());
    assert!(counts[0] >= 5 && counts[0] == counts[1] + counts[2], "{counts:?}");
    assert!(cases[0].get("charts").is_none());
    let parameter = &cases[0]["outcomes"][0]["parameters"][0];
    assert_eq!((&parameter["name"], &parameter["truth"]), (&"a".into(), &3.0.into()));
    // The document in the folder is the same.
    let file: serde_json::Value = serde_json::from_str(&folder.read("phugoid-reproduction/reproduction.json")).unwrap();
    assert_eq!(file, short);
    let long = phugoid(&folder.0, &["reproduce", "first-order/1", "--json", "--charts"]).json();
    let x = long["cases"][0]["charts"][0]["panels"][0]["content"]["curves"]["curves"][0]["x"].as_array().unwrap();
    assert!(x.len() > 100);
}

#[test]
fn a_case_of_ones_own_runs_like_a_published_one() {
    let folder = Folder::new("reproduce-own");
    let mine = case_file("first-order-1.toml").replace("truth = 3.0", "truth = 4.0");
    folder.file("mine.toml", &mine);
    let run = phugoid(&folder.0, &["reproduce", "mine.toml", "--json"]).json();
    assert_eq!(run["cases"][0]["id"], "mine");
    let flagship = &run["cases"][0]["outcomes"][0];
    assert_eq!((&flagship["role"], &flagship["behaviour"]), (&"flagship".into(), &"converges".into()));
    assert!((flagship["parameters"][0]["end"].as_f64().unwrap() - 4.0).abs() < 0.2);
    assert!(folder.0.join("phugoid-reproduction/mine.csv").is_file());
}

#[test]
fn mistakes_are_answered_with_the_nearest_right_word() {
    let folder = Folder::new("reproduce-wrong");
    for (wrong, right) in [("second-oder/3", "`second-order/3`"), ("nois", "`noise`")] {
        let run = phugoid(&folder.0, &["reproduce", wrong]);
        assert!(run.fails(3).contains(right), "{}", run.err);
    }
    let run = phugoid(&folder.0, &["reproduce", "xyz"]);
    assert!(run.fails(3).contains("--list"), "{}", run.err);
    let run = phugoid(&folder.0, &["reproduce", "gone.toml"]);
    assert!(run.fails(3).contains("gone.toml"), "{}", run.err);
    folder.file("bad.toml", &case_file("first-order-1.toml").replace("lambda =", "lamda ="));
    let run = phugoid(&folder.0, &["reproduce", "bad.toml"]);
    assert!(run.fails(3).contains("lambda"), "{}", run.err);
    assert!(!folder.0.join("phugoid-reproduction").exists(), "nothing is written before all cases are known");
    folder.file("file", "");
    assert!(phugoid(&folder.0, &["reproduce", "first-order/1", "--out", "file"]).fails(4).contains("--out"));
}

#[test]
fn a_case_that_cannot_be_run_does_not_lose_the_others() {
    let folder = Folder::new("reproduce-escape");
    // The unstable plant escapes in finite time, before this record ends.
    let escapes = case_file("second-order-nonlinear-4.toml")
        .replace("duration = \"2.15 s\"", "duration = \"20 s\"")
        .replace("amplitude = 1e-06", "amplitude = 1.0");
    folder.file("escapes.toml", &escapes);
    let run = phugoid(&folder.0, &["reproduce", "escapes.toml", "first-order/1"]);
    assert_eq!(run.code, Some(1), "{}{}", run.out, run.err);
    assert!(run.err.starts_with("error: escapes has no result") && run.err.contains("escapes at"), "{}", run.err);
    assert!(run.out.contains("first-order/1") && run.out.contains("No result: escapes"), "{}", run.out);
    assert!(folder.read("phugoid-reproduction/report.html").contains("Without a result"));
    assert!(folder.0.join("phugoid-reproduction/first-order-1.csv").is_file());
}

#[test]
fn files_of_one_name_are_kept_apart() {
    let folder = Folder::new("reproduce-names");
    std::fs::create_dir_all(folder.0.join("other")).unwrap();
    for (name, truth) in [("first-order-1.toml", "truth = 4.0"), ("other/first-order-1.toml", "truth = 2.0")] {
        folder.file(name, &case_file("first-order-1.toml").replace("truth = 3.0", truth));
    }
    let names = ["first-order-1.toml", "first-order/1", "other/first-order-1.toml", "first-order-1.toml"];
    let json = phugoid(&folder.0, &[&["reproduce", "--json"], &names[..]].concat()).json();
    let found: Vec<(&str, f64)> = json["cases"]
        .as_array()
        .unwrap()
        .iter()
        .map(|case| (case["id"].as_str().unwrap(), case["outcomes"][0]["parameters"][0]["truth"].as_f64().unwrap()))
        .collect();
    assert_eq!(found, [("first-order-1-2", 4.0), ("first-order/1", 3.0), ("first-order-1-3", 2.0)]);
    for name in ["first-order-1", "first-order-1-2", "first-order-1-3"] {
        assert!(folder.0.join(format!("phugoid-reproduction/{name}.csv")).is_file(), "{name}");
    }
}

#[test]
fn a_case_that_teaches_nothing_is_refused_with_the_key_to_mend() {
    let folder = Folder::new("reproduce-nothing");
    for (file, right, wrong, words) in [
        ("first-order-1.toml", "amplitude = 1.0", "amplitude = nan", "`input.amplitude`"),
        ("first-order-1.toml", "amplitude = 1.0", "amplitude = 0.0", "`input.amplitude`"),
        ("first-order-1.toml", "amplitude = 1.0", "amplitude = 1.0\nat = \"5 s\"", "`input.at`"),
        ("second-order-3.toml", "frequency = \"", "frequency = \"-", "`input.frequency`"),
        ("dcm-q-1.toml", "dCm_q = -0.01", "dCm_q = nan", "`dCm_q` is NaN"),
        ("dcm-q-1.toml", "dCm_q = -0.01", "dCm_q = 0", "`dCm_q` that is not 0"),
        ("model-reference-1.toml", "dCm_q = -10", "dCm_q = inf", "`dCm_q` is inf"),
    ] {
        let text = case_file(file);
        assert!(text.contains(right), "{file}: {right}");
        folder.file("wrong.toml", &text.replacen(right, wrong, 1));
        let run = phugoid(&folder.0, &["reproduce", "wrong.toml"]);
        assert!(run.fails(3).contains(words), "{wrong}: {}", run.err);
    }
}

#[test]
fn a_truth_outside_the_bounds_is_said() {
    let folder = Folder::new("reproduce-outside");
    folder.file("plant.toml", &case_file("first-order-1.toml").replace("truth = 3.0", "truth = 20.0"));
    folder.file("flight.toml", &case_file("dcm-q-1.toml").replace("dCm_q = -0.01", "dCm_q = -5"));
    let json = phugoid(&folder.0, &["reproduce", "plant.toml", "flight.toml", "first-order/1", "--json"]).json();
    let difference = |k: usize| json["cases"][k]["difference"].as_str().unwrap();
    assert!(difference(0).starts_with("The true a of 20 lies outside the bounds 1 to 9"), "{}", difference(0));
    assert!(difference(1).starts_with("The true dCm_q of -5 lies outside the bounds -0.03 to -0.002"));
    assert!(!difference(2).contains("outside the bounds"));
}

#[test]
fn a_comparison_of_ones_own_finds_the_files_beside_it() {
    let folder = Folder::new("reproduce-beside");
    std::fs::create_dir_all(folder.0.join("mine")).unwrap();
    let sine =
        "type = \"sine\"\nsurface = \"elevator\"\nstart = \"3 s\"\nfrequency = \"1 Hz\"\namplitude = \"0.05 deg\"";
    let text = case_file("model-reference-1.toml");
    assert!(text.contains(sine));
    let recorded = "type = \"csv\"\nsurface = \"elevator\"\nfile = \"stick.csv\"\nchannel = \"elevator\"";
    folder.file("mine/compare.toml", &text.replace(sine, recorded));
    folder.file("mine/stick.csv", "time_s,elevator_deg\n0,0\n3,0\n4,0.05\n5,-0.05\n6,0.05\n7,0\n20,0\n");
    let run = phugoid(&folder.0, &["reproduce", "mine/compare.toml"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
}

#[test]
fn a_case_is_shown_and_a_changed_one_is_labelled() {
    let folder = Folder::new("reproduce-show");
    let shown = phugoid(&folder.0, &["reproduce", "first-order/1", "--show"]);
    assert_eq!((shown.code, shown.out.trim_end()), (Some(0), case_file("first-order-1.toml").trim_end()));
    assert!(!folder.0.join("phugoid-reproduction").exists(), "nothing is run");
    let study = phugoid(&folder.0, &["reproduce", "laws/reaching", "--show"]);
    assert!(study.fails(3).contains("`laws/reaching` is a study"), "{}", study.err);
    // The same text runs under its title; with another number it is another case, and says so.
    folder.file("same.toml", &shown.out);
    folder.file("mine.toml", &shown.out.replacen("lambda", "# mine\nlambda", 1));
    let json = phugoid(&folder.0, &["reproduce", "same.toml", "mine.toml", "--json", "--out", "r"]).json();
    let text = json.to_string();
    assert_eq!(text.matches("(changed: not the case first-order/1 of the thesis)").count(), 1, "{text}");
}
