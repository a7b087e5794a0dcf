//! Every entry of the reproduction against the numbers committed in `tests/golden/`, so that a change of behaviour is seen
//! as a difference. After a change that is wanted,
//! `PHUGOID_WRITE_GOLDEN=1 cargo test -p phugoid-thesis --test integration golden::` rewrites them; look at what
//! `git diff` shows before you commit it.

// What goes wrong here fails the test.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use phugoid_thesis::golden::{differences, file_name, read, write};
use phugoid_thesis::{Entry, entries};
use rayon::prelude::*;

/// Differences told per entry; a changed estimator differs in hundreds.
const MOST: usize = 6;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// What is wrong with an entry, a line each.
fn check(entry: &Entry, writing: bool) -> Vec<String> {
    let id = entry.id;
    let found = match (entry.run)(id, &|_| {}) {
        Ok(reproduction) => reproduction.golden,
        Err(error) => return vec![format!("{id} does not run: {error}")],
    };
    if found.columns.is_empty() || found.rows.is_empty() {
        return vec![format!("{id} gives no golden numbers")];
    }
    let text = match write(&found) {
        Ok(text) => text,
        Err(error) => return vec![format!("{id}: its golden numbers are no table: {error}")],
    };
    let path = folder().join(file_name(id));
    if writing {
        std::fs::write(&path, text).unwrap();
        return Vec::new();
    }
    let committed = match std::fs::read_to_string(&path) {
        Ok(text) => read(&text).unwrap(),
        Err(error) => return vec![format!("{id}: {} cannot be read: {error}", file_name(id))],
    };
    let all = differences(&found, &committed);
    let mut told: Vec<String> = all.iter().take(MOST).map(|d| format!("{id}: {d}")).collect();
    if all.len() > MOST {
        told.push(format!("{id}: and {} more", all.len() - MOST));
    }
    told
}

#[test]
fn every_entry_gives_its_committed_numbers() {
    let writing = std::env::var_os("PHUGOID_WRITE_GOLDEN").is_some();
    let entries = entries();
    if writing {
        std::fs::create_dir_all(folder()).unwrap();
    }
    let mut wrong: Vec<String> = entries.par_iter().with_max_len(1).flat_map_iter(|e| check(e, writing)).collect();

    let expected: BTreeSet<String> = entries.iter().map(|e| file_name(e.id)).collect();
    let present = std::fs::read_dir(folder()).map(|found| found.map(|f| f.unwrap().file_name()).collect::<Vec<_>>());
    for file in present.unwrap_or_default() {
        let name = file.to_string_lossy().into_owned();
        if !expected.contains(&name) {
            if writing {
                std::fs::remove_file(folder().join(&name)).unwrap();
            } else {
                wrong.push(format!("{name} belongs to no entry"));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{}\nIf this is meant, write them anew with PHUGOID_WRITE_GOLDEN=1 and look at the difference.",
        wrong.join("\n")
    );
}

#[test]
fn ids_and_files_are_one_to_one() {
    let entries = entries();
    let files: BTreeSet<String> = entries.iter().map(|e| file_name(e.id)).collect();
    assert_eq!(files.len(), entries.len(), "two entries share an id or a file");
}
