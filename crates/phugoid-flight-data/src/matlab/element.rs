//! Reads data elements: a tag with type and size, then numbers in one of two byte orders.

use std::io::{self, Read};

use crate::memory::Excess;

/// What can be wrong with one variable. Other variables may still be readable.
#[derive(Debug)]
pub(super) enum Problem {
    /// The bytes contradict the format.
    Bad(String),
    /// The bytes cannot be read: the file ends, or compressed data are damaged.
    Io(io::Error),
    /// What it holds needs more memory than the budget.
    OverBudget { variable: String, excess: Excess },
}

impl From<Excess> for Problem {
    fn from(excess: Excess) -> Self {
        Problem::OverBudget { variable: String::new(), excess }
    }
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        Problem::Io(error)
    }
}

pub(super) fn bad<T>(problem: impl Into<String>) -> Result<T, Problem> {
    Err(Problem::Bad(problem.into()))
}

/// The type of a data element ("MAT-File Format", table 1-1).
pub(super) mod kind {
    pub(in crate::matlab) const INT8: u32 = 1;
    pub(in crate::matlab) const UINT8: u32 = 2;
    pub(in crate::matlab) const INT16: u32 = 3;
    pub(in crate::matlab) const UINT16: u32 = 4;
    pub(in crate::matlab) const INT32: u32 = 5;
    pub(in crate::matlab) const UINT32: u32 = 6;
    pub(in crate::matlab) const SINGLE: u32 = 7;
    pub(in crate::matlab) const DOUBLE: u32 = 9;
    pub(in crate::matlab) const INT64: u32 = 12;
    pub(in crate::matlab) const UINT64: u32 = 13;
    pub(in crate::matlab) const MATRIX: u32 = 14;
    pub(in crate::matlab) const COMPRESSED: u32 = 15;
    pub(in crate::matlab) const UTF8: u32 = 16;
    pub(in crate::matlab) const UTF16: u32 = 17;
}

/// Type and size of a data element; a small element has its data in the tag.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tag {
    pub(super) kind: u32,
    pub(super) size: u64,
    small: Option<[u8; 4]>,
}

impl Tag {
    pub(super) fn is_small(self) -> bool {
        self.small.is_some()
    }
}

/// Reads data elements up to the end of the element that contains them.
pub(super) struct Input<'r> {
    reader: &'r mut dyn Read,
    pub(super) big_endian: bool,
    /// Number of bytes left in the element that is being read.
    left: u64,
}

impl<'r> Input<'r> {
    pub(super) fn new(reader: &'r mut dyn Read, big_endian: bool, left: u64) -> Self {
        Self { reader, big_endian, left }
    }

    pub(super) fn left(&self) -> u64 {
        self.left
    }

    fn bytes(&mut self, target: &mut [u8]) -> Result<(), Problem> {
        let wanted = target.len() as u64;
        if wanted > self.left {
            return bad(format!("{wanted} bytes wanted where its element has {} left", self.left));
        }
        self.left -= wanted;
        Ok(self.reader.read_exact(target)?)
    }

    pub(super) fn skip(&mut self, mut bytes: u64) -> Result<(), Problem> {
        let mut sink = [0; 4096];
        while bytes > 0 {
            let step = usize::try_from(bytes).unwrap_or(usize::MAX).min(sink.len());
            self.bytes(sink.get_mut(..step).unwrap_or_default())?;
            bytes -= step as u64;
        }
        Ok(())
    }

    /// The number of four bytes in the byte order of the file.
    fn word(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }

    pub(super) fn tag(&mut self) -> Result<Tag, Problem> {
        let (mut first, mut second) = ([0; 4], [0; 4]);
        self.bytes(&mut first)?;
        self.bytes(&mut second)?;
        let word = self.word(first);
        // "Small data element format": the size stands in the upper half of the first word.
        let (kind, small_size) = (word & 0xFFFF, word >> 16);
        match small_size {
            0 => Ok(Tag { kind: word, size: u64::from(self.word(second)), small: None }),
            1..=4 => Ok(Tag { kind, size: u64::from(small_size), small: Some(second) }),
            size => bad(format!("a small data element of {size} bytes, where at most 4 have room")),
        }
    }

    /// Runs `inner` on the element of this tag, then skips what `inner` did not read and the padding to eight bytes.
    pub(super) fn within<T>(
        &mut self,
        tag: Tag,
        inner: impl FnOnce(&mut Input<'_>) -> Result<T, Problem>,
    ) -> Result<T, Problem> {
        if let Some(data) = tag.small {
            let size = usize::try_from(tag.size).unwrap_or(0);
            let mut data = data.get(..size).unwrap_or_default();
            return inner(&mut Input { reader: &mut data, big_endian: self.big_endian, left: tag.size });
        }
        if tag.size > self.left {
            return bad(format!("an element of {} bytes where {} are left", tag.size, self.left));
        }
        let after = self.left - tag.size;
        self.left = tag.size;
        let result = inner(self)?;
        self.skip(self.left)?;
        self.left = after;
        let padding = tag.size.wrapping_neg() % 8;
        // The last element of a matrix may lack its padding.
        self.skip(padding.min(self.left))?;
        Ok(result)
    }

    /// Gives the numbers of an element to `take`, one by one, until it returns false.
    pub(super) fn numbers(&mut self, kind: u32, mut take: impl FnMut(f64) -> bool) -> Result<(), Problem> {
        let width = width(kind)?;
        if !self.left.is_multiple_of(width) {
            return bad(format!("{} bytes of numbers of {width} bytes", self.left));
        }
        let mut buffer = [0; 4096];
        while self.left > 0 {
            let step = usize::try_from(self.left).unwrap_or(usize::MAX).min(buffer.len());
            let chunk = buffer.get_mut(..step).unwrap_or_default();
            self.bytes(chunk)?;
            for bytes in chunk.chunks_exact_mut(width as usize) {
                if self.big_endian {
                    bytes.reverse();
                }
                if !take(number(kind, bytes)) {
                    return Ok(());
                }
            }
        }
        Ok(())
    }
}

/// Number of bytes of a number of this type.
pub(super) fn width(kind: u32) -> Result<u64, Problem> {
    match kind {
        kind::INT8 | kind::UINT8 => Ok(1),
        kind::INT16 | kind::UINT16 => Ok(2),
        kind::INT32 | kind::UINT32 | kind::SINGLE => Ok(4),
        kind::DOUBLE | kind::INT64 | kind::UINT64 => Ok(8),
        other => bad(format!("data of type {other}, which is none of numbers")),
    }
}

/// The number in little-endian bytes; integers beyond 2^53 are rounded.
fn number(kind: u32, bytes: &[u8]) -> f64 {
    match (kind, bytes) {
        (kind::INT8, &[a]) => f64::from(a.cast_signed()),
        (kind::UINT8, &[a]) => f64::from(a),
        (kind::INT16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (kind::UINT16, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
        (kind::INT32, &[a, b, c, d]) => f64::from(i32::from_le_bytes([a, b, c, d])),
        (kind::UINT32, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
        (kind::SINGLE, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        (_, &[a, b, c, d, e, f, g, h]) => {
            let eight = [a, b, c, d, e, f, g, h];
            match kind {
                kind::INT64 => i64::from_le_bytes(eight) as f64,
                kind::UINT64 => u64::from_le_bytes(eight) as f64,
                _ => f64::from_le_bytes(eight),
            }
        }
        _ => f64::NAN,
    }
}
