//! Instructions to read a CSV of 20 columns, for callgrind, and the time of the fastest of several readings:
//!
//! ```text
//! cargo build --profile dist -p phugoid-flight-data --example csv_instructions
//! valgrind --tool=callgrind --toggle-collect='*read_table*' target/dist/examples/csv_instructions 20000
//! target/dist/examples/csv_instructions 100000
//! ```
//!
//! The first argument is the number of rows. After it `commas` for decimal commas, and `plain` for the least that a reader
//! can do with the standard library, in place of a reading. Divide the instructions by the bytes that it prints.

#[path = "../tests/logger_table/mod.rs"]
mod logger_table;

use phugoid_flight_data::csv::{self, CsvOptions, ReadError};
use std::hint::black_box;
use std::time::Instant;

/// Readings of which the fastest counts; under callgrind one, since every one takes the same number of instructions.
const READINGS: usize = 7;

fn main() -> Result<(), ReadError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    let rows = arguments.first().and_then(|rows| rows.parse().ok()).unwrap_or(20_000);
    let mut text = logger_table::csv(rows);
    if has("commas") {
        text = text.replace(',', ";").replace('.', ",");
    }
    let readings = if has("once") { 1 } else { READINGS };
    let mut fastest = f64::INFINITY;
    for _ in 0..readings {
        let start = Instant::now();
        if has("plain") {
            black_box(logger_table::plain_pass(&text));
        } else {
            black_box(read_table(&text)?);
        }
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    println!("{} bytes, {readings} readings, the fastest {:.1} MB/s", text.len(), text.len() as f64 / fastest / 1e6);
    Ok(())
}

/// A function of its own, so that callgrind can count what happens in it.
#[inline(never)]
fn read_table(text: &str) -> Result<usize, ReadError> {
    let record = csv::read(text.as_bytes(), "flight", &CsvOptions::default())?;
    Ok(black_box(record).len())
}
