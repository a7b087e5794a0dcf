//! `--store` of `phugoid study`, `compare` and `tune`: killed and started again, in shards, with other files, the result is that of
//! an undisturbed run without a store.
#![cfg(feature = "fleet")]

use std::process::{Command, Stdio};
use std::time::Instant;

use serde_json::Value;

use crate::common::{Folder, phugoid};
use crate::stores::{content, killed_until_it_ends};

const STUDY: [&str; 9] =
    ["study", "accuracy", "--scenario", "mine.toml", "--model", "f16-model", "--runs", "10", "--json"];

/// Calm air, four seconds.
fn scenario(folder: &Folder) {
    let calm = include_str!("../../../../scenarios/f16-calm.toml");
    folder.file("mine.toml", &calm.replace("duration = \"20 s\"", "duration = \"4 s\""));
}

fn json(folder: &Folder, arguments: &[&str]) -> Value {
    phugoid(&folder.0, arguments).json()
}

#[test]
fn a_study_that_is_killed_again_and_again_ends_like_an_undisturbed_one() {
    let folder = Folder::new("study-kill");
    scenario(&folder);
    let begun = Instant::now();
    let without = json(&folder, &STUDY);
    let lasted = begun.elapsed();
    let with = |store| [&STUDY[..], &["--store", store]].concat();
    assert_eq!(json(&folder, &with("whole")), without);
    let kills = killed_until_it_ends(&folder, &with("killed"), |turn| lasted.mul_f64(0.05 + 0.4 * turn));
    assert!(kills >= 2, "killed {kills} times only");
    assert_eq!(json(&folder, &with("killed")), without);
    assert_eq!(content(&folder.0.join("killed")), content(&folder.0.join("whole")));
}

#[test]
fn what_decides_on_a_run_makes_another_one_of_it() {
    let folder = Folder::new("study-inputs");
    scenario(&folder);
    let runs = || content(&folder.0.join("kept")).keys().filter(|file| file.starts_with("runs")).count();
    let with = |further: &[&str]| json(&folder, &[&STUDY[..7], &["4", "--json", "--store", "kept"], further].concat());
    let first = with(&[]);
    assert_eq!(runs(), 4);
    // More runs keep the earlier ones; another method, another time and another scenario do not.
    json(&folder, &[&STUDY[..7], &["6", "--json", "--store", "kept"]].concat());
    assert_eq!(runs(), 6);
    with(&["--method", "ekf"]);
    assert_eq!(runs(), 10);
    with(&["--at", "3s"]);
    assert_eq!(runs(), 14);
    let changed =
        folder.read("mine.toml").replace("seed = 1", "seed = 5001").replace("duration = \"4 s\"", "duration = \"3 s\"");
    folder.file("mine.toml", &changed);
    assert_ne!(with(&[])["checkpoints"], first["checkpoints"]);
    assert_eq!(runs(), 18);
}

/// Three processes begin with the runs of their own and leave the whole to whoever asks for the result.
#[test]
fn processes_with_one_store_share_a_comparison() {
    let folder = Folder::new("compare-shards");
    let asked = ["compare", "outliers", "--methods", "rls,fourier", "--seeds", "3"];
    let result = |further: &[&str]| json(&folder, &[&asked[..], &["--json", "--out", "x"], further].concat());
    let without = result(&[]);
    let helpers: Vec<_> = ["1/3", "2/3", "3/3"]
        .map(|shard| {
            Command::new(env!("CARGO_BIN_EXE_phugoid"))
                .current_dir(&folder.0)
                .args(asked)
                .args(["--out", "of-a-shard", "--store", "kept", "--shard", shard])
                .stdout(Stdio::piped())
                .stderr(Stdio::null())
                .spawn()
                .unwrap()
        })
        .into_iter()
        .map(|child| child.wait_with_output().unwrap())
        .collect();
    for helper in helpers {
        assert!(helper.status.success());
        assert!(String::from_utf8_lossy(&helper.stdout).starts_with("All runs are in the store"));
    }
    assert!(!folder.0.join("of-a-shard").exists());
    let before = content(&folder.0.join("kept"));
    assert_eq!(before.keys().filter(|file| file.starts_with("runs/study=compare")).count(), 3);
    let with = result(&["--store", "kept"]);
    assert_eq!(content(&folder.0.join("kept")), before);
    for method in 0..2 {
        let of = |result: &Value| result["entries"][0]["methods"][method]["checkpoints"].clone();
        assert_eq!(of(&with), of(&without));
    }
    let times = |result: &Value| result["entries"][0]["methods"][1]["microseconds"].as_f64().unwrap();
    assert_eq!(times(&with), times(&result(&["--store", "kept"])));
}

#[test]
fn a_search_finds_the_scores_of_an_earlier_one() {
    let folder = Folder::new("tune-kept");
    let asked = ["tune", "model-reference", "--scenario", "first-order/1", "--runs", "2", "--json"];
    let search = |budget, further: &[&str]| {
        let mut result = json(&folder, &[&asked[..], &["--budget", budget, "--out", "tuned.toml"], further].concat());
        result.as_object_mut().unwrap().remove("settings_path");
        (result, folder.read("tuned.toml"))
    };
    let without = search("24", &[]);
    assert_eq!(search("24", &["--store", "kept"]), without);
    let scores = || content(&folder.0.join("kept")).keys().filter(|file| file.starts_with("runs/study=tune")).count();
    let first = scores();
    assert_eq!(search("24", &["--store", "kept"]), without);
    assert_eq!(scores(), first);
    // A longer search begins with what the shorter one has tried.
    let longer = search("48", &["--store", "kept"]).0;
    let (evaluations, shorter) = (longer["evaluations"].as_u64().unwrap(), without.0["evaluations"].as_u64().unwrap());
    assert!(scores() - first <= 2 * (evaluations - shorter) as usize + 4, "{} {first}", scores());
}

#[test]
fn mistakes_with_stores_are_told() {
    let folder = Folder::new("kept-mistakes");
    scenario(&folder);
    let told = |further: &[&str], code| phugoid(&folder.0, &[&STUDY[..], further].concat()).fails(code).to_owned();
    assert!(told(&["--shard", "1/2"], 2).contains("--store"));
    assert!(told(&["--store", "kept", "--shard", "3/2"], 2).contains("3/2"));
    assert!(told(&["--store", "s3://bucket/kept"], 3).contains("folder"));
    std::fs::create_dir(folder.0.join("full")).unwrap();
    folder.file("full/letter.txt", "no store");
    assert!(told(&["--store", "full"], 4).contains("not empty and no store"));
}
