//! Reads the text of a CSV file into a record.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::rows::{Header, Rows};
use super::text_file::TextFile;
use super::{CsvOptions, ReadError};
use crate::memory::Account;
use crate::printable;
use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::columns::{self, Head};
use crate::table::{OptionProblem, TableError};

/// Reads a CSV file from the disk; otherwise as [`read()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn read_path(path: &Path, options: &CsvOptions) -> Result<Record, ReadError> {
    let source_name = printable::path(path);
    match File::open(path) {
        Ok(file) => {
            let account = Account::new(options.max_memory);
            read_counted(account.follow(file), &source_name, options, &account)
        }
        Err(error) => Err(ReadError::Io { source_name, error }),
    }
}

/// Reads CSV text into a record in SI units. `source` is its name in messages and reports.
///
/// Channels get their canonical names where the header or a mapping identifies them, and keep their own names
/// otherwise. The times of the record increase strictly: rows that go back in time are left out, rows of equal time are
/// merged, and if the clock starts again, only the longest part is taken. Missing values are NaN. `record.quality`
/// reports all of this.
///
/// # Errors
/// [`ReadError`] if the file cannot be read, is no table of text, has no header, no time, two columns for the same
/// channel, contradicting units, fewer than two usable rows, or if it needs more than `options.max_memory` or a mapping
/// is wrong.
pub fn read(reader: impl Read, source: &str, options: &CsvOptions) -> Result<Record, ReadError> {
    read_counted(reader, source, options, &Account::new(options.max_memory))
}

/// As [`read()`], with the memory counted in this account.
pub(crate) fn read_counted(
    reader: impl Read,
    source: &str,
    options: &CsvOptions,
    account: &Account,
) -> Result<Record, ReadError> {
    check(options)?;
    let mut file = TextFile::open(reader, source, options.delimiter)?;
    let mut report = QualityReport::default();
    let (line, headers, carried) = file.header(&options.column_names, &mut report)?;
    let (units, carried) = file.unit_row(&headers, carried)?;
    let carried = match carried {
        Some(row) => Some(row),
        None => file.next_row()?,
    };
    let first_row = carried.as_ref().map(|row| file.cells(&row.text));
    let head =
        Head { source, line: Some(line), headers: &headers, units: units.as_deref(), first_row: first_row.as_deref() };
    let table_options = options.table();
    let plan = columns::plan(&head, &table_options, &mut report)?;
    let header = Header { line, fields: headers.len(), empty_names: file.empty_names };
    let mut rows = Rows::new(plan, header, file.format.clone());
    if let Some(mut row) = carried {
        rows.add(&row, source, options, account)?;
        while file.read_row(&mut row)? {
            rows.add(&row, source, options, account)?;
        }
    }
    rows.finish(source, &table_options, report)
}

fn check(options: &CsvOptions) -> Result<(), ReadError> {
    options.table().check()?;
    if let Some(mark) = options.delimiter.filter(|mark| ![',', ';', '\t', '|', ' '].contains(mark)) {
        return Err(TableError::BadOption(OptionProblem::Delimiter(mark)).into());
    }
    Ok(())
}
