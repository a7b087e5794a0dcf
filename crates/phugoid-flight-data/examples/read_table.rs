//! Reads a table (Parquet, Arrow, MATLAB or CSV, by content) and writes it as CSV, or as Parquet if its name ends so, for
//! comparison with the formats' own tools.
//!
//!     cargo run -p phugoid-flight-data --features matlab,parquet --example read_table -- flight.mat flight.csv

use phugoid_flight_data::reader::{self, ReadOptions};
use phugoid_flight_data::{csv, parquet};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut names = std::env::args().skip(1);
    let (Some(from), Some(to)) = (names.next(), names.next()) else {
        return Err("a table and a target are needed".into());
    };
    let record = reader::read_path(from.as_ref(), &ReadOptions::default())?;
    eprintln!("{}", record.quality);
    match to.ends_with(".parquet") {
        true => parquet::write_path(&record, to.as_ref())?,
        false => csv::write_path(&record, to.as_ref())?,
    }
    Ok(())
}
