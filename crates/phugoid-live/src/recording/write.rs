//! Writing a recording on threads of its own, so that the estimation never waits for the disk.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::block::{Block, BlockKind, append};
use super::header::Header;
use super::parts::{Disk, FileSystem, Oldest, Parts};
use crate::arrival::Arrival;
use crate::budget::Budget;

/// Data are handed to the operating system within this time. A kill of the program loses no more than that.
const WRITE_WITHIN: Duration = Duration::from_millis(50);
/// Time between two attempts while the disk takes nothing.
const TRY_AGAIN: Duration = Duration::from_millis(250);
/// Data are put on the disk at this interval. A loss of power loses no more than about that, if the disk does what it
/// reports.
const SYNC_INTERVAL: Duration = Duration::from_secs(1);
/// Bytes of the arrivals that may wait for a slow or full disk: two minutes at 2400 messages a second.
const WAITING_BYTES: usize = 64 << 20;
/// Bytes that are written at once at most.
const AT_ONCE: usize = 1 << 20;

/// Counts of the recorder, shared with its thread.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    bytes: Arc<AtomicU64>,
    dropped: Arc<AtomicU64>,
    failing: Arc<AtomicBool>,
    news: Arc<Mutex<Vec<String>>>,
}

impl Recorded {
    /// Bytes handed to the operating system so far, in all parts.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Number of arrivals that were not recorded because the disk was too slow or full for too long.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Whether the last attempt to write has failed, as on a full disk. It is tried again.
    pub fn failed(&self) -> bool {
        self.failing.load(Ordering::Relaxed)
    }

    /// What happened since the last call, as sentences for people: the disk is full, it is written again, how much was
    /// lost, a part was removed.
    pub fn take_news(&self) -> Vec<String> {
        std::mem::take(&mut *self.news.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn say(&self, sentence: String) {
        self.news.lock().unwrap_or_else(PoisonError::into_inner).push(sentence);
    }
}

/// What waits for the recorder's thread, in the order of the file.
enum Entry {
    Arrival(Arrival),
    /// So many arrivals are missing here.
    Gap(u64),
}

/// Writes a recording while it is received. [`write_whole`] writes one at once.
pub struct Recorder {
    queue: Option<Sender<Entry>>,
    budget: Arc<Budget>,
    /// Arrivals that were dropped since the last one that was not.
    missing: AtomicU64,
    /// Nothing further comes.
    ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<io::Result<()>>>,
    recorded: Recorded,
}

impl Recorder {
    /// Creates the file and writes the header. Only the user who runs the program may read the file.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if the file exists; else what the operating system says.
    pub fn create(path: &Path, header: &Header) -> io::Result<Self> {
        Self::create_limited(path, header, None)
    }

    /// The same with a limit of the size, bytes. It is written in parts of a quarter of it (`flight.phugoid-live`,
    /// `flight.2.phugoid-live`, ...), each of which can be replayed alone, and the oldest is removed when a fifth
    /// begins.
    ///
    /// # Errors
    /// As [`Recorder::create`].
    pub fn create_limited(path: &Path, header: &Header, limit: Option<u64>) -> io::Result<Self> {
        Self::create_on(Box::new(FileSystem), path, header, limit, WAITING_BYTES)
    }

    fn create_on(
        disk: Box<dyn Disk>,
        path: &Path,
        header: &Header,
        limit: Option<u64>,
        waiting_bytes: usize,
    ) -> io::Result<Self> {
        let mut first = Vec::new();
        append_header(&mut first, header)?;
        let recorded = Recorded::default();
        recorded.bytes.store(first.len() as u64, Ordering::Relaxed);
        let parts = Parts::create(disk, path, first, limit)?;
        let budget = Arc::new(Budget::new(waiting_bytes));
        // What waits is bounded in bytes.
        let (queue, arrivals) = mpsc::channel();
        let (shared, returned) = (recorded.clone(), Arc::clone(&budget));
        let ending = Arc::new(AtomicBool::new(false));
        let writing = Writing {
            parts,
            recorded: shared,
            budget: returned,
            ending: Arc::clone(&ending),
            said_dropped: 0,
            failing: None,
        };
        let thread = std::thread::Builder::new().name("recorder".to_owned()).spawn(move || writing.run(&arrivals))?;
        Ok(Self { queue: Some(queue), budget, missing: AtomicU64::new(0), ending, thread: Some(thread), recorded })
    }

    /// Hands over an arrival. This never waits: if the disk is too far behind, the arrival is dropped and counted.
    pub fn record(&self, arrival: Arrival) {
        let bytes = arrival.size();
        let Some(queue) = &self.queue else { return };
        let taken = self.budget.try_take(bytes);
        if taken {
            self.send_gap(queue);
        }
        if taken && queue.send(Entry::Arrival(arrival)).is_ok() {
            return;
        }
        if taken {
            self.budget.give_back(bytes);
        }
        self.missing.fetch_add(1, Ordering::Relaxed);
        self.recorded.dropped.fetch_add(1, Ordering::Relaxed);
    }

    /// Notes where arrivals are missing: behind what waits, before what comes next.
    fn send_gap(&self, queue: &Sender<Entry>) {
        let missing = self.missing.swap(0, Ordering::Relaxed);
        if missing > 0 {
            // If the thread is gone, there is no file to note it in; the arrivals are counted.
            let _ = queue.send(Entry::Gap(missing));
        }
    }

    /// The counts, which go on changing while the recorder writes.
    pub fn recorded(&self) -> Recorded {
        self.recorded.clone()
    }

    /// Writes the arrivals that still wait and the end, and puts everything on the disk.
    ///
    /// # Errors
    /// What the operating system said when writing failed, also in a last attempt now, with the number of packets that
    /// are missing in the recording by that.
    pub fn finish(mut self) -> io::Result<()> {
        if let Some(queue) = self.queue.take() {
            self.send_gap(&queue);
        }
        self.ending.store(true, Ordering::Relaxed);
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(io::Error::other("the recorder has stopped")),
            None => Ok(()),
        }
    }
}

/// Writes a whole recording with its end: for conversions and tests. Stamps must not decrease from one arrival to the
/// next.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_whole<'a>(
    mut out: impl Write,
    header: &Header,
    arrivals: impl IntoIterator<Item = &'a Arrival>,
) -> io::Result<()> {
    let mut buffer = Vec::new();
    append_header(&mut buffer, header)?;
    let mut last_ns = [0, header.started_wall_ns];
    for arrival in arrivals {
        append_arrival(&mut buffer, arrival);
        last_ns = [arrival.arrival_ns, arrival.wall_ns];
        out.write_all(&buffer)?;
        buffer.clear();
    }
    append(&mut buffer, BlockKind::End, last_ns, 0, &[]);
    out.write_all(&buffer)
}

