//! What is in a log or a table, as columns in SI units: `cargo run -p phugoid --example any_log_to_columns [FILE ...]`.
//!
//! The format is known by the content of a file, not by its name. Without arguments it takes three flights: a log of PX4 and one
//! of ArduPilot, some seconds of each, and a table.

#![allow(clippy::expect_used, clippy::panic)] // an example may stop

use phugoid::{Error, Record};

fn main() -> Result<(), Error> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let given: Vec<String> = std::env::args().skip(1).collect();
    let ours = ["fuzz/seeds/ulog/flight.ulg", "fuzz/seeds/dataflash/flight.bin", "crates/phugoid/examples/flight.csv"];
    let files =
        if given.is_empty() { ours.iter().map(|file| format!("{root}/{file}")).collect() } else { given.clone() };

    let mut records = Vec::new();
    for file in &files {
        let record = Record::open(file)?;
        let name = std::path::Path::new(file).file_name().unwrap_or_default().to_string_lossy();
        println!("{name}: {} samples, one per {:.4} s", record.len(), record.sample_time_s());
        println!("  {:<16} {:>6} {:>12} {:>12}", "channel", "unit", "smallest", "largest");
        for channel in &record.channels {
            let finite = || channel.values.iter().copied().filter(|value| value.is_finite());
            let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
            println!("  {:<16} {:>6} {low:>12.4} {high:>12.4}", channel.name, channel.quantity.si_unit());
        }
        records.push(record);
    }

    // Columns that are in memory already need no file; their headers say the units.
    let columns = [("time_s", vec![0.0, 0.1, 0.2]), ("alpha_deg", vec![2.0, f64::NAN, 3.0])];
    let alpha = &Record::from_columns("three samples", columns)?.channels[0];
    assert_eq!((alpha.name.as_str(), alpha.quantity.si_unit()), ("alpha", "rad"));
    assert!((alpha.values[2] - 3_f64.to_radians()).abs() < 1e-15 && alpha.values[1].is_nan());

    if given.is_empty() {
        for record in &records {
            assert!(record.time.windows(2).all(|pair| pair[0] < pair[1]), "{}: time increases", record.source);
            assert!(record.channel("q").is_some(), "{}: every flight has a pitch rate", record.source);
        }
        // The table says degrees: the flight begins at 2.35 deg, which are 0.041 rad.
        let alpha = records[2].channel("alpha").expect("it is in the table");
        assert!((alpha.values[0] - 2.3509_f64.to_radians()).abs() < 1e-12);
    }
    Ok(())
}
