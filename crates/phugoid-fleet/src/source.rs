//! Which files are meant by what the user writes: files, folders, and patterns such as `flights/*/*.ulg`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use phugoid_flight_data::log::is_flight_review;

use crate::row::STORE_MARK;

/// Ends of the names of flights. In a folder everything else is left out; a file that is named is always taken.
pub const ENDS: [&str; 13] = [
    ".ulg", ".bin", ".tlog", ".mcap", ".csv", ".csv.gz", ".txt", ".mat", ".parquet", ".arrow", ".feather", ".xlsx",
    ".xlsm",
];

/// Why there are no logs to take.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// Neither a file nor a folder, and no pattern.
    #[error("`{word}`: there is no such file or folder")]
    NotThere {
        /// What was given.
        word: String,
    },
    /// A pattern that fits no file.
    #[error("`{word}`: no file fits this pattern")]
    NothingFits {
        /// What was given.
        word: String,
    },
    /// A pattern that is none.
    #[error("`{word}` is no pattern: {source}")]
    Pattern {
        /// What was given.
        word: String,
        /// What is wrong with it.
        source: glob::PatternError,
    },
    /// A folder that cannot be read.
    #[error("`{}`: cannot be read: {source}. Give yourself the right to read it, or name the other folders one by one", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// An address of an object store, which the engine of the Python package reads and this program does not.
    #[error(
        "`{word}` is an address of an object store: this program reads files. Mount the bucket, or use the Python package: \
         phugoid.fleet([...], engine=\"ray\")"
    )]
    Remote {
        /// What was given.
        word: String,
    },
}

/// The files that are meant, each once, in the order of their paths, whatever the order of the words.
///
/// # Errors
/// [`SourceError`]: a word that means nothing. A folder without flights is no error, since flights may come later.
pub fn files(words: &[String]) -> Result<Vec<PathBuf>, SourceError> {
    let mut found = BTreeSet::new();
    for word in words {
        let path = Path::new(word);
        if path.is_dir() {
            walk(path, &mut found)?;
        } else if path.exists() {
            found.insert(path.to_owned());
        } else if word.contains("://") {
            return Err(SourceError::Remote { word: word.clone() });
        } else if word.contains(['*', '?', '[']) {
            let paths = glob::glob(word).map_err(|source| SourceError::Pattern { word: word.clone(), source })?;
            let mut fits = false;
            for path in paths {
                let path = path
                    .map_err(|error| SourceError::Folder { folder: error.path().to_owned(), source: error.into() })?;
                fits = true;
                if path.is_dir() { walk(&path, &mut found)? } else { _ = found.insert(path) }
            }
            if !fits {
                return Err(SourceError::NothingFits { word: word.clone() });
            }
        } else {
            return Err(SourceError::NotThere { word: word.clone() });
        }
    }
    Ok(found.into_iter().collect())
}

/// All flights in a folder and those below it, but for stores of a fleet; a folder may be one log by itself. Links to folders are not followed, since they may lead back.
fn walk(folder: &Path, found: &mut BTreeSet<PathBuf>) -> Result<(), SourceError> {
    let failed = |source| SourceError::Folder { folder: folder.to_owned(), source };
    // What a store holds are results, and no flights.
    if folder.join(STORE_MARK).exists() {
        return Ok(());
    }
    if is_log(folder) {
        found.insert(folder.to_owned());
        return Ok(());
    }
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(failed)?);
        if kind.is_dir() {
            walk(&path, found)?;
        } else if path.is_file() && is_flight(&entry.file_name().to_string_lossy()) {
            found.insert(path);
        }
    }
    Ok(())
}

/// Whether a folder is one log, as Flight Review 2 keeps it. Other folders may have a `metadata.json` among their flights: this one says
/// when the log begins, and has tables beside it.
fn is_log(folder: &Path) -> bool {
    let says_when = || {
        let text = fs::read(folder.join("metadata.json")).unwrap_or_default();
        let metadata: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
        metadata.get("start_timestamp_us").is_some()
    };
    let is_table = |entry: fs::DirEntry| entry.path().extension().is_some_and(|end| end == "parquet");
    let has_table = || fs::read_dir(folder).is_ok_and(|mut entries| entries.any(|entry| entry.is_ok_and(is_table)));
    is_flight_review(folder) && has_table() && says_when()
}

fn is_flight(name: &str) -> bool {
    let name = name.to_lowercase();
    !name.starts_with('.') && ENDS.iter().any(|end| name.ends_with(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_patterns_and_files_give_each_file_once_in_order() {
        let root = std::env::temp_dir().join(format!("phugoid-fleet-source-{}", std::process::id()));
        for name in ["b/2.csv", "b/1.ULG", "a/3.bin", "a/notes.md", "a/.hidden.csv"] {
            let path = root.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, name).unwrap();
        }
        let word = |path: &str| root.join(path).display().to_string();
        let names = |words: &[String]| -> Vec<String> {
            let relative = |path: &PathBuf| path.strip_prefix(&root).unwrap().display().to_string();
            files(words).unwrap().iter().map(relative).collect()
        };
        assert_eq!(names(&[word("b"), word("a/3.bin"), word("")]), ["a/3.bin", "b/1.ULG", "b/2.csv"]);
        assert_eq!(names(&[word("*/*.csv")]), ["a/.hidden.csv", "b/2.csv"]);
        assert_eq!(names(&[word("a/notes.md")]), ["a/notes.md"]);
        // What a pattern finds that was named before still fits it; and a store among the flights holds none.
        assert_eq!(names(&[word("a/3.bin"), word("a/*.bin")]), ["a/3.bin"]);
        fs::create_dir_all(root.join("b/store/logs")).unwrap();
        fs::write(root.join("b/store").join(STORE_MARK), "").unwrap();
        fs::write(root.join("b/store/logs/7.parquet"), "").unwrap();
        assert_eq!(names(&[word("b")]), ["b/1.ULG", "b/2.csv"]);
        // A folder of Flight Review is one log; another one with a file of that name has its flights in it.
        for (folder, metadata) in
            [("d/1", "{\"start_timestamp_us\": 5, \"topics\": {}}"), ("d/2", "{\"author\": \"me\"}")]
        {
            fs::create_dir_all(root.join(folder)).unwrap();
            fs::write(root.join(folder).join("metadata.json"), metadata).unwrap();
            fs::write(root.join(folder).join("vehicle_attitude.parquet"), "").unwrap();
        }
        assert_eq!(names(&[word("d")]), ["d/1", "d/2/vehicle_attitude.parquet"]);
        assert_eq!(names(&[word("d/1"), word("d/*")]), ["d/1", "d/2/vehicle_attitude.parquet"]);
        assert!(matches!(files(&[word("c")]), Err(SourceError::NotThere { .. })));
        assert!(matches!(files(&[word("*.mat")]), Err(SourceError::NothingFits { .. })));
        assert!(matches!(files(&["s3://bucket/x".to_owned()]), Err(SourceError::Remote { .. })));
        fs::remove_dir_all(root).unwrap();
    }
}
