//! Files written by scipy.io.savemat (`tests/python/table_fixtures.py`), whole and damaged.
#![cfg(feature = "matlab")]
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use crate::damage;
use crate::flight;

use phugoid_flight_data::matlab::{ReadError, read, read_path};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::reader::{self, ReadOptions};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::table::{ColumnMapping, TableOptions};

fn file(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/matlab").join(name)
}

fn good(name: &str) -> Record {
    reader::read_path(&file(name), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_way_to_lay_a_table_out_gives_the_same_numbers() {
    for name in ["vectors.mat", "compressed.mat", "struct.mat", "values.mat", "matrix.mat", "transposed.mat"] {
        let record = good(name);
        flight::check(&record, name);
        assert_eq!(record.quality.rows_kept, flight::ROWS, "{name}");
    }
}

#[test]
fn one_of_several_variables_is_read_by_its_name() {
    let read = |wanted: &str| {
        let options = TableOptions { variable: Some(wanted.to_owned()), ..TableOptions::default() };
        read_path(&file("struct.mat"), &options)
    };
    flight::check(&read("flight").unwrap(), "struct.mat");
    let error = read("flight2").unwrap_err().to_string();
    assert!(error.contains("there is no variable 'flight2'. Found: flight, version"), "{error}");
    let error = read("flight.q.p").unwrap_err().to_string();
    assert!(error.contains("no variable 'flight.q.p'"), "{error}");
}

#[test]
fn several_structs_are_told_with_the_way_to_name_one() {
    let error = read_path(&file("several.mat"), &TableOptions::default()).unwrap_err().to_string();
    assert!(error.contains("several structs: first, second") && error.contains("--variable first"), "{error}");
    let second = TableOptions { variable: Some("second".to_owned()), ..TableOptions::default() };
    assert_eq!(read_path(&file("several.mat"), &second).unwrap().len(), flight::ROWS);
    let third = ReadOptions {
        table: TableOptions { variable: Some("third".to_owned()), ..TableOptions::default() },
        ..ReadOptions::default()
    };
    assert!(reader::read_path(&file("several.mat"), &third).unwrap_err().is_without_variable());
    assert!(!reader::read_path(&file("no.mat"), &third).unwrap_err().is_without_variable());
}

/// Names of columns that fit no matrix are refused, and not left unsaid.
#[test]
fn names_for_other_columns_than_there_are_are_refused() {
    let names = |file_name: &str, names: &[&str]| {
        let column_names = names.iter().map(|name| (*name).to_owned()).collect();
        read_path(&file(file_name), &TableOptions { column_names, ..TableOptions::default() })
    };
    let error = names("matrix.mat", &["time_s", "alpha_deg"]).unwrap_err().to_string();
    assert!(error.contains("2 names of columns") && error.contains("data has 6"), "{error}");
    let error = names("vectors.mat", &["time_s", "alpha_deg"]).unwrap_err().to_string();
    assert!(error.contains("2 names of columns"), "{error}");
    let six = ["time_s", "alpha_deg", "q_deg_s", "count", "big", "on"];
    assert_eq!(names("matrix.mat", &six).unwrap().len(), flight::ROWS);
    // A file without variables.
    let mut empty = std::fs::read(file("vectors.mat")).unwrap();
    empty.truncate(128);
    let wanted = TableOptions { variable: Some("flight".to_owned()), ..TableOptions::default() };
    let error = read(empty.as_slice(), "empty.mat", &wanted).unwrap_err().to_string();
    assert!(!error.contains("Found: ."), "{error}");
    let error = read(empty.as_slice(), "empty.mat", &TableOptions::default()).unwrap_err().to_string();
    assert!(!error.contains("Found: ."), "{error}");
}

#[test]
fn what_is_no_column_is_named() {
    for name in ["vectors.mat", "compressed.mat"] {
        let said = good(name).quality.to_string();
        for part in [
            "column 'wing_area': left out: it is a matrix of 1 x 1, where the columns of the table have 40 values",
            "column 'inertia': left out: it is a matrix of 3 x 3",
            "column 'z': left out: it is complex",
        ] {
            assert!(said.contains(part), "{part}\n{said}");
        }
    }
}

#[test]
fn other_versions_are_refused_with_a_remedy() {
    let error = read_path(&file("version4.mat"), &TableOptions::default()).unwrap_err().to_string();
    assert!(error.contains("perhaps MATLAB 4") && error.contains("'-v7'"), "{error}");
    let mut header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".to_vec();
    header.resize(512, b' ');
    let error = read(header.as_slice(), "x.mat", &TableOptions::default()).unwrap_err().to_string();
    assert!(error.contains("HDF5") && error.contains("save('flight.mat', '-v7', ...)"), "{error}");
    let error = read(&b"MATLAB 5.0"[..], "x.mat", &TableOptions::default()).unwrap_err().to_string();
    assert!(error.contains("shorter than its header"), "{error}");
}

#[test]
fn columns_without_names_can_be_mapped() {
    let bytes = std::fs::read(file("matrix.mat")).unwrap();
    // Without the list of names: the list is called otherwise.
    let bytes = replaced(&bytes, b"data_names", b"data_xames");
    let columns = vec![ColumnMapping::new("time", "data(:,1)").with_unit("s"), ColumnMapping::new("q", "data(:,3)")];
    let record = read(bytes.as_slice(), "x.mat", &TableOptions { columns, ..TableOptions::default() }).unwrap();
    assert_eq!(record.time[39], 39.0 * 0.0625);
    assert_eq!(record.channel("q").unwrap().values[0], (-0.5_f64).to_radians());
}

/// One damaged variable does not take the others with it.
#[test]
fn what_is_good_in_a_damaged_file_is_kept() {
    let mut bytes = std::fs::read(file("compressed.mat")).unwrap();
    // The second element (alpha_deg) is found behind the first; a byte in the middle of it is turned.
    let size = |at: usize| u32::from_le_bytes(bytes[at + 4..at + 8].try_into().unwrap()) as usize;
    let second = 128 + 8 + size(128);
    let middle = second + 8 + size(second) / 2;
    bytes[middle] ^= 0xFF;
    let record = read(bytes.as_slice(), "x.mat", &TableOptions::default()).unwrap();
    assert!(record.channel("alpha").is_none());
    assert!(record.channel("q").is_some());
    let said = record.quality.to_string();
    assert!(said.contains(&format!("byte {second}: the variable that begins here is left out")), "{said}");
}

#[test]
fn damage_anywhere_is_a_record_or_an_error() {
    let options = TableOptions { max_memory: Memory::from_bytes(200_000), ..TableOptions::default() };
    for name in ["vectors.mat", "compressed.mat", "struct.mat", "values.mat", "matrix.mat"] {
        let bytes = std::fs::read(file(name)).unwrap();
        damage::try_all(&bytes, |damaged| match read(damaged, "x.mat", &options) {
            Ok(record) => flight::keeps_its_promises(&record),
            Err(error) => assert!(error.to_string().starts_with("x.mat"), "{error}"),
        });
    }
}

#[test]
fn memory_is_bounded() {
    let bytes = std::fs::read(file("compressed.mat")).unwrap();
    let options = TableOptions { max_memory: Memory::from_bytes(800), ..TableOptions::default() };
    let error = read(bytes.as_slice(), "x.mat", &options).unwrap_err();
    assert!(error.to_string().contains("the budget is 800 bytes"), "{error}");
    // A matrix that claims four thousand million values, and has none.
    let mut bytes = bytes[..128].to_vec();
    let mut element = |kind: u32, content: &[u8]| {
        bytes.extend(kind.to_le_bytes());
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(content);
    };
    let mut matrix = Vec::new();
    for (kind, content) in [(6_u32, vec![6_u32, 0]), (5, vec![65_536, 65_536]), (1, vec![]), (9, vec![])] {
        matrix.extend(kind.to_le_bytes());
        matrix.extend((4 * content.len() as u32).to_le_bytes());
        content.iter().for_each(|word| matrix.extend(word.to_le_bytes()));
    }
    element(14, &matrix);
    assert!(matches!(read(bytes.as_slice(), "x.mat", &TableOptions::default()), Err(ReadError::Table(_))));
}

fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|window| window == from).unwrap();
    let mut bytes = bytes.to_vec();
    bytes[at..at + to.len()].copy_from_slice(to);
    bytes
}

