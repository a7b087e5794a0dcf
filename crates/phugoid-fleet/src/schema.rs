//! The columns of the store, and rows to and from Parquet.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::arrow::{ArrowWriter, ProjectionMask};
use parquet::basic::Compression;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use phugoid_flight_data::output_file::OutputFile;
use phugoid_identification::estimation::UncertainQuantity;

use crate::logs::LogRow;
use crate::row::{Row, RunRow, SCHEMA};
use crate::store::StoreError;

/// How one column is taken from a row and put into one.
enum Column<R> {
    Word(fn(&R) -> &str, fn(&mut R, String)),
    Text(fn(&R) -> Option<&str>, fn(&mut R, Option<String>)),
    Number(fn(&R) -> Option<f64>, fn(&mut R, Option<f64>)),
    Count(fn(&R) -> Option<i64>, fn(&mut R, Option<i64>)),
    Flag(fn(&R) -> Option<bool>, fn(&mut R, Option<bool>)),
    /// Part of the budget of this number.
    Budget(usize),
}

/// A kind of row: its columns, and the budget where it has one.
pub(crate) trait Stored: Default {
    fn columns() -> Vec<(String, ColumnOf<Self>)>;
    fn budget(&self, _: usize) -> Option<f64> {
        None
    }
    fn set_budget(&mut self, _: usize, _: Option<f64>) {}
}

pub(crate) struct ColumnOf<R>(Column<R>);

macro_rules! column {
    (word $field:ident) => {
        (stringify!($field).to_owned(), ColumnOf(Column::Word(|r: &Self| &r.$field, |r: &mut Self, v| r.$field = v)))
    };
    (text $field:ident) => {
        (stringify!($field).to_owned(), ColumnOf(Column::Text(|r: &Self| r.$field.as_deref(), |r, v| r.$field = v)))
    };
    (number $field:ident) => {
        (stringify!($field).to_owned(), ColumnOf(Column::Number(|r: &Self| r.$field, |r, v| r.$field = v)))
    };
    (count $field:ident) => {
        (stringify!($field).to_owned(), ColumnOf(Column::Count(|r: &Self| r.$field, |r, v| r.$field = v)))
    };
    (flag $field:ident) => {
        (stringify!($field).to_owned(), ColumnOf(Column::Flag(|r: &Self| r.$field, |r, v| r.$field = v)))
    };
}

impl Stored for Row {
    fn columns() -> Vec<(String, ColumnOf<Self>)> {
        let mut columns = vec![
            column!(word key),
            column!(word kind),
            column!(text source_sha256),
            column!(word model_sha256),
            column!(word model),
            column!(word version),
            column!(word method),
            column!(count segment),
            column!(number from_s),
            column!(number to_s),
            column!(text input),
            column!(number duration_s),
            column!(count clock_at_zero_us),
            column!(number airspeed_m_s),
            column!(number alpha_rad),
            column!(number altitude_m),
            column!(word status),
            column!(text refusal),
            column!(text reasons),
            column!(text message),
            column!(text parameter),
            column!(text unit),
            column!(number value),
            column!(number std_error),
            column!(number random_std),
            column!(number systematic_std),
            column!(number lower),
            column!(number upper),
            column!(text parameter_status),
            column!(flag nuisance),
            column!(number converged_at_s),
        ];
        let parts = UncertainQuantity::ALL.iter().enumerate();
        columns.extend(parts.map(|(place, q)| (format!("budget_{}", q.key()), ColumnOf(Column::Budget(place)))));
        columns.extend([
            column!(text scenario),
            column!(count seed),
            column!(text factors),
            column!(number truth),
            column!(number error_over_sigma),
            column!(flag covered),
        ]);
        columns
    }

    fn budget(&self, place: usize) -> Option<f64> {
        self.budget.get(place).copied().flatten()
    }

    fn set_budget(&mut self, place: usize, value: Option<f64>) {
        if let Some(part) = self.budget.get_mut(place) {
            *part = value;
        }
    }
}

