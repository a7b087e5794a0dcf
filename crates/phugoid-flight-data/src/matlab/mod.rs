//! Reads tables from MATLAB files (MAT-File Level 5: `save -v6` and `save -v7`, compressed or not).
//!
//! A column is a real vector (column or row), one column of a matrix, or the field of a struct that is one of these. All
//! columns of the table have one length: that of the time, or the one that most have; whatever is of another length (constants,
//! settings) is left out and named. Columns are called by their variable or field, and by the whole path (`flight.alpha_deg`)
//! where two would have one name; the columns of a matrix `data` by a list of names of that length beside it (a cell array of
//! text), else `data(:,1)`, `data(:,2)`, ... Units stand in the names, or in text: a field `unit` beside a field `values`, a
//! struct `units` with a field per column, a cell array `units` beside the names, or `alpha_unit` beside `alpha`.
//!
//! The format is that of "MAT-File Format" (MathWorks, R2024a, chapter 1, "Level 5 MAT-File Format"). Objects of MATLAB
//! (table, timetable, timeseries, datetime) are not documented there and are left out with a word on what to do. MATLAB 7.3
//! files are HDF5 and are refused.

mod element;
mod error;
mod layout;
mod variable;

pub use error::ReadError;

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::{self, TableOptions};

/// Reads a MATLAB file from the disk; otherwise as [`read()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn read_path(path: &Path, options: &TableOptions) -> Result<Record, ReadError> {
    let source_name = path.display().to_string();
    match File::open(path) {
        Ok(file) => read(file, &source_name, options),
        Err(error) => Err(ReadError::Io { source_name, error }),
    }
}

/// Reads the table of a MATLAB file into a record in SI units. `source` is its name in messages and reports. Memory is
/// bounded by `options.max_values`, whatever the file says of its sizes.
///
/// Of a damaged file the variables that can be read are kept, and the report says at which byte which was lost.
///
/// # Errors
/// [`ReadError`] if the file cannot be read, is no MATLAB file of level 5, holds no variable that could be read, or its columns
/// make no record.
pub fn read(reader: impl Read, source: &str, options: &TableOptions) -> Result<Record, ReadError> {
    let mut report = QualityReport::default();
    let mut reader = BufReader::with_capacity(1 << 16, reader);
    let variables = variable::read_all(&mut reader, source, options.max_values, &mut report)?;
    let (columns, left_out) = layout::columns(variables, options, &mut report);
    Ok(table::from_columns(source, columns, &left_out, options, report)?)
}