fn append_header(buffer: &mut Vec<u8>, header: &Header) -> io::Result<()> {
    let text = serde_json::to_vec(header).map_err(io::Error::other)?;
    append(buffer, BlockKind::Header, [0, header.started_wall_ns], 0, &text);
    Ok(())
}

fn append_arrival(buffer: &mut Vec<u8>, arrival: &Arrival) {
    let (kind, content) = Block::of(arrival);
    append(buffer, kind, [arrival.arrival_ns, arrival.wall_ns], arrival.origin, content);
}

/// The recorder's thread.
struct Writing {
    parts: Parts,
    recorded: Recorded,
    budget: Arc<Budget>,
    /// Nothing further comes: what a full disk does not take now, it never takes.
    ending: Arc<AtomicBool>,
    /// Arrivals that were dropped and have been told of.
    said_dropped: u64,
    /// Since when nothing can be written.
    failing: Option<Instant>,
}

/// Blocks that are not in the file yet.
#[derive(Default)]
struct Pending {
    blocks: Vec<u8>,
    /// Number of the arrivals in them.
    arrivals: u64,
    /// Bytes that these arrivals took in the queue.
    taken: usize,
    /// Stamps of the last arrival.
    stamps: [u64; 2],
}

impl Pending {
    /// Takes entries of the queue until there is enough to write. True if it is empty and nothing further comes.
    fn fill(&mut self, entries: &Receiver<Entry>, parts: &mut Parts, at_once: usize) -> bool {
        while self.blocks.len() < at_once {
            match entries.try_recv() {
                Ok(Entry::Arrival(arrival)) => {
                    self.arrivals += 1;
                    self.taken += arrival.size();
                    self.stamps = [arrival.arrival_ns, arrival.wall_ns];
                    parts.note(&arrival);
                    append_arrival(&mut self.blocks, &arrival);
                }
                Ok(Entry::Gap(missing)) => {
                    append(&mut self.blocks, BlockKind::Gap, self.stamps, 0, &missing.to_le_bytes());
                }
                Err(TryRecvError::Empty) => return false,
                Err(TryRecvError::Disconnected) => return true,
            }
        }
        false
    }
}

