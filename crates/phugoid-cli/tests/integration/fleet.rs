//! A fleet: killed and started again, in shards, on one thread and on two, the store is the same to the last bit.
#![cfg(feature = "fleet")]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use phugoid_fleet::simulated::{Drift, Exchange, SimulatedFleet};
use phugoid_flight_data::csv;

use crate::common::{Folder, phugoid};
use crate::stores::{content, killed_until_it_ends};

const AIRFRAMES: usize = 3;
const FLIGHTS: usize = 4;

/// A drift of ten percent in four flights, which cannot be overlooked.
fn drifting() -> SimulatedFleet {
    let drift = Drift { airframe: 2, parameter: "Cm_alpha".to_owned(), part_per_flight: 0.1 };
    SimulatedFleet {
        seed: 5,
        sensor_scale: 0.01,
        sample_rate_hz: 25.0,
        manoeuvres: 1,
        drifts: vec![drift],
        exchanges: Vec::new(),
    }
}

/// Twelve flights, a copy of one of them, a flight in which nothing moves, and a file that is no flight.
fn logs(folder: &Path) {
    let fleet = drifting();
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

#[test]
fn a_run_that_is_killed_again_and_again_ends_like_an_undisturbed_one() {
    let folder = Folder::new("fleet-kill");
    logs(&folder.0);
    let begun = Instant::now();
    let whole = fleet(&folder.0, "whole", &["--workers", "1"]);
    let lasted = begun.elapsed();
    assert_eq!((&whole["estimated"], &whole["refused"], &whole["copies"]), (&14.into(), &2.into(), &1.into()));
    // Killed at times that cover the whole run, whatever its length, until it has nothing left to do: at a part of the run between
    // 5 % and 45 %, another one each time.
    let arguments = ["fleet", "logs", "--model", "hfb320", "--store", "killed", "--workers", "2"];
    let kills = killed_until_it_ends(&folder, &arguments, |turn| lasted.mul_f64(0.05 + 0.4 * turn));
    assert!(kills >= 2, "killed {kills} times only");
    assert_eq!(content(&folder.0.join("killed")), content(&folder.0.join("whole")));
    leave(&folder.0.join("killed"), "fleet");
    // Nothing is done a second time.
    let again = fleet(&folder.0, "killed", &[]);
    assert_eq!((&again["estimated"], &again["found"], &again["rows"]), (&0.into(), &14.into(), &0.into()));
}

/// Leaves a store for scripts/check-fleet.sh, which asks it questions.
fn leave(store: &Path, name: &str) {
    let Some(place) = std::env::var_os("PHUGOID_FLEET_STORES") else { return };
    for (file, bytes) in content(store) {
        let target = Path::new(&place).join(name).join(file);
        fs::create_dir_all(target.parent().unwrap()).unwrap();
        fs::write(target, bytes).unwrap();
    }
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
    assert!(run(&["logs", "--model", "hfb320", "--store", "s3://b/s"]).fails(3).contains("--engine ray"));
    assert!(run(&["logs", "--model", "hfb", "--store", "s"]).fails(3).contains("hfb320"));
    assert!(run(&["logs", "--model", "hfb320", "--store", "logs"]).fails(4).contains("no store"));
    let run = Command::new(env!("CARGO_BIN_EXE_phugoid"))
        .current_dir(&folder.0)
        .env("PHUGOID_PYTHON", "no-such-python")
        .args(["fleet", "logs", "--model", "hfb320", "--store", "s", "--engine", "ray"])
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(1));
    assert!(String::from_utf8(run.stderr).unwrap().contains("no-such-python"));
    assert_eq!(
        phugoid(&folder.0, &["fleet", "logs", "--model", "hfb320", "--store", "s", "--engine", "spark"]).code,
        Some(2)
    );
    assert!(!folder.0.join("s").exists());
}

