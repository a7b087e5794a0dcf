//! Any bytes as a Parquet file.
//!
//! The library panics on some damaged pages, and the reader makes errors of that. libFuzzer's hook would end the run at every
//! such panic, so it is taken off; what the reader does not catch still ends it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_flight_data::parquet::read;

mod common;

fuzz_target!(
    init: std::panic::set_hook(Box::new(|_| {})),
    |bytes: &[u8]| {
        common::table(read(bytes, "fuzz", &common::options()));
    }
);
