//! Running the command as a user does.

// Each test file uses a part; what goes wrong here fails the test.
#![allow(dead_code, unused_imports, clippy::unwrap_used, clippy::panic)]

#[path = "../../../../tests/shared_data.rs"]
mod shared_data;

pub(crate) use shared_data::shared_file;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;

/// A folder of one test, removed at its end.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        // Tests of one program run side by side, and two may give the same name.
        static MADE: AtomicUsize = AtomicUsize::new(0);
        let number = MADE.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("phugoid-cli-{name}-{}-{number}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub(crate) struct Run {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Run {
    pub(crate) fn json(&self) -> Value {
        assert_eq!(self.code, Some(0), "{}", self.err);
        // One document and nothing else.
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}\n{}", self.out))
    }

    /// The document of a result, whatever it is worth: a refused one is written too, with the exit code 1,
    /// and one of a flight in which nothing moves with 5.
    pub(crate) fn json_of_any_result(&self) -> Value {
        assert!(matches!(self.code, Some(0 | 1 | 5)), "{}", self.err);
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}\n{}", self.out))
    }

    /// The command failed with this code and one screen of text for people.
    pub(crate) fn fails(&self, code: i32) -> &str {
        assert_eq!(self.code, Some(code), "{}{}", self.out, self.err);
        assert!(self.out.is_empty(), "{}", self.out);
        assert!(self.err.starts_with("error: ") && self.err.lines().count() <= 24, "{}", self.err);
        for word in ["panicked", "RUST_BACKTRACE", "Err(", "Some("] {
            assert!(!self.err.contains(word), "{word}: {}", self.err);
        }
        &self.err
    }
}

/// Runs `phugoid` in a folder.
pub(crate) fn phugoid(folder: &Path, arguments: &[&str]) -> Run {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_phugoid")).args(arguments).current_dir(folder).output().unwrap();
    Run { code: status.code(), out: String::from_utf8(stdout).unwrap(), err: String::from_utf8(stderr).unwrap() }
}
