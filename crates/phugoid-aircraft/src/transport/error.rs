//! Why the data do not make an aircraft.

use std::path::PathBuf;

/// Why the data of the Generic Transport Model do not make an aircraft.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TransportError {
    /// A file cannot be read.
    #[error("{}: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// A file is larger than any table of this model.
    #[error("{}: larger than {most} bytes, which no table of this model is", file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// The largest size that is read, bytes.
        most: u64,
    },
    /// A file is no JSON. The message of `source` gives line and column.
    #[error("{}: {source}", file.display())]
    Json {
        /// The file.
        file: PathBuf,
        /// What is wrong with it, and where.
        source: serde_json::Error,
    },
    /// A value of a file is missing or makes no sense.
    #[error("{}: {key}: {problem}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// The key in the file, with the keys above it and indices.
        key: String,
        /// What is wrong with the value.
        problem: String,
    },
    /// An option is out of its range.
    #[error("option {option} is {value}; it has to be {expected}")]
    Option {
        /// Its name in the options.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What it has to be.
        expected: &'static str,
    },
    /// Mass or inertia with these options are not positive definite.
    #[error("mass or inertia of the aircraft ({damage}) are not positive definite")]
    Mass {
        /// Word of the damage.
        damage: &'static str,
    },
}
