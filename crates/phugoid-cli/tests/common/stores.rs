//! What tests of stores share: their content, and a program that is killed until it has nothing left to do.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::common::Folder;

/// Every file of a store with its content.
pub(crate) fn content(store: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![store.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if !path.file_name().unwrap().to_string_lossy().starts_with(".phugoid-") {
                files.insert(path.strip_prefix(store).unwrap().to_owned(), fs::read(&path).unwrap());
            }
        }
    }
    files
}

/// Starts the program again and again and kills it, each time after another time, until one start ends by itself; how many were
/// killed. `after` makes a time of a number between 0 and 1 that covers the range evenly.
pub(crate) fn killed_until_it_ends(folder: &Folder, arguments: &[&str], after: impl Fn(f64) -> Duration) -> usize {
    for attempt in 0..60 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_phugoid"))
            .current_dir(&folder.0)
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(after((attempt as f64 * 0.618_034).fract()));
        if child.try_wait().unwrap().is_some() {
            return attempt;
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    panic!("no end after 60 starts");
}
