//! Reads a stream through a window of bounded size.

use std::io::{ErrorKind, Read};

/// Size of the window, bytes: several times the longest message of any format, so that bytes are seldom moved.
const SIZE: usize = 1 << 20;

/// The part of a stream that is in memory: at most one mebibyte, moving forward.
pub(super) struct Window<R> {
    reader: R,
    memory: Vec<u8>,
    start: usize,
    end: usize,
    offset: u64,
    ended: bool,
}

impl<R: Read> Window<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, memory: vec![0; SIZE], start: 0, end: 0, offset: 0, ended: false }
    }

    /// Reads until this many bytes are in the window (at most [`SIZE`]); fewer only at the end of the stream.
    #[inline]
    pub(super) fn fill(&mut self, bytes: usize) -> std::io::Result<()> {
        if self.end - self.start >= bytes || self.ended { Ok(()) } else { self.refill(bytes) }
    }

    fn refill(&mut self, bytes: usize) -> std::io::Result<()> {
        self.memory.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        while self.end < bytes.min(SIZE) && !self.ended {
            let Some(room) = self.memory.get_mut(self.end..) else { break };
            match self.reader.read(room) {
                Ok(0) => self.ended = true,
                Ok(read) => self.end = (self.end + read).min(SIZE),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// The bytes in the window.
    #[inline]
    pub(super) fn bytes(&self) -> &[u8] {
        self.memory.get(self.start..self.end).unwrap_or_default()
    }

    /// True if the stream has ended and its last bytes are in the window.
    pub(super) fn has_end(&self) -> bool {
        self.ended
    }

    /// Position in the stream at which the window begins, bytes.
    #[inline]
    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// Moves the beginning of the window forward by this many bytes, at most to its end.
    #[inline]
    pub(super) fn advance(&mut self, bytes: usize) {
        let step = bytes.min(self.end - self.start);
        self.start += step;
        self.offset += step as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives at most seven bytes at a time.
    struct Drops<'a>(&'a [u8]);

    impl Read for Drops<'_> {
        fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
            let length = out.len().min(7);
            self.0.read(&mut out[..length])
        }
    }

    #[test]
    fn every_byte_comes_once_and_in_order() {
        let bytes: Vec<u8> = (0..3 * SIZE / 2).map(|i| (i % 251) as u8).collect();
        let mut window = Window::new(Drops(&bytes));
        let mut seen = 0;
        loop {
            window.fill(1000).unwrap();
            assert_eq!(window.offset(), seen as u64);
            let step = window.bytes().len().min(777);
            if step == 0 {
                break;
            }
            assert!(window.bytes().len() >= 1000 || window.has_end());
            assert_eq!(window.bytes()[..step], bytes[seen..seen + step]);
            window.advance(step);
            seen += step;
        }
        assert_eq!(seen, bytes.len());
    }
}
