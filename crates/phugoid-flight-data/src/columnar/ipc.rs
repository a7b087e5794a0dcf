//! Reads Arrow IPC: a schema and batches of columns, one message after the other.
//!
//! Files (Feather version 2) are read as streams too: a file is a stream between `ARROW1` and a footer, which is needed
//! only to find batches out of order. So a file that was cut off gives the batches before the cut.

use std::collections::HashMap;
use std::io::{self, Read};
use std::sync::Arc;

use arrow_buffer::Buffer;
use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::read_record_batch;
use arrow_ipc::{Endianness, Message, MessageHeader, RecordBatch, root_as_message};
use arrow_schema::Schema;

use super::{AddError, Columns, ReadError, schema};
use crate::memory::{Account, Excess};
use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::{TableError, TableOptions};

/// The longest description of a message that is read, bytes. The schema of thousands of columns has a few million.
const LONGEST_DESCRIPTION: u64 = 64 << 20;
/// How many times their length compressed data may have when they are unpacked: Zstandard makes blocks of 128 KiB of
/// four bytes.
const MOST_TIMES: u64 = 1 << 15;
const CONTINUATION: [u8; 4] = [0xFF; 4];

/// Reads batches until the end; if one is damaged, those before it are kept.
pub(crate) fn read(
    reader: impl Read,
    source: &str,
    options: &TableOptions,
    account: &Account,
) -> Result<Record, ReadError> {
    let mut stream = Stream { reader, offset: 0, source, account };
    let mut report = QualityReport::default();
    let damaged = |place: u64, problem: String| ReadError::Damaged {
        source_name: source.to_owned(),
        place: format!("byte {place}"),
        problem,
    };
    let mut pending = stream.start()?;
    let mut table: Option<(Arc<Schema>, Columns)> = None;
    loop {
        let place = stream.offset;
        let result = match stream.message(pending.take(), table.as_mut()) {
            Ok(result) => result,
            Err(Problem::Stop(error)) => return Err(error),
            Err(Problem::Damaged(problem)) => match &table {
                Some((_, columns)) if columns.rows() > 0 => {
                    let kept = columns.rows();
                    let message = format!("the file is damaged here ({problem}); the {kept} rows before it are kept");
                    report.warn(format!("byte {place}"), message);
                    break;
                }
                _ => return Err(damaged(place, problem)),
            },
        };
        match result {
            Got::Schema(schema) => {
                let columns = Columns::of(&schema, source)?;
                table = Some((Arc::new(schema), columns));
            }
            Got::Other => {}
            Got::End => break,
        }
    }
    match table {
        Some((_, columns)) => columns.record(source, options, report, account),
        None => Err(damaged(0, "there is no schema in it".into())),
    }
}

enum Problem {
    /// The file is damaged, and nothing after this place can be read.
    Damaged(String),
    /// Reading has to stop with this error.
    Stop(ReadError),
}

fn damaged<T>(problem: impl Into<String>) -> Result<T, Problem> {
    Err(Problem::Damaged(problem.into()))
}

enum Got {
    Schema(Schema),
    Other,
    End,
}

struct Stream<'a, R> {
    reader: R,
    offset: u64,
    source: &'a str,
    account: &'a Account,
}

