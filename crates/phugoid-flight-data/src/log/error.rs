//! Errors of logs that cannot be read at all. Damage within a log is no error: the quality report names it.

use crate::memory::OverBudget;

/// Why a log could not be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The operating system could not open or read the file or stream.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// The file is in another format, or ends before its header does.
    #[error("{source_name}: this is no {format}: {problem}")]
    NotThisFormat {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The format that was expected.
        format: &'static str,
        /// What was found and what was expected.
        problem: String,
    },
    /// The log declares that a reader of this version would misread it (incompatible flags of ULog).
    #[error(
        "{source_name}: the log uses {feature}, which this version does not know, and says that its data are misread \
         without it. Read it with a newer version, or convert it with the tools of the autopilot"
    )]
    Incompatible {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// What it uses that is not known here, as a noun.
        feature: String,
    },
    /// Not one sample of the log could be read.
    #[error(
        "{source_name}: the log holds no data{reason}. No sample of it could be read; if it was cut off or damaged, copy it again"
    )]
    NoData {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The cause, beginning with `: `; empty if none is known.
        reason: String,
    },
    /// What is asked of it needs more memory than [`super::Selection::max_memory`].
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}
