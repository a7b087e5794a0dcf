//! Estimates a flight and writes the estimates as CSV, as Parquet and as a workbook: `export_estimates FLIGHT.csv MODEL
//! OUT.csv OUT.parquet OUT.xlsx`, the model a built-in one. For the check of the one against the others by pyarrow and openpyxl.

use phugoid_flight_data::reader::{ReadOptions, read_path};
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::export::{csv, parquet, xlsx};
use phugoid_identification::model_file::ModelFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [flight, model, text, columns, workbook] = arguments.as_slice() else {
        return Err("usage: export_estimates FLIGHT.csv MODEL OUT.csv OUT.parquet OUT.xlsx".into());
    };
    let model = ModelFile::named(model)?;
    let record = read_path(flight.as_ref(), &ReadOptions::with_columns(model.columns()))?;
    let estimation = estimate(&record, &model, &EstimateOptions::default(), &mut |_| {})?;
    std::fs::write(text, csv(&estimation))?;
    parquet(&estimation, columns.as_ref())?;
    std::fs::write(workbook, xlsx(&estimation)?)?;
    Ok(())
}