impl Writing {
    /// Writes arrivals until their sender is gone, then the end.
    fn run(mut self, entries: &Receiver<Entry>) -> io::Result<()> {
        // Putting data on the disk may take long, so another thread does it.
        let (sync, wanted) = mpsc::sync_channel::<File>(1);
        let syncing = std::thread::Builder::new().name("recorder-sync".to_owned()).spawn(move || {
            while let Ok(file) = wanted.recv() {
                // If this fails, the data are still with the operating system; nothing else can be done.
                let _ = file.sync_data();
            }
        })?;
        let mut synced = Instant::now();
        let mut pending = Pending::default();
        // A part ends with the write that makes it long enough, and may not be much longer than it should be.
        let of_part = self.parts.part_bytes().map_or(AT_ONCE, |most| usize::try_from(most / 16).unwrap_or(AT_ONCE));
        let at_once = of_part.clamp(1, AT_ONCE);
        let result = loop {
            // The thread sleeps most of the time, because waking up for every arrival would cost more than writing.
            std::thread::sleep(if self.failing.is_some() { TRY_AGAIN } else { WRITE_WITHIN / 2 });
            // Asked before the attempt: after it the disk has had its last chance.
            let is_last = self.ending.load(Ordering::Relaxed);
            let written = loop {
                let ended = pending.fill(entries, &mut self.parts, at_once);
                let more = pending.blocks.len() >= at_once;
                match self.attempt(&mut pending) {
                    Ok(()) if more => {}
                    Ok(()) => break Ok(ended),
                    Err(error) => break Err(error),
                }
            };
            match written {
                Ok(true) => break self.parts.end(),
                Err(error) if is_last => {
                    // However much waits: a disk that stays full would never take it.
                    let waiting = entries.try_iter().filter(|entry| matches!(entry, Entry::Arrival(_))).count();
                    let lost = pending.arrivals + waiting as u64;
                    break Err(io::Error::new(
                        error.kind(),
                        format!("{error}; of what was received last {} could not be written", packets(lost)),
                    ));
                }
                Ok(false) | Err(_) => {}
            }
            if synced.elapsed() >= SYNC_INTERVAL {
                // A full queue means that the other thread is still at work.
                let _ = self.parts.twin().map(|file| sync.try_send(file));
                synced = Instant::now();
            }
        };
        drop(sync);
        let _ = syncing.join();
        result
    }

    /// Tries to write what waits, and says when that stops or begins to succeed.
    fn attempt(&mut self, pending: &mut Pending) -> io::Result<()> {
        let written = self.parts.rotate(pending.stamps).and_then(|rotated| {
            self.parts.write(&pending.blocks)?;
            Ok(rotated)
        });
        let (further, oldest) = match written {
            Ok(rotated) => rotated,
            Err(error) => {
                if self.failing.is_none() {
                    self.failing = Some(Instant::now());
                    self.recorded.failing.store(true, Ordering::Relaxed);
                    self.recorded.say(format!(
                        "the recording cannot be written ({error}): it is tried again, and what comes waits meanwhile"
                    ));
                }
                return Err(error);
            }
        };
        self.recorded.bytes.fetch_add(pending.blocks.len() as u64 + further, Ordering::Relaxed);
        self.budget.give_back(std::mem::take(&mut pending.taken));
        pending.blocks.clear();
        pending.arrivals = 0;
        match oldest {
            Oldest::Stays => {}
            Oldest::Removed(path) => {
                self.recorded.say(format!("the recording has reached its limit: {} was removed", path.display()));
            }
            Oldest::Refuses(path, error) => self
                .recorded
                .say(format!("the recording is larger than its limit: {} cannot be removed ({error})", path.display())),
        }
        let dropped = self.recorded.dropped();
        let lost = dropped - std::mem::replace(&mut self.said_dropped, dropped);
        if let Some(since) = self.failing.take() {
            self.recorded.failing.store(false, Ordering::Relaxed);
            let seconds = since.elapsed().as_secs_f64();
            self.recorded.say(format!("the recording goes on after {seconds:.1} s; {}", lost_words(lost)));
        } else if lost > 0 {
            self.recorded.say(format!("the disk is too slow for the recording; {}", lost_words(lost)));
        }
        Ok(())
    }
}

