//! Flights beside the first one: the options `--with` and `--predict`.

use std::path::Path;

use phugoid_flight_data::printable;
use phugoid_flight_data::reader::{ReadError, ReadOptions};
use phugoid_flight_data::record::Record;

use crate::arguments::{Further, check_variable};
use crate::failure::Failure;

/// Reads a further flight, of the variable that is named behind its file. Where none is, it is the variable of the first flight,
/// and in a file without that one the table of the file itself.
///
/// # Errors
/// [`Failure::Input`]: the file cannot be read, has several tables and none of this name, or has one table and a name behind it.
pub(super) fn read(
    option: &str,
    further: &Further,
    options: &ReadOptions,
    open: impl Fn(&Path, &ReadOptions) -> Result<Record, Box<ReadError>>,
) -> Result<Record, Failure> {
    let with = |variable: Option<&String>| {
        let mut options = options.clone();
        options.table.variable = variable.cloned();
        open(&further.file, &options)
    };
    check_variable(option, further.variable.as_deref(), &further.file)?;
    let named = match with(further.variable.as_ref().or(options.table.variable.as_ref())) {
        Ok(record) => return Ok(record),
        Err(error) if error.is_without_variable() => error,
        Err(error) => return Err(Failure::input(error)),
    };
    if further.variable.is_none()
        && let Ok(record) = with(None)
    {
        return Ok(record);
    }
    let file = printable::path(&further.file);
    Err(Failure::input(format!("{named}. Name the one of this flight behind its file: {option} {file}:NAME")))
}
