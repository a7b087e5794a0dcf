//! How much memory the reading of a file may take, and how readers keep to it.
//!
//! Every reader counts what a file asks for before it allocates it: values, names, definitions, unpacked pages and
//! chunks. What needs more than the budget is refused with [`OverBudget`], which says how much it needs. A few million
//! bytes that every reader takes (windows onto the file, tables of its own) are not counted.
//!
//! ```
//! use phugoid_flight_data::memory::Memory;
//! use phugoid_flight_data::reader::{ReadOptions, read_path};
//! let options = ReadOptions::default().with_max_memory("1.5 GB".parse()?);
//! assert!(read_path("examples/flight.csv".as_ref(), &options).is_ok());
//! let options = ReadOptions::default().with_max_memory(Memory::from_bytes(1000));
//! let error = read_path("examples/flight.csv".as_ref(), &options).unwrap_err().to_string();
//! assert!(error.contains("the budget is 1 kB"), "{error}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::cell::Cell;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::rc::Rc;
use std::str::FromStr;

/// An amount of memory, in steps of one byte. As text it is a number with a unit, such as `500MB` or `1.5 GiB`: kB, MB
/// and GB are powers of 1000, KiB, MiB and GiB of 1024. The default is the budget of the readers, 200 MB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Memory(u64);

/// A text that is no amount of memory.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no amount of memory; write a number with a unit (kB, MB, GB, KiB, MiB, GiB), such as 500MB")]
pub struct NotMemory(String);

impl Memory {
    /// No bound, for what the caller has made himself.
    pub const UNBOUNDED: Self = Self(u64::MAX);

    /// This many bytes.
    pub const fn from_bytes(bytes: u64) -> Self {
        Self(bytes)
    }

    /// The number of bytes.
    pub const fn bytes(self) -> u64 {
        self.0
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self(200_000_000)
    }
}

impl FromStr for Memory {
    type Err = NotMemory;

    fn from_str(text: &str) -> Result<Self, NotMemory> {
        let wrong = || NotMemory(crate::wording::cut(text, 40));
        let trimmed = text.trim();
        let end = trimmed.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(trimmed.len());
        let (number, unit) = trimmed.split_at_checked(end).ok_or_else(wrong)?;
        let factor = match unit.trim().to_ascii_lowercase().as_str() {
            "kb" => 1e3,
            "mb" => 1e6,
            "gb" => 1e9,
            "kib" => 1024.0,
            "mib" => 1024.0 * 1024.0,
            "gib" => 1024.0 * 1024.0 * 1024.0,
            _ => return Err(wrong()),
        };
        let bytes = number.parse::<f64>().map_err(|_| wrong())? * factor;
        // Above a million gigabytes it is a slip of the pen.
        if (1.0..1e15).contains(&bytes) { Ok(Self(bytes as u64)) } else { Err(wrong()) }
    }
}

impl fmt::Display for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.0 as f64;
        let (value, unit) = match self.0 {
            0..1_000 => return write!(f, "{} bytes", self.0),
            1_000..1_000_000 => (bytes / 1e3, "kB"),
            1_000_000..1_000_000_000 => (bytes / 1e6, "MB"),
            _ => (bytes / 1e9, "GB"),
        };
        let text = if value < 10.0 { format!("{value:.1}") } else { format!("{value:.0}") };
        write!(f, "{} {unit}", text.trim_end_matches(".0"))
    }
}

/// A file needs more memory than its reader may take. Nothing of it is read then.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{source_name}{}: to read it {} {needs} of memory are needed, and the budget is {budget}. Raise the budget \
     (--max-memory {}, in code `max_memory`), or read less: fewer columns or topics, or a shorter span of time",
    if place.is_empty() { String::new() } else { format!(", {place}") },
    if *at_least { "more than" } else { "about" },
    enough(*needs, *at_least)
)]
pub struct OverBudget {
    /// Name of the file or stream, as the caller gave it.
    pub source_name: String,
    /// Where the budget was reached: a line, a row, a variable, a topic or a byte; empty if that says nothing.
    pub place: String,
    /// What it needs, as far as can be told from what was read until then.
    pub needs: Memory,
    /// True if only a lower bound of the need is known.
    pub at_least: bool,
    /// What the reader may take.
    pub budget: Memory,
}

/// A round amount with some room above this need, and with as much again where that is only the least.
fn enough(needs: Memory, at_least: bool) -> String {
    let needs = Memory(needs.0.saturating_mul(1 + u64::from(at_least)));
    let step = match needs.0 {
        0..10_000_000 => 1_000_000,
        10_000_000..100_000_000 => 10_000_000,
        100_000_000..1_000_000_000 => 100_000_000,
        _ => 1_000_000_000,
    };
    let room = needs.0.saturating_add(needs.0 / 10);
    let rounded = Memory(room.div_ceil(step).saturating_mul(step));
    rounded.to_string().replace(' ', "")
}

/// More was asked for than is left of a budget; the number is what would be held then, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Excess(pub(crate) u64);

/// What one reading may take, and what it holds. Clones share one account.
#[derive(Clone, Debug)]
pub(crate) struct Account {
    budget: Memory,
    shared: Rc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    held: Cell<u64>,
    /// Length of the file, bytes; 0 if it is not known, as of a stream.
    length: Cell<u64>,
    /// Number of bytes of the file read so far.
    read: Cell<u64>,
}

