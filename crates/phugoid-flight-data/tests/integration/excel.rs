//! Workbooks written by openpyxl (`tests/python/table_fixtures.py`), whole and damaged.
#![cfg(feature = "excel")]
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use crate::damage;
use crate::flight;

use phugoid_flight_data::excel::{read, read_path};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::reader::{self, ReadOptions};
use phugoid_flight_data::table::TableOptions;

fn file(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/excel").join(name)
}

#[test]
fn a_sheet_is_read_by_its_name() {
    let mut options = ReadOptions::default();
    options.table.variable = Some("Flight 2".to_owned());
    let record = reader::read_path(&file("sheets.xlsx"), &options).unwrap();
    flight::check(&record, "sheets.xlsx");
    let said = record.quality.to_string();
    assert!(said.contains("sheet 'Flight 2': read; not read: Notes"), "{said}");
    options.table.variable = Some("Flight 3".to_owned());
    let error = reader::read_path(&file("sheets.xlsx"), &options).unwrap_err().to_string();
    assert!(error.contains("there is no sheet 'Flight 3'. Found: Notes, Flight 2"), "{error}");
}

/// Titles above the table, a row of units below the header, and times that are Excel's dates over midnight.
#[test]
fn a_sheet_as_people_make_it_is_read() {
    let record = reader::read_path(&file("clock.xlsx"), &ReadOptions::default()).unwrap();
    assert_eq!(record.len(), flight::ROWS);
    for (row, time) in record.time.iter().enumerate() {
        assert!((time - 0.125 * row as f64).abs() < 1e-3, "{row}: {time}");
    }
    assert_eq!(record.channel("q").unwrap().values[0], (-0.5_f64).to_radians());
    assert!(record.channel("q").unwrap().values[3].is_nan());
    let said = record.quality.to_string();
    assert!(said.contains("line 1: not part of the table"), "{said}");
    assert!(said.contains("counts from the first row, which is at 2024-05-01 23:59:59.000000"), "{said}");
}

#[test]
fn what_is_too_large_unpacked_is_refused() {
    let options = TableOptions { max_memory: Memory::from_bytes(20_000), ..TableOptions::default() };
    let error = read_path(&file("clock.xlsx"), &options).unwrap_err().to_string();
    assert!(error.contains("budget is 20 kB"), "{error}");
}

#[test]
fn other_archives_are_named() {
    let error = read(&b"PK\x03\x04...."[..], "x.zip", &TableOptions::default()).unwrap_err().to_string();
    assert!(error.starts_with("x.zip: this is no workbook that can be read"), "{error}");
}

#[test]
fn damaged_workbooks_do_not_panic() {
    for name in ["clock.xlsx", "sheets.xlsx"] {
        let bytes = std::fs::read(file(name)).unwrap();
        damage::try_all(&bytes, |bytes| {
            let _ = read(bytes, "x.xlsx", &TableOptions::default()).map(|record| flight::keeps_its_promises(&record));
        });
    }
}
