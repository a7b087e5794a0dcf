//! Reads tables from MATLAB files (MAT-File Level 5: `save -v6` and `save -v7`, compressed or not).
//!
//! - A column is a real vector (column or row), one column of a matrix, or a field of a struct that is one of these.
//! - All columns have the same length: that of the time, or the most frequent one. What has another length (constants,
//!   settings) is left out and named in the report.
//! - The header of a column is the name of its variable or field, or the whole path (`flight.alpha_deg`) where two would
//!   have the same name. The columns of a matrix `data` take their names from a list of that length beside it (a cell
//!   array of text), else `data(:,1)`, `data(:,2)`, ...
//! - Units are part of the names, or text: a field `unit` beside a field `values`, a struct `units` with a field per
//!   column, a cell array `units` beside the names, or `alpha_unit` beside `alpha`.
//!
//! The format is that of "MAT-File Format" (MathWorks, R2024a, chapter 1, "Level 5 MAT-File Format"). Objects of MATLAB
//! (table, timetable, timeseries, datetime) are not documented there and are left out with advice on how to save them.
//! MATLAB 7.3 files are HDF5 and are refused.

mod element;
mod error;
mod layout;
mod variable;

pub use error::ReadError;

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use crate::memory::Account;
use crate::printable;
use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::{self, TableError, TableOptions};
use crate::wording::list;

/// Reads a MATLAB file from the disk; otherwise as [`read()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn read_path(path: &Path, options: &TableOptions) -> Result<Record, ReadError> {
    let source_name = printable::path(path);
    match File::open(path) {
        Ok(file) => {
            let account = Account::new(options.max_memory);
            read_counted(account.follow(file), &source_name, options, &account)
        }
        Err(error) => Err(ReadError::Io { source_name, error }),
    }
}

/// Reads the table of a MATLAB file into a record in SI units. `source` is its name in messages and reports. Memory is
/// bounded by `options.max_memory`, whatever the file says of its sizes.
///
/// Of a damaged file the variables that can be read are kept, and the report names the byte at which one was lost.
///
/// ```
/// use phugoid_flight_data::{matlab, table::TableOptions};
/// let file = std::fs::File::open("tests/data/matlab/struct.mat")?;
/// let record = matlab::read(file, "struct.mat", &TableOptions::default())?;
/// assert!(record.channel("alpha").is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ReadError`] if the file cannot be read, is no MATLAB file of level 5, holds no variable that could be read, or no
/// record can be made of its columns.
pub fn read(reader: impl Read, source: &str, options: &TableOptions) -> Result<Record, ReadError> {
    read_counted(reader, source, options, &Account::new(options.max_memory))
}

/// As [`read()`], with the memory counted in this account.
pub(crate) fn read_counted(
    reader: impl Read,
    source: &str,
    options: &TableOptions,
    account: &Account,
) -> Result<Record, ReadError> {
    let mut report = QualityReport::default();
    let mut reader = BufReader::with_capacity(1 << 16, reader);
    let variables = variable::read_all(&mut reader, source, account, &mut report)?;
    let variables = match &options.variable {
        Some(wanted) => vec![layout::variable(variables, wanted).map_err(|found| ReadError::NoVariable {
            source_name: source.to_owned(),
            wanted: printable::one_line(wanted).into_owned(),
            found: if found.is_empty() { "no variable at all".to_owned() } else { list(&found) },
        })?],
        None => variables,
    };
    let structs = layout::structs(&variables);
    let found = layout::columns(variables, options, &mut report, account);
    let layout::Laid { columns, left_out, unnamed } =
        found.map_err(|excess| TableError::from(account.over(excess, source, "")))?;
    if let Some(found) = unnamed {
        let (source_name, given) = (source.to_owned(), options.column_names.len());
        return Err(ReadError::Names { source_name, given, found });
    }
    let record = table::from_counted_columns(source, columns, &left_out, options, report, account);
    Ok(record.map_err(|error| one_of_several(error, &structs))?)
}

/// Where a file has several structs and no time of all of them, the remedy is to name one.
fn one_of_several(error: TableError, structs: &[String]) -> TableError {
    match (error, structs) {
        (TableError::NoTime { source_name, line, headers, .. }, [first, _, ..]) => {
            let nearest = format!(
                " The file has several structs: {}. Where each is a flight, read one by --variable {first}. Else:",
                list(structs)
            );
            TableError::NoTime { source_name, line, headers, nearest }
        }
        (error, _) => error,
    }
}
