//! Reads a table (Parquet, Arrow, MATLAB or CSV, by content) and writes it as CSV, or as Parquet if its name ends so, for
//! comparison with the formats' own tools.
//!
//!     cargo run -p phugoid-flight-data --features matlab,parquet --example read_table -- flight.mat flight.csv

use std::io::Read;
use std::path::Path;

use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::format::{Format, SNIFFED};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::table::TableOptions;
use phugoid_flight_data::{arrow, matlab, parquet};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut names = std::env::args().skip(1);
    let (Some(from), Some(to)) = (names.next(), names.next()) else {
        return Err("a table and a target are needed".into());
    };
    let record = read(from.as_ref())?;
    eprintln!("{}", record.quality);
    match to.ends_with(".parquet") {
        true => parquet::write_path(&record, to.as_ref())?,
        false => csv::write_path(&record, to.as_ref())?,
    }
    Ok(())
}

fn read(path: &Path) -> Result<Record, Box<dyn std::error::Error>> {
    let mut start = Vec::new();
    std::fs::File::open(path)?.take(SNIFFED as u64).read_to_end(&mut start)?;
    let options = TableOptions::default();
    Ok(match Format::sniff(&start) {
        Format::Mat5 => matlab::read_path(path, &options)?,
        Format::Parquet => parquet::read_path(path, &options)?,
        Format::Arrow => arrow::read_path(path, &options)?,
        _ => csv::read_path(path, &CsvOptions::default())?,
    })
}
