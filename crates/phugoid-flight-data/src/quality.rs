//! What a reader found in a record, mended and left out.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::wording::Short;

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

/// Where one channel came from and what is missing in it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelQuality {
    /// Canonical name, as in the record.
    pub name: String,
    /// The header it was read from.
    pub header: String,
    /// The unit it was converted from, e.g. `deg`; `-` for a pure number.
    pub unit: String,
    /// Was the unit assumed, because none was written?
    pub unit_assumed: bool,
    /// The factor of an explicit mapping (its sign or scale); 1 otherwise.
    pub scale: f64,
    /// Values missing among the rows kept: empty cells, NaN, infinities and text.
    pub missing: usize,
    /// Values that stand alone far away from their neighbours (kept as they are).
    pub spikes: usize,
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
    /// One entry per channel read from a file, time first; empty for a record made in memory.
    #[serde(default)]
    pub channels: Vec<ChannelQuality>,
}

impl QualityReport {
    /// Adds a [`Severity::Note`].
    pub fn note(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.findings.push(Finding { severity: Severity::Note, place: place.into(), message: message.into() });
    }

    /// Adds a [`Severity::Warning`].
    pub fn warn(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.findings.push(Finding { severity: Severity::Warning, place: place.into(), message: message.into() });
    }

    /// The warnings alone.
    pub fn warnings(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| finding.severity == Severity::Warning)
    }
}

impl fmt::Display for QualityReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let missing: usize = self.channels.iter().map(|channel| channel.missing).sum();
        write!(f, "{} of {} rows kept", self.rows_kept, self.rows_read)?;
        if self.sample_time_s > 0.0 {
            write!(f, ", median sample time {} s", Short(self.sample_time_s))?;
        }
        writeln!(f, ", {missing} values missing")?;
        for finding in &self.findings {
            let kind = match finding.severity {
                Severity::Note => "note",
                Severity::Warning => "warning",
            };
            match finding.place.as_str() {
                "" => writeln!(f, "  {kind}: {}", finding.message)?,
                place => writeln!(f, "  {kind}: {place}: {}", finding.message)?,
            }
        }
        Ok(())
    }
}
