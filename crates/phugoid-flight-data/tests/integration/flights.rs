//! Recorded flights and traces are read as they stand, to the last digit.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use crate::shared_data;

use phugoid_flight_data::csv::{CsvOptions, read_path};
use phugoid_flight_data::record::Record;
use shared_data::shared_file;

/// The record of a file of the shared data.
fn shared(file: &str) -> Option<Record> {
    Some(read_path(&shared_file(file)?, &CsvOptions::default()).unwrap_or_else(|error| panic!("{error}")))
}

fn at(record: &Record, name: &str, row: usize) -> f64 {
    record.require(name).unwrap_or_else(|error| panic!("{error}")).values[row]
}

/// The HFB-320 flight: 601 rows at 10 Hz in SI. Numbers are the first row of the file as printed there.
#[test]
fn hfb_320() {
    let Some(record) = shared("flight/hfb320.csv") else { return };
    assert_eq!(record.time.len(), 601);
    assert_eq!(record.time[600], 60.00002);
    for (name, value) in [
        ("elevator", -0.0079912),
        ("dynamic_pressure", 4467.594),
        ("thrust", 11548.7),
        ("true_airspeed", 106.0321),
        ("alpha", 0.1117975),
        ("theta", 0.105409),
        ("q", -0.00344005),
        ("qdot", -0.0060279),
        ("ax", 0.96958),
        ("az", -9.86526),
        ("ay", -0.0744216),
        ("p", 0.0289607),
        ("r", -0.02091264),
        ("pdot", -0.00346854),
        ("rdot", 0.0),
        ("beta", -0.0059548),
        ("phi", 0.02366995),
        ("aileron", -0.03850417),
        ("rudder", -0.01637254),
    ] {
        assert_eq!(at(&record, name, 0), value, "{name}");
    }
    assert_eq!(record.channels.len(), 19);
    assert!(record.quality.findings.is_empty(), "a clean flight needs no word: {}", record.quality);
}

#[test]
fn unstable_short_period() {
    let Some(record) = shared("flight/unstable_short_period.csv") else { return };
    let names: Vec<_> = record.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names, ["pilot_command", "w", "q", "elevator", "az"]);
    assert_eq!(record.time.len(), 251);
    assert_eq!(record.quality.warnings().count(), 0, "{}", record.quality);
}

/// Traces in feet and degrees with 2 % of the frames and 5 % of the values bad; columns of expected values pass through.
#[test]
fn golden_traces() {
    let Some(calm) = shared("golden/calm_3211_p4.csv") else { return };
    assert_eq!(calm.time.len(), 2000);
    // First row of the file: -1.9625410157731686 deg, 20000 ft, 675.034192767 ft/s, -32.311691021 ft/s2.
    assert!((at(&calm, "elevator", 0) - (-1.962_541_015_773_168_6_f64).to_radians()).abs() < 1e-16);
    assert!((at(&calm, "altitude", 0) - 6096.0).abs() < 1e-9);
    assert!((at(&calm, "true_airspeed", 0) - 675.034_192_767 * 0.3048).abs() < 1e-12);
    assert!((at(&calm, "az", 0) + 32.311_691_021 * 0.3048).abs() < 1e-13);
    assert_eq!(at(&calm, "theta", 0), 0.042_770_621);
    assert_eq!(at(&calm, "expected_sd_dCm_q", 0), 3.0);
    assert_eq!(at(&calm, "frame_present", 0), 1.0);
    assert!(calm.quality.findings.is_empty(), "{}", calm.quality);

    let Some(hard) = shared("golden/gust_bias_outliers_damage_p5_6.csv") else { return };
    assert_eq!(hard.time.len(), 2000, "missing frames are rows without measurements, not missing rows");
    let absent: Vec<bool> =
        hard.require("frame_present").unwrap().values.iter().map(|&present| present == 0.0).collect();
    for name in ["true_airspeed", "alpha", "theta", "q", "ax", "az"] {
        let missing: Vec<bool> = hard.require(name).unwrap().values.iter().map(|value| value.is_nan()).collect();
        assert_eq!(missing, absent, "{name}");
        // 5 % of 2000 values stand 20 sigma off: about 100, of which neighbours hide some.
        let spikes = hard.quality.channels.iter().find(|channel| channel.name == name).unwrap().spikes;
        assert!((70..=110).contains(&spikes), "{name}: {spikes}");
    }
    assert_eq!(hard.quality.warnings().count(), 0, "{}", hard.quality);
}

/// Autopilot logs are not CSV; the message says what they are.
#[test]
fn binary_logs_are_refused_by_name() {
    for (file, name) in [("logs/sample_log_small.ulg", "PX4 ULog"), ("logs/log171.bin", "ArduPilot DataFlash")] {
        let Some(path) = shared_file(file) else { continue };
        let error = read_path(&path, &CsvOptions::default()).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}
