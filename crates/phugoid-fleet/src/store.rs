//! The folder in which rows are kept: one file for each unit of work, named by its key.
//!
//! A unit is done if and only if its file is there, and a file is there whole or not at all. That is all that exactly
//! once needs: no journal, no lock and no scheduler. Two processes that work on the same unit write the same bytes.
//!
//! ```text
//! store/
//!   estimates/source=log/model_hash=<12 digits>/part=<2 digits>/<key>.parquet     the rows
//!   logs/part=<2 digits>/<hash of the log>.parquet                         where the log stands and whose flight it is
//!   models/<hash of the model>.toml                                        the text of each model
//!   runs/study=<name>/part=<2 digits>/<key>.parquet                        a run of a study
//!   again/<key>                                                            units to be tried again
//! ```

use std::fs;
use std::path::{Path, PathBuf};

use phugoid_flight_data::output_file;

use crate::logs::LogRow;
use crate::row::{Row, RunRow, SCHEMA, STORE_MARK};
use crate::schema;

/// Why the store cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file or folder of it cannot be written.
    #[error("{}: cannot be written: {source}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// A file of it cannot be read, or is none of a store.
    #[error("{}: {message}. If the file is broken, remove it and run the same command as before: what is missing is done again", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// A folder that holds something else.
    #[error("{}: this folder is not empty and no store. Name a new folder", folder.display())]
    NotAStore {
        /// The folder.
        folder: PathBuf,
    },
    /// A store of another schema.
    #[error("{}: this store has schema {found}, this version writes {SCHEMA}. Name a new folder", folder.display())]
    OtherSchema {
        /// The folder.
        folder: PathBuf,
        /// What it says of its schema.
        found: String,
    },
    /// There is no store.
    #[error("{}: there is no store", folder.display())]
    NotThere {
        /// The folder.
        folder: PathBuf,
    },
}