/// Ten flights of each of four airframes, of which the third one drifts by five percent in each flight, and sensors with
/// scale errors of one and a half percent.
#[test]
fn the_drift_of_one_airframe_is_found_and_no_other() {
    let folder = Folder::new("fleet-drift");
    let drift = Drift { airframe: 2, parameter: "Cm_alpha".to_owned(), part_per_flight: 0.05 };
    let made = SimulatedFleet {
        seed: 11,
        sensor_scale: 0.015,
        sample_rate_hz: 25.0,
        manoeuvres: 1,
        drifts: vec![drift],
        exchanges: Vec::new(),
    };
    let mut table = "log,airframe,flight,hours\n".to_owned();
    for airframe in 0..4 {
        for flight in 0..10 {
            let name = format!("logs/{airframe}-{flight}.csv");
            fs::create_dir_all(folder.0.join("logs")).unwrap();
            csv::write_path(&made.record(airframe, flight).unwrap(), &folder.0.join(&name)).unwrap();
            table.push_str(&format!("{name},N{airframe},{},{}\n", flight + 1, 2 * flight));
        }
    }
    folder.file("flights.csv", &table);
    fleet(&folder.0, "store", &["--flights", "flights.csv"]);
    let told = phugoid(&folder.0, &["fleet", "tell", "store", "--json"]).json();
    let courses: Vec<_> = told["airframes"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|a| a["courses"].as_array().unwrap().iter().map(move |course| (a["name"].clone(), course)))
        .collect();
    assert!(courses.len() >= 4 * 4, "{}", courses.len());
    let changed: Vec<String> = courses
        .iter()
        .filter(|(_, course)| course["shape"] != "steady")
        .map(|(name, course)| format!("{name} {} {}", course["parameter"], course["shape"]))
        .collect();
    let (_, drifting) = courses.iter().find(|(name, c)| name == "N2" && c["parameter"] == "Cm_alpha").unwrap();
    assert_eq!(changed, ["\"N2\" \"Cm_alpha\" \"drift\""], "{drifting:#}");
    let [size, std_error] = ["size", "std_error"].map(|key| drifting["drift"][key].as_f64().unwrap());
    assert!((size + 0.05 * 0.4986).abs() < 3.0 * std_error, "{size} +- {std_error}");
    // A slope of the pitching moment alone drifts: the parameter, or the centre of gravity, which moves no other one here.
    let together =
        told["airframes"].as_array().unwrap().iter().find(|a| a["name"] == "N2").unwrap()["together"][0].clone();
    let causes: Vec<&serde_json::Value> =
        together["explanations"].as_array().unwrap().iter().map(|e| &e["cause"]["name"]).collect();
    assert!(causes.iter().any(|cause| **cause == "Cm_alpha"), "{together:#}");
    assert!(!causes.iter().any(|cause| **cause == "flow_angle_scale"), "{together:#}");
    // Means are no better than what the sensors of an airframe allow.
    let combined = &drifting["combined"];
    assert!(combined["airframe_std"].as_f64() > combined["random_std"].as_f64());
    // Over hours the slope is half as large; a page leads from each point to its flight.
    let over_hours = phugoid(&folder.0, &["fleet", "tell", "store", "--over", "hours"]);
    assert!(over_hours.out.contains("per hour") && over_hours.out.contains("N2"), "{}", over_hours.out);
    let page = phugoid(&folder.0, &["fleet", "view", "store", "--html", "fleet.html"]);
    assert_eq!(page.code, Some(0), "{}", page.err);
    let page = folder.read("fleet.html");
    assert!(page.contains("logs/2-9.csv") && page.contains("drift"));
    reports_of_what_was_found(&folder);
    documents_of_the_logs(&folder);
    let mistaken = phugoid(&folder.0, &["fleet", "tell", "store", "--only", "ekf"]);
    assert!(mistaken.fails(3).contains("ekf"));
}

