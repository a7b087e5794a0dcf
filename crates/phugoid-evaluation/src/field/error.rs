//! Why the field could not be run.

use std::path::Path;

/// Why the field could not be run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FieldError {
    /// A folder or a file cannot be read.
    #[error("cannot read `{path}`: {error}")]
    Reading {
        /// Its path.
        path: String,
        /// What the system says.
        error: String,
    },
    /// A truth file is not what the generator writes.
    #[error("{file}: {error}. Make the field again with scripts/field/make.py of this version")]
    Truth {
        /// The file.
        file: String,
        /// What is wrong with it.
        error: String,
    },
    /// A model file of the field cannot be read.
    #[error("{0}")]
    Model(String),
    /// What happened without instruments cannot be read.
    #[error("{0}. Make the field with scripts/field/make.py --exact")]
    NoExact(String),
    /// There is no flight.
    #[error("{folder}: no flight of the part `{split}`. Make the field with scripts/field/make.py, or name its folder")]
    Empty {
        /// The folder that was looked through.
        folder: String,
        /// The part that was asked for.
        split: &'static str,
    },
    /// No flight has the words that were asked for.
    #[error("no flight has {0} in its aircraft, group or name")]
    NoSuch(String),
}

impl FieldError {
    pub(super) fn reading(path: &Path, error: impl std::fmt::Display) -> Self {
        Self::Reading { path: path.display().to_string(), error: error.to_string() }
    }
}
