//! Checks the page headers of a Parquet column before anything is unpacked, because the library allocates what they
//! announce.
//!
//! The headers are structs in Thrift's compact protocol ("Apache Thrift compact protocol encoding"; "Parquet:
//! PageHeader" in `parquet.thrift`), of which only the sizes and counts are needed.

use std::io::{BufReader, Read};

use ::parquet::file::reader::ChunkReader;

/// Structs are never nested deeper than this in a page header.
const MAX_DEPTH: usize = 8;
/// The same for the footer of a file: groups of rows, columns, their sizes and statistics, and lists of all these.
const DEPTH_OF_FOOTER: usize = 24;
/// What the library (60.1) makes of a struct of the footer takes less than this, bytes; measured with 50,000 columns
/// and with 500 columns in 2,000 groups.
const BYTES_PER_STRUCT: u64 = 400;
/// The largest value of a column of numbers, bytes.
const LARGEST_VALUE: u64 = 12;
/// The longest header that is read, bytes; statistics in it may hold text.
const LONGEST_HEADER: u64 = 1 << 20;

/// Checks the pages in `from..from + length` of a column that is said to have `unpacked_in_all` bytes when it is
/// unpacked. Returns what the library needs to read them one after the other, bytes: the largest page, packed and not,
/// and the dictionary with its values.
pub(crate) fn check(reader: &impl ChunkReader, from: u64, length: u64, unpacked_in_all: u64) -> Result<u64, String> {
    let (mut dictionary, mut largest) = (0_u64, 0_u64);
    let mut at = from;
    let end = from.saturating_add(length);
    while at < end {
        let input = reader.get_read(at).map_err(|error| error.to_string())?;
        let mut thrift = Thrift {
            input: BufReader::with_capacity(512, input.take(LONGEST_HEADER.min(end - at))),
            read: 0,
            structs: 0,
        };
        let mut sizes = Sizes::default();
        thrift.page_header(&mut sizes)?;
        let [packed, unpacked] = [sizes.packed, sizes.unpacked].map(u64::try_from);
        let (Ok(packed), Ok(unpacked)) = (packed, unpacked) else {
            return Err(format!("byte {at}: a page of {} bytes, unpacked {}", sizes.packed, sizes.unpacked));
        };
        let values = u64::try_from(sizes.values).unwrap_or(u64::MAX);
        // No value of a dictionary is shorter than a byte.
        if unpacked > unpacked_in_all || sizes.dictionary && values > unpacked {
            return Err(format!(
                "byte {at}: a page of {unpacked} bytes with {} values, in a column of {unpacked_in_all} bytes",
                sizes.values
            ));
        }
        match sizes.dictionary {
            true => dictionary = dictionary.saturating_add(packed + unpacked + LARGEST_VALUE * values),
            false => largest = largest.max(packed + unpacked),
        }
        at = at.saturating_add(thrift.read).saturating_add(packed);
    }
    if at > end {
        return Err(format!("byte {end}: the last page of a column is longer than the column"));
    }
    Ok(dictionary.saturating_add(largest))
}

/// Counts what the library needs for the footer of a file, bytes, before it is read: most of it are structs, each of
/// which takes many times the bytes that it has in the file. `None` if there is no footer.
pub(crate) fn footer(reader: &impl ChunkReader) -> Result<Option<u64>, String> {
    let read = |error: ::parquet::errors::ParquetError| error.to_string();
    let Some(end) = reader.len().checked_sub(8) else { return Ok(None) };
    let tail = reader.get_bytes(end, 8).map_err(read)?;
    let Some([a, b, c, d, b'P', b'A', b'R', b'1']) = tail.first_chunk().copied() else { return Ok(None) };
    let length = u64::from(u32::from_le_bytes([a, b, c, d]));
    let Some(start) = end.checked_sub(length) else { return Ok(None) };
    let input = reader.get_read(start).map_err(read)?.take(length);
    let mut thrift = Thrift { input: BufReader::with_capacity(1 << 16, input), read: 0, structs: 0 };
    thrift.skip(STRUCT, DEPTH_OF_FOOTER)?;
    Ok(Some((thrift.structs * BYTES_PER_STRUCT).saturating_add(4 * length)))
}

/// The sizes in a page header, bytes, and the largest count in it (values, missing values or rows).
#[derive(Default)]
struct Sizes {
    packed: i64,
    unpacked: i64,
    values: i64,
    /// True for the page that holds the dictionary of a column.
    dictionary: bool,
}

struct Thrift<R> {
    input: BufReader<R>,
    /// Number of bytes read so far.
    read: u64,
    /// Number of structs read past so far.
    structs: u64,
}

impl<R: Read> Thrift<R> {
    fn byte(&mut self) -> Result<u8, String> {
        let mut byte = [0];
        self.input.read_exact(&mut byte).map_err(|_| "a header that ends in the middle".to_owned())?;
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
        Err("a header with a number of more than 64 bits".into())
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
                    sizes.dictionary |= field == 7;
                    let mut last = 0;
                    while let Some((kind, inner)) = self.field(&mut last)? {
                        match (kind, inner) {
                            (INTEGER_32, 1) => sizes.count(self.signed()?),
                            (INTEGER_32, 2 | 3) if field == 8 => sizes.count(self.signed()?),
                            _ => self.skip(kind, MAX_DEPTH)?,
                        }
                    }
                }
                _ => self.skip(kind, MAX_DEPTH)?,
            }
        }
        Ok(())
    }

    fn skip_bytes(&mut self, count: u64) -> Result<(), String> {
        (0..count).try_for_each(|_| self.byte().map(|_| ()))
    }

    /// Reads past a field, in which structs and lists may be nested at most `depth` deep.
    fn skip(&mut self, kind: u8, depth: usize) -> Result<(), String> {
        let Some(below) = depth.checked_sub(1) else {
            return Err("structs within structs, deeper than in any such file".into());
        };
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
                (0..count).try_for_each(|_| if kind <= 2 { self.skip_bytes(1) } else { self.skip(kind, below) })
            }
            STRUCT => {
                self.structs += 1;
                let mut last = 0;
                while let Some((kind, _)) = self.field(&mut last)? {
                    self.skip(kind, below)?;
                }
                Ok(())
            }
            other => Err(format!("a header with a field of kind {other}")),
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