fn packets(number: u64) -> String {
    if number == 1 { "one packet".to_owned() } else { format!("{number} packets") }
}

fn lost_words(lost: u64) -> String {
    match lost {
        0 => "nothing was lost".to_owned(),
        lost => format!("{} {} missing in it", packets(lost), if lost == 1 { "is" } else { "are" }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arrival::Content;
    use crate::recording::Reader;
    use crate::recording::parts::DiskFile;
    use std::collections::BTreeMap;
    use std::path::PathBuf;

    /// A disk in memory with room for so many bytes.
    #[derive(Clone, Default)]
    struct Memory(Arc<Mutex<Shelf>>);

    #[derive(Default)]
    struct Shelf {
        files: BTreeMap<PathBuf, Vec<u8>>,
        room: usize,
        /// Nothing may be removed.
        keeps: bool,
    }

    struct MemoryFile(Memory, PathBuf);

    impl Memory {
        fn room(&self, room: usize) {
            self.0.lock().unwrap().room = room;
        }

        fn file(&self, path: &str) -> Vec<u8> {
            self.0.lock().unwrap().files[Path::new(path)].clone()
        }

        fn names(&self) -> Vec<String> {
            self.0.lock().unwrap().files.keys().map(|path| path.display().to_string()).collect()
        }
    }

    impl Disk for Memory {
        fn create(&self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
            let mut shelf = self.0.lock().unwrap();
            if shelf.room == 0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            assert_eq!(shelf.files.insert(path.to_owned(), Vec::new()), None);
            Ok(Box::new(MemoryFile(self.clone(), path.to_owned())))
        }

        fn remove(&self, path: &Path) -> io::Result<()> {
            if self.0.lock().unwrap().keeps {
                return Err(io::ErrorKind::PermissionDenied.into());
            }
            self.0.lock().unwrap().files.remove(path).map(|_| ()).ok_or(io::ErrorKind::NotFound.into())
        }
    }

    impl Write for MemoryFile {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let mut shelf = self.0.0.lock().unwrap();
            let part = bytes.len().min(shelf.room);
            if part == 0 && !bytes.is_empty() {
                return Err(io::ErrorKind::StorageFull.into());
            }
            shelf.room -= part;
            shelf.files.get_mut(&self.1).unwrap().extend(&bytes[..part]);
            Ok(part)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl DiskFile for MemoryFile {
        fn cut(&mut self, length: u64) -> io::Result<()> {
            self.0.0.lock().unwrap().files.get_mut(&self.1).unwrap().truncate(length as usize);
            Ok(())
        }

        fn twin(&self) -> Option<File> {
            None
        }

        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn datagram(k: u64) -> Arrival {
        let content = Content::Datagram(format!("row {k}, {}", "x".repeat(80)).into_bytes());
        Arrival { arrival_ns: k, wall_ns: k, origin: 0, content }
    }

    fn opened() -> Arrival {
        Arrival { arrival_ns: 0, wall_ns: 0, origin: 0, content: Content::Opened("udp 127.0.0.1:1".to_owned()) }
    }

    /// The arrivals in a file, and how many are missing.
    fn read(bytes: &[u8]) -> (Vec<Arrival>, u64) {
        let mut reader = Reader::from_input(bytes, "test").unwrap();
        let mut arrivals = Vec::new();
        while let Some(arrival) = reader.next_arrival().unwrap() {
            arrivals.push(arrival);
        }
        let damage = reader.damage();
        assert!(damage.skipped_bytes == 0 && damage.cut_off_bytes == 0 && damage.ended, "{damage:?}");
        (arrivals, damage.lost_arrivals)
    }

    fn until(what: impl Fn() -> bool) {
        let start = Instant::now();
        while !what() {
            assert!(start.elapsed() < Duration::from_secs(60), "it does not come");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn a_recording_goes_on_after_a_full_disk_and_says_what_is_missing() {
        for waiting_bytes in [usize::MAX, 20_000] {
            let disk = Memory::default();
            // Full in the middle of a block.
            disk.room(1234);
            let recorder =
                Recorder::create_on(Box::new(disk.clone()), Path::new("f"), &Header::default(), None, waiting_bytes);
            let recorder = recorder.unwrap();
            let recorded = recorder.recorded();
            (0..100).for_each(|k| recorder.record(datagram(k)));
            until(|| recorded.failed());
            (100..1000).for_each(|k| recorder.record(datagram(k)));
            assert!(recorded.take_news()[0].contains("tried again"));
            disk.room(1 << 30);
            until(|| !recorded.failed());
            (1000..1100).for_each(|k| recorder.record(datagram(k)));
            let dropped = recorded.dropped();
            recorder.finish().unwrap();
            let (arrivals, lost) = read(&disk.file("f"));
            assert_eq!((lost, arrivals.len() as u64), (dropped, 1100 - dropped));
            assert_eq!(dropped > 0, waiting_bytes != usize::MAX);
            // Before and after it nothing is missing.
            let kept: Vec<u64> = arrivals.iter().map(|arrival| arrival.arrival_ns).collect();
            assert!(
                kept.starts_with(&(0..100).collect::<Vec<_>>()) && kept.ends_with(&(1000..1100).collect::<Vec<_>>())
            );
            let news = recorded.take_news().concat();
            assert!(news.contains("goes on") && news.contains("nothing was lost") == (dropped == 0), "{news}");
        }
    }

    /// However much waits: more than is written at once, too.
    #[test]
    fn a_disk_that_stays_full_is_an_error_at_the_end() {
        for number in [100, 20_000] {
            let disk = Memory::default();
            disk.room(1000);
            let recorder = Recorder::create_on(Box::new(disk), Path::new("f"), &Header::default(), None, 1 << 30);
            let recorder = recorder.unwrap();
            (0..number).for_each(|k| recorder.record(datagram(k)));
            let (tell, told) = mpsc::channel();
            std::thread::spawn(move || tell.send(recorder.finish()));
            let error = told.recv_timeout(Duration::from_secs(60)).expect("it does not end").unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::StorageFull);
            let said = error.to_string();
            assert!(said.contains(&format!("{number} packets could not be written")), "{said}");
        }
    }

    /// The note of what is missing stands where it is missing: behind all that waited, before all that came later.
    #[test]
    fn a_gap_is_noted_where_it_is() {
        let disk = Memory::default();
        disk.room(1000);
        // Several times what is written at once may wait.
        let waiting = 4 * AT_ONCE;
        let recorder =
            Recorder::create_on(Box::new(disk.clone()), Path::new("f"), &Header::default(), None, waiting).unwrap();
        let recorded = recorder.recorded();
        let before = waiting as u64 / datagram(0).size() as u64 * 2;
        (0..before).for_each(|k| recorder.record(datagram(k)));
        let dropped = recorded.dropped();
        assert!(dropped > 1000, "{dropped}");
        until(|| recorded.failed());
        disk.room(1 << 30);
        until(|| !recorded.failed());
        (before..before + 10).for_each(|k| recorder.record(datagram(k)));
        assert_eq!(recorded.dropped(), dropped);
        recorder.finish().unwrap();
        let file = disk.file("f");
        let mut reader = Reader::from_input(file.as_slice(), "test").unwrap();
        let (mut next, mut lost) = (0, 0);
        while let Some(arrival) = reader.next_arrival().unwrap() {
            let skipped = reader.damage().lost_arrivals - lost;
            lost += skipped;
            assert_eq!(arrival.arrival_ns, next + skipped);
            next = arrival.arrival_ns + 1;
        }
        assert_eq!((next, lost), (before + 10, dropped));
    }

    #[test]
    fn with_a_limit_the_oldest_part_goes_and_each_can_be_read_alone() {
        let disk = Memory::default();
        disk.room(1 << 30);
        let path = Path::new("a.b");
        let recorder = Recorder::create_on(Box::new(disk.clone()), path, &Header::default(), Some(40_000), 1 << 30);
        let recorder = recorder.unwrap();
        let recorded = recorder.recorded();
        recorder.record(opened());
        let header = Content::Datagram(b"time_s,alpha_deg\n0,1".to_vec());
        recorder.record(Arrival { arrival_ns: 0, wall_ns: 0, origin: 0, content: header });
        for k in 0..1000 {
            recorder.record(datagram(k));
            if k % 50 == 0 {
                let before = recorded.bytes();
                until(|| recorded.bytes() > before);
            }
        }
        recorder.finish().unwrap();
        let names = disk.names();
        assert_eq!(names.len(), 4, "{names:?}");
        assert!(!names.contains(&"a.b".to_owned()) && names.iter().all(|name| name.starts_with("a.")), "{names:?}");
        let mut last = None;
        let mut numbers: Vec<u32> = names.iter().map(|name| name.split('.').nth(1).unwrap().parse().unwrap()).collect();
        numbers.sort_unstable();
        for number in numbers {
            let bytes = disk.file(&format!("a.{number}.b"));
            assert!(bytes.len() < 20_000, "{}", bytes.len());
            let (arrivals, _) = read(&bytes);
            assert_eq!(arrivals[0].content, opened().content);
            assert_eq!(arrivals[1].content, Content::Datagram(b"time_s,alpha_deg\n".to_vec()));
            // One part goes on where the one before it ends.
            let first = arrivals[2].arrival_ns;
            assert!(last.is_none_or(|last| first == last + 1), "{last:?} {first}");
            last = arrivals.last().map(|arrival| arrival.arrival_ns);
        }
        assert_eq!(last, Some(999));
        assert!(recorded.take_news().iter().any(|text| text.contains("a.b was removed")));
    }

    /// The disk may be full at any byte: within a block, at the end of a part, in the beginning of the next one. Once
    /// there is room, all goes on where it was.
    #[test]
    fn a_disk_that_is_full_at_any_byte_of_a_rotation_loses_nothing() {
        let mut header = Vec::new();
        append_header(&mut header, &Header::default()).unwrap();
        let (path, most) = (Path::new("a.b"), 4 * (header.len() as u64 + 300));
        let mut refused = 0;
        for room in header.len()..header.len() + 1200 {
            let disk = Memory::default();
            disk.room(room);
            let mut parts = Parts::create(Box::new(disk.clone()), path, header.clone(), Some(most)).unwrap();
            parts.note(&opened());
            for k in 0..9 {
                let mut blocks = Vec::new();
                append_arrival(&mut blocks, &datagram(k));
                // As the thread does it: what was not written is written again.
                while parts.rotate([k, k]).and_then(|_| parts.write(&blocks)).is_err() {
                    refused += 1;
                    disk.room(1 << 20);
                }
            }
            parts.end().unwrap();
            let mut numbers = Vec::new();
            for name in disk.names() {
                let arrivals = read(&disk.file(&name)).0.into_iter();
                numbers.extend(
                    arrivals
                        .filter(|a| *a != Arrival { arrival_ns: a.arrival_ns, wall_ns: a.wall_ns, ..opened() })
                        .map(|a| a.arrival_ns),
                );
            }
            numbers.sort_unstable();
            assert_eq!(numbers, (0..9).collect::<Vec<_>>(), "{room}");
            assert!(disk.names().len() > 1, "{room}");
        }
        assert!(refused > 500, "{refused}");
    }

    /// A part that cannot be removed is said, and is no reason to record no more.
    #[test]
    fn a_part_that_stays_is_said() {
        let disk = Memory::default();
        disk.room(1 << 30);
        disk.0.lock().unwrap().keeps = true;
        let path = Path::new("a.b");
        let recorder = Recorder::create_on(Box::new(disk.clone()), path, &Header::default(), Some(8_000), 1 << 30);
        let recorder = recorder.unwrap();
        let recorded = recorder.recorded();
        for k in 0..200 {
            recorder.record(datagram(k));
            if k % 10 == 9 {
                let before = recorded.bytes();
                until(|| recorded.bytes() > before);
            }
        }
        recorder.finish().unwrap();
        assert!(disk.names().len() > 5, "{:?}", disk.names());
        let news = recorded.take_news().concat();
        assert!(
            news.contains("larger than its limit: a.b cannot be removed") && !news.contains("tried again"),
            "{news}"
        );
    }

    #[cfg(unix)]
    #[test]
    fn only_the_user_may_read_the_file() {
        use std::os::unix::fs::PermissionsExt;

        let path = std::env::temp_dir().join(format!("phugoid-mode-{}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        Recorder::create(&path, &Header::default()).unwrap().finish().unwrap();
        assert_eq!(std::fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        std::fs::remove_file(&path).unwrap();
    }
}