/// The first and the last flight of the course that drifts have a report, to which the page leads; a log that has gone has none.
fn reports_of_what_was_found(folder: &Folder) {
    let view = |further: &[&str]| phugoid(&folder.0, &[&["fleet", "view", "store", "--reports"], further].concat());
    fs::rename(folder.0.join("logs/2-0.csv"), folder.0.join("logs/gone.csv")).unwrap();
    let one = view(&["findings"]);
    assert!(one.out.contains("Reports: 1 (1 of them new)") && one.out.contains("Without a report: 1"), "{}", one.out);
    assert!(one.out.contains("2-0.csv"), "{}", one.out);
    fs::rename(folder.0.join("logs/gone.csv"), folder.0.join("logs/2-0.csv")).unwrap();
    let both = view(&["findings"]);
    assert!(both.out.contains("Reports: 2 (1 of them new)") && !both.out.contains("Without"), "{}", both.out);
    let page = folder.read("fleet.html");
    let mut addresses: Vec<&str> = page.split("href=\"").filter_map(|rest| rest.split('"').next()).collect();
    addresses.retain(|address| address.starts_with("fleet-reports/"));
    addresses.sort_unstable();
    addresses.dedup();
    assert_eq!(addresses.len(), 2, "{addresses:?}");
    for address in addresses {
        let report = folder.read(address);
        assert!(report.contains("Cm_alpha") && report.contains(", manoeuvre 1</h1>"), "{address}");
    }
    // A model that is another one gives other numbers.
    let other = view(&["findings", "--model", "f16"]);
    assert!(other.fails(3).contains("--model"), "{}", other.err);
}

