//! Text in UTF-16 as UTF-8, in bounded memory: spreadsheets write it as "Unicode text".

use std::io::{self, ErrorKind, Read};

/// Number of bytes that are converted at once.
const CHUNK: usize = 16 * 1024;

/// How the two bytes of a unit of UTF-16 lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    LowFirst,
    HighFirst,
}

/// The bytes of a reader, converted to UTF-8 if they begin with a byte-order mark of UTF-16, else as they are. What is no UTF-16
/// becomes U+FFFD, as `�`.
pub(super) struct AsUtf8<R> {
    reader: R,
    /// `None` before the first bytes were read.
    order: Option<Option<Order>>,
    /// Bytes for the one who reads, and how many of them were given.
    ready: Vec<u8>,
    given: usize,
    /// Bytes of the file that are no whole unit yet, and a first half of a pair of units.
    rest: Vec<u8>,
    half: Option<u16>,
}

impl<R: Read> AsUtf8<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, order: None, ready: Vec::new(), given: 0, rest: Vec::new(), half: None }
    }

    /// Reads the first two bytes, which tell the encoding.
    fn begin(&mut self) -> io::Result<Option<Order>> {
        let mut mark = Vec::with_capacity(2);
        self.reader.by_ref().take(2).read_to_end(&mut mark)?;
        let order = match mark.as_slice() {
            [0xFF, 0xFE] => Some(Order::LowFirst),
            [0xFE, 0xFF] => Some(Order::HighFirst),
            _ => None,
        };
        if order.is_none() {
            self.ready = mark;
        }
        self.order = Some(order);
        Ok(order)
    }

    /// Converts the next bytes of the file; nothing is ready afterwards only at its end.
    fn convert(&mut self, order: Order) -> io::Result<()> {
        self.ready.clear();
        self.given = 0;
        while self.ready.is_empty() {
            let kept = self.rest.len();
            self.rest.resize(kept + CHUNK, 0);
            let read = match self.reader.read(self.rest.get_mut(kept..).unwrap_or_default()) {
                Ok(read) => read,
                Err(error) => {
                    self.rest.truncate(kept);
                    if error.kind() == ErrorKind::Interrupted {
                        continue;
                    }
                    return Err(error);
                }
            };
            self.rest.truncate(kept + read);
            let units = self.rest.chunks_exact(2).map(|pair| match (order, pair) {
                (Order::LowFirst, [low, high]) | (Order::HighFirst, [high, low]) => u16::from_be_bytes([*high, *low]),
                _ => 0xFFFD,
            });
            let mut units: Vec<u16> = self.half.take().into_iter().chain(units).collect();
            let odd = self.rest.len() % 2;
            self.rest.drain(..self.rest.len() - odd);
            if read > 0 {
                // The second half of a pair may come with the next bytes.
                self.half = units.pop_if(|unit| (0xD800..0xDC00).contains(unit));
            } else if odd == 1 {
                self.rest.clear();
                units.push(0xFFFD);
            }
            let mut utf8 = [0; 4];
            for unit in char::decode_utf16(units) {
                let character = unit.unwrap_or(char::REPLACEMENT_CHARACTER);
                self.ready.extend_from_slice(character.encode_utf8(&mut utf8).as_bytes());
            }
            if read == 0 {
                break;
            }
        }
        Ok(())
    }
}

impl<R: Read> Read for AsUtf8<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let order = match self.order {
            Some(order) => order,
            None => self.begin()?,
        };
        if self.given == self.ready.len() {
            match order {
                None => return self.reader.read(buffer),
                Some(order) => self.convert(order)?,
            }
        }
        let ready = self.ready.get(self.given..).unwrap_or_default();
        let count = ready.len().min(buffer.len());
        if let (Some(to), Some(from)) = (buffer.get_mut(..count), ready.get(..count)) {
            to.copy_from_slice(from);
        }
        self.given += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reader that gives a few bytes at a time.
    struct Slow<'a>(&'a [u8], usize);

    impl Read for Slow<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.1.min(buffer.len()).min(self.0.len());
            buffer[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    fn read(bytes: &[u8], step: usize) -> Vec<u8> {
        let mut all = Vec::new();
        AsUtf8::new(Slow(bytes, step)).read_to_end(&mut all).unwrap();
        all
    }

    #[test]
    fn both_orders_are_converted_and_other_bytes_stay() {
        // Longer than a chunk, with a pair of units.
        let text = "Höhenruder [°]\tη 𝛼\r\n".repeat(2000);
        let units: Vec<u16> = std::iter::once(0xFEFF).chain(text.encode_utf16()).collect();
        let low: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let high: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        for step in [1, 3, 8191, 1 << 20] {
            assert_eq!(read(&low, step), text.as_bytes(), "{step}");
            assert_eq!(read(&high, step), text.as_bytes(), "{step}");
            assert_eq!(read(text.as_bytes(), step), text.as_bytes(), "{step}");
        }
        // Cut inside a unit, and inside a pair of units.
        assert_eq!(read(b"\xFF\xFEa\0b", 2), "a\u{FFFD}".as_bytes());
        assert_eq!(read(b"\xFF\xFEa\0\x35\xD8", 2), "a\u{FFFD}".as_bytes());
        for bytes in [&b""[..], b"a", b"\xFF", b"\xFF\xFE"] {
            assert_eq!(read(bytes, 4), if bytes.len() < 2 { bytes } else { b"" });
        }
    }
}
