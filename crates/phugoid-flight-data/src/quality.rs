//! What a reader found in a record, mended and left out.

use serde::{Deserialize, Serialize};

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing; nothing was changed.
    Note,
    /// Data were converted, dropped or mended; results hold with that in mind.
    Warning,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// How much it matters.
    pub severity: Severity,
    /// Where: a channel, a row, a time span; empty for the whole record.
    pub place: String,
    /// What was found, what was done about it, and what the user can do.
    pub message: String,
}

/// Data-quality section of a record.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct QualityReport {
    /// Data rows read.
    pub rows_read: usize,
    /// Rows kept in the record.
    pub rows_kept: usize,
    /// Median sample time, s.
    pub sample_time_s: f64,
    /// Findings in the order in which they were made.
    pub findings: Vec<Finding>,
}
