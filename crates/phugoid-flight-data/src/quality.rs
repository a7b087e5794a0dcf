//! The quality report: what a reader found in a file, what it assumed, converted and left out.
//!
//! ```
//! use phugoid_flight_data::csv::{self, CsvOptions};
//! let text = "time_s,alpha\n0.0,0.05\n0.1,0.06\n0.1,0.06\n0.2,\n"; // no unit, a double row, a missing value
//! let record = csv::read(text.as_bytes(), "flight.csv", &CsvOptions::default())?;
//! let quality = &record.quality;
//! assert_eq!((quality.rows_read, quality.rows_kept), (4, 3));
//! assert!(quality.warnings().any(|finding| finding.message.contains("no unit is written")));
//! let alpha = quality.channels.iter().find(|channel| channel.name == "alpha").expect("alpha was read");
//! assert!(alpha.unit_assumed && alpha.missing == 1);
//! # Ok::<(), csv::ReadError>(())
//! ```

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::wording::{Precise, Short, plural};

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing; results are not affected.
    Note,
    /// Data were left out, changed or assumed, or are probably wrong: check it before results are trusted.
    Warning,
}

/// One thing that a reader or a check found in the data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Whether it may affect results.
    pub severity: Severity,
    /// Where it was found: a channel, a column, rows or a span of time; empty if it concerns the whole record.
    pub place: String,
    /// What was found, what was done about it, and what the user can do, as a sentence.
    pub message: String,
}

/// Where one channel came from, how it was converted, and how much of it is missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelQuality {
    /// Canonical name, as in the record.
    pub name: String,
    /// The header it was read from.
    pub header: String,
    /// The unit it was converted from, e.g. `deg`; `-` for a pure number.
    pub unit: String,
    /// True if the file states no unit and SI was assumed.
    pub unit_assumed: bool,
    /// The factor of an explicit mapping, by which values were multiplied before the unit was converted; 1 otherwise.
    pub scale: f64,
    /// Values missing among the rows kept: empty cells, NaN, infinities and text.
    pub missing: usize,
    /// Number of single values far away from both neighbours; they are kept as they are.
    pub spikes: usize,
}

/// What one [`Deletion`](crate::deletion::Deletion) has made missing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deleted {
    /// Time of the first sample that lost a value, s.
    pub from_s: f64,
    /// Time of the last sample that lost a value, s.
    pub to_s: f64,
    /// Why.
    pub reason: String,
    /// How many values each channel has lost; only channels that have lost some.
    pub channels: Vec<DeletedValues>,
}

/// When time zero of a record was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Seconds from 1970-01-01T00:00:00, without leap seconds, finite.
    pub unix_s: f64,
    /// True if that is UTC: the file writes `Z`, an offset such as `+02:00`, or the time of a satellite receiver. False for a
    /// date and a time of day whose time zone nobody wrote.
    pub is_utc: bool,
}

/// How many values of a channel were deleted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeletedValues {
    /// Canonical name of the channel.
    pub channel: String,
    /// Number of finite values that were made missing.
    pub values: usize,
}

impl Deleted {
    /// When, in words.
    fn when(&self) -> String {
        if self.from_s == self.to_s {
            format!("at {} s", Precise(self.from_s))
        } else {
            format!("from {} s to {} s", Precise(self.from_s), Precise(self.to_s))
        }
    }

    /// What was deleted, in words: `alpha: 3 values deleted from 2.5 s to 2.6 s: bird strike`, one for each channel.
    pub fn sentences(&self) -> impl Iterator<Item = String> {
        self.findings(usize::MAX).into_iter().map(|finding| format!("{}: {}", finding.place, finding.message))
    }

    /// One warning for each channel, or one for all of a record of so many channels that lost equally many values.
    pub(crate) fn findings(&self, channels: usize) -> Vec<Finding> {
        let warn = |place: &str, message: String| Finding { severity: Severity::Warning, place: place.into(), message };
        let words = |values: usize, each: &str| {
            format!("{}{each} deleted {}: {}", plural(values, "value"), self.when(), self.reason)
        };
        match self.channels.as_slice() {
            [first, rest @ ..]
                if rest.len() > 1
                    && channels == self.channels.len()
                    && rest.iter().all(|c| c.values == first.values) =>
            {
                vec![warn("all channels", words(first.values, " of each"))]
            }
            some => some.iter().map(|one| warn(&one.channel, words(one.values, ""))).collect(),
        }
    }
}

/// The quality report of a record or a log. Its `Display` form is a text of one line per finding.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct QualityReport {
    /// Number of data rows that the file has.
    pub rows_read: usize,
    /// Number of rows that are in the record.
    pub rows_kept: usize,
    /// Median time from one row to the next, s; 0 if not known.
    pub sample_time_s: f64,
    /// Findings in the order in which they were made.
    pub findings: Vec<Finding>,
    /// Values that were deleted by hand, with the reasons, in the order in which it was done.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub deletions: Vec<Deleted>,
    /// When time zero was; `None` where the file has no date.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Start>,
    /// What the clock of the recorder said at time zero, microseconds: of an autopilot the time since it was switched on, by which the
    /// messages in its log and other programs name a moment. `None` where the file has no such clock, or it began at time zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_at_zero_us: Option<u64>,
    /// The time of day that the clock of a table shows at time zero, seconds from midnight, as the file writes it: a time zone has
    /// no part in it. `None` where the file has no such clock, or one that changes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_of_day_at_zero_s: Option<f64>,
    /// One entry per channel read from a file, time first; empty for a record made in memory.
    #[serde(default)]
    pub channels: Vec<ChannelQuality>,
}

impl QualityReport {
    /// Adds a finding of [`Severity::Note`].
    pub fn note(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.findings.push(Finding { severity: Severity::Note, place: place.into(), message: message.into() });
    }

    /// Adds a finding of [`Severity::Warning`].
    pub fn warn(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.findings.push(Finding { severity: Severity::Warning, place: place.into(), message: message.into() });
    }

    /// The findings of [`Severity::Warning`], in their order.
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