/// Every log has a document; the last flight of the airframe that drifts says so.
fn documents_of_the_logs(folder: &Folder) {
    let written = phugoid(&folder.0, &["fleet", "analyses", "store", "--dir", "analyses"]);
    assert_eq!(written.out, "Documents: 40 in analyses\n", "{}", written.err);
    let documents: Vec<serde_json::Value> = fs::read_dir(folder.0.join("analyses"))
        .unwrap()
        .map(|entry| serde_json::from_slice(&fs::read(entry.unwrap().path()).unwrap()).unwrap())
        .collect();
    let of = |path: &str| documents.iter().find(|d| d["log"]["path"] == path).unwrap();
    let ids = |document: &serde_json::Value| -> Vec<String> {
        document["diagnostics"].as_array().unwrap().iter().map(|d| d["id"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(ids(of("logs/2-9.csv")), ["aerodynamic_derivatives", "airframe_explained", "derivative_changed"]);
    let others = documents.iter().filter(|document| ids(document).len() > 1).count();
    assert_eq!(others, 1, "only one flight is told of");
    // A table of numbers has no clock of an autopilot: times are those of the record.
    let first = of("logs/0-0.csv");
    assert_eq!(first["clock"], "record");
    let begins_us = first["diagnostics"][0]["timestamp_us"].as_u64().unwrap();
    assert!(begins_us < 14_000_000, "{begins_us}");
}

/// Twenty flights of an airframe that gets another vane after ten of them: 8 % more, and a zero that is half a degree off.
#[test]
fn another_vane_is_named_as_what_changed() {
    let folder = Folder::new("fleet-vane");
    let zero = 0.5_f64.to_radians();
    let vane = Exchange { airframe: 0, flight: 10, channel: "alpha".to_owned(), scale: 0.08, zero };
    let made = SimulatedFleet {
        seed: 12,
        sensor_scale: 0.015,
        sample_rate_hz: 25.0,
        manoeuvres: 1,
        drifts: Vec::new(),
        exchanges: vec![vane],
    };
    fs::create_dir_all(folder.0.join("logs/N1")).unwrap();
    for flight in 0..20 {
        let path = folder.0.join(format!("logs/N1/{flight:02}.csv"));
        csv::write_path(&made.record(0, flight).unwrap(), &path).unwrap();
    }
    fleet(&folder.0, "store", &[]);
    let told = phugoid(&folder.0, &["fleet", "tell", "store", "--json"]).json();
    let together = &told["airframes"][0]["together"][0];
    let explanations = together["explanations"].as_array().unwrap();
    let [first, ..] = &explanations[..] else { panic!("{together:#}") };
    assert_eq!((&together["what"], &together["at"]), (&"step".into(), &11.0.into()), "{together:#}");
    assert_eq!(first["cause"]["kind"], "vane", "{together:#}");
    // The model declares 2 % of the vane.
    let number = |key: &str| first[key].as_f64().unwrap();
    assert!((number("size") - 4.0).abs() < 3.0 * number("std_error"), "{first:#}");
    assert!((number("zero_rad") - zero).abs() < 3.0 * number("zero_std_rad"), "{first:#}");
    let text = phugoid(&folder.0, &["fleet", "tell", "store"]).out;
    assert!(text.contains("step at flight 11  flow angles: scale +"), "{text}");
    phugoid(&folder.0, &["fleet", "view", "store", "--html", "fleet.html"]);
    assert!(folder.read("fleet.html").contains("flow angles: scale +"));
}

const CAMPAIGN: &str = r#"
name = "a small campaign"
scenarios = ["small.toml"]
models = ["hfb320"]
methods = ["smpe", "ekf"]
seeds = 1
[[vary]]
in = "scenario"
path = "sensors.alpha.noise"
values = [0.05, 0.2]
unit = "deg"
[[vary]]
in = "model"
path = "parameters.Cm_q.prior_std"
from = 25.8
to = 258.0
log = true
steps = 2
"#;

const SMALL: &str = r#"
name = "short"
duration = "8 s"
sample_rate = "25 Hz"
[aircraft]
file = "hfb320"
[condition]
altitude = "4300 m"
speed = "104.67 m/s"
[[manoeuvre]]
type = "3-2-1-1"
surface = "elevator"
start = "1 s"
unit = "0.7 s"
amplitude = "0.8 deg"
[sensors]
alpha = { noise = "0.057 deg" }
q = { noise = "0.033 deg/s" }
qdot = { noise = "0.32 deg/s^2" }
"#;

#[test]
fn a_campaign_is_flown_once_scored_and_grows() {
    let folder = Folder::new("fleet-campaign");
    folder.file("small.toml", SMALL);
    let campaign = CAMPAIGN.replace("\"ekf\"", "\"ekf\", \"cramer-rao\"");
    folder.file("c.toml", &campaign);
    let run = |store: &str, further: &[&str]| {
        phugoid(&folder.0, &[&["campaign", "c.toml", "--store", store, "--json"], further].concat()).json()
    };
    let whole = run("study", &[]);
    assert_eq!((&whole["summary"]["estimated"], &whole["summary"]["refused"]), (&12.into(), &0.into()));
    let scores = whole["scores"].as_array().unwrap();
    let score = |method: &str| {
        scores.iter().find(|s| s["method"] == method && s["parameter"] == "Cm_elevator").unwrap().clone()
    };
    for method in ["smpe", "ekf"] {
        let score = score(method);
        assert_eq!(score["estimations"], 4);
        assert!(score["median_error"].as_f64().unwrap() < 0.2, "{score}");
    }
    // What no unbiased method can be better than stands beside them; it claims nothing that may be wrong. Of four flights the ratio
    // of an efficient method is 0.35 to 1.67 in 95 of 100 (chi-squared). This air is calm, and the model file declares turbulence, for
    // which the filter leaves room: of twenty flights the ratio is 2.3.
    let bound = score("cramer-rao");
    assert!(bound["coverage"].is_null() && bound["median_error"].is_null(), "{bound}");
    let ratio = score("smpe")["rmse"].as_f64().unwrap() / bound["rmse"].as_f64().unwrap();
    assert!((0.35..6.0).contains(&ratio), "{ratio}");
    // In shards the store is the same; a second run finds all of it.
    run("shards", &["--shard", "2/2", "--workers", "1"]);
    assert_eq!(run("shards", &["--shard", "1/2"])["scores"], whole["scores"]);
    assert_eq!(content(&folder.0.join("shards")), content(&folder.0.join("study")));
    assert_eq!(run("study", &[])["summary"]["found"], 12);
    leave(&folder.0.join("study"), "study");
    // Another value of a factor flies what is new alone.
    folder.file("c.toml", &campaign.replace("values = [0.05, 0.2]", "values = [0.05, 0.1, 0.2]"));
    let grown = run("study", &[]);
    assert_eq!((&grown["summary"]["found"], &grown["summary"]["estimated"]), (&12.into(), &6.into()));
    // The scenario that a file names counts by its content.
    folder.file("small.toml", &SMALL.replace("8 s", "9 s"));
    assert_eq!(run("study", &[])["summary"]["found"], 0);
    // A key that means nothing is a row with its reason, and a path that leads nowhere is told at once.
    folder.file("c.toml", &CAMPAIGN.replace("sensors.alpha.noise", "sensors.alhpa.noise"));
    let refused = phugoid(&folder.0, &["campaign", "c.toml", "--store", "wrong", "--json"]);
    assert!(
        refused.code == Some(1) && refused.err.contains("no estimation of the campaign has numbers"),
        "{}",
        refused.err
    );
    let refused = refused.json_of_any_result();
    assert_eq!((&refused["summary"]["refused"], &refused["summary"]["estimated"]), (&8.into(), &8.into()));
    assert!(refused["unscored"][0]["message"].as_str().unwrap().contains("alhpa"), "{refused:#}");
    folder.file("c.toml", &CAMPAIGN.replace("sensors.alpha.noise", "name.alpha"));
    let run = phugoid(&folder.0, &["campaign", "c.toml", "--store", "wrong"]);
    assert!(run.fails(3).contains("`name.alpha`"));
}

/// Twelve flights in blocks of three.
fn in_blocks() -> String {
    CAMPAIGN
        .replace("seeds = 1", "seeds = 3\nblock = 3")
        .replace("methods = [\"smpe\", \"ekf\"]", "methods = [\"smpe\"]")
}

#[test]
fn a_campaign_in_blocks_is_the_same_whoever_flies_it_and_however_often_it_is_killed() {
    let folder = Folder::new("fleet-blocks");
    folder.file("small.toml", SMALL);
    folder.file("c.toml", &in_blocks());
    let run = |store: &str, further: &[&str]| {
        phugoid(&folder.0, &[&["campaign", "c.toml", "--store", store, "--json"], further].concat()).json()
    };
    let begun = Instant::now();
    let whole = run("whole", &["--workers", "1"]);
    let lasted = begun.elapsed();
    assert_eq!((&whole["summary"]["files"], &whole["summary"]["estimated"]), (&12.into(), &12.into()));
    let files = content(&folder.0.join("whole"));
    let rows = files.keys().filter(|file| file.starts_with("estimates")).count();
    assert_eq!(rows, 4, "{:?}", files.keys());
    for (store, shards) in [("two", vec!["1/1"]), ("shards", vec!["3/3", "1/3", "2/3"])] {
        shards.iter().for_each(|shard| _ = run(store, &["--workers", "2", "--shard", shard]));
        assert_eq!(content(&folder.0.join(store)), files, "{store}");
    }
    // Killed again and again, it ends where the undisturbed one did.
    let arguments = ["campaign", "c.toml", "--store", "killed", "--workers", "1"];
    let kills = killed_until_it_ends(&folder, &arguments, |turn| lasted.mul_f64(0.3 + 0.5 * turn));
    assert!(kills >= 1, "it was never killed");
    assert_eq!(content(&folder.0.join("killed")), files);
    let again = run("killed", &[]);
    assert_eq!((&again["summary"]["found"], &again["scores"]), (&12.into(), &whole["scores"]));
    // The rows are those of a campaign without blocks, but for the key, which is that of the block.
    folder.file("c.toml", &in_blocks().replace("block = 3", ""));
    assert_eq!(run("single", &[])["scores"], whole["scores"]);
    let single = content(&folder.0.join("single"));
    assert_eq!(single.keys().filter(|file| file.starts_with("estimates")).count(), 12);
}