impl Stored for LogRow {
    fn columns() -> Vec<(String, ColumnOf<Self>)> {
        vec![
            column!(word log_sha256),
            column!(word path),
            ("bytes".to_owned(), ColumnOf(Column::Count(|r| Some(r.bytes), |r, v| r.bytes = v.unwrap_or_default()))),
            column!(word airframe),
            column!(number flight),
            column!(number hours),
        ]
    }
}

impl Stored for RunRow {
    fn columns() -> Vec<(String, ColumnOf<Self>)> {
        vec![
            column!(word key),
            column!(word study),
            column!(word version),
            column!(word inputs),
            column!(word run),
            column!(word result),
        ]
    }
}

/// Names and types of the columns of [`Row`], in the order of the file, as DuckDB calls the types.
pub fn columns() -> Vec<(String, &'static str)> {
    let name = |column: &ColumnOf<Row>| match column.0 {
        Column::Word(..) | Column::Text(..) => "VARCHAR",
        Column::Number(..) | Column::Budget(_) => "DOUBLE",
        Column::Count(..) => "BIGINT",
        Column::Flag(..) => "BOOLEAN",
    };
    Row::columns().iter().map(|(field, column)| (field.clone(), name(column))).collect()
}

/// Writes rows to a file that is there whole or not at all.
pub(crate) fn write<R: Stored>(rows: &[R], path: &Path) -> Result<(), StoreError> {
    let failed = |source: std::io::Error| StoreError::Write { file: path.to_owned(), source };
    let other = |error: parquet::errors::ParquetError| failed(std::io::Error::other(error));
    let (mut fields, mut arrays): (Vec<Field>, Vec<ArrayRef>) = (Vec::new(), Vec::new());
    for (name, column) in R::columns() {
        let rows = rows.iter();
        let (kind, array): (DataType, ArrayRef) = match column.0 {
            Column::Word(of, _) => (DataType::Utf8, Arc::new(StringArray::from_iter_values(rows.map(of)))),
            Column::Text(of, _) => (DataType::Utf8, Arc::new(rows.map(of).collect::<StringArray>())),
            Column::Number(of, _) => (DataType::Float64, Arc::new(rows.map(of).collect::<Float64Array>())),
            Column::Budget(place) => {
                (DataType::Float64, Arc::new(rows.map(|r| r.budget(place)).collect::<Float64Array>()))
            }
            Column::Count(of, _) => (DataType::Int64, Arc::new(rows.map(of).collect::<Int64Array>())),
            Column::Flag(of, _) => (DataType::Boolean, Arc::new(rows.map(of).collect::<BooleanArray>())),
        };
        fields.push(Field::new(name, kind, !matches!(column.0, Column::Word(..))));
        arrays.push(array);
    }
    let version = KeyValue::new("phugoid_fleet_schema".to_owned(), SCHEMA.to_string());
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(vec![version]))
        .build();
    let schema = Arc::new(Schema::new(fields));
    let batch =
        RecordBatch::try_new(Arc::clone(&schema), arrays).map_err(|error| failed(std::io::Error::other(error)))?;
    let mut file = OutputFile::create(path).map_err(failed)?;
    let mut writer = ArrowWriter::try_new(&mut file, schema, Some(properties)).map_err(other)?;
    writer.write(&batch).map_err(other)?;
    writer.close().map_err(other)?;
    file.finish().map_err(failed)
}

/// Reads the rows of a file. Columns that it lacks stay empty; those that this version does not know are left out.
pub(crate) fn read<R: Stored>(path: &Path) -> Result<Vec<R>, StoreError> {
    read_columns(path, &R::columns().iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>())
}

