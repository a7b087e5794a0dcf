//! Tables as text that are compressed by gzip.

use std::cell::Cell;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::{ReadError, ReadOptions, STANDARD_INPUT, table};
use crate::format::Format;
use crate::memory::{Account, Memory};
use crate::printable;
use crate::record::Record;

/// Text that a byte of a record's memory may have taken in the file: rows of a table keep eight bytes and more for each cell, so
/// that cells of 64 characters are allowed. Text that is no row (blank lines, comments) keeps nothing.
const TEXT_PER_BYTE: u64 = 8;

/// Reads the table in a compressed file. A file that is cut off gives the rows before the cut, as one that is not compressed does.
pub(super) fn read(
    reader: &mut dyn Read,
    path: &Path,
    options: &ReadOptions,
    account: &Account,
) -> Result<Record, ReadError> {
    let source = printable::path(path);
    let progress = Progress::default();
    let unpacked = Unpacked { decoder: MultiGzDecoder::new(reader), account, progress: &progress };
    let failed = |error| ReadError::Io { source_name: source.clone(), error };
    let (format, mut unpacked) = Format::of(unpacked).map_err(failed)?;
    if progress.is_cut.get() && progress.bytes.get() == 0 {
        let why = "the compressed file is cut off before anything could be unpacked: copy it again from where it came";
        return Err(failed(io::Error::new(ErrorKind::UnexpectedEof, why)));
    }
    if !matches!(format, Format::Csv | Format::Utf16) {
        return Err(ReadError::Packed { source_name: source, format, command: gunzip(path) });
    }
    let mut record = table(format, &mut unpacked, path, options, account)?;
    if progress.is_cut.get() {
        record.quality.warn(
            format!("line {}", progress.line()),
            "the compressed file is cut off here; the rows before are kept. If rows are missing, copy the file again from where \
             it came",
        );
    }
    Ok(record)
}

/// The command that unpacks a file.
fn gunzip(path: &Path) -> String {
    if path.as_os_str() == STANDARD_INPUT {
        return "gunzip".to_owned();
    }
    let name = printable::path(path);
    match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz")) {
        true => format!("gunzip {name}"),
        // It unpacks into a file of its own only what is called .gz.
        false => format!("gunzip < {name} > unpacked"),
    }
}

/// How far a file is unpacked.
#[derive(Default)]
struct Progress {
    bytes: Cell<u64>,
    lines: Cell<usize>,
    /// The compressed data ended before their end.
    is_cut: Cell<bool>,
}

impl Progress {
    /// The line that is being unpacked, from 1.
    fn line(&self) -> usize {
        self.lines.get() + 1
    }
}

/// The text in a compressed file, which ends where the file is cut off.
struct Unpacked<'a, R: Read> {
    decoder: MultiGzDecoder<R>,
    account: &'a Account,
    progress: &'a Progress,
}

impl<R: Read> Unpacked<'_, R> {
    /// A few bytes can be unpacked to any length, and what is no row of the table is kept nowhere: without a bound, reading goes on
    /// for as long as somebody who wrote the file wants.
    fn check_size(&self) -> io::Result<()> {
        let (bytes, budget) = (self.progress.bytes.get(), self.account.budget());
        if bytes <= budget.bytes().saturating_add(TEXT_PER_BYTE.saturating_mul(self.account.held())) {
            return Ok(());
        }
        Err(io::Error::other(format!(
            "up to line {} it was unpacked to {}, hardly any of which are rows of a table, and the budget is {budget}. Unpack it \
             (gunzip) and look whether it is a table; if it is, remove blank lines and comments, or raise the budget (--max-memory, \
             in code `max_memory`)",
            self.progress.line(),
            Memory::from_bytes(bytes)
        )))
    }
}

impl<R: Read> Read for Unpacked<'_, R> {
    fn read(&mut self, target: &mut [u8]) -> io::Result<usize> {
        let progress = self.progress;
        if progress.is_cut.get() {
            return Ok(0);
        }
        match self.decoder.read(target) {
            Ok(read) => {
                let text = target.get(..read).unwrap_or_default();
                progress.bytes.set(progress.bytes.get().saturating_add(read as u64));
                progress.lines.set(progress.lines.get() + memchr::memchr_iter(b'\n', text).count());
                self.check_size()?;
                Ok(read)
            }
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                progress.is_cut.set(true);
                Ok(0)
            }
            // The decoder says with these kinds what is wrong with the data, the operating system with others why it cannot read.
            Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::InvalidData) => {
                let line = progress.line();
                let message = format!(
                    "its compressed data are damaged, found at line {line} of the text in it ({error}): copy it again from where it \
                     came; `gzip -t` tests whether a copy is whole"
                );
                Err(io::Error::new(error.kind(), message))
            }
            Err(error) => Err(error),
        }
    }
}
