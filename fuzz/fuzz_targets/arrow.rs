//! Any bytes as an Arrow file or stream: a record that keeps its promises, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_flight_data::arrow::read;
use phugoid_flight_data::table::TableOptions;

mod common;

fuzz_target!(|bytes: &[u8]| {
    let options = TableOptions { max_values: common::MAX_VALUES, ..TableOptions::default() };
    match read(bytes, "fuzz", &options) {
        Ok(record) => common::keeps_its_promises(&record),
        Err(error) => assert!(error.to_string().len() < 8000, "an error fits on a screen"),
    }
});
