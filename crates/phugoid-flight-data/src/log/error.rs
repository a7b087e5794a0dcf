//! Why a log could not be read at all. What is damaged within it is no error, but said in its quality report.

/// Why a log could not be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The operating system could not open or read it.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// File or stream.
        source_name: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// It is another format, or not even its head is there.
    #[error("{source_name}: this is no {format}: {problem}")]
    NotThisFormat {
        /// File or stream.
        source_name: String,
        /// The format that was expected.
        format: &'static str,
        /// What was found and what was expected.
        problem: String,
    },
    /// The log says of itself that a reader of this version would misread it.
    #[error(
        "{source_name}: the log uses {feature}, which this version does not know, and says that its data are misread \
         without it. Read it with a newer version, or convert it with the tools of the autopilot"
    )]
    Incompatible {
        /// File or stream.
        source_name: String,
        /// What it uses.
        feature: String,
    },
    /// There is nothing in it that could be read.
    #[error(
        "{source_name}: the log holds no data{reason}. No sample of it could be read; if it was cut off or damaged, copy it again"
    )]
    NoData {
        /// File or stream.
        source_name: String,
        /// `: ...` why, or empty.
        reason: String,
    },
    /// More than fits into the set bound.
    #[error(
        "{source_name}: the topics asked for hold more than {max_values} values, the set bound on memory. Ask for fewer topics \
         or fields, or raise `max_values`"
    )]
    TooLarge {
        /// File or stream.
        source_name: String,
        /// The bound.
        max_values: usize,
    },
}
