//! The rows of an arena as Parquet, for tools that read columns.

use std::sync::Arc;

use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::rows::Row;

/// Columns in the order of [`Row`]'s fields.
const SCHEMA: &str = "message row {
    required binary entry (UTF8);
    required binary method (UTF8);
    required int64 seed;
    required double cycles;
    required binary parameter (UTF8);
    required double truth;
    required double estimate;
    required double std_error;
    required double unit;
}";

/// One column of a table.
enum Column {
    Words(Vec<ByteArray>),
    Integers(Vec<i64>),
    Numbers(Vec<f64>),
}

/// The rows as a Parquet file of one row group, columns as the fields of [`Row`]. Seeds beyond 2^63 wrap.
///
/// # Errors
/// What the writer says.
pub fn parquet(rows: &[Row]) -> Result<Vec<u8>, ParquetError> {
    let words = |of: fn(&Row) -> &str| Column::Words(rows.iter().map(|r| ByteArray::from(of(r))).collect());
    let numbers = |of: fn(&Row) -> f64| Column::Numbers(rows.iter().map(of).collect());
    let columns = [
        words(|r| &r.entry),
        words(|r| &r.method),
        Column::Integers(rows.iter().map(|r| r.seed as i64).collect()),
        numbers(|r| r.cycles),
        words(|r| &r.parameter),
        numbers(|r| r.truth),
        numbers(|r| r.estimate),
        numbers(|r| r.std_error),
        numbers(|r| r.unit),
    ];
    let schema = Arc::new(parse_message_type(SCHEMA)?);
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(WriterProperties::default()))?;
    let mut group = writer.next_row_group()?;
    for column in &columns {
        let Some(mut place) = group.next_column()? else {
            return Err(ParquetError::General("the schema has fewer columns than the table".to_owned()));
        };
        match column {
            Column::Words(values) => place.typed::<ByteArrayType>().write_batch(values, None, None)?,
            Column::Integers(values) => place.typed::<Int64Type>().write_batch(values, None, None)?,
            Column::Numbers(values) => place.typed::<DoubleType>().write_batch(values, None, None)?,
        };
        place.close()?;
    }
    group.close()?;
    writer.into_inner()
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let row = |seed: u64| Row {
            entry: "calm".to_owned(),
            method: "smpe".to_owned(),
            seed,
            cycles: 2.0,
            parameter: "dCm_q".to_owned(),
            truth: -2.0,
            estimate: -2.5,
            std_error: f64::NAN,
            unit: 0.25,
        };
        let path = std::env::temp_dir().join(format!("phugoid-arena-{}.parquet", std::process::id()));
        std::fs::write(&path, parquet(&[row(7), row(8)]).unwrap()).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        let second = &rows[1];
        assert_eq!((second.get_string(0).unwrap().as_str(), second.get_long(2).unwrap()), ("calm", 8));
        assert_eq!((second.get_double(6).unwrap(), second.get_double(8).unwrap()), (-2.5, 0.25));
        assert!(second.get_double(7).unwrap().is_nan());
        std::fs::remove_file(&path).unwrap();
    }
}