/// A store in a folder.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// Opens the store in this folder, or begins one in a folder that is new or empty. What killed programs have left of
    /// half-written files is removed.
    ///
    /// # Errors
    /// [`StoreError`]: the folder cannot be written, holds something else, or has another schema.
    pub fn create(folder: &Path) -> Result<Self, StoreError> {
        let store = Self { folder: folder.to_owned() };
        let mark = folder.join(STORE_MARK);
        if !mark.exists() {
            let is_foreign = |entry: fs::DirEntry| !entry.file_name().to_string_lossy().starts_with(".phugoid-");
            if fs::read_dir(folder).is_ok_and(|mut entries| entries.any(|entry| entry.is_ok_and(is_foreign))) {
                // Another process may have begun the store since.
                if !mark.exists() {
                    return Err(StoreError::NotAStore { folder: folder.to_owned() });
                }
            } else {
                store.write(&mark, format!("{SCHEMA}\n").as_bytes())?;
            }
        }
        store.check_schema()?;
        for part in store.folders() {
            output_file::remove_abandoned(&part);
        }
        Ok(store)
    }

    /// Opens a store to read it.
    ///
    /// # Errors
    /// [`StoreError`]: there is none, or it has another schema.
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        let store = Self { folder: folder.to_owned() };
        if !folder.join(STORE_MARK).exists() {
            return Err(StoreError::NotThere { folder: folder.to_owned() });
        }
        store.check_schema()?;
        Ok(store)
    }

    fn check_schema(&self) -> Result<(), StoreError> {
        let mark = self.folder.join(STORE_MARK);
        let found = fs::read_to_string(&mark)
            .map_err(|error| StoreError::Read { file: mark, message: error.to_string() })?
            .trim()
            .to_owned();
        match found == SCHEMA.to_string() {
            true => Ok(()),
            false => Err(StoreError::OtherSchema { folder: self.folder.clone(), found }),
        }
    }

    /// The folder of the store.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where the rows of a unit stand below the folder of a store.
    pub fn place(kind: &str, model_sha256: &str, key: &str) -> PathBuf {
        let beginning = |text: &str, length: usize| text.get(..length).unwrap_or(text).to_owned();
        Path::new("estimates")
            .join(format!("source={kind}"))
            .join(format!("model_hash={}", beginning(model_sha256, 12)))
            .join(format!("part={}", beginning(key, 2)))
            .join(format!("{key}.parquet"))
    }

    /// Where the note that a unit is tried again stands below the folder of a store.
    pub fn place_of_note(key: &str) -> PathBuf {
        Path::new("again").join(key)
    }

    fn unit(&self, kind: &str, model_sha256: &str, key: &str) -> PathBuf {
        self.folder.join(Self::place(kind, model_sha256, key))
    }

    fn again(&self, key: &str) -> PathBuf {
        self.folder.join(Self::place_of_note(key))
    }

    /// Whether a unit is done and need not be tried again.
    pub fn has(&self, kind: &str, model_sha256: &str, key: &str) -> bool {
        self.unit(kind, model_sha256, key).exists() && !self.again(key).exists()
    }

    /// Writes the rows of a unit, all at once, in place of earlier ones. A unit that `is_tried_again` is not counted as
    /// done. Nothing is written where there is no row.
    ///
    /// # Errors
    /// [`StoreError::Write`].
    pub fn write_unit(&self, rows: &[Row], is_tried_again: bool) -> Result<(), StoreError> {
        let Some(Row { key, kind, model_sha256, .. }) = rows.first() else { return Ok(()) };
        self.write_block(rows, (kind, model_sha256, key), is_tried_again)
    }

    /// As [`write_unit`](Self::write_unit), under a kind, a model and a key, where the rows may be of several models.
    ///
    /// # Errors
    /// [`StoreError::Write`].
    pub fn write_block(
        &self,
        rows: &[Row],
        (kind, model_sha256, key): (&str, &str, &str),
        is_tried_again: bool,
    ) -> Result<(), StoreError> {
        let (file, again) = (self.unit(kind, model_sha256, key), self.again(key));
        // The note comes before the rows and goes after them, so that whoever is killed in between tries again.
        if is_tried_again {
            self.write(&again, b"")?;
        }
        make_folder_of(&file)?;
        schema::write(rows, &file)?;
        if !is_tried_again { remove(&again) } else { Ok(()) }
    }

    /// These columns of the rows of one unit; none where it is not there.
    ///
    /// # Errors
    /// [`StoreError::Read`].
    pub fn unit_rows(
        &self,
        kind: &str,
        model_sha256: &str,
        key: &str,
        columns: &[&str],
    ) -> Result<Vec<Row>, StoreError> {
        let file = self.unit(kind, model_sha256, key);
        if file.exists() { schema::read_columns(&file, columns) } else { Ok(Vec::new()) }
    }

    /// Removes a unit, if there is one.
    ///
    /// # Errors
    /// [`StoreError::Write`].
    pub fn remove_unit(&self, kind: &str, model_sha256: &str, key: &str) -> Result<(), StoreError> {
        remove(&self.unit(kind, model_sha256, key))?;
        remove(&self.again(key))
    }

    /// Keeps the text of a model, so that every row can be made again.
    ///
    /// # Errors
    /// [`StoreError::Write`].
    pub fn write_model(&self, model_sha256: &str, text: &str) -> Result<(), StoreError> {
        let file = self.model_file(model_sha256);
        if file.exists() { Ok(()) } else { self.write(&file, text.as_bytes()) }
    }

    /// Where the text of a model is.
    pub fn model_file(&self, model_sha256: &str) -> PathBuf {
        self.folder.join("models").join(format!("{model_sha256}.toml"))
    }

    /// Keeps what is known of a log, unless it is there already as it is.
    ///
    /// # Errors
    /// [`StoreError::Write`].
    pub fn write_log(&self, log: &LogRow) -> Result<(), StoreError> {
        let part = log.log_sha256.get(..2).unwrap_or_default();
        let file = self.folder.join("logs").join(format!("part={part}")).join(format!("{}.parquet", log.log_sha256));
        if schema::read::<LogRow>(&file).is_ok_and(|there| there == std::slice::from_ref(log)) {
            return Ok(());
        }
        make_folder_of(&file)?;
        schema::write(std::slice::from_ref(log), &file)
    }

    fn place_of_run(&self, study: &str, key: &str) -> PathBuf {
        let part = key.get(..2).unwrap_or(key);
        self.folder
            .join("runs")
            .join(format!("study={study}"))
            .join(format!("part={part}"))
            .join(format!("{key}.parquet"))
    }

    /// A run of a study, if it is there.
    ///
    /// # Errors
    /// [`StoreError::Read`].
    pub fn run(&self, study: &str, key: &str) -> Result<Option<RunRow>, StoreError> {
        let file = self.place_of_run(study, key);
        match file.exists() {
            true => Ok(schema::read::<RunRow>(&file)?.pop()),
            false => Ok(None),
        }
    }

    /// Keeps a run of a study.
    ///
    /// # Errors
    /// [`StoreError::Write`].
    pub fn write_run(&self, row: &RunRow) -> Result<(), StoreError> {
        let file = self.place_of_run(&row.study, &row.key);
        make_folder_of(&file)?;
        schema::write(std::slice::from_ref(row), &file)
    }

    /// All rows, in the order of their keys.
    ///
    /// # Errors
    /// [`StoreError::Read`].
    pub fn rows(&self) -> Result<Vec<Row>, StoreError> {
        self.read_all("estimates")
    }

    /// All logs, in the order of their hashes.
    ///
    /// # Errors
    /// [`StoreError::Read`].
    pub fn logs(&self) -> Result<Vec<LogRow>, StoreError> {
        self.read_all("logs")
    }

    fn read_all<R: schema::Stored>(&self, name: &str) -> Result<Vec<R>, StoreError> {
        let mut files = Vec::new();
        for folder in below(&self.folder.join(name)) {
            let entries = fs::read_dir(&folder).into_iter().flatten().flatten().map(|entry| entry.path());
            files.extend(entries.filter(|path| path.extension().is_some_and(|end| end == "parquet")));
        }
        files.sort();
        let mut rows = Vec::new();
        for file in files {
            rows.extend(schema::read(&file)?);
        }
        Ok(rows)
    }

    /// Every folder of the store.
    fn folders(&self) -> Vec<PathBuf> {
        let names = ["estimates", "logs", "models", "runs", "again"];
        names.iter().flat_map(|name| below(&self.folder.join(name))).chain([self.folder.clone()]).collect()
    }

    fn write(&self, file: &Path, content: &[u8]) -> Result<(), StoreError> {
        make_folder_of(file)?;
        output_file::write(file, content).map_err(|source| StoreError::Write { file: file.to_owned(), source })
    }
}

/// A folder and all below it; nothing if there is none.
fn below(folder: &Path) -> Vec<PathBuf> {
    let mut all = vec![folder.to_owned()];
    let mut next = 0;
    while let Some(folder) = all.get(next).cloned() {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        all.extend(entries.filter(|e| e.file_type().is_ok_and(|kind| kind.is_dir())).map(|e| e.path()));
        next += 1;
    }
    all
}

fn make_folder_of(file: &Path) -> Result<(), StoreError> {
    let folder = file.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(|source| StoreError::Write { file: folder.to_owned(), source })
}

fn remove(file: &Path) -> Result<(), StoreError> {
    match fs::remove_file(file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(StoreError::Write { file: file.to_owned(), source: error })
        }
        _ => Ok(()),
    }
}
