//! Writes a record, or columns of any kind, as Parquet.

use std::collections::HashMap;
use std::io::Write;
use std::sync::Arc;

use ::parquet::arrow::ArrowWriter;
use ::parquet::basic::Compression;
use ::parquet::errors::ParquetError;
use ::parquet::file::properties::WriterProperties;
use arrow_array::{ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};

use crate::csv::WriteError;
use crate::record::{Quantity, Record};

/// Number of rows given to the writer at once; it needs a copy of them.
const CHUNK: usize = 1 << 16;

/// Writes a record under the headers of its columns, time first.
pub(crate) fn write(
    record: &Record,
    headers: &[String],
    writer: impl Write + Send,
    target: &str,
) -> Result<(), WriteError> {
    let failed =
        |error: ParquetError| WriteError::Io { target: target.to_owned(), error: std::io::Error::other(error) };
    let quantities = [Quantity::Time].into_iter().chain(record.channels.iter().map(|channel| channel.quantity));
    let fields: Vec<Field> = headers
        .iter()
        .zip(quantities)
        .enumerate()
        .map(|(index, (header, quantity))| {
            let unit = if quantity == Quantity::Number { "1" } else { quantity.si_unit() };
            let metadata = HashMap::from([("unit".to_owned(), unit.to_owned())]);
            Field::new(header, DataType::Float64, index > 0).with_metadata(metadata)
        })
        .collect();
    let schema = Arc::new(Schema::new(fields));
    let mut writer = ArrowWriter::try_new(writer, Arc::clone(&schema), Some(properties())).map_err(failed)?;
    for start in (0..record.time.len()).step_by(CHUNK) {
        let times = record.time.iter().skip(start).take(CHUNK);
        let mut columns: Vec<ArrayRef> = vec![Arc::new(times.copied().collect::<Float64Array>())];
        for channel in &record.channels {
            let values = channel.values.iter().skip(start).take(CHUNK);
            // A missing value becomes null, as it becomes an empty cell in CSV.
            columns.push(Arc::new(values.map(|value| (!value.is_nan()).then_some(*value)).collect::<Float64Array>()));
        }
        let batch = RecordBatch::try_new(Arc::clone(&schema), columns);
        writer.write(&batch.map_err(|error| failed(error.into()))?).map_err(failed)?;
    }
    writer.close().map_err(failed)?;
    Ok(())
}

fn properties() -> WriterProperties {
    WriterProperties::builder().set_compression(Compression::SNAPPY).build()
}

/// The values of one column of a general table, for [`crate::parquet::write_columns`].
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Text, one per row.
    Words(Vec<String>),
    /// Numbers; `None` is written as null.
    Numbers(Vec<Option<f64>>),
    /// Truth values, one per row.
    Flags(Vec<bool>),
}

/// Writes named columns of the same length.
pub(crate) fn write_columns(
    columns: &[(&str, Values)],
    writer: impl Write + Send,
    target: &str,
) -> Result<(), WriteError> {
    let failed =
        |error: ParquetError| WriteError::Io { target: target.to_owned(), error: std::io::Error::other(error) };
    let (mut fields, mut arrays): (Vec<Field>, Vec<ArrayRef>) = (Vec::new(), Vec::new());
    for (name, values) in columns {
        let (kind, array): (DataType, ArrayRef) = match values {
            Values::Words(words) => (DataType::Utf8, Arc::new(StringArray::from_iter_values(words))),
            Values::Numbers(numbers) => {
                (DataType::Float64, Arc::new(numbers.iter().copied().collect::<Float64Array>()))
            }
            Values::Flags(flags) => (DataType::Boolean, Arc::new(BooleanArray::from(flags.clone()))),
        };
        fields.push(Field::new(*name, kind, matches!(values, Values::Numbers(_))));
        arrays.push(array);
    }
    let schema = Arc::new(Schema::new(fields));
    let mut writer = ArrowWriter::try_new(writer, Arc::clone(&schema), Some(properties())).map_err(failed)?;
    let batch = RecordBatch::try_new(schema, arrays).map_err(|error| failed(error.into()))?;
    writer.write(&batch).map_err(failed)?;
    writer.close().map_err(failed)?;
    Ok(())
}
