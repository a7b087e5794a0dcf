//! Files of which a few bytes ask for much memory. Each is read in a process of its own, whose address space is limited, because an
//! allocation that fails ends the process that asked for it.
#![cfg(target_os = "linux")]

use crate::hostile;

use std::path::{Path, PathBuf};
use std::process::Command;

use phugoid_flight_data::log::{self, Selection};
use phugoid_flight_data::reader::{self, ReadOptions};

/// Names the folder of the files that the child reads.
const FILES: &str = "PHUGOID_TEST_FILES";
/// The limit of the child's address space, KiB.
const ADDRESS_SPACE_KIB: u64 = 1 << 20;
/// The most that a reader of a file may need in fact, MiB: the budget of 200 MB, the program itself, and what the allocator keeps.
const MOST_MIB: u64 = 300;

/// What the child says of its memory: the most that it ever had, MiB.
const PEAK: &str = "peak MiB ";

/// Reads every file of the folder, surveyed and not, and says how much memory that took. Runs only as a child of the other tests.
#[test]
#[ignore = "the child of the other tests of this file"]
fn child() {
    let Some(folder) = std::env::var_os(FILES) else { return };
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        println!("reads {name}");
        let said = match reader::read_path(&file, &ReadOptions::default()) {
            Ok(record) => format!("{} rows", record.len()),
            Err(error) => error.to_string(),
        };
        println!("said of {name}: {}", said.replace('\n', " "));
        drop(reader::survey_path(&file, &ReadOptions::default()));
        // As a log it is read whole, not only what makes a record.
        drop(log::read_path(&file, &Selection::default()));
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    let kib: u64 = peak.trim().trim_end_matches("kB").trim().parse().unwrap();
    println!("{PEAK}{}", kib / 1024);
}

/// Runs the child on a folder and returns what it printed, after checking that it ended well and within the memory.
#[track_caller]
fn read_in_child(folder: &Path) -> String {
    let output = Command::new("sh")
        .args(["-c", "ulimit -v $0; exec \"$@\""])
        .arg(ADDRESS_SPACE_KIB.to_string())
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "memory::child", "--ignored", "--nocapture", "--test-threads=1"])
        .env(FILES, folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let last = said.lines().rfind(|line| line.starts_with("reads ")).unwrap_or_default();
    let complained = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{last}: {}\n{complained}", output.status);
    let peak: u64 = said.lines().find_map(|line| line.strip_prefix(PEAK)).unwrap().parse().unwrap();
    assert!(peak <= MOST_MIB, "{peak} MiB were needed, more than {MOST_MIB}: {said}");
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

/// Each alone, so that one that ends its process does not hide the others.
#[test]
fn a_file_gets_no_more_memory_than_the_budget() {
    let mut failed = Vec::new();
    for (name, bytes) in hostile::files() {
        let folder = Folder::new(name);
        std::fs::write(folder.0.join(name), bytes).unwrap();
        match std::panic::catch_unwind(|| read_in_child(&folder.0)) {
            Ok(said) => print!("{said}"),
            Err(_) => failed.push(name),
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}
