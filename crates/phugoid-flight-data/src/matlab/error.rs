//! Why a MATLAB file could not be read.

use crate::table::TableError;

/// Why a MATLAB file could not be read. Every message says where, what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system could not open or read it.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// File or stream.
        source_name: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// It is not a MATLAB file of level 5.
    #[error("{source_name}: this is no MATLAB 5 file but {found}. {advice}")]
    NotMatlab {
        /// File or stream.
        source_name: String,
        /// What it seems to be.
        found: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// Nothing in it could be read.
    #[error(
        "{source_name}, byte {offset}: the file is damaged ({problem}), and no variable before that place could be read. \
         Copy or save it again"
    )]
    Damaged {
        /// File or stream.
        source_name: String,
        /// Where the first damaged variable begins.
        offset: u64,
        /// What was found and expected.
        problem: String,
    },
    /// The numbers were read, but make no record.
    #[error(transparent)]
    Table(#[from] TableError),
}
