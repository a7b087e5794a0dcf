//! Parquet and Arrow files written by pyarrow (`tests/python/table_fixtures.py`), whole and damaged, and our own.
#![cfg(feature = "parquet")]
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use crate::damage;
use crate::flight;

use std::path::{Path, PathBuf};

use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::parquet::ReadError;
use phugoid_flight_data::reader::{self, ReadOptions};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::table::TableOptions;
use phugoid_flight_data::{arrow, parquet};

const PARQUET: [&str; 5] = [
    "parquet/none.parquet",
    "parquet/snappy.parquet",
    "parquet/zstd.parquet",
    "parquet/lz4.parquet",
    "parquet/pages2.parquet",
];
const ARROW: [&str; 4] =
    ["arrow/uncompressed.feather", "arrow/lz4.feather", "arrow/zstd.feather", "arrow/stream.arrows"];

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn read_bytes(name: &str, bytes: &[u8], options: &TableOptions) -> Result<Record, ReadError> {
    match name.starts_with("arrow/") {
        true => arrow::read(bytes, "x", options),
        false => parquet::read(bytes, "x", options),
    }
}

fn good(name: &str) -> Record {
    reader::read_path(&file(name), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_compression_and_layout_gives_the_same_numbers() {
    for name in PARQUET.iter().chain(&ARROW) {
        let record = good(name);
        flight::check(&record, name);
        let said = record.quality.to_string();
        for part in [
            "column 'mode': left out: it is text",
            "column 'category': left out: it is a dictionary",
            "column 'list': left out: it is nested",
            "column 'struct': left out: it is nested",
            "column 'decimal': left out: it is of the type Decimal",
        ] {
            assert!(said.contains(part), "{name}: {part}\n{said}");
        }
        // The unit was in the field's metadata alone.
        let q = record.quality.channels.iter().find(|channel| channel.name == "q").unwrap();
        assert_eq!((q.unit.as_str(), q.unit_assumed), ("deg_s", false), "{name}");
    }
}

#[test]
fn timestamps_are_the_time() {
    let record = good("parquet/stamped.parquet");
    assert_eq!((record.time[0], record.time[39]), (0.0, 39.0 * 0.0625));
    let said = record.quality.to_string();
    assert!(said.contains("column 'index': taken as the time"), "{said}");
    assert!(said.contains("counts from the first row, which is at 1714566896.000 s"), "{said}");
}

#[test]
fn what_is_not_read_is_refused_with_a_remedy() {
    let options = TableOptions::default();
    let error = parquet::read_path(&file("parquet/gzip.parquet"), &options).unwrap_err().to_string();
    assert!(error.contains("compressed by GZIP") && error.contains("'zstd', 'snappy' or none"), "{error}");
    let error = arrow::read_path(&file("arrow/version1.feather"), &options).unwrap_err().to_string();
    assert!(error.contains("Feather file of version 1") && error.contains("version=2"), "{error}");
    let error = arrow::read(&b"PAR1"[..], "x", &options).unwrap_err().to_string();
    assert!(error.starts_with("x, byte"), "{error}");
    let error = parquet::read(b"PAR1", "x", &options).unwrap_err().to_string();
    assert!(error.starts_with("x, footer: the file is damaged"), "{error}");
}

/// What we write is what we read, bit for bit.
#[test]
fn round_trip() {
    let text =
        "time_s,alpha_deg,tas_kt,throttle,mine [kg m^2],other\n0,1,100,0.5,1,2\n0.1,,101,1e300,2,3\n0.3,3,,0.25,,4\n";
    let record = csv::read(text.as_bytes(), "flight", &CsvOptions::default()).unwrap();
    let path = std::env::temp_dir().join(format!("phugoid-columnar-{}.parquet", std::process::id()));
    parquet::write_path(&record, &path).unwrap();
    let back = parquet::read_path(&path, &TableOptions::default());
    std::fs::remove_file(&path).unwrap();
    let back = back.unwrap();
    assert_eq!(back.time, record.time);
    assert_eq!(back.channels.len(), record.channels.len());
    for (read, written) in back.channels.iter().zip(&record.channels) {
        assert_eq!((&read.name, read.quantity), (&written.name, written.quantity));
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        assert!(read.values.iter().zip(&written.values).all(same), "{}", read.name);
    }
    let assumed = back.quality.channels.iter().filter(|channel| channel.unit_assumed).count();
    assert_eq!(assumed, 0, "{}", back.quality);
}

#[test]
fn the_rows_before_the_damage_are_kept() {
    // Batches of 16 rows: cut in the third.
    let bytes = std::fs::read(file("arrow/stream.arrows")).unwrap();
    let record = arrow::read(&bytes[..bytes.len() - 1000], "x", &TableOptions::default()).unwrap();
    assert_eq!(record.len(), 32);
    assert!(record.quality.to_string().contains("the 32 rows before it are kept"), "{}", record.quality);
    // Groups of 16 rows: the pages of the first are at the beginning of the file.
    let mut bytes = std::fs::read(file("parquet/snappy.parquet")).unwrap();
    bytes[4..200].fill(0xFF);
    let record = parquet::read(&bytes, "x", &TableOptions::default()).unwrap();
    assert_eq!(record.len(), 24);
    assert!(record.quality.to_string().contains("row group 1 of 3: damaged"), "{}", record.quality);
}

#[test]
fn damage_anywhere_is_a_record_or_an_error() {
    let options = TableOptions { max_memory: Memory::from_bytes(2_000_000), ..TableOptions::default() };
    for name in PARQUET.iter().chain(&ARROW) {
        let bytes = std::fs::read(file(name)).unwrap();
        damage::try_all(&bytes, |damaged| match read_bytes(name, damaged, &options) {
            Ok(record) => flight::keeps_its_promises(&record),
            Err(error) => {
                let error = error.to_string();
                assert!(error.starts_with('x') && error.len() < 2000, "{error}");
            }
        });
    }
}

#[test]
fn memory_is_bounded() {
    let options = TableOptions { max_memory: Memory::from_bytes(5000), ..TableOptions::default() };
    for name in PARQUET.iter().chain(&ARROW) {
        let bytes = std::fs::read(file(name)).unwrap();
        let error = read_bytes(name, &bytes, &options).unwrap_err().to_string();
        assert!(error.contains("the budget is 5 kB"), "{name}: {error}");
    }
}
