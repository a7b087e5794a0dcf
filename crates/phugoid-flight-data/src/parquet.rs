//! Reads and writes flight records as Parquet.
//!
//! Every flat column of numbers, truth values, timestamps or durations becomes a channel by its name and unit, as a CSV
//! column does by its header; the unit may also be in the metadata of the field under `unit`. Timestamps become seconds
//! from 1970. Text, dictionaries and nested columns are left out, and the report names them. Groups of rows are read
//! one after the other, in bounded memory; of a damaged group the readable rows are kept.
//!
//! Files that are compressed by Snappy, Zstandard or raw LZ4, or not at all, are read. Gzip, Brotli and Hadoop's LZ4
//! are refused, because the library would unpack them without a bound on memory.
//!
//! ```
//! use phugoid_flight_data::{parquet, record::Record, table::TableOptions};
//! let record = Record::from_columns("example", [("time_s", vec![0.0, 0.1]), ("alpha_rad", vec![0.05, 0.06])])?;
//! let path = std::env::temp_dir().join(format!("phugoid-example-{}.parquet", std::process::id()));
//! parquet::write_path(&record, &path)?;
//! let again = parquet::read_path(&path, &TableOptions::default())?;
//! std::fs::remove_file(&path)?;
//! assert_eq!(again.channels, record.channels);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::fs::File;
use std::path::Path;

use bytes::Bytes;

pub use crate::columnar::ReadError;
pub use crate::columnar::write::Values;
use crate::columnar::{row_groups, write};
pub use crate::csv::WriteError;
use crate::output_file::OutputFile;
use crate::printable;
use crate::record::Record;
use crate::table::TableOptions;

/// Reads a Parquet file from the disk into a record in SI units. Channels, units and the findings in `record.quality`
/// are as those of [`crate::csv::read`], with rows counted from 1.
///
/// # Errors
/// [`ReadError`] if the file cannot be read, is no Parquet file, holds no group of rows that could be read, or no
/// record can be made of its columns.
pub fn read_path(path: &Path, options: &TableOptions) -> Result<Record, ReadError> {
    row_groups::read(|| File::open(path), &printable::path(path), options)
}

/// Reads a Parquet file in memory; otherwise as [`read_path`]. `source` is its name in messages and reports.
///
/// # Errors
/// As [`read_path`].
pub fn read(bytes: &[u8], source: &str, options: &TableOptions) -> Result<Record, ReadError> {
    let bytes = Bytes::copy_from_slice(bytes);
    row_groups::read(|| Ok(bytes.clone()), source, options)
}

/// Writes a record as Parquet in SI units: the columns of [`crate::csv::write`] under the same names (`time_s`,
/// `alpha_rad`), as doubles, each with its unit in the field's metadata (`unit` = `rad`; `1` for a pure number).
/// Missing values are null. The quality report is not written.
///
/// # Errors
/// [`WriteError`] if a channel has another length than the time, a name that could not be read back, or the file cannot
/// be written. Names and lengths are checked before the file is created.
pub fn write_path(record: &Record, path: &Path) -> Result<(), WriteError> {
    let target = printable::path(path);
    let headers = crate::csv::headers(record, &target)?;
    let failed = |error| WriteError::Io { target: target.clone(), error };
    let mut file = OutputFile::create(path).map_err(failed)?;
    write::write(record, &headers, &mut file, &target)?;
    file.finish().map_err(failed)
}

/// Writes a general table, which need not be a flight: named columns of the same length.
///
/// # Errors
/// [`WriteError::Io`]: the file cannot be written, or the columns differ in length.
pub fn write_columns(columns: &[(&str, Values)], path: &Path) -> Result<(), WriteError> {
    let target = printable::path(path);
    let failed = |error| WriteError::Io { target: target.clone(), error };
    let mut file = OutputFile::create(path).map_err(failed)?;
    write::write_columns(columns, &mut file, &target)?;
    file.finish().map_err(failed)
}
