//! Files of which a few bytes ask for much memory. Each is read in a process of its own, whose address space is
//! limited, because an allocation that fails ends the process that asked for it.
#![cfg(target_os = "linux")]

use crate::{damaged, hostile};

use std::path::{Path, PathBuf};
use std::process::Command;

use phugoid_flight_data::log::{self, Selection};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::reader::{self, ReadOptions};

/// Names the folder of the files that the child reads.
const FILES: &str = "PHUGOID_TEST_FILES";
/// The budget that the child's readers have, as text.
const BUDGET: &str = "PHUGOID_TEST_BUDGET";
/// The limit of the child's address space, KiB.
const ADDRESS_SPACE_KIB: u64 = 1 << 20;

/// The numbers of damaged files that the child reads, first and last.
const DAMAGED: &str = "PHUGOID_TEST_DAMAGED";
/// What the child says of its memory: the most that it ever had, MiB.
const PEAK: &str = "peak MiB ";

/// Reads every file of the folder, or the damaged ones with these numbers, and says how much memory that took. Runs
/// only as a child of the other tests.
#[test]
#[ignore = "the child of the other tests of this file"]
fn child() {
    let Some(folder) = std::env::var_os(FILES).map(PathBuf::from) else { return };
    let budget: Memory = std::env::var(BUDGET).unwrap().parse().unwrap();
    if let Ok(numbers) = std::env::var(DAMAGED) {
        let (first, last) = numbers.split_once(' ').unwrap();
        let intact = damaged::intact();
        for number in first.parse().unwrap()..=last.parse().unwrap() {
            let (name, bytes) = damaged::file(&intact, number);
            println!("reads number {number}, made of {name}");
            let file = folder.join("damaged");
            std::fs::write(&file, bytes).unwrap();
            read_every_way(&file, budget);
        }
    } else {
        let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        for file in files {
            let name = file.file_name().unwrap().to_string_lossy().into_owned();
            println!("reads {name}");
            println!("said of {name}: {}", read_every_way(&file, budget).replace('\n', " "));
        }
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    let kib: u64 = peak.trim().trim_end_matches("kB").trim().parse().unwrap();
    println!("{PEAK}{}", kib / 1024);
}

/// Reads a file as a record, surveys it, and reads it whole if it is a log. Returns what came of it.
fn read_every_way(file: &Path, budget: Memory) -> String {
    let options = ReadOptions::default().with_max_memory(budget);
    let said = match reader::read_path(file, &options) {
        Ok(record) => format!("{} rows", record.len()),
        Err(error) => error.to_string(),
    };
    drop(reader::survey_path(file, &options));
    drop(log::read_path(file, &Selection { max_memory: budget, ..Selection::default() }));
    said
}

/// Runs the child on a folder and returns what it printed, after checking that it ended well and never had more than so
/// many MiB.
#[track_caller]
fn read_in_child(folder: &Path, damaged: Option<(u64, u64)>, budget: &str, most: u64) -> String {
    let mut command = Command::new("sh");
    if let Some((first, last)) = damaged {
        command.env(DAMAGED, format!("{first} {last}"));
    }
    let output = command
        .args(["-c", "ulimit -v $0; exec \"$@\""])
        .arg(ADDRESS_SPACE_KIB.to_string())
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "memory::child", "--ignored", "--nocapture", "--test-threads=1"])
        .env(FILES, folder)
        .env(BUDGET, budget)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let last = said.lines().rfind(|line| line.starts_with("reads ")).unwrap_or_default();
    let complained = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{last}: {}\n{complained}", output.status);
    let peak: u64 = said.lines().find_map(|line| line.strip_prefix(PEAK)).unwrap().parse().unwrap();
    assert!(peak <= most, "{peak} MiB were needed, more than {most}: {said}");
    said
}

/// A folder of its own for a test, removed when it is done.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("phugoid-memory-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Each alone, so that one that ends its process does not hide the others. The program itself takes 12 MiB, and the
/// allocator keeps a part of what is freed.
#[test]
fn a_file_gets_no_more_memory_than_the_budget() {
    let mut failed = Vec::new();
    for (name, bytes) in hostile::files() {
        let folder = Folder::new(name);
        std::fs::write(folder.0.join(name), bytes).unwrap();
        match std::panic::catch_unwind(|| read_in_child(&folder.0, None, "20MB", 60)) {
            Ok(said) => print!("{said}"),
            Err(_) => failed.push(name),
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

/// A damaged log may hold millions of definitions that deserve a finding; the report has the first and their number.
#[test]
fn findings_about_definitions_do_not_pile_up() {
    for (bytes, number) in [(hostile::many_complaints(), 5000), (hostile::redefined(), 9999)] {
        let quality = log::read(bytes.as_slice(), "x", &Selection::default()).unwrap().quality;
        assert!(quality.findings.len() < 100, "{}", quality.findings.len());
        let said = quality.to_string();
        assert!(said.contains(&format!("{number} findings about definitions; the first 50 are listed")), "{said}");
    }
}

/// The message names the file, the need, the budget and what to do.
#[test]
fn what_needs_too_much_is_told_what_it_needs() {
    let folder = Folder::new("told");
    let file = folder.0.join("flight.csv");
    let rows: String = (0..20_000).map(|row| format!("{row},{row}.5\n")).collect();
    std::fs::write(&file, format!("time_s,alpha_deg\n{rows}")).unwrap();
    let options = ReadOptions::default().with_max_memory("1MB".parse().unwrap());
    let error = reader::read_path(&file, &options).unwrap_err().to_string();
    assert!(error.starts_with(&format!("{}, line 125", file.display())), "{error}");
    let told =
        "to read it about 1.7 MB of memory are needed, and the budget is 1 MB. Raise the budget (--max-memory 2MB";
    assert!(error.contains(told), "{error}");
    let options = options.with_max_memory("2MB".parse().unwrap());
    assert_eq!(reader::read_path(&file, &options).unwrap().len(), 20_000);
}

/// Reads the damaged files with these numbers, a thousand in a process, with the budget that is the default.
fn damaged_files(count: u64) {
    let mut peak = 0;
    for first in (0..count).step_by(1000) {
        let folder = Folder::new(&format!("damaged-{count}-{first}"));
        let last = (first + 1000).min(count) - 1;
        let said = read_in_child(&folder.0, Some((first, last)), "200MB", 300);
        peak = peak.max(said.lines().find_map(|line| line.strip_prefix(PEAK)).unwrap().parse::<u64>().unwrap());
    }
    println!("{count} damaged files, at most {peak} MiB");
}

#[test]
fn damaged_files_end_no_process() {
    damaged_files(300);
}

/// `cargo test --profile quick -p phugoid-flight-data --features matlab,mcap,parquet --test integration -- --ignored
/// --nocapture twenty_thousand`; another number of files is given by `PHUGOID_DAMAGED_FILES`.
#[test]
#[ignore = "takes minutes"]
fn twenty_thousand_damaged_files_end_no_process() {
    damaged_files(std::env::var("PHUGOID_DAMAGED_FILES").map_or(20_000, |count| count.parse().unwrap()));
}
