//! Reads flight records from Arrow IPC: files (Feather version 2, `.arrow`) and streams.
//!
//! Columns are as in [`crate::parquet`]. Batches are read one after the other, in bounded memory; of a file that is cut
//! off or damaged the batches before the damage are kept.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

pub use crate::columnar::ReadError;
use crate::columnar::ipc;
use crate::memory::Account;
use crate::printable;
use crate::record::Record;
use crate::table::TableOptions;

/// Reads an Arrow file or stream from the disk; otherwise as [`read()`].
///
/// # Errors
/// As [`read()`], with the path as the source's name.
pub fn read_path(path: &Path, options: &TableOptions) -> Result<Record, ReadError> {
    let source_name = printable::path(path);
    match File::open(path) {
        Ok(file) => {
            let account = Account::new(options.max_memory);
            ipc::read(BufReader::new(account.follow(file)), &source_name, options, &account)
        }
        Err(error) => Err(ReadError::Io { source_name, error }),
    }
}

/// Reads an Arrow file or stream into a record in SI units. `source` is its name in messages and reports. Channels,
/// units and the findings in `record.quality` are as those of [`crate::csv::read`], with rows counted from 1.
///
/// # Errors
/// [`ReadError`] if it cannot be read, is no Arrow IPC, holds no batch that could be read, or no record can be made of
/// its columns.
pub fn read(reader: impl Read, source: &str, options: &TableOptions) -> Result<Record, ReadError> {
    ipc::read(reader, source, options, &Account::new(options.max_memory))
}
