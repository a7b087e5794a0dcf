//! How fast a log is read: repeats a small one to a large file, and reads that plainly, as a survey, and one topic of it.
//!
//!     cargo run --release -p phugoid-flight-data --example log_speed -- flight.ulg TOPIC [MEGABYTES]
//!
//! Speeds are by the clock on the wall and, where Linux tells it, by the time that this program had a processor: on a machine that
//! others use too only the second says what the reader costs. The file lies in the folder for temporary files and is removed afterwards. Megabytes are of 10^6 bytes.

#[path = "clock/mod.rs"]
mod clock;

use std::error::Error;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use clock::Clock;
use phugoid_flight_data::format::Format;
use phugoid_flight_data::log::{self, Selection};
use phugoid_flight_data::memory::Memory;

struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(name), Some(topic)) = (arguments.next(), arguments.next()) else {
        return Err("usage: log_speed LOG TOPIC [MEGABYTES]".into());
    };
    let megabytes: usize = arguments.next().map_or(Ok(1000), |text| text.parse())?;
    let file = Temporary(std::env::temp_dir().join(format!("phugoid-log-speed-{}", std::process::id())));
    let bytes = write(&std::fs::read(&name)?, &file.0, megabytes * 1_000_000)?;
    println!("{name} repeated to {:.0} MB", bytes as f64 / 1e6);

    // Twice: the first time brings it into the cache, if it fits.
    for what in ["plain reading, the first time", "plain reading"] {
        let clock = Clock::start();
        plain(&file.0)?;
        say(what, bytes, &clock, "");
    }

    forget_peak();
    let clock = Clock::start();
    let survey = log::survey_path(&file.0)?;
    let samples: usize = survey.topics.iter().map(|topic| topic.samples).sum();
    let detail = format!("{samples} samples, peak {} MiB", peak_mib());
    say("survey: counts, times, ranges of every field", bytes, &clock, &detail);
    drop(survey);

    forget_peak();
    let clock = Clock::start();
    let log =
        log::read_path(&file.0, &Selection { max_memory: Memory::UNBOUNDED, ..Selection::topics([topic.as_str()]) })?;
    let values: usize = log.topics.iter().map(|topic| topic.time_s.len() * (topic.fields.len() + 1)).sum();
    let detail = format!("{values} values kept are {} MiB, peak {} MiB", values * 8 / (1 << 20), peak_mib());
    say(&format!("topic {topic}"), bytes, &clock, &detail);
    Ok(())
}

fn say(what: &str, bytes: usize, clock: &Clock, detail: &str) {
    let megabytes = bytes as f64 / 1e6;
    let wall_s = clock.wall_s();
    print!("{what}: {wall_s:.2} s, {:.0} MB/s", megabytes / wall_s);
    if let Some(processor_s) = clock.processor_s() {
        print!("; {processor_s:.2} s on a processor, {:.0} MB/s", megabytes / processor_s);
    }
    println!("{}{detail}", if detail.is_empty() { "" } else { "; " });
}

/// Repeats what comes after the definitions; gives the length of the file.
fn write(log: &[u8], path: &Path, bytes: usize) -> Result<usize, Box<dyn Error>> {
    let start = match Format::sniff(log) {
        Format::Ulog => {
            let mut at = 16;
            while let Some(&[low, high, kind]) = log.get(at..).and_then(|rest| rest.first_chunk()) {
                if kind == b'D' {
                    break;
                }
                at += 3 + usize::from(u16::from_le_bytes([low, high]));
            }
            at
        }
        _ => 0,
    };
    let (head, data) = log.split_at_checked(start).ok_or("the log is cut")?;
    let mut file = File::create(path)?;
    file.write_all(head)?;
    let mut written = head.len();
    while written < bytes && !data.is_empty() {
        file.write_all(data)?;
        written += data.len();
    }
    Ok(written)
}

fn plain(path: &Path) -> Result<(), Box<dyn Error>> {
    let mut file = File::open(path)?;
    let mut buffer = vec![0; 1 << 20];
    while file.read(&mut buffer)? > 0 {}
    Ok(())
}

/// Begins a new peak of the resident memory (Linux).
fn forget_peak() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

fn peak_mib() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<u64>().ok());
    kib.map_or_else(|| "unknown".into(), |kib| (kib / 1024).to_string())
}
