//! Telemetry logs of ground stations: what is in them, their clocks, and what is kept of damaged ones.
#![allow(clippy::unwrap_used, clippy::panic)]

use phugoid_flight_data::log::{Log, Selection, read, survey};
use phugoid_flight_data::mavlink::definitions::{self, Kind};
use phugoid_flight_data::mavlink::frame;
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::reader::{self, ReadOptions};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::table::ColumnMapping;

use crate::damage;
use crate::logs::{TLOG_START_US as START_US, tlog, tlog_entry};

fn all(bytes: &[u8]) -> Log {
    read(bytes, "test.tlog", &Selection::default()).unwrap()
}

#[allow(clippy::result_large_err)] // the error of the reader itself
fn record_of(bytes: &[u8], name: &str, options: &ReadOptions) -> Result<Record, reader::ReadError> {
    let path = std::env::temp_dir().join(format!("phugoid-tlog-{name}-{}.tlog", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    let record = reader::read_path(&path, options);
    std::fs::remove_file(&path).unwrap();
    record
}

/// A message of the vehicle (1, 1) that comes `ms` after the start.
fn entry(ms: u64, name: &str, numbers: &[(&str, f64)], text: &str) -> Vec<u8> {
    tlog_entry(START_US + 1000 * ms, (1, 1), name, numbers, text)
}

#[test]
fn messages_are_topics_in_plain_units_at_the_times_of_the_vehicle() {
    let log = all(&tlog(200));
    let attitude = log.topic("ATTITUDE", 0).unwrap();
    assert_eq!((attitude.time_s.len(), attitude.field("pitch").unwrap().unit.as_deref()), (200, Some("rad")));
    // They arrive with a delay of 0 to 30 ms; their own stamps are 20 ms apart.
    assert!(attitude.time_s.windows(2).all(|pair| (pair[1] - pair[0] - 0.02).abs() < 1e-9));
    let position = log.topic("GLOBAL_POSITION_INT", 0).unwrap().field("lat").unwrap();
    assert_eq!((position.unit.as_deref(), position.values[0]), (Some("deg"), 47.397_742_1));
    assert!(log.topic("VFR_HUD", 0).unwrap().time_s[0] >= attitude.time_s[0], "it has the newest time before it");
    assert_eq!(log.topic("NAMED_VALUE_FLOAT", 0).unwrap().fields[0].name, "alpha");
    let parameter = |name: &str| log.parameters.iter().find(|(other, _)| other == name).map(|(_, value)| *value);
    assert_eq!((parameter("SERVO2_FUNCTION"), parameter("MAV_TYPE")), (Some(19.0), Some(1.0)));
    assert_eq!(log.messages[0].text, "ArduPlane V4.5.0");
    let said = log.quality.to_string();
    assert!(said.contains("read is system 1") && said.contains("40 of 255"), "{said}");
    assert!(said.contains("VFR_HUD") && said.contains("carry the newest one"), "{said}");
    let information = format!("{:?}", log.information);
    assert!(information.contains("ArduPilot") && information.contains("2023-11-14"), "{information}");
    // A survey counts the same.
    let survey = survey(&tlog(200)[..], "test.tlog").unwrap();
    assert_eq!(survey.topic("ATTITUDE", 0).unwrap().samples, 200);
}

#[test]
fn a_record_has_the_channels_of_a_stream() {
    let record = record_of(&tlog(200), "record", &ReadOptions::default()).unwrap();
    assert_eq!(record.len(), 200);
    let value = |name: &str, sample: usize| record.require(name).unwrap().values[sample];
    for sample in [10, 150] {
        let t = 0.02 * sample as f64;
        assert!((value("theta", sample) - f64::from((0.05 * t.sin()) as f32)).abs() < 1e-9);
        assert!((value("q", sample) - f64::from((0.05 * t.cos()) as f32)).abs() < 1e-9);
    }
    // By name, in SI; and the servo by the parameters of the vehicle: 1600 us is a quarter of the way to 1900 from 1500.
    assert!((value("alpha", 20) - f64::from(0.07_f32)).abs() < 1e-9);
    assert!((value("elevator_command", 20) - 0.25).abs() < 1e-9);
    assert!((value("calibrated_airspeed", 20) - 21.5).abs() < 1e-6);
    assert!(record.quality.to_string().contains("elevator = { header = \"elevator_command\""), "{}", record.quality);
}

#[test]
fn any_field_and_name_can_be_mapped_and_pulses_count_from_the_middle() {
    let mut options = ReadOptions::default();
    options.table.columns = vec![
        ColumnMapping::new("elevator", "SERVO_OUTPUT_RAW.servo2_raw").with_scale(-0.001),
        ColumnMapping::new("beta", "NAMED_VALUE_FLOAT.my_vane").with_unit("deg"),
    ];
    let record = record_of(&tlog(200), "mapped", &options).unwrap();
    let value = |name: &str| record.require(name).unwrap().values[20];
    assert!((value("elevator") + 0.1).abs() < 1e-12, "{}", value("elevator"));
    assert!((value("beta") - 2_f64.to_radians()).abs() < 1e-9);
    options.table.columns = vec![ColumnMapping::new("beta", "NAMED_VALUE_FLOAT.my_vain")];
    let error = record_of(&tlog(200), "misspelt", &options).unwrap_err().to_string();
    assert!(error.contains("my_vain") && error.contains("my_vane"), "{error}");
}

#[test]
fn a_restart_of_the_vehicle_goes_on_by_the_clock_of_the_ground_station() {
    let attitude = |sent_ms: u64, boot_ms: u64| entry(sent_ms, "ATTITUDE", &[("time_boot_ms", boot_ms as f64)], "");
    let before = (0..100).flat_map(|k| attitude(20 * k, 60_000 + 20 * k));
    let after = (0..100).flat_map(|k| attitude(10_000 + 20 * k, 500 + 20 * k));
    let log = all(&before.chain(after).collect::<Vec<u8>>());
    let times = &log.topic("ATTITUDE", 0).unwrap().time_s;
    // Four messages are needed to see it.
    assert_eq!(times.len(), 196);
    assert!((times[195] - 11.98).abs() < 1e-9 && times.windows(2).all(|pair| pair[1] > pair[0]), "{}", times[195]);
    let said = log.quality.to_string();
    assert!(said.contains("clock has begun again 1 time") && said.contains("4 messages left out"), "{said}");
}

#[test]
fn what_is_damaged_is_left_out_and_counted_and_the_rest_is_read() {
    let intact = tlog(200);
    // A bit in a payload: that message alone is lost. The first is HEARTBEAT, the second ATTITUDE.
    let mut flipped = intact.clone();
    let first = 8 + frame::length(&intact[8..]).unwrap();
    flipped[first + 8 + 12] ^= 4;
    let log = all(&flipped);
    assert_eq!(log.topic("ATTITUDE", 0).unwrap().time_s.len(), 199);
    assert!(log.quality.to_string().contains("1 message left out: the checksum is wrong"), "{}", log.quality);
    // Bytes lost and bytes put in: the place is named.
    let mut torn = intact.clone();
    torn.drain(first + 3..first + 7);
    let log = all(&torn);
    assert_eq!(log.topic("ATTITUDE", 0).unwrap().time_s.len(), 199);
    assert!(log.quality.to_string().contains(&format!("byte {first}")), "{}", log.quality);
    let mut noisy = intact.clone();
    noisy.splice(first..first, (0..1000_u32).map(|k| (k * 7 % 256) as u8));
    let log = all(&noisy);
    assert_eq!(log.topic("ATTITUDE", 0).unwrap().time_s.len(), 200);
    assert!(log.quality.to_string().contains("1000 bytes skipped"), "{}", log.quality);
    // Cut in the middle of the last message.
    let log = all(&intact[..intact.len() - 3]);
    assert!(log.quality.to_string().contains("the log ends within a message"), "{}", log.quality);
}

#[test]
fn damage_never_ends_the_program() {
    damage::try_all(&tlog(40), |bytes| {
        let _ = read(bytes, "damaged.tlog", &Selection::default());
        let _ = survey(bytes, "damaged.tlog");
    });
}

/// Every byte of this could begin a frame, and none does.
#[test]
fn nonsense_takes_linear_time() {
    let time = |megabytes: usize| {
        let mut nonsense = tlog(2);
        nonsense.extend([0, 0, 0, 0, 0, 0, 0, 0, 0xFD, 0xFE, 0, 0].iter().cycle().take(megabytes << 20));
        let start = std::time::Instant::now();
        let log = all(&nonsense);
        assert_eq!(log.topic("ATTITUDE", 0).unwrap().time_s.len(), 2);
        start.elapsed().as_secs_f64()
    };
    let (one, four) = (time(1).min(time(1)), time(4));
    // Four times as much, with room for a busy machine; a search from every byte to the end would take sixteen times.
    assert!(four < 10.0 * one.max(0.01), "{one} s and {four} s");
}

#[test]
fn only_values_that_are_asked_for_take_memory_and_more_than_the_budget_is_refused() {
    let bytes = tlog(4000);
    let few = Selection { max_memory: "400 kB".parse::<Memory>().unwrap(), ..Selection::topics(["VFR_HUD"]) };
    assert!(read(&bytes[..], "long.tlog", &few).unwrap().topic("VFR_HUD", 0).is_some());
    let all = Selection { max_memory: "400 kB".parse().unwrap(), ..Selection::default() };
    let error = read(&bytes[..], "long.tlog", &all).unwrap_err().to_string();
    assert!(error.contains("long.tlog") && error.contains("400 kB"), "{error}");
}

#[test]
fn what_holds_no_vehicle_is_refused_with_the_reason() {
    let ground = tlog_entry(START_US, (255, 190), "HEARTBEAT", &[("type", 6.0)], "").repeat(10);
    let error = read(&ground[..], "ground.tlog", &Selection::default()).unwrap_err().to_string();
    assert!(error.contains("no message states its time"), "{error}");
    let error = read(&b"time_s,q\n0,1\n"[..], "table.csv", &Selection::default()).unwrap_err();
    assert!(error.to_string().contains("table.csv"), "{error}");
}

/// `SYSTEM_TIME` and `GPS_RAW_INT` have stamps of another clock, and MAVLink 1 and signed frames are read too.
#[test]
fn other_clocks_and_kinds_of_frames() {
    let mut bytes = entry(0, "GPS_RAW_INT", &[("time_usec", START_US as f64)], "");
    for k in 0..10_u64 {
        bytes.extend(entry(20 * k, "ATTITUDE", &[("time_boot_ms", (5000 + 20 * k) as f64)], ""));
        bytes.extend(entry(20 * k + 1, "GPS_RAW_INT", &[("time_usec", (START_US + 20_000 * k) as f64)], ""));
    }
    let attitude = definitions::by_name("ATTITUDE").unwrap();
    let mut payload = vec![0; attitude.length()];
    let stamp = attitude.field("time_boot_ms").unwrap();
    assert_eq!(stamp.kind, Kind::Unsigned(4));
    payload[stamp.offset..stamp.offset + 4].copy_from_slice(&5300_u32.to_le_bytes());
    // MAVLink 1: all of the payload, and a number of one byte.
    let mut first = vec![0xFE, payload.len() as u8, 7, 1, 1, 30];
    first.extend(&payload);
    first.extend(frame::checksum(&first[1..], attitude.crc_extra).to_le_bytes());
    bytes.extend([&(START_US + 300_000).to_be_bytes()[..], &first].concat());
    let mut signed = frame::encode_with_flags(1, 30, 8, 1, 1, &payload).unwrap();
    signed.extend([9; frame::SIGNATURE]);
    bytes.extend([&(START_US + 320_000).to_be_bytes()[..], &signed].concat());
    let log = all(&bytes);
    assert_eq!(log.topic("ATTITUDE", 0).unwrap().time_s.len(), 12);
    let gps = log.topic("GPS_RAW_INT", 0).unwrap();
    assert_eq!(
        gps.time_s[..3],
        [0.0, 0.02, 0.04],
        "the newest time of the vehicle; the first came before there was one"
    );
    assert!(log.quality.to_string().contains("1 message left out: they came before the first time"), "{}", log.quality);
}
