//! Estimates a flight and writes the estimates as CSV and as Parquet: `export_estimates FLIGHT.csv MODEL OUT.csv
//! OUT.parquet`, the model a built-in one. For the check of the one against the other by pyarrow.

use phugoid_flight_data::reader::{ReadOptions, read_path};
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::export::{csv, parquet};
use phugoid_identification::model_file::ModelFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [flight, model, text, columns] = arguments.as_slice() else {
        return Err("usage: export_estimates FLIGHT.csv MODEL OUT.csv OUT.parquet".into());
    };
    let model = ModelFile::named(model)?;
    let record = read_path(flight.as_ref(), &ReadOptions::with_columns(model.columns()))?;
    let estimation = estimate(&record, &model, &EstimateOptions::default(), &mut |_| {})?;
    std::fs::write(text, csv(&estimation))?;
    parquet(&estimation, columns.as_ref())?;
    Ok(())
}
