//! Reading a recording, even one that is cut off or damaged.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use super::block::{Block, BlockKind, HEAD, LARGEST, MARK};
use super::header::{Header, VERSION};
use crate::arrival::Arrival;

/// Why a recording cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The operating system could not open or read the file.
    #[error("{file}: cannot be read: {error}")]
    Io {
        /// Name of the file that was opened.
        file: String,
        /// What the operating system said.
        error: io::Error,
    },
    /// The file is not a recording.
    #[error("{file}: this is no recording of `phugoid live`: it begins with {found:02x?}, expected {MARK:02x?} (PHGL)")]
    NoRecording {
        /// Name of the file that was opened.
        file: String,
        /// The first bytes of the file, at most eight.
        found: Vec<u8>,
    },
    /// The header is damaged or missing, so that model and options are not known.
    #[error(
        "{file}: the first block is no header that can be read ({reason}): the model and the options are not known"
    )]
    NoHeader {
        /// Name of the file that was opened.
        file: String,
        /// What is wrong with the header.
        reason: String,
    },
    /// The file was written by a later version of the program.
    #[error(
        "{file}: format {found} of the recording, this program reads up to {VERSION}: use the program that wrote it ({program})"
    )]
    Version {
        /// Name of the file that was opened.
        file: String,
        /// Version of the format in the file.
        found: u32,
        /// Version of the program that wrote the file.
        program: String,
    },
}

/// What could not be read of a recording so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Damage {
    /// Bytes inside the file that belong to no undamaged block.
    pub skipped_bytes: u64,
    /// Position of the first such byte in the file.
    pub first_at: Option<u64>,
    /// Bytes of the last block, if it was not written to its end.
    pub cut_off_bytes: u64,
    /// Whether the reception ended normally; false after a kill. Known only after the last arrival.
    pub ended: bool,
    /// Arrivals that were not recorded because the disk was full or too slow.
    pub lost_arrivals: u64,
}

/// Reads a recording block by block, in bounded memory, from a file or any other input.
pub struct Reader<I = BufReader<File>> {
    file: String,
    input: I,
    /// Bytes that were read and are not used yet.
    buffer: Vec<u8>,
    /// Position of the buffer in the file.
    at: u64,
    /// The input has ended.
    exhausted: bool,
    header: Header,
    damage: Damage,
}

impl Reader {
    /// Whether these are the first bytes of a recording; at least four are needed.
    pub fn is_recording(start: &[u8]) -> bool {
        start.starts_with(&MARK)
    }

    /// Opens a recording and reads its header.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be read, is not a recording, has no header, or is of a later version.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        let input = File::open(path).map_err(|error| RecordingError::Io { file: file.clone(), error })?;
        Self::from_input(BufReader::with_capacity(1 << 16, input), &file)
    }
}

impl<I: Read> Reader<I> {
    /// Reads the header of a recording from any input, such as a slice of bytes. `name` stands in the messages of
    /// errors.
    ///
    /// # Errors
    /// As [`Reader::open`].
    pub fn from_input(input: I, name: &str) -> Result<Self, RecordingError> {
        let file = name.to_owned();
        let mut reader = Self {
            file: file.clone(),
            input,
            buffer: Vec::new(),
            at: 0,
            exhausted: false,
            header: Header::default(),
            damage: Damage::default(),
        };
        reader.fill(HEAD)?;
        if !reader.buffer.starts_with(&MARK) {
            let found = reader.buffer.get(..reader.buffer.len().min(8)).unwrap_or_default().to_vec();
            return Err(RecordingError::NoRecording { file, found });
        }
        let no_header = |reason: String| RecordingError::NoHeader { file: file.clone(), reason };
        let first = reader.next_block()?.ok_or_else(|| no_header("the file ends within it".to_owned()))?;
        if first.kind != BlockKind::Header || reader.damage.skipped_bytes > 0 {
            return Err(no_header("it is damaged".to_owned()));
        }
        let header: Header = serde_json::from_slice(&first.content).map_err(|error| no_header(error.to_string()))?;
        if header.version > VERSION {
            return Err(RecordingError::Version { file, found: header.version, program: header.program });
        }
        reader.header = header;
        Ok(reader)
    }

