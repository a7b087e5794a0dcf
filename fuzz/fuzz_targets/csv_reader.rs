//! Any bytes as a CSV file: a record that keeps its promises and survives a round trip, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_flight_data::csv::{CsvOptions, read, write};

fuzz_target!(|bytes: &[u8]| {
    let options = CsvOptions { max_values: 1 << 16, ..CsvOptions::default() };
    let without_time = CsvOptions { sample_time_s: Some(0.02), ..options.clone() };
    for options in [&options, &without_time] {
        let record = match read(bytes, "fuzz", options) {
            Ok(record) => record,
            Err(error) => {
                assert!(error.to_string().len() < 8000, "an error fits on a screen");
                continue;
            }
        };
        assert!(record.len() >= 2);
        assert!(record.time.windows(2).all(|pair| pair[0] < pair[1]), "time increases");
        assert!(record.time.iter().all(|time| time.is_finite()));
        assert!(record.channels.iter().all(|channel| channel.values.len() == record.len()));
        assert!(record.channels.iter().all(|channel| channel.values.iter().all(|value| !value.is_infinite())));
        assert!(record.quality.rows_read >= record.quality.rows_kept);
        let _ = record.quality.to_string();
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
