//! MCAP files written by the package `mcap` of PyPI (`tests/python/table_fixtures.py`), whole and damaged.
#![cfg(feature = "mcap")]
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use crate::damage;

use phugoid_flight_data::csv::ColumnMapping;
use phugoid_flight_data::log::{Log, LogError, Selection, Wanted, mcap};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::reader::{self, ReadOptions};

const FILES: [&str; 4] = ["none.mcap", "lz4.mcap", "zstd.mcap", "unchunked.mcap"];

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/mcap").join(name)).unwrap()
}

fn read(bytes: &[u8]) -> Result<Log, LogError> {
    mcap::read(bytes, "x.mcap", &Selection::default())
}

fn values(log: &Log, topic: &str, instance: u16, field: &str) -> Vec<f64> {
    log.topic(topic, instance).unwrap().field(field).unwrap_or_else(|| panic!("{field}")).values.clone()
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
}

#[test]
fn every_compression_gives_the_same_numbers() {
    for name in FILES {
        let log = read(&bytes(name)).unwrap();
        let column = |value: &dyn Fn(f64) -> f64| (0..40).map(|k| value(f64::from(k))).collect::<Vec<f64>>();
        let attitude = log.topic("attitude", 0).unwrap();
        assert_eq!(attitude.time_s, column(&|k| (k * 20_000.0) * 1e-6), "{name}");
        for (field, expected) in [
            ("q[0]", column(&|k| k / 8.0)),
            ("q[1]", column(&|k| -k / 16.0)),
            ("pose.x", column(&|k| if k == 3.0 { f64::NAN } else { k * k / 1024.0 - 0.5 })),
            ("pose.ok", column(&|k| k % 2.0)),
            ("late", column(&|k| if k < 20.0 { f64::NAN } else { k })),
        ] {
            let found = values(&log, "attitude", 0, field);
            assert!(same(&found, &expected), "{name}: {field}: {found:?}");
        }
        assert_eq!(attitude.fields.len(), 5, "text is no signal");
        // Two channels of one topic are two instances of it.
        assert_eq!(values(&log, "air", 0, "tas")[..3], [0.0, 2.0, 4.0]);
        assert_eq!(values(&log, "air", 1, "tas")[..3], [1.0, 3.0, 5.0]);
        assert_eq!(log.topic("air", 1).unwrap().time_s[0], 21_000.0 * 1e-6);
        let said = log.quality.to_string();
        assert!(said.contains("in 'cdr': /imu sensor_msgs/msg/Imu (40 messages)"), "{said}");
        assert!(said.contains("mcap-ros2-support"), "{said}");
        let utc = log.information.iter().find(|(name, _)| name == "utc_at_start");
        assert_eq!(utc.unwrap().1, "2024-05-01T12:34:56.000Z");
        let start = log.quality.start.unwrap();
        assert!((start.unix_s - 1_714_566_896.0).abs() < 1e-3 && start.is_utc, "{start:?}");
        let survey = mcap::survey(bytes(name).as_slice(), "x.mcap").unwrap();
        assert_eq!(survey.topic("attitude", 0).unwrap().samples, 40);
    }
}

#[test]
fn only_what_is_asked_for_is_kept() {
    let wanted = Wanted { topic: "attitude".into(), instance: None, fields: Some(vec!["pose.x".into()]) };
    let selection = Selection { topics: Some(vec![wanted]), max_memory: Memory::from_bytes(40_000) };
    let log = mcap::read(bytes("zstd.mcap").as_slice(), "x.mcap", &selection).unwrap();
    assert_eq!((log.topics.len(), log.topics[0].fields.len(), log.topics[0].time_s.len()), (1, 1, 40));
    let selection = Selection { max_memory: Memory::from_bytes(3000), ..selection };
    let error = mcap::read(bytes("zstd.mcap").as_slice(), "x.mcap", &selection).unwrap_err();
    assert!(matches!(error, LogError::OverBudget(_)), "{error}");
}

/// From the first message of the file, whatever is kept: else a survey and a record had different times.
#[test]
fn time_begins_at_the_first_message() {
    let selection = Selection::topics(["air"]);
    let part = mcap::read(bytes("zstd.mcap").as_slice(), "x.mcap", &selection).unwrap();
    let whole = read(&bytes("zstd.mcap")).unwrap();
    assert_eq!(part.topic("air", 1).unwrap().time_s, whole.topic("air", 1).unwrap().time_s);
    assert_eq!(part.information, whole.information);
}