impl<R: Read> Stream<'_, R> {
    /// The first four bytes of the first message, if they had to be read to recognise the format.
    fn start(&mut self) -> Result<Option<[u8; 4]>, ReadError> {
        let mut first = [0; 4];
        let not_read = |found: &str, advice| ReadError::NotRead {
            source_name: self.source.to_owned(),
            found: found.to_owned(),
            advice,
        };
        match self.reader.read_exact(&mut first) {
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return Err(not_read("no Arrow file but one of fewer than four bytes", "Copy or write it again"));
            }
            result => result.map_err(|error| ReadError::Io { source_name: self.source.to_owned(), error })?,
        }
        self.offset = 4;
        if &first == b"FEA1" {
            return Err(not_read("a Feather file of version 1", "Write it with version 2 (pyarrow: version=2)"));
        }
        if &first != b"ARRO" {
            return Ok(Some(first));
        }
        let rest = self.bytes(4).map_err(|problem| self.stopped(problem))?;
        match rest.starts_with(b"W1") {
            true => Ok(None),
            false => {
                Err(not_read("no Arrow file (ARROW1 is expected at its beginning)", "Check that it is the right file"))
            }
        }
    }

    fn stopped(&self, problem: Problem) -> ReadError {
        match problem {
            Problem::Stop(error) => error,
            Problem::Damaged(problem) => ReadError::Damaged {
                source_name: self.source.to_owned(),
                place: format!("byte {}", self.offset),
                problem,
            },
        }
    }

    fn over(&self, excess: Excess) -> Problem {
        let place = format!("byte {}", self.offset);
        Problem::Stop(TableError::from(self.account.over_so_far(excess, self.source, place)).into())
    }

    /// Reads this many bytes. Memory is taken as they arrive, because the announced number may be wrong, but all of it
    /// is counted before.
    fn bytes(&mut self, count: u64) -> Result<Vec<u8>, Problem> {
        if self.account.file_is_shorter_than(self.offset.saturating_add(count)) {
            return damaged(format!("{count} bytes announced, which the file does not have"));
        }
        let _held = self.account.hold(count).map_err(|excess| self.over(excess))?;
        let mut bytes = Vec::new();
        let read = self
            .reader
            .by_ref()
            .take(count)
            .read_to_end(&mut bytes)
            .map_err(|error| Problem::Stop(ReadError::Io { source_name: self.source.to_owned(), error }))?;
        self.offset += read as u64;
        if (read as u64) < count {
            return damaged(format!("{} of {count} bytes are missing at the end", count - read as u64));
        }
        Ok(bytes)
    }

    fn word(&mut self) -> Result<Option<[u8; 4]>, Problem> {
        let before = self.offset;
        match self.bytes(4) {
            Ok(bytes) => Ok(bytes.try_into().ok()),
            // A stream may end without an end marker.
            Err(Problem::Damaged(_)) if self.offset == before => Ok(None),
            Err(problem) => Err(problem),
        }
    }

    /// Reads one message and adds what it holds to the table.
    fn message(
        &mut self,
        pending: Option<[u8; 4]>,
        table: Option<&mut (Arc<Schema>, Columns)>,
    ) -> Result<Got, Problem> {
        let first = match pending {
            Some(word) => Some(word),
            None => self.word()?,
        };
        let Some(first) = first else { return Ok(Got::End) };
        // Before version 0.15 of Arrow a message began with its length, without a marker.
        let length = if first == CONTINUATION { self.word()?.unwrap_or_default() } else { first };
        let length = u64::from(u32::from_le_bytes(length));
        if length == 0 {
            return Ok(Got::End);
        }
        if length > LONGEST_DESCRIPTION {
            return damaged(format!(
                "a description of {length} bytes, more than the {LONGEST_DESCRIPTION} that are read"
            ));
        }
        let description = self.bytes(length)?;
        // Held as long as the description is there.
        let account = self.account;
        let _held = account.hold(length).map_err(|excess| self.over(excess))?;
        let message = match root_as_message(&description) {
            Ok(message) => message,
            Err(error) => return damaged(format!("its description cannot be understood: {error}")),
        };
        let body_length = u64::try_from(message.bodyLength()).or_else(|_| damaged("a body of negative length"))?;
        match (message.header_type(), table) {
            (MessageHeader::Schema, None) => {
                self.skip(body_length)?;
                self.schema(message).map(Got::Schema)
            }
            (MessageHeader::Schema, Some(_)) => damaged("a second schema"),
            (MessageHeader::RecordBatch, Some((schema, columns))) => {
                let body = self.bytes(body_length)?;
                let _held = account.hold(body_length).map_err(|excess| self.over(excess))?;
                self.batch(message, body, schema, columns)?;
                Ok(Got::Other)
            }
            (MessageHeader::RecordBatch, None) => damaged("a batch before the schema"),
            _ => {
                self.skip(body_length)?;
                Ok(Got::Other)
            }
        }
    }

    fn skip(&mut self, count: u64) -> Result<(), Problem> {
        let copied = io::copy(&mut self.reader.by_ref().take(count), &mut io::sink());
        let copied =
            copied.map_err(|error| Problem::Stop(ReadError::Io { source_name: self.source.to_owned(), error }))?;
        self.offset += copied;
        if copied < count {
            damaged(format!("{} of {count} bytes are missing at the end", count - copied))
        } else {
            Ok(())
        }
    }

    fn schema(&self, message: Message<'_>) -> Result<Schema, Problem> {
        let Some(schema) = message.header_as_schema() else { return damaged("a schema without content") };
        if schema.endianness() != Endianness::Little {
            return Err(Problem::Stop(ReadError::NotRead {
                source_name: self.source.to_owned(),
                found: "an Arrow file of big-endian numbers".into(),
                advice: "Write it on a little-endian machine",
            }));
        }
        schema::check(schema, self.account).map_err(|excess| self.over(excess))?;
        try_fb_to_schema(schema).or_else(|error| damaged(format!("its schema cannot be understood: {error}")))
    }

    fn batch(
        &self,
        message: Message<'_>,
        body: Vec<u8>,
        schema: &Arc<Schema>,
        columns: &mut Columns,
    ) -> Result<(), Problem> {
        let Some(batch) = message.header_as_record_batch() else { return damaged("a batch without content") };
        let (rows, unpacked) = sizes(batch, &body).or_else(damaged)?;
        // The library gives every column as many values as the batch has rows, and unpacks all before it looks at them.
        let over = |excess| {
            let place = format!("byte {}", self.offset);
            Problem::Stop(TableError::from(self.account.over(excess, self.source, place)).into())
        };
        let _held = self.account.hold(unpacked).map_err(over)?;
        self.account.hold(rows.saturating_mul(8 * columns.chosen.len() as u64)).map_err(over)?;
        if columns.chosen.is_empty() {
            return Ok(());
        }
        let (body, dictionaries) = (Buffer::from_vec(body), HashMap::new());
        let (schema, chosen) = (Arc::clone(schema), Some(columns.chosen.as_slice()));
        let batch = read_record_batch(&body, batch, schema, &dictionaries, chosen, &message.version());
        let batch = batch.or_else(|error| damaged(error.to_string()))?;
        columns.add(&batch, self.account).map_err(|error| match error {
            AddError::Damaged(problem) => Problem::Damaged(problem),
            AddError::OverBudget(excess) => self.over(excess),
        })
    }
}

