//! Checks the page headers of a Parquet column before anything is unpacked, because the library allocates what they
//! announce.
//!
//! The headers are structs in Thrift's compact protocol ("Apache Thrift compact protocol encoding"; "Parquet:
//! PageHeader" in `parquet.thrift`), of which only the sizes and counts are needed.

use std::io::{BufReader, Read};

use ::parquet::file::reader::ChunkReader;

/// Structs are never nested deeper than this in a page header.
const MAX_DEPTH: usize = 8;
/// The longest header that is read, bytes; statistics in it may hold text.
const LONGEST_HEADER: u64 = 1 << 20;

/// Checks the pages in `from..from + length`: none may be unpacked to more than `most_bytes` or hold more than
/// `most_values`.
pub(crate) fn check(
    reader: &impl ChunkReader,
    from: u64,
    length: u64,
    most_bytes: u64,
    most_values: u64,
) -> Result<(), String> {
    let mut at = from;
    let end = from.saturating_add(length);
    while at < end {
        let input = reader.get_read(at).map_err(|error| error.to_string())?;
        let mut thrift =
            Thrift { input: BufReader::with_capacity(512, input.take(LONGEST_HEADER.min(end - at))), read: 0 };
        let mut sizes = Sizes::default();
        thrift.page_header(&mut sizes)?;
        let [packed, unpacked] = [sizes.packed, sizes.unpacked].map(u64::try_from);
        let (Ok(packed), Ok(unpacked)) = (packed, unpacked) else {
            return Err(format!("byte {at}: a page of {} bytes, unpacked {}", sizes.packed, sizes.unpacked));
        };
        let values = u64::try_from(sizes.values).unwrap_or(u64::MAX);
        if unpacked > most_bytes || values > most_values {
            return Err(format!(
                "byte {at}: a page of {unpacked} bytes with {} values, more than the bound on memory",
                sizes.values
            ));
        }
        at = at.saturating_add(thrift.read).saturating_add(packed);
    }
    if at > end {
        return Err(format!("byte {end}: the last page of a column is longer than the column"));
    }
    Ok(())
}

/// The sizes in a page header, bytes, and the largest count in it (values, missing values or rows).
#[derive(Default)]
struct Sizes {
    packed: i64,
    unpacked: i64,
    values: i64,
}

struct Thrift<R> {
    input: BufReader<R>,
    /// Number of bytes read so far.
    read: u64,
}

impl<R: Read> Thrift<R> {
    fn byte(&mut self) -> Result<u8, String> {
        let mut byte = [0];
        self.input.read_exact(&mut byte).map_err(|_| "a page header that ends in the middle".to_owned())?;
        self.read += 1;
        Ok(byte[0])
    }

    fn unsigned(&mut self) -> Result<u64, String> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7F) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err("a page header with a number of more than 64 bits".into())
    }

    /// Reads a signed number in the zigzag encoding of Thrift: 0, 1, 2, 3, ... stand for 0, -1, 1, -2, ...
    fn signed(&mut self) -> Result<i64, String> {
        let value = self.unsigned()?;
        Ok((value >> 1).cast_signed() ^ -((value & 1).cast_signed()))
    }

    /// Kind and number of the next field of a struct; `None` at its end.
    fn field(&mut self, last: &mut i64) -> Result<Option<(u8, i64)>, String> {
        let head = self.byte()?;
        if head == 0 {
            return Ok(None);
        }
        let step = i64::from(head >> 4);
        *last = if step == 0 { self.signed()? } else { last.saturating_add(step) };
        Ok(Some((head & 0x0F, *last)))
    }

    fn page_header(&mut self, sizes: &mut Sizes) -> Result<(), String> {
        let mut last = 0;
        while let Some((kind, field)) = self.field(&mut last)? {
            match (kind, field) {
                (INTEGER_32, 2) => sizes.unpacked = self.signed()?,
                (INTEGER_32, 3) => sizes.packed = self.signed()?,
                // data_page_header, dictionary_page_header, data_page_header_v2: numbers of values, missing values and
                // rows
                (STRUCT, 5 | 7 | 8) => {
                    let mut last = 0;
                    while let Some((kind, inner)) = self.field(&mut last)? {
                        match (kind, inner) {
                            (INTEGER_32, 1) => sizes.count(self.signed()?),
                            (INTEGER_32, 2 | 3) if field == 8 => sizes.count(self.signed()?),
                            _ => self.skip(kind, 0)?,
                        }
                    }
                }
                _ => self.skip(kind, 0)?,
            }
        }
        Ok(())
    }

    fn skip_bytes(&mut self, count: u64) -> Result<(), String> {
        (0..count).try_for_each(|_| self.byte().map(|_| ()))
    }

    fn skip(&mut self, kind: u8, depth: usize) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err("a page header of structs within structs".into());
        }
        match kind {
            // The kind of the field itself says true or false.
            1 | 2 => Ok(()),
            3 => self.skip_bytes(1),
            4..=6 => self.unsigned().map(|_| ()),
            7 => self.skip_bytes(8),
            8 => {
                let length = self.unsigned()?;
                self.skip_bytes(length)
            }
            9 | 10 => {
                let head = self.byte()?;
                let count = if head >> 4 == 0x0F { self.unsigned()? } else { u64::from(head >> 4) };
                let kind = head & 0x0F;
                // In a list a truth value is a byte.
                (0..count).try_for_each(|_| if kind <= 2 { self.skip_bytes(1) } else { self.skip(kind, depth + 1) })
            }
            STRUCT => {
                let mut last = 0;
                while let Some((kind, _)) = self.field(&mut last)? {
                    self.skip(kind, depth + 1)?;
                }
                Ok(())
            }
            other => Err(format!("a page header with a field of kind {other}")),
        }
    }
}

impl Sizes {
    fn count(&mut self, values: i64) {
        self.values = if values < 0 { i64::MAX } else { self.values.max(values) };
    }
}

const INTEGER_32: u8 = 5;
const STRUCT: u8 = 12;
