//! A fleet: killed and started again, in shards, on one thread and on two, the store is the same to the last bit.
#![cfg(feature = "fleet")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use phugoid_fleet::simulated::SimulatedFleet;
use phugoid_flight_data::csv;

use crate::common::{Folder, phugoid};

const AIRFRAMES: usize = 3;
const FLIGHTS: usize = 4;

/// Twelve flights, a copy of one of them, a flight in which nothing moves, and a file that is no flight.
fn logs(folder: &Path) {
    let fleet = SimulatedFleet { seed: 5, sensor_scale: 0.01, drifts: Vec::new() };
    for airframe in 0..AIRFRAMES {
        for flight in 0..FLIGHTS {
            let path = folder.join(format!("logs/{airframe}/{flight}.csv"));
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            csv::write_path(&fleet.record(airframe, flight).unwrap(), &path).unwrap();
        }
    }
    fs::copy(folder.join("logs/0/0.csv"), folder.join("logs/0/copy.csv")).unwrap();
    fs::write(folder.join("logs/0/broken.csv"), "this is no flight\n1\n").unwrap();
    let still: String = (0..200).map(|k| format!("{},0.1,100,1\n", 0.1 * f64::from(k))).collect();
    fs::write(folder.join("logs/0/still.csv"), format!("time_s,elevator_deg,true_airspeed_m_s,alpha_deg\n{still}"))
        .unwrap();
}

fn fleet(folder: &Path, store: &str, further: &[&str]) -> serde_json::Value {
    let arguments = ["fleet", "logs", "--model", "hfb320", "--store", store, "--json"];
    phugoid(folder, &[&arguments, further].concat()).json()
}

/// Every file of a store with its content.
fn content(store: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![store.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if !path.file_name().unwrap().to_string_lossy().starts_with(".phugoid-") {
                files.insert(path.strip_prefix(store).unwrap().to_owned(), fs::read(&path).unwrap());
            }
        }
    }
    files
}

#[test]
fn a_run_that_is_killed_again_and_again_ends_like_an_undisturbed_one() {
    let folder = Folder::new("fleet-kill");
    logs(&folder.0);
    let begun = Instant::now();
    let whole = fleet(&folder.0, "whole", &["--workers", "1"]);
    let lasted = begun.elapsed();
    assert_eq!((&whole["estimated"], &whole["refused"], &whole["copies"]), (&14.into(), &2.into(), &1.into()));
    // Killed at times that cover the whole run, whatever its length, until it has nothing left to do.
    let mut kills = 0;
    for attempt in 0.. {
        assert!(attempt < 60, "no end after {attempt} starts");
        let mut child = Command::new(env!("CARGO_BIN_EXE_phugoid"))
            .current_dir(&folder.0)
            .args(["fleet", "logs", "--model", "hfb320", "--store", "killed", "--workers", "2"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // A part of the run between 5 % and 45 %, another one each time.
        let part = 0.05 + 0.4 * (f64::from(attempt) * 0.618_034).fract();
        std::thread::sleep(Duration::from_secs_f64(lasted.as_secs_f64() * part));
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
    }
    assert!(kills >= 2, "killed {kills} times only");
    assert_eq!(content(&folder.0.join("killed")), content(&folder.0.join("whole")));
    // Nothing is done a second time.
    let again = fleet(&folder.0, "killed", &[]);
    assert_eq!((&again["estimated"], &again["found"], &again["rows"]), (&0.into(), &14.into(), &0.into()));
}

#[test]
fn shards_threads_and_what_is_added_later_give_the_same_store() {
    let folder = Folder::new("fleet-shards");
    logs(&folder.0);
    fs::rename(folder.0.join("logs/2"), folder.0.join("later")).unwrap();
    fleet(&folder.0, "whole", &["--workers", "2"]);
    let mut of_shards = 0;
    for shard in ["3/3", "1/3", "2/3"] {
        of_shards += fleet(&folder.0, "shards", &["--shard", shard])["estimated"].as_u64().unwrap();
    }
    assert_eq!(of_shards, 10);
    assert_eq!(content(&folder.0.join("shards")), content(&folder.0.join("whole")));
    let before = content(&folder.0.join("whole"));
    fs::rename(folder.0.join("later"), folder.0.join("logs/2")).unwrap();
    let added = fleet(&folder.0, "whole", &[]);
    assert_eq!((&added["estimated"], &added["found"]), (&4.into(), &10.into()));
    let after = content(&folder.0.join("whole"));
    assert!(before.iter().all(|(file, bytes)| after.get(file) == Some(bytes)));
}

#[test]
fn mistakes_are_told_before_anything_is_estimated() {
    let folder = Folder::new("fleet-mistakes");
    logs(&folder.0);
    let run = |arguments: &[&str]| phugoid(&folder.0, &[&["fleet"], arguments].concat());
    assert!(run(&["nowhere", "--model", "hfb320", "--store", "s"]).fails(3).contains("`nowhere`"));
    assert!(run(&["s3://b/x", "--model", "hfb320", "--store", "s"]).fails(3).contains("object store"));
    assert!(run(&["logs", "--model", "hfb", "--store", "s"]).fails(3).contains("hfb320"));
    assert!(run(&["logs", "--model", "hfb320", "--store", "logs"]).fails(4).contains("no store"));
    assert!(!folder.0.join("s").exists());
}
