//! The files of a recording: one, or several parts of which the oldest are removed.

use std::collections::{BTreeMap, VecDeque};
use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::block::{BlockKind, append};
use crate::arrival::{Arrival, Content, wall_ns};

/// Parts that are kept at one time; together they have the size that was allowed.
const PARTS: u64 = 4;
/// Longest header line of a text stream that is written again at the beginning of a part, bytes.
const LONGEST_HEADER: usize = 16 * 1024;

/// A place for files. Tests have one that can be full.
pub(super) trait Disk: Send {
    /// Makes a file that must not exist.
    fn create(&self, path: &Path) -> io::Result<Box<dyn DiskFile>>;
    /// Removes a file.
    fn remove(&self, path: &Path) -> io::Result<()>;
}

/// A file that is being written.
pub(super) trait DiskFile: Write + Send {
    /// Cuts the file after so many bytes; what is written next follows them.
    fn cut(&mut self, length: u64) -> io::Result<()>;
    /// The same file for another thread, which puts it on the disk; `None` where there is nothing to do.
    fn twin(&self) -> Option<File>;
    /// Puts what was written on the disk.
    fn sync(&mut self) -> io::Result<()>;
}

/// The file system. Only the user of the program may read what is recorded, because a flight may be confidential.
pub(super) struct FileSystem;

impl Disk for FileSystem {
    fn create(&self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        Ok(Box::new(options.open(path)?))
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        std::fs::remove_file(path)
    }
}

impl DiskFile for File {
    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::Start(length)).map(|_| ())
    }

    fn twin(&self) -> Option<File> {
        self.try_clone().ok()
    }

    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }
}

/// What became of the oldest part when another one began.
pub(super) enum Oldest {
    /// There is room for it.
    Stays,
    /// It was removed.
    Removed(PathBuf),
    /// It should have been removed, and the system does not allow it.
    Refuses(PathBuf, io::Error),
}

/// The file that is being written, and those before it.
pub(super) struct Parts {
    disk: Box<dyn Disk>,
    path: PathBuf,
    /// The header block, with which every part begins.
    header: Vec<u8>,
    /// Size from which on another part begins, bytes.
    part_bytes: Option<u64>,
    file: Box<dyn DiskFile>,
    /// Bytes of the file that were written whole.
    length: u64,
    /// An attempt to write may have left bytes behind them.
    is_torn: bool,
    number: u32,
    kept: VecDeque<PathBuf>,
    senders: BTreeMap<u16, Sender>,
}

/// What a part has to begin with so that it can be read without the ones before it.
#[derive(Default)]
struct Sender {
    name: String,
    /// The header line of a text stream, with its end.
    header: Vec<u8>,
    has_sent: bool,
}

impl Parts {
    /// Makes the first file. With a limit all parts together have no more than about so many bytes.
    pub(super) fn create(disk: Box<dyn Disk>, path: &Path, header: Vec<u8>, limit: Option<u64>) -> io::Result<Self> {
        let mut file = disk.create(path)?;
        file.write_all(&header)?;
        Ok(Self {
            disk,
            path: path.to_owned(),
            length: header.len() as u64,
            header,
            part_bytes: limit.map(|limit| limit / PARTS),
            file,
            is_torn: false,
            number: 1,
            kept: VecDeque::from([path.to_owned()]),
            senders: BTreeMap::new(),
        })
    }

    /// Size from which on another part begins, bytes, if the recording is limited.
    pub(super) fn part_bytes(&self) -> Option<u64> {
        self.part_bytes
    }

