//! What the fleet knows of each log beside its content: where it stands, whose flight it is, and when it was flown.
//!
//! None of this is part of a key: a log that is moved, or assigned to another airframe, is not estimated again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

/// A log in the store.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LogRow {
    /// SHA-256 of its content, as in [`Row::source_sha256`](crate::row::Row::source_sha256).
    pub log_sha256: String,
    /// Where it was found; of several copies the first by the order of the paths.
    pub path: String,
    /// Its length, bytes.
    pub bytes: i64,
    /// The airframe that flew it.
    pub airframe: String,
    /// Number of the flight of its airframe, if a table of flights gives it.
    pub flight: Option<f64>,
    /// Hours that the airframe had flown before, if a table of flights gives it.
    pub hours: Option<f64>,
}

/// A table of flights: CSV with the columns `log` (name of the file, or the end of its path), `airframe`, and, if wanted,
/// `flight` and `hours`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlightTable {
    entries: BTreeMap<String, TableEntry>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct TableEntry {
    log: String,
    airframe: String,
    #[serde(default)]
    flight: Option<f64>,
    #[serde(default)]
    hours: Option<f64>,
}

/// What is wrong with a table of flights.
#[derive(Debug, thiserror::Error)]
pub enum FlightTableError {
    /// It cannot be read, or a row of it is not what is expected.
    #[error("{}: {source}. Expected are the columns log, airframe, and if wanted flight and hours", file.display())]
    Wrong {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        source: csv::Error,
    },
    /// Two rows for one log.
    #[error("{}: `{log}` stands in two rows", file.display())]
    Twice {
        /// The file.
        file: PathBuf,
        /// The log.
        log: String,
    },
    /// A number that is not finite.
    #[error("{}: `{log}`: flight and hours have to be finite numbers", file.display())]
    NotFinite {
        /// The file.
        file: PathBuf,
        /// The log.
        log: String,
    },
}

impl FlightTable {
    /// Reads a table of flights.
    ///
    /// # Errors
    /// [`FlightTableError`].
    pub fn open(file: &Path) -> Result<Self, FlightTableError> {
        let wrong = |source| FlightTableError::Wrong { file: file.to_owned(), source };
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(file).map_err(wrong)?;
        let mut entries = BTreeMap::new();
        for entry in reader.deserialize::<TableEntry>() {
            let entry = entry.map_err(wrong)?;
            if [entry.flight, entry.hours].iter().flatten().any(|number| !number.is_finite()) {
                return Err(FlightTableError::NotFinite { file: file.to_owned(), log: entry.log });
            }
            if let Some(twice) = entries.insert(name_of(Path::new(&entry.log)), entry) {
                return Err(FlightTableError::Twice { file: file.to_owned(), log: twice.log });
            }
        }
        Ok(Self { entries })
    }

    /// The key of the entry for a log: the longest end of its path that the table names.
    fn key_of(&self, path: &Path) -> Option<&str> {
        // Of a relative path also what it is in full, which the table may name.
        let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let parts: Vec<String> = full.components().map(|part| name_of(part.as_ref())).collect();
        let whole = self.entries.get_key_value(&name_of(&full));
        let ends = (1..parts.len()).find_map(|first| self.entries.get_key_value(&parts[first..].join("/")));
        whole.or(ends).map(|(key, _)| key.as_str())
    }

    /// The entries of the table that name none of these logs, as they are written.
    pub fn without_a_log<'a>(&self, logs: impl Iterator<Item = &'a Path>) -> Vec<&str> {
        let used: BTreeSet<&str> = logs.filter_map(|path| self.key_of(path)).collect();
        self.entries
            .iter()
            .filter(|(key, _)| !used.contains(key.as_str()))
            .map(|(_, entry)| entry.log.as_str())
            .collect()
    }

    /// The row of a log. A log that is not in the table belongs to the airframe that is called as its folder.
    pub fn log(&self, path: &Path, log_sha256: &str, bytes: u64) -> LogRow {
        // The longest end of the path that the table names.
        let found = self.key_of(path).and_then(|key| self.entries.get(key));
        let folder = path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        LogRow {
            log_sha256: log_sha256.to_owned(),
            path: path.display().to_string(),
            bytes: bytes as i64,
            airframe: found.map(|entry| entry.airframe.clone()).or(folder).unwrap_or_else(|| "unknown".to_owned()),
            flight: found.and_then(|entry| entry.flight),
            hours: found.and_then(|entry| entry.hours),
        }
    }
}

/// A path with `/` between its parts and without `./`.
fn name_of(path: &Path) -> String {
    let parts = path.components().filter(|part| *part != Component::CurDir);
    let parts: Vec<_> = parts.map(|part| part.as_os_str().to_string_lossy().replace('\\', "/")).collect();
    parts.join("/").replace("//", "/")
}

/// A name as people count: `flight 9` comes before `flight 10`. Numbers compare by value, everything else as text.
pub fn natural(name: &str) -> Vec<(String, u128)> {
    let mut parts: Vec<(String, u128)> = Vec::new();
    let (mut text, mut number) = (String::new(), String::new());
    for letter in name.chars().chain(['\0']) {
        if letter.is_ascii_digit() {
            number.push(letter);
            continue;
        }
        if !number.is_empty() {
            parts.push((std::mem::take(&mut text), number.parse().unwrap_or(u128::MAX)));
            number.clear();
        }
        text.push(letter);
    }
    parts.push((text, 0));
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_wins_over_the_folder_and_says_what_is_wrong_with_it() {
        let file = std::env::temp_dir().join(format!("phugoid-fleet-table-{}.csv", std::process::id()));
        let table = |text: &str| {
            std::fs::write(&file, text).unwrap();
            FlightTable::open(&file)
        };
        let flights = table("log,airframe,flight,hours\na/1.csv,N17,3,12.5\n2.csv,N18,,\n").unwrap();
        let log = flights.log(Path::new("logs/a/1.csv"), "abc", 7);
        assert_eq!((log.airframe.as_str(), log.flight, log.hours), ("N17", Some(3.0), Some(12.5)));
        assert_eq!(flights.log(Path::new("logs/b/1.csv"), "abc", 7).airframe, "b");
        assert_eq!(flights.log(Path::new("logs/b/2.csv"), "abc", 7).airframe, "N18");
        assert_eq!(flights.without_a_log([Path::new("logs/b/1.csv"), Path::new("x/2.csv")].into_iter()), ["a/1.csv"]);
        // As it is written in the table, and in full.
        let here = std::path::absolute("logs/a/7.csv").unwrap();
        let both = table(&format!("log,airframe\n./b/1.csv,N1\n{},N2\n", here.display())).unwrap();
        assert_eq!(both.log(Path::new("b/1.csv"), "abc", 7).airframe, "N1");
        assert_eq!(both.log(Path::new("logs/a/7.csv"), "abc", 7).airframe, "N2");
        assert!(matches!(table("log,airframe,hour\na,b,3\n"), Err(FlightTableError::Wrong { .. })));
        assert!(matches!(table("log,airframe\na,b\na,c\n"), Err(FlightTableError::Twice { .. })));
        assert!(matches!(table("log,plane\na,b\n"), Err(FlightTableError::Wrong { .. })));
        assert!(matches!(table("log,airframe,flight\na,b,nan\n"), Err(FlightTableError::NotFinite { .. })));
        std::fs::remove_file(&file).unwrap();
    }

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = ["f10.csv", "f9.csv", "f9b.csv", "e99.csv"];
        names.sort_by_key(|name| natural(name));
        assert_eq!(names, ["e99.csv", "f9.csv", "f9b.csv", "f10.csv"]);
    }
}
