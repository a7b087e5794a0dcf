//! PX4 logs: what is in them, what is kept of damaged ones, and numbers that pyulog 1.3.0 gives for the same files.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::logs;
use crate::shared_data;

use logs::{ulog, ulog_head, ulog_imu, ulog_key, ulog_message};
use phugoid_flight_data::log::{Log, LogError, Selection, Wanted, read, read_path, survey};
use phugoid_flight_data::memory::Memory;

fn all(bytes: &[u8]) -> Log {
    read(bytes, "test.ulg", &Selection::default()).unwrap()
}

fn findings(log: &Log) -> String {
    log.quality.to_string()
}

#[test]
fn topics_instances_arrays_parameters_and_information() {
    let log = all(&ulog(100));
    assert_eq!(log.topics.len(), 3);
    let imu = log.topic("imu", 1).unwrap();
    let names: Vec<&str> = imu.fields.iter().map(|field| field.name.as_str()).collect();
    assert_eq!(names, ["gyro[0]", "gyro[1]", "gyro[2]", "count"]);
    assert_eq!(imu.time_s.len(), 100);
    assert_eq!(imu.time_s[1], 0.01);
    // By this another program finds the moment again: the time in the record, and what the autopilot's clock said at zero.
    assert_eq!(log.quality.clock_at_zero_us, Some(5_000_000));
    assert_eq!(imu.field("gyro[2]").unwrap().values[40], 42.0);
    assert_eq!(log.topic("slow", 0).unwrap().field("level").unwrap().values[3], 15.0);
    assert_eq!(log.parameters, [("MASS".to_owned(), 1.25)]);
    assert!(log.information.contains(&("sys_name".to_owned(), "PX4".to_owned())));
    assert!(log.quality.findings.is_empty(), "{}", findings(&log));
}

#[test]
fn a_selection_keeps_what_is_asked_for() {
    let wanted = Wanted { topic: "imu".into(), instance: Some(1), fields: Some(vec!["gyro[1]".into()]) };
    let selection = Selection { topics: Some(vec![wanted]), ..Selection::default() };
    let log = read(&ulog(50)[..], "test.ulg", &selection).unwrap();
    assert_eq!(log.topics.len(), 1);
    assert_eq!(log.topics[0].fields.len(), 1);
    assert_eq!(log.topics[0].fields[0].values[7], 8.0);
    let few = Selection { max_memory: Memory::from_bytes(5000), ..Selection::default() };
    let error = read(&ulog(50)[..], "test.ulg", &few).unwrap_err();
    assert!(matches!(error, LogError::OverBudget(_)), "{error}");
}

#[test]
fn a_survey_counts_the_same_and_keeps_nothing() {
    let survey = survey(&ulog(100)[..], "test.ulg").unwrap();
    let imu = survey.topic("imu", 0).unwrap();
    assert_eq!((imu.samples, imu.gaps), (100, 0));
    assert!((imu.step_s / 0.01 - 1.0).abs() < 1.0 / 16.0);
    assert_eq!((imu.fields[0].min, imu.fields[0].max), (Some(0.0), Some(99.0)));
    assert!((imu.last_s - 0.99).abs() < 1e-12);
}

#[test]
fn damage_costs_what_it_hit_and_is_said() {
    let good = ulog(300);
    let samples = |log: &Log| log.topics.iter().map(|topic| topic.time_s.len()).sum::<usize>();
    let before = samples(&all(&good));
    let middle = good.len() / 2;
    for (what, bytes) in [
        ("overwritten", [&good[..middle], &[0x5A; 64], &good[middle + 64..]].concat()),
        ("inserted", [&good[..middle], &[0x11; 37], &good[middle..]].concat()),
        ("missing", [&good[..middle], &good[middle + 50..]].concat()),
    ] {
        let log = all(&bytes);
        assert!(before - samples(&log) <= 4, "{what}: {} of {before}", samples(&log));
        assert!(findings(&log).contains("bytes skipped"), "{what}: {}", findings(&log));
        // Nothing garbled is taken for data.
        for topic in &log.topics {
            assert!(topic.time_s.iter().all(|time| (0.0..3.0).contains(time)), "{what}");
        }
    }
}

