//! Reads a sheet of an Excel workbook (`.xlsx`, `.xlsm`; Office Open XML, ECMA-376) as the table of text that it shows.
//!
//! Rows are numbered as in the workbook, cells that are dates and times are clock times, and header, units and titles are found
//! as in a CSV file. Formulas have the values that the workbook stores for them.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::Path;

use calamine::{DataRef, Reader, Xlsx};

use crate::csv::{self, CsvOptions};
use crate::memory::{Account, many};
use crate::printable;
use crate::record::Record;
use crate::table::clock::written;
use crate::table::columns::MAX_COLUMNS;
use crate::table::{TableError, TableOptions};
use crate::wording::list;

/// Why a workbook could not be read. Every message says where, what was found and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system could not open or read the file or stream.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The error of the operating system.
        error: io::Error,
    },
    /// It is no workbook of Excel, or a damaged one.
    #[error("{source_name}: this is no workbook that can be read (.xlsx, .xlsm): {problem}. Save it again, or as CSV")]
    NoWorkbook {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// What was found, as a clause.
        problem: String,
    },
    /// The workbook has no sheet of the name that was asked for.
    #[error("{source_name}: there is no sheet '{wanted}'. Found: {found}")]
    NoSheet {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The name that was asked for.
        wanted: String,
        /// The sheets of the workbook.
        found: String,
    },
    /// The cells were read, but no record can be made of them.
    #[error(transparent)]
    Csv(#[from] csv::ReadError),
}

/// Reads a sheet of a workbook from the disk; otherwise as [`read()`].
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

/// Reads a sheet of a workbook into a record in SI units: that of [`TableOptions::variable`], else the first one. `source` is
/// its name in messages and reports. Everything in the workbook, unpacked, has to fit into `options.max_memory`.
///
/// # Errors
/// [`ReadError`] if the file cannot be read, is no workbook, has no such sheet, or no record can be made of its cells.
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
    let io = |error| ReadError::Io { source_name: source.to_owned(), error };
    let broken = |problem: String| ReadError::NoWorkbook { source_name: source.to_owned(), problem };
    let over = |excess| ReadError::Csv(TableError::from(account.over(excess, source, "")).into());
    let mut file = Vec::new();
    let bound = options.max_memory.bytes();
    reader.take(bound.saturating_add(1)).read_to_end(&mut file).map_err(io)?;
    account.take(file.len() as u64).map_err(over)?;
    let unpacked = unpacked(&file, bound).map_err(broken)?;
    account.take(unpacked).map_err(over)?;
    let mut book =
        Xlsx::new(Cursor::new(file)).map_err(|error| broken(printable::one_line(&error.to_string()).into()))?;
    let names = book.sheet_names();
    let sheet = match &options.variable {
        Some(wanted) => names.iter().find(|name| *name == wanted).cloned().ok_or_else(|| ReadError::NoSheet {
            source_name: source.to_owned(),
            wanted: printable::one_line(wanted).into_owned(),
            found: list(&names.iter().map(|name| printable::one_line(name).into_owned()).collect::<Vec<_>>()),
        })?,
        None => names.first().cloned().ok_or_else(|| broken("there is no sheet in it".into()))?,
    };
    let text = text_of(&mut book, &sheet, account).map_err(|problem| match problem {
        Problem::Broken(problem) => broken(problem),
        Problem::Over(excess) => over(excess),
    })?;
    let mut record = csv::read_counted(text.as_bytes(), source, &CsvOptions::of(options.clone(), Some('\t')), account)?;
    if names.len() > 1 {
        let others: Vec<String> =
            names.iter().filter(|name| **name != sheet).map(|name| printable::one_line(name).into_owned()).collect();
        let message = format!("read; not read: {} (another one with --sheet NAME)", list(&others));
        record.quality.note(format!("sheet '{}'", printable::one_line(&sheet)), message);
    }
    Ok(record)
}