impl Account {
    pub(crate) fn new(budget: Memory) -> Self {
        Self { budget, shared: Rc::default() }
    }

    /// Counts bytes that are about to be allocated and kept.
    #[inline]
    pub(crate) fn take(&self, bytes: u64) -> Result<(), Excess> {
        let held = self.shared.held.get().saturating_add(bytes);
        if held > self.budget.0 {
            return Err(Excess(held));
        }
        self.shared.held.set(held);
        Ok(())
    }

    /// Counts bytes that were freed.
    pub(crate) fn give_back(&self, bytes: u64) {
        self.shared.held.set(self.shared.held.get().saturating_sub(bytes));
    }

    /// Counts bytes that are held as long as the result lives.
    pub(crate) fn hold(&self, bytes: u64) -> Result<Held<'_>, Excess> {
        self.take(bytes)?;
        Ok(Held { account: self, bytes })
    }

    /// The bytes that are held.
    #[cfg(feature = "gzip")]
    pub(crate) fn held(&self) -> u64 {
        self.shared.held.get()
    }

    /// What may be taken in all.
    #[cfg(feature = "gzip")]
    pub(crate) fn budget(&self) -> Memory {
        self.budget
    }

    /// The bytes that may still be taken.
    #[cfg(any(test, feature = "matlab"))]
    pub(crate) fn left(&self) -> u64 {
        self.budget.0.saturating_sub(self.shared.held.get())
    }

    /// The error of a file that as a whole needs what is in excess.
    pub(crate) fn over(&self, Excess(needs): Excess, source: &str, place: impl Into<String>) -> OverBudget {
        let needs = Memory(needs);
        let source_name = source.to_owned();
        OverBudget { source_name, place: place.into(), needs, at_least: false, budget: self.budget }
    }

    /// The error of a file whose need grows as it is read. If its length is known, the whole need is estimated from the
    /// part that was read.
    pub(crate) fn over_so_far(&self, Excess(needs): Excess, source: &str, place: impl Into<String>) -> OverBudget {
        let (read, length) = (self.shared.read.get(), self.shared.length.get());
        let known = 0 < read && read < length;
        let share = if known { length as f64 / read as f64 } else { 1.0 };
        let needs = Excess((needs as f64 * share) as u64);
        OverBudget { at_least: !known, ..self.over(needs, source, place) }
    }

    /// Counts what is read of a file from here on, and notes its length.
    pub(crate) fn follow(&self, file: File) -> Followed {
        let length = file.metadata().ok().filter(std::fs::Metadata::is_file).map_or(0, |metadata| metadata.len());
        self.shared.length.set(length);
        self.shared.read.set(0);
        Followed { file, shared: Rc::clone(&self.shared) }
    }

    /// True if the file surely has fewer bytes than this; false if it may have them or its length is not known.
    #[cfg(any(feature = "mcap", feature = "parquet"))]
    pub(crate) fn file_is_shorter_than(&self, bytes: u64) -> bool {
        self.shared.length.get() > 0 && bytes > self.shared.length.get()
    }
}

/// Bytes that are counted as long as this lives.
#[derive(Debug)]
pub(crate) struct Held<'a> {
    account: &'a Account,
    bytes: u64,
}

impl Drop for Held<'_> {
    fn drop(&mut self) {
        self.account.give_back(self.bytes);
    }
}

/// A file whose account knows how much of it was read.
pub(crate) struct Followed {
    file: File,
    shared: Rc<Shared>,
}

impl Read for Followed {
    fn read(&mut self, target: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(target)?;
        self.shared.read.set(self.shared.read.get() + read as u64);
        Ok(read)
    }
}

/// A count of bytes as accounts take it.
pub(crate) fn many(count: usize, each: usize) -> u64 {
    (count as u64).saturating_mul(each as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_as_text() {
        for (text, bytes, shown) in [
            ("500MB", 500_000_000, "500 MB"),
            ("1.5 GB", 1_500_000_000, "1.5 GB"),
            ("64 KiB", 65_536, "66 kB"),
            ("200mb", 200_000_000, "200 MB"),
        ] {
            let memory: Memory = text.parse().unwrap();
            assert_eq!((memory.bytes(), memory.to_string().as_str()), (bytes, shown));
        }
        for text in ["", "500", "MB", "-1MB", "0MB", "1e3MB", "5 apples", "99999999999GB", "1.2.3MB", "µB"] {
            assert!(text.parse::<Memory>().is_err(), "{text}");
        }
    }

    #[test]
    fn an_account_counts_what_is_held() {
        let account = Account::new(Memory::from_bytes(100));
        account.take(60).unwrap();
        assert_eq!(account.take(60), Err(Excess(120)));
        {
            let _held = account.clone().hold(40).map(|held| std::mem::ManuallyDrop::new(held).bytes).unwrap();
        }
        assert_eq!(account.left(), 0);
        account.give_back(40);
        drop(account.hold(40).unwrap());
        assert_eq!(account.left(), 40);
        assert_eq!(account.take(u64::MAX), Err(Excess(u64::MAX)));
        let error = account.over_so_far(Excess(930_000_000), "a.csv", "line 7").to_string();
        assert!(error.starts_with("a.csv, line 7: to read it more than 930 MB of memory are needed"), "{error}");
        assert!(error.contains("(--max-memory 3GB,"), "{error}");
    }
}
