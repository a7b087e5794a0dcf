//! ArduPilot logs: what is in them, what is kept of damaged ones, and numbers that pymavlink 2.4.50 gives for a real one.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::logs;
use crate::shared_data;

use logs::{dataflash, dataflash_define, dataflash_head, dataflash_imu, dataflash_message, dataflash_units};
use phugoid_flight_data::log::{Log, Selection, read, read_path, survey};

fn all(bytes: &[u8]) -> Log {
    read(bytes, "test.bin", &Selection::default()).unwrap()
}

fn findings(log: &Log) -> String {
    log.quality.to_string()
}

#[test]
fn instances_units_multipliers_parameters_and_texts() {
    let log = all(&dataflash(90));
    assert_eq!(log.topics.len(), 3);
    let imu = log.topic("IMU", 2).unwrap();
    assert_eq!(imu.time_s.len(), 30);
    let (rate, temperature) = (imu.field("GyrX").unwrap(), imu.field("Temp").unwrap());
    assert_eq!((rate.unit.as_deref(), rate.values[1]), (Some("rad/s"), 5.0));
    assert_eq!((temperature.unit.as_deref(), temperature.values[0]), (Some("degC"), 25.12));
    assert!((imu.time_s[0] - 0.005).abs() < 1e-12, "from the first stamp");
    assert_eq!(log.parameters, [("SERVO2_FUNCTION".to_owned(), 19.0)]);
    assert_eq!(log.messages[0].text, "ArduPlane V4.5.0");
    assert!(log.quality.findings.is_empty(), "{}", findings(&log));
}

#[test]
fn units_that_come_after_data_apply_to_them_too() {
    let mut log = dataflash_head();
    log.extend(dataflash_define(183, 3 + 8 + 2, "TMP", "Qh", "TimeUS,T"));
    let sample = |stamp: u64| [&stamp.to_le_bytes()[..], &1234_i16.to_le_bytes()].concat();
    log.extend(dataflash_message(183, &sample(2_000_000)));
    log.extend(dataflash_units(183, "sO", "FB"));
    log.extend(dataflash_message(183, &sample(2_100_000)));
    let all_of_it = all(&log);
    let field = all_of_it.topic("TMP", 0).unwrap().field("T").unwrap();
    assert_eq!((field.values.as_slice(), field.unit.as_deref()), ([12.34, 12.34].as_slice(), Some("degC")));
    let survey = survey(&log[..], "test.bin").unwrap();
    let field = &survey.topic("TMP", 0).unwrap().fields[0];
    assert_eq!((field.min, field.max), (Some(12.34), Some(12.34)));
}

#[test]
fn a_type_defined_anew_begins_another_topic() {
    let mut log = dataflash(9);
    log.extend(dataflash_define(182, 3 + 8 + 4, "NEW", "Qf", "TimeUS,X"));
    log.extend(dataflash_message(182, &[&3_000_000_u64.to_le_bytes()[..], &7_f32.to_le_bytes()].concat()));
    let log = all(&log);
    assert_eq!(log.topic("IMU", 0).unwrap().time_s.len(), 3);
    assert_eq!(log.topic("NEW", 0).unwrap().field("X").unwrap().values, [7.0]);
    assert!(findings(&log).contains("was IMU and is NEW"), "{}", findings(&log));
}

#[test]
fn a_topic_that_gains_a_field_has_none_before() {
    let mut log = dataflash_head();
    log.extend(dataflash_define(183, 3 + 8 + 1, "A", "QB", "TimeUS,x"));
    log.extend(dataflash_message(183, &[&2_000_000_u64.to_le_bytes()[..], &[1]].concat()));
    log.extend(dataflash_define(183, 3 + 8 + 2, "A", "QBB", "TimeUS,y,x"));
    log.extend(dataflash_message(183, &[&2_100_000_u64.to_le_bytes()[..], &[2, 3]].concat()));
    let log = all(&log);
    let topic = log.topic("A", 0).unwrap();
    assert_eq!(topic.field("x").unwrap().values, [1.0, 3.0]);
    assert!(topic.field("y").unwrap().values[0].is_nan() && topic.field("y").unwrap().values[1] == 2.0);
}