/// Number of bytes of everything in the archive, unpacked; counting ends beyond `bound`. What an archive says of its sizes
/// proves nothing, so that it is unpacked once.
fn unpacked(file: &[u8], bound: u64) -> Result<u64, String> {
    let problem = |error: &dyn std::fmt::Display| printable::one_line(&error.to_string()).into_owned();
    let mut archive = zip::ZipArchive::new(Cursor::new(file)).map_err(|error| problem(&error))?;
    let mut total = 0_u64;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(|error| problem(&error))?;
        let left = bound.saturating_sub(total).saturating_add(1);
        total += io::copy(&mut entry.take(left), &mut io::sink()).map_err(|error| problem(&error))?;
        if total > bound {
            break;
        }
    }
    Ok(total)
}

enum Problem {
    Broken(String),
    Over(crate::memory::Excess),
}

/// The cells of a sheet as text: a line for each row, tabs between cells.
fn text_of(book: &mut Xlsx<Cursor<Vec<u8>>>, sheet: &str, account: &Account) -> Result<String, Problem> {
    let broken = |error: calamine::XlsxError| Problem::Broken(printable::one_line(&error.to_string()).into_owned());
    let mut cells = book.worksheet_cells_reader(sheet).map_err(broken)?;
    let mut text = String::new();
    let (mut row, mut column, mut counted) = (0, 0, 0);
    // Blank cells at the end of a row are not stored: a row is as wide as the widest one above it.
    let mut widest = 0;
    while let Some(cell) = cells.next_cell().map_err(broken)? {
        let (this_row, this_column) = cell.get_position();
        if matches!(cell.get_value(), DataRef::Empty) {
            continue;
        }
        if this_row < row || (this_row == row && this_column < column) {
            return Err(Problem::Broken(format!("its cells are not in order in row {}", this_row + 1)));
        }
        if this_column as usize >= MAX_COLUMNS {
            let message = format!("row {} has more than {MAX_COLUMNS} columns", this_row + 1);
            return Err(Problem::Broken(message));
        }
        while row < this_row {
            if column > 0 {
                text.extend(std::iter::repeat_n('\t', widest - column as usize));
            }
            text.push('\n');
            (row, column) = (row + 1, 0);
        }
        while column < this_column {
            text.push('\t');
            column += 1;
        }
        widest = widest.max(column as usize);
        write_cell(&mut text, cell.get_value());
        if text.len() > counted + (1 << 20) {
            account.take(many(text.len() - counted, 1)).map_err(Problem::Over)?;
            counted = text.len();
        }
    }
    text.extend(std::iter::repeat_n('\t', widest - column as usize));
    text.push('\n');
    Ok(text)
}

fn write_cell(text: &mut String, value: &DataRef<'_>) {
    // Writing to a string cannot fail.
    let _ = match value {
        DataRef::Int(value) => write!(text, "{value}"),
        DataRef::Float(value) => write!(text, "{value}"),
        DataRef::Bool(value) => write!(text, "{}", u8::from(*value)),
        DataRef::DateTime(time) => write!(text, "{}", clock_time(time.as_f64())),
        DataRef::String(value) | DataRef::DateTimeIso(value) | DataRef::DurationIso(value) => {
            put(text, value);
            Ok(())
        }
        DataRef::SharedString(value) => {
            put(text, value);
            Ok(())
        }
        DataRef::Error(_) | DataRef::Empty => Ok(()),
    };
}

/// Text of a cell without what separates cells and lines.
fn put(text: &mut String, value: &str) {
    text.extend(value.chars().map(|c| match c {
        '\t' | '\n' | '\r' => ' ',
        '"' => '\'',
        c => c,
    }));
}

/// A number of days from the beginning of 1900 as Excel counts them, as a clock time; below one day a time of day.
fn clock_time(days: f64) -> String {
    /// Days from Excel's day 0 (1899-12-30) to 1970-01-01.
    const TO_1970: f64 = 25_569.0;
    let dated = days >= 1.0;
    let days = if dated { days - TO_1970 } else { days };
    written(days * 86_400.0, dated)
}

#[cfg(test)]
mod tests {
    use super::clock_time;

    #[test]
    fn days_are_clock_times() {
        assert_eq!(clock_time(0.5), "12:00:00.000000");
        // Excel shows 45413.75 as 2024-05-01 18:00.
        assert_eq!(clock_time(45_413.75), "2024-05-01 18:00:00.000000");
    }
}