/// scipy writes in the order of the machine alone, so this file is made by hand, after the format's description.
#[test]
fn either_byte_order() {
    let element = |kind: u32, content: &[u8]| {
        let mut bytes = [kind.to_be_bytes(), (content.len() as u32).to_be_bytes()].concat();
        bytes.extend(content);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    };
    let vector = |name: &str, values: &[f64]| {
        let words = |words: &[u32]| words.iter().flat_map(|word| word.to_be_bytes()).collect::<Vec<u8>>();
        let numbers: Vec<u8> = values.iter().flat_map(|value| value.to_be_bytes()).collect();
        // A name of four bytes or fewer stands in its tag, the size in the upper half of the first word.
        let mut short = ((name.len() as u32) << 16 | 1).to_be_bytes().to_vec();
        short.extend(name.as_bytes());
        short.resize(8, 0);
        let parts =
            [element(6, &words(&[6, 0])), element(5, &words(&[values.len() as u32, 1])), short, element(9, &numbers)];
        element(14, &parts.concat())
    };
    let mut bytes = b"MATLAB 5.0 MAT-file, Platform: made by hand".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([1, 0, b'M', b'I']);
    bytes.extend(vector("t", &[0.0, 0.5, 1.0]));
    bytes.extend(vector("q", &[1.0, -2.5, 1e-300]));
    let record = read(bytes.as_slice(), "x.mat", &TableOptions::default()).unwrap();
    assert_eq!(record.time, [0.0, 0.5, 1.0]);
    assert_eq!(record.channel("q").unwrap().values, [1.0, -2.5, 1e-300]);
}