/// As [`read`], with these columns alone; the others stay empty.
pub(crate) fn read_columns<R: Stored>(path: &Path, only: &[&str]) -> Result<Vec<R>, StoreError> {
    let failed = |message: String| StoreError::Read { file: path.to_owned(), message };
    let file = File::open(path).map_err(|error| failed(error.to_string()))?;
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| failed(error.to_string()))?;
    let wanted = ProjectionMask::columns(builder.parquet_schema(), only.iter().copied());
    let reader = builder.with_projection(wanted).build().map_err(|error| failed(error.to_string()))?;
    let columns = R::columns();
    let mut rows: Vec<R> = Vec::new();
    for batch in reader {
        let batch = batch.map_err(|error| failed(error.to_string()))?;
        let first = rows.len();
        rows.extend((0..batch.num_rows()).map(|_| R::default()));
        for (name, column) in &columns {
            if let Some(array) = batch.column_by_name(name) {
                let added = rows.get_mut(first..).unwrap_or_default();
                fill(added, column, array).map_err(|kind| failed(format!("column `{name}` holds {kind}")))?;
            }
        }
    }
    Ok(rows)
}

/// Puts the values of a column into rows; the type of the column where it is another than expected.
fn fill<R: Stored>(rows: &mut [R], column: &ColumnOf<R>, array: &ArrayRef) -> Result<(), String> {
    let wrong = || array.data_type().to_string();
    let there = |k: usize| !array.is_null(k);
    let each = rows.iter_mut().enumerate();
    match column.0 {
        Column::Word(_, set) => {
            let values = array.as_string_opt::<i32>().ok_or_else(wrong)?;
            each.for_each(|(k, row)| set(row, values.value(k).to_owned()));
        }
        Column::Text(_, set) => {
            let values = array.as_string_opt::<i32>().ok_or_else(wrong)?;
            each.for_each(|(k, row)| set(row, there(k).then(|| values.value(k).to_owned())));
        }
        Column::Number(_, set) => {
            let values = array.as_primitive_opt::<Float64Type>().ok_or_else(wrong)?;
            each.for_each(|(k, row)| set(row, there(k).then(|| values.value(k))));
        }
        Column::Budget(place) => {
            let values = array.as_primitive_opt::<Float64Type>().ok_or_else(wrong)?;
            each.for_each(|(k, row)| row.set_budget(place, there(k).then(|| values.value(k))));
        }
        Column::Count(_, set) => {
            let values = array.as_primitive_opt::<Int64Type>().ok_or_else(wrong)?;
            each.for_each(|(k, row)| set(row, there(k).then(|| values.value(k))));
        }
        Column::Flag(_, set) => {
            let values = array.as_boolean_opt().ok_or_else(wrong)?;
            each.for_each(|(k, row)| set(row, there(k).then(|| values.value(k))));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::QUANTITIES;

    #[test]
    fn rows_come_back_as_they_were_written() {
        let path = std::env::temp_dir().join(format!("phugoid-fleet-rows-{}.parquet", std::process::id()));
        let mut budget = [None; QUANTITIES];
        budget[3] = Some(0.25);
        let full = Row {
            key: "k".to_owned(),
            segment: Some(2),
            value: Some(-1.0 / 3.0),
            nuisance: Some(false),
            parameter: Some("Cm_alpha".to_owned()),
            budget,
            seed: Some(-1),
            ..Row::default()
        };
        let rows = [full, Row::default()];
        write(&rows, &path).unwrap();
        let first = std::fs::read(&path).unwrap();
        assert_eq!(read::<Row>(&path).unwrap(), rows);
        // The same rows are the same bytes.
        write(&rows, &path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), first);
        std::fs::write(&path, &first[..first.len() / 2]).unwrap();
        assert!(matches!(read::<Row>(&path), Err(StoreError::Read { .. })));
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn every_field_of_a_row_is_a_column() {
        let fields = serde_json::to_value(Row::default()).unwrap();
        let fields: Vec<String> = fields.as_object().unwrap().keys().filter(|k| *k != "budget").cloned().collect();
        let mut columns: Vec<String> =
            columns().into_iter().map(|(name, _)| name).filter(|name| !name.starts_with("budget_")).collect();
        columns.sort();
        assert_eq!(fields, columns);
    }
}
