//! Why an aircraft is refused, and what was left out of one that was read.

use std::path::PathBuf;

use crate::xml::XmlError;

/// Why an aircraft of JSBSim could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JsbsimError {
    /// A file cannot be opened, or is too large.
    #[error(transparent)]
    Unreadable(XmlError),
    /// The text of a file is not XML, or is nested too deep.
    #[error("{}: {source}", file.display())]
    Xml {
        /// The file.
        file: PathBuf,
        /// What is wrong with its text.
        source: XmlError,
    },
    /// An element cannot be understood, or changes the aerodynamics in a way that is not supported.
    #[error("{}: line {line}: {what}", file.display())]
    Refused {
        /// The file.
        file: PathBuf,
        /// Line of the element, from 1.
        line: u32,
        /// What is wrong with it.
        what: String,
    },
}

/// Something of a file that was left out, and what that means for what is evaluated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Omission {
    /// The file.
    pub file: PathBuf,
    /// Line of the element, from 1.
    pub line: u32,
    /// What was left out and what stands in its place.
    pub what: String,
}

impl std::fmt::Display for Omission {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}: line {}: {}", self.file.display(), self.line, self.what)
    }
}
