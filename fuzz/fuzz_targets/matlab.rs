//! Any bytes as a MATLAB file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_flight_data::matlab::read;

mod common;

fuzz_target!(|bytes: &[u8]| {
    common::table(read(bytes, "fuzz", &common::options()));
});