    /// Notes what a later part has to begin with.
    pub(super) fn note(&mut self, arrival: &Arrival) {
        match &arrival.content {
            Content::Opened(name) => {
                self.senders.insert(arrival.origin, Sender { name: name.clone(), ..Sender::default() });
            }
            Content::Closed(_) => {
                self.senders.remove(&arrival.origin);
            }
            Content::Datagram(bytes) | Content::Piece(bytes) => {
                let Some(sender) = self.senders.get_mut(&arrival.origin) else { return };
                if std::mem::replace(&mut sender.has_sent, true) {
                    return;
                }
                let line = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
                let is_header = !line.starts_with(b"{") && std::str::from_utf8(line).is_ok();
                if is_header && line.len() <= LONGEST_HEADER {
                    sender.header = [line, b"\n"].concat();
                }
            }
        }
    }

    /// Writes whole blocks. After an error nothing of them is in the file, and they can be written again.
    pub(super) fn write(&mut self, blocks: &[u8]) -> io::Result<()> {
        if self.is_torn {
            self.file.cut(self.length)?;
            self.is_torn = false;
        }
        self.is_torn = true;
        self.file.write_all(blocks)?;
        self.is_torn = false;
        self.length += blocks.len() as u64;
        Ok(())
    }

    /// Begins another part if this one is large enough, with the stamps of the last arrival. Gives the bytes that were
    /// written beside those of the caller, and what became of the oldest part.
    pub(super) fn rotate(&mut self, stamps: [u64; 2]) -> io::Result<(u64, Oldest)> {
        if self.part_bytes.is_none_or(|most| self.length < most) {
            return Ok((0, Oldest::Stays));
        }
        let mut end = Vec::new();
        append(&mut end, BlockKind::End, stamps, 0, &[]);
        let mut start = self.header.clone();
        for (origin, sender) in &self.senders {
            append(&mut start, BlockKind::Opened, stamps, *origin, sender.name.as_bytes());
            if !sender.header.is_empty() {
                append(&mut start, BlockKind::Datagram, stamps, *origin, &sender.header);
            }
        }
        let (path, mut next) = loop {
            let path = numbered(&self.path, self.number + 1);
            match self.disk.create(&path) {
                // It belongs to another recording.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => self.number += 1,
                Err(error) => return Err(error),
                Ok(next) => break (path, next),
            }
        };
        if let Err(error) = next.write_all(&start).and_then(|()| self.write(&end)) {
            drop(next);
            // What is left of it would be in the way of the next attempt.
            let _ = self.disk.remove(&path);
            return Err(error);
        }
        let synced = self.file.sync();
        (self.file, self.length) = (next, start.len() as u64);
        self.number += 1;
        self.kept.push_back(path);
        synced?;
        Ok(((end.len() + start.len()) as u64, self.remove_oldest()))
    }

    /// Removes the oldest part if there are too many. That it cannot be removed is no reason to write nothing more: it
    /// is tried again with the next part.
    fn remove_oldest(&mut self) -> Oldest {
        let mut oldest = Oldest::Stays;
        while self.kept.len() as u64 > PARTS
            && let Some(path) = self.kept.pop_front()
        {
            match self.disk.remove(&path) {
                Ok(()) => oldest = Oldest::Removed(path),
                // Somebody has removed or moved it.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => {
                    self.kept.push_front(path.clone());
                    return Oldest::Refuses(path, error);
                }
            }
        }
        oldest
    }

    /// The present file for the thread that puts it on the disk.
    pub(super) fn twin(&self) -> Option<File> {
        self.file.twin()
    }

    /// Ends the recording and puts it on the disk.
    pub(super) fn end(&mut self) -> io::Result<()> {
        let mut end = Vec::new();
        append(&mut end, BlockKind::End, [u64::MAX, wall_ns()], 0, &[]);
        self.write(&end)?;
        self.file.sync()
    }
}

/// The path of a part: `flight.phugoid-live`, `flight.2.phugoid-live`, ...
fn numbered(path: &Path, number: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    match path.extension() {
        Some(extension) => path.with_file_name(format!("{stem}.{number}.{}", extension.to_string_lossy())),
        None => path.with_file_name(format!("{stem}.{number}")),
    }
}