/// Where the chunks begin, and their lengths.
fn chunks(bytes: &[u8]) -> Vec<(usize, usize)> {
    let mut offset = mcap::MAGIC.len();
    let mut chunks = Vec::new();
    while offset + 9 < bytes.len() {
        let length = u64::from_le_bytes(bytes[offset + 1..offset + 9].try_into().unwrap()) as usize;
        if bytes[offset] == 6 {
            chunks.push((offset, length));
        }
        offset += 9 + length;
    }
    chunks
}

/// A file of which nothing is left says why: else "copy it again" sends its owner in circles.
#[test]
fn a_file_without_a_readable_chunk_says_what_is_wrong_with_the_first() {
    let mut file = bytes("zstd.mcap");
    for (offset, length) in chunks(&file) {
        file[offset + length - 1] ^= 0xff;
    }
    let error = read(&file).unwrap_err().to_string();
    assert!(error.contains("holds no data: byte ") && error.contains("left out, it is damaged"), "{error}");
}

#[test]
fn a_damaged_chunk_is_left_out_and_the_rest_is_read() {
    for name in ["none.mcap", "lz4.mcap", "zstd.mcap"] {
        let mut bytes = bytes(name);
        // The first chunk begins after the header record, with schemas and channels; a byte in the middle of it is turned.
        let chunks = chunks(&bytes);
        assert!(chunks.len() >= 3, "{name}: {chunks:?}");
        let (second, length) = chunks[1];
        bytes[second + 9 + length / 2] ^= 0x10;
        let log = read(&bytes).unwrap();
        let kept = log.topic("attitude", 0).unwrap().time_s.len();
        assert!((20..40).contains(&kept), "{name}: {kept}");
        let said = log.quality.to_string();
        assert!(said.contains(&format!("byte {second}: the record that begins here is left out")), "{name}: {said}");
    }
}

/// Found by fuzzing: the library takes no notice of a record that is longer than its chunk, where nothing is packed and no check sum
/// is given.
#[test]
fn a_record_longer_than_its_chunk_is_damage() {
    let mut bytes = bytes("none.mcap");
    let (at, _) = chunks(&bytes)[1];
    // Start, end, size; check sum; name of the compression, here empty; size; the first record.
    let (checksum, first) = (at + 9 + 24, at + 9 + 24 + 4 + 4 + 8);
    bytes[checksum..checksum + 4].fill(0);
    bytes[first + 1 + 4] = 1;
    let said = read(&bytes).unwrap().quality.to_string();
    assert!(said.contains("its records do not end where it ends"), "{said}");
}

#[test]
fn a_file_that_was_cut_off_is_read_up_to_the_cut() {
    let whole = bytes("unchunked.mcap");
    let log = read(&whole[..whole.len() / 2]).unwrap();
    assert!(log.topic("attitude", 0).unwrap().time_s.len() > 10);
    assert!(log.quality.to_string().contains("what is before is read"), "{}", log.quality);
    let error = read(b"\x89MCAP0").unwrap_err().to_string();
    assert!(error.starts_with("x.mcap: this is no MCAP file"), "{error}");
    let error = read(&whole[..60]).unwrap_err().to_string();
    assert!(error.starts_with("x.mcap: the log holds no data"), "{error}");
}

#[test]
fn damage_anywhere_is_a_log_or_an_error() {
    for name in FILES {
        damage::try_all(&bytes(name), |damaged| match read(damaged) {
            Ok(log) => {
                for topic in &log.topics {
                    assert!(topic.fields.iter().all(|field| field.values.len() == topic.time_s.len()));
                }
                assert!(log.quality.to_string().len() < 50_000);
            }
            Err(error) => assert!(error.to_string().starts_with("x.mcap"), "{error}"),
        });
    }
}

/// Fields whose names say what they are need no profile; others are mapped.
#[test]
fn a_record_by_the_names_of_the_fields() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/mcap/zstd.mcap");
    let record = reader::read_path(&path, &ReadOptions::default()).unwrap();
    assert_eq!(record.len(), 20);
    let speed = record.channel("true_airspeed").unwrap();
    assert_eq!(speed.values[..3], [0.0, 2.0, 4.0]);
    let said = record.quality.to_string();
    assert!(said.contains("no unit is written; taken as m/s (SI)"), "{said}");
    let mapping = ColumnMapping::new("alpha", "attitude.pose.x").with_unit("deg");
    let options = ReadOptions { time_base: Some("attitude".into()), ..ReadOptions::with_columns(vec![mapping]) };
    let record = reader::read_path(&path, &options).unwrap();
    assert_eq!(record.len(), 40);
    assert_eq!(record.channel("alpha").unwrap().values[32], 0.5_f64.to_radians());
}