/// Checks that everything the batch announces lies in its body. Returns the number of its rows, and of the bytes that
/// its columns have when they are unpacked.
fn sizes(batch: RecordBatch<'_>, body: &[u8]) -> Result<(u64, u64), String> {
    let mut rows = u64::try_from(batch.length()).unwrap_or(u64::MAX);
    for node in batch.nodes().into_iter().flatten() {
        let (length, missing) = (node.length(), node.null_count());
        if length < 0 || missing < 0 || missing > length {
            return Err(format!("a column of {length} values, {missing} of them missing"));
        }
        rows = rows.max(length.unsigned_abs());
    }
    let mut unpacked = 0_u64;
    for buffer in batch.buffers().into_iter().flatten() {
        let (offset, length) = (buffer.offset(), buffer.length());
        let range = usize::try_from(offset).ok().zip(usize::try_from(length).ok());
        let bytes = range.and_then(|(offset, length)| body.get(offset..offset.checked_add(length)?));
        let Some(bytes) = bytes else {
            return Err(format!("{length} bytes from {offset} in a body of {}", body.len()));
        };
        if batch.compression().is_some() && !bytes.is_empty() {
            let Some(size) = bytes.first_chunk::<8>().map(|size| i64::from_le_bytes(*size)) else {
                return Err(format!("compressed data of {length} bytes, which have no room for their size"));
            };
            // No method packs so tightly: the size is damaged.
            if size < -1 || size.unsigned_abs() > MOST_TIMES.saturating_mul(length.unsigned_abs()) {
                return Err(format!("{length} bytes of compressed data that want {size} bytes"));
            }
            // A size of -1 marks a buffer that is not compressed.
            unpacked = unpacked.saturating_add(u64::try_from(size).unwrap_or(0));
        }
    }
    Ok((rows, unpacked))
}
