//! Errors of reading MATLAB files.

use crate::table::TableError;

/// Why a MATLAB file could not be read. Every message says where, what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system could not open or read the file or stream.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// It is not a MATLAB file of level 5.
    #[error("{source_name}: this is no MATLAB 5 file but {found}. {advice}")]
    NotMatlab {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// What the file seems to be, such as `a zip archive`.
        found: &'static str,
        /// What the user can do about it, as a sentence.
        advice: &'static str,
    },
    /// The file is damaged, and not one variable of it could be read.
    #[error(
        "{source_name}, byte {offset}: the file is damaged ({problem}), and no variable before that place could be read. \
         Copy or save it again"
    )]
    Damaged {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Where the first damaged variable begins.
        offset: u64,
        /// What was found there and what was expected, as a clause.
        problem: String,
    },
    /// The file has no variable of the name that was asked for.
    #[error("{source_name}: there is no variable '{wanted}'. Found: {found}")]
    NoVariable {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The name that was asked for.
        wanted: String,
        /// The variables of the file.
        found: String,
    },
    /// The names that were given for the columns are not as many as a matrix of the file has columns.
    #[error(
        "{source_name}: {given} names of columns were given, and no matrix of the file has so many columns: {found}. Give a name for \
         each column of the matrix, in its order"
    )]
    Names {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Number of names.
        given: usize,
        /// The matrices of the file, with their sizes, or that there is none.
        found: String,
    },
    /// The numbers were read, but no record can be made of them.
    #[error(transparent)]
    Table(#[from] TableError),
}