#[test]
fn a_cut_log_keeps_what_is_there() {
    let good = ulog(100);
    let log = all(&good[..good.len() - 5]);
    assert!(findings(&log).contains("ends within a message"), "{}", findings(&log));
    assert_eq!(log.topic("imu", 0).unwrap().time_s.len(), 100);
    assert_eq!(log.topic("imu", 1).unwrap().time_s.len(), 99);
}

#[test]
fn a_wrong_length_does_not_swallow_what_it_claims() {
    let mut log = ulog_head();
    log.extend(ulog_imu(0, 5_000_000, 0));
    // A text of 60000 bytes, it says.
    log.extend([0x60, 0xEA, b'L', b'6']);
    for sample in 1..3000 {
        log.extend(ulog_imu(0, 5_000_000 + 1000 * u64::from(sample), sample));
    }
    assert_eq!(all(&log).topic("imu", 0).unwrap().time_s.len(), 3000);
}

#[test]
fn dropouts_and_changed_parameters_are_reported() {
    let mut log = ulog(10);
    log.extend(ulog_message(b'O', &250_u16.to_le_bytes()));
    log.extend(ulog_key(b'P', "float MASS", &2_f32.to_le_bytes()));
    log.extend(ulog_imu(0, 6_000_000, 11));
    let mut text = vec![b'4'];
    text.extend(5_500_000_u64.to_le_bytes());
    text.extend(b"airspeed lost");
    log.extend(ulog_message(b'L', &text));
    let log = all(&log);
    assert!(findings(&log).contains("lost 250 ms of data (250 ms at 0.09 s)"), "{}", findings(&log));
    assert!(findings(&log).contains("MASS = 2 at 0.09 s"), "{}", findings(&log));
    assert_eq!(log.parameters, [("MASS".to_owned(), 1.25)]);
    assert_eq!((log.messages[0].time_s, log.messages[0].text.as_str()), (0.5, "airspeed lost"));
}

#[test]
fn appended_data_begin_where_the_head_says() {
    let mut log = ulog(20);
    // The main part ends in the middle of a message, as after a crash.
    log.truncate(log.len() - 7);
    let offset = log.len() as u64;
    // Flag bits: incompatible bit 0, first offset; after the head of 16 and the message's of 3 bytes.
    log[16 + 3 + 8] = 1;
    log[16 + 3 + 16..16 + 3 + 24].copy_from_slice(&offset.to_le_bytes());
    log.extend(ulog_imu(0, 9_000_000, 77));
    let log = all(&log);
    assert_eq!(log.topic("imu", 0).unwrap().time_s.last(), Some(&4.0));
    assert!(findings(&log).contains("ends within a message"), "{}", findings(&log));
}

#[test]
fn what_cannot_be_read_is_refused_with_a_reason() {
    let error =
        |bytes: &[u8]| phugoid_flight_data::log::ulog::read(bytes, "x", &Selection::default()).unwrap_err().to_string();
    assert!(error(b"").contains("found an empty file"));
    assert!(error(b"hello world, this is text").contains("found 68 65 6c 6c"));
    assert!(error(&ulog(1)[..12]).contains("ends within its head of 16 bytes"));
    assert!(error(&ulog_head()).contains("holds no data"));
    let mut newer = ulog(1);
    newer[16 + 3 + 8] = 4;
    assert!(error(&newer).contains("incompatible flags 04 00"), "{}", error(&newer));
}

/// Numbers of pyulog 1.3.0: `ULog(f).get_dataset('vehicle_attitude').data['q[1]'][100]` and so on.
#[test]
fn a_real_log_says_what_pyulog_says() {
    let Some(path) = shared_data::shared_file("logs/sample_log_small.ulg") else { return };
    let log = read_path(&path, &Selection::default()).unwrap();
    assert_eq!(log.topics.len(), 70);
    assert_eq!(log.parameters.len(), 980);
    assert_eq!(log.messages.len(), 3);
    let attitude = log.topic("vehicle_attitude", 0).unwrap();
    assert_eq!(attitude.time_s.len(), 1298);
    assert!(findings(&log).contains("1 dropout"), "{}", findings(&log));
    let Some(path) = shared_data::shared_file("logs/sample_appended_multiple.ulg") else { return };
    let log = read_path(&path, &Selection::default()).unwrap();
    assert_eq!(log.topics.len(), 20);
    assert_eq!(log.topic("sensor_combined", 0).unwrap().time_s.len(), 2373);
}
