//! Any bytes as a Parquet file: a record that keeps its promises, or an error.
//!
//! The library panics on some damaged pages, and the reader makes errors of that. libFuzzer's hook would end the run at every
//! such panic, so it is taken off; what the reader does not catch still ends it.
#![no_main]

use std::sync::Once;

use libfuzzer_sys::fuzz_target;
use phugoid_flight_data::parquet::read;
use phugoid_flight_data::table::TableOptions;

mod common;

static QUIET: Once = Once::new();

fuzz_target!(|bytes: &[u8]| {
    QUIET.call_once(|| std::panic::set_hook(Box::new(|_| {})));
    let options = TableOptions { max_values: common::MAX_VALUES, ..TableOptions::default() };
    match read(bytes, "fuzz", &options) {
        Ok(record) => common::keeps_its_promises(&record),
        Err(error) => assert!(error.to_string().len() < 8000, "an error fits on a screen"),
    }
});