    /// The header of the recording.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// What could not be read so far. It is complete once [`Reader::next_arrival`] has returned `None`.
    pub fn damage(&self) -> Damage {
        self.damage
    }

    /// The next arrival; `None` at the end. Damaged blocks are skipped and counted.
    ///
    /// # Errors
    /// [`RecordingError::Io`] if the file cannot be read.
    pub fn next_arrival(&mut self) -> Result<Option<Arrival>, RecordingError> {
        while let Some(block) = self.next_block()? {
            if block.kind == BlockKind::End {
                self.damage.ended = true;
            } else if block.kind == BlockKind::Gap {
                let lost = block.content.first_chunk().map_or(0, |lost| u64::from_le_bytes(*lost));
                self.damage.lost_arrivals = self.damage.lost_arrivals.saturating_add(lost);
            } else if let Some(arrival) = block.arrival() {
                return Ok(Some(arrival));
            }
        }
        Ok(None)
    }

    /// The next undamaged block; `None` at the end.
    fn next_block(&mut self) -> Result<Option<Block>, RecordingError> {
        loop {
            self.fill(HEAD)?;
            if self.buffer.len() < HEAD {
                self.damage.cut_off_bytes += self.buffer.len() as u64;
                self.consume(self.buffer.len());
                return Ok(None);
            }
            let number = |from: usize| {
                let bytes = self.buffer.get(from..from + 4).and_then(|bytes| bytes.try_into().ok());
                bytes.map_or(0, u32::from_le_bytes)
            };
            let (length, checksum) = (number(4) as usize, number(8));
            if !self.buffer.starts_with(&MARK) || length > LARGEST {
                self.skip();
                continue;
            }
            self.fill(HEAD + length)?;
            let Some(body) = self.buffer.get(HEAD..HEAD + length) else {
                // Either the block was not written to its end, or its length is damaged and further blocks follow.
                if self.find_mark(1).is_some() {
                    self.skip();
                    continue;
                }
                self.damage.cut_off_bytes += self.buffer.len() as u64;
                self.consume(self.buffer.len());
                return Ok(None);
            };
            let block = (crc32fast::hash(body) == checksum).then(|| Block::parse(body)).flatten();
            let Some(block) = block else {
                self.skip();
                continue;
            };
            self.consume(HEAD + length);
            return Ok(Some(block));
        }
    }

    /// Skips everything up to the next mark.
    fn skip(&mut self) {
        let bytes = self.find_mark(1).unwrap_or_else(|| match self.exhausted {
            true => self.buffer.len(),
            // The buffer may end within a mark.
            false => self.buffer.len().saturating_sub(MARK.len() - 1).max(1),
        });
        self.damage.first_at.get_or_insert(self.at);
        self.damage.skipped_bytes += bytes as u64;
        self.consume(bytes);
    }

    /// Place of the next mark in the buffer.
    fn find_mark(&self, from: usize) -> Option<usize> {
        let rest = self.buffer.get(from..)?;
        rest.windows(MARK.len()).position(|window| window == MARK).map(|found| found + from)
    }

    fn consume(&mut self, bytes: usize) {
        self.buffer.drain(..bytes.min(self.buffer.len()));
        self.at += bytes as u64;
    }

    /// Reads until the buffer has this many bytes, or the file ends.
    fn fill(&mut self, wanted: usize) -> Result<(), RecordingError> {
        let missing = wanted.saturating_sub(self.buffer.len());
        if missing == 0 || self.exhausted {
            return Ok(());
        }
        let read = (&mut self.input).take(missing as u64).read_to_end(&mut self.buffer);
        let read = read.map_err(|error| RecordingError::Io { file: self.file.clone(), error })?;
        self.exhausted = read < missing;
        Ok(())
    }
}