#[test]
fn damage_costs_what_it_hit_and_is_said() {
    let good = dataflash(600);
    let samples = |log: &Log| log.topics.iter().map(|topic| topic.time_s.len()).sum::<usize>();
    let middle = good.len() / 2 + 5;
    for (what, bytes) in [
        ("overwritten", [&good[..middle], &[0x5A; 64], &good[middle + 64..]].concat()),
        ("inserted", [&good[..middle], &[0x11; 37], &good[middle..]].concat()),
        ("missing", [&good[..middle], &good[middle + 50..]].concat()),
    ] {
        let log = all(&bytes);
        assert!(600 - samples(&log) <= 6, "{what}: {}", samples(&log));
        assert!(findings(&log).contains("bytes skipped"), "{what}: {}", findings(&log));
        for topic in &log.topics {
            assert!(topic.time_s.iter().all(|time| (0.0..1.5).contains(time)), "{what}: {:?}", topic.time_s);
        }
    }
}

#[test]
fn types_without_a_definition_and_definitions_that_do_not_add_up() {
    let mut log = dataflash(30);
    log.extend(dataflash_message(201, &[1, 2, 3, 4]));
    log.extend(dataflash_imu(3_000_000, 0, 1.0));
    log.extend(dataflash_message(201, &[1, 2, 3, 4]));
    log.extend(dataflash_define(183, 2, "BAD", "Q", "TimeUS"));
    log.extend(dataflash_define(184, 40, "ODD", "Qf", "TimeUS,X"));
    log.extend(dataflash_message(184, &[9; 37]));
    log.extend(dataflash_imu(3_100_000, 0, 1.0));
    let log = all(&log);
    let told = findings(&log);
    assert!(told.contains("2 messages left out: their types (201) were never defined"), "{told}");
    assert!(told.contains("message type 183 is damaged"), "{told}");
    assert!(told.contains("ODD") && told.contains("length is given as 40, but its types (Qf) take 15"), "{told}");
    assert_eq!(log.topic("IMU", 0).unwrap().time_s.len(), 12);
}

#[test]
fn a_cut_log_and_one_that_ends_with_filling() {
    let good = dataflash(30);
    let cut = all(&good[..good.len() - 3]);
    assert!(findings(&cut).contains("ends within a message; its 15 bytes"), "{}", findings(&cut));
    let filled = all(&[&good[..], &[0xFF; 200]].concat());
    assert!(findings(&filled).contains("ends with 200 bytes of filling"), "{}", findings(&filled));
    assert_eq!(filled.topics.len(), 3);
}

#[test]
fn what_cannot_be_read_is_refused_with_a_reason() {
    let error = |bytes: &[u8]| {
        phugoid_flight_data::log::dataflash::read(bytes, "x", &Selection::default()).unwrap_err().to_string()
    };
    assert!(error(b"").contains("found an empty file"));
    assert!(error(b"hello").contains("found 68 65 6c"));
    assert!(error(&dataflash_head()).contains("holds no data"));
}

/// Numbers of pymavlink 2.4.50: `DFReader_binary(f, zero_time_base=True)`, its messages counted and read.
#[test]
fn a_real_log_says_what_pymavlink_says() {
    let Some(path) = shared_data::shared_file("logs/log171.bin") else { return };
    let log = read_path(&path, &Selection::default()).unwrap();
    assert_eq!(log.topics.len(), 34);
    assert_eq!(log.parameters.len(), 491);
    for (name, samples) in [("IMU", 11916), ("ATT", 2383), ("GPS", 1199), ("RCOU", 11916), ("PM", 23)] {
        assert_eq!(log.topic(name, 0).unwrap().time_s.len(), samples, "{name}");
    }
}

/// Else a manoeuvre that a survey shows would be elsewhere in the record.
#[test]
fn time_begins_at_the_same_stamp_whatever_is_kept() {
    let mut log = dataflash(30);
    log.extend(dataflash_define(183, 3 + 8 + 4, "ATT", "Qf", "TimeUS,Roll"));
    for sample in 0..3_u64 {
        let mut attitude = (2_500_000 + 10_000 * sample).to_le_bytes().to_vec();
        attitude.extend(0.25_f32.to_le_bytes());
        log.extend(dataflash_message(183, &attitude));
    }
    let selection = Selection::topics(["ATT"]);
    let kept = read(log.as_slice(), "x.bin", &selection).unwrap();
    let survey = survey(log.as_slice(), "x.bin").unwrap();
    assert_eq!(kept.topic("ATT", 0).unwrap().time_s, [0.5, 0.51, 0.52]);
    assert_eq!(survey.topic("ATT", 0).unwrap().first_s, 0.5);
}
