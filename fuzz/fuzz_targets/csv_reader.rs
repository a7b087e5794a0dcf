//! Any bytes as a CSV file: what can be read survives a round trip.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_flight_data::csv::{CsvOptions, read, write};

mod common;

fuzz_target!(|bytes: &[u8]| {
    let options = CsvOptions { max_memory: common::options().max_memory, ..CsvOptions::default() };
    let without_time = CsvOptions { sample_time_s: Some(0.02), ..options.clone() };
    for options in [&options, &without_time] {
        let Some(record) = common::table(read(bytes, "fuzz", options)) else { continue };
        let mut text = Vec::new();
        if write(&record, &mut text).is_ok() {
            let again = read(text.as_slice(), "fuzz", &CsvOptions::default()).expect("what was written can be read");
            assert_eq!(again.time, record.time);
            for channel in &again.channels {
                let original = record.channel(&channel.name).expect("no channel comes from nowhere");
                assert_eq!(original.quantity, channel.quantity);
                let alike = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
                assert!(original.values.iter().zip(&channel.values).all(alike), "{}", channel.name);
            }
        }
    }
});
