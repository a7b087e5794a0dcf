//! Reading a recording, whole, cut off or damaged.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use super::block::{Block, BlockKind, HEAD, LARGEST, MARK};
use super::header::{Header, VERSION};
use crate::arrival::Arrival;

/// Why a file is no recording that can be read.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The operating system could not open or read it.
    #[error("{file}: cannot be read: {error}")]
    Io {
        /// File.
        file: String,
        /// What the system says.
        error: io::Error,
    },
    /// Another kind of file.
    #[error("{file}: this is no recording of `phugoid live`: it begins with {found:02x?}, expected {MARK:02x?} (PHGL)")]
    NoRecording {
        /// File.
        file: String,
        /// Its first bytes.
        found: Vec<u8>,
    },
    /// The header is damaged or not there.
    #[error(
        "{file}: the first block is no header that can be read ({reason}): the model and the options are not known"
    )]
    NoHeader {
        /// File.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// Written by a later version.
    #[error(
        "{file}: format {found} of the recording, this program reads up to {VERSION}: use the program that wrote it ({program})"
    )]
    Version {
        /// File.
        file: String,
        /// Version of the format.
        found: u32,
        /// Version of the program.
        program: String,
    },
}

/// What could not be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Damage {
    /// Bytes inside the file that belong to no whole block.
    pub skipped_bytes: u64,
    /// Where the first of them is.
    pub first_at: Option<u64>,
    /// Bytes of a last block that was not written to its end.
    pub cut_off_bytes: u64,
    /// Whether the reception was ended in order: false after a kill.
    pub ended: bool,
}

/// Reads a recording block by block, in bounded memory.
pub struct Reader {
    file: String,
    input: BufReader<File>,
    /// What was read and is not used up, and where it begins in the file.
    buffer: Vec<u8>,
    at: u64,
    exhausted: bool,
    header: Header,
    damage: Damage,
}

impl Reader {
    /// True if these are the first bytes of a recording.
    pub fn is_recording(start: &[u8]) -> bool {
        start.starts_with(&MARK)
    }

    /// Opens a recording and reads its header.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        let input = File::open(path).map_err(|error| RecordingError::Io { file: file.clone(), error })?;
        let mut reader = Self {
            file: file.clone(),
            input: BufReader::with_capacity(1 << 16, input),
            buffer: Vec::new(),
            at: 0,
            exhausted: false,
            header: Header::default(),
            damage: Damage::default(),
        };
        reader.fill(HEAD)?;
        if !Self::is_recording(&reader.buffer) {
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

    /// The header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// What could not be read so far; whole after the last arrival.
    pub fn damage(&self) -> Damage {
        self.damage
    }

    /// The next arrival; none at the end.
    ///
    /// # Errors
    /// [`RecordingError::Io`].
    pub fn next_arrival(&mut self) -> Result<Option<Arrival>, RecordingError> {
        while let Some(block) = self.next_block()? {
            if block.kind == BlockKind::End {
                self.damage.ended = true;
            } else if let Some(arrival) = block.arrival() {
                return Ok(Some(arrival));
            }
        }
        Ok(None)
    }

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
                // Not written to its end, or a length that is damaged: then further blocks lie behind it.
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

    /// Leaves out everything up to the next mark.
    fn skip(&mut self) {
        let bytes = self.find_mark(1).unwrap_or_else(|| match self.exhausted {
            true => self.buffer.len(),
            // A mark may be cut by the end of what was read.
            false => self.buffer.len().saturating_sub(MARK.len() - 1).max(1),
        });
        self.damage.first_at.get_or_insert(self.at);
        self.damage.skipped_bytes += bytes as u64;
        self.consume(bytes);
    }

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
