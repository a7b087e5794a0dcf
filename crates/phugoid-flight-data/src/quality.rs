//! What a reader found in a record, mended and left out.

use std::fmt;

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

/// A number to at most six significant digits without trailing zeros, for messages.
pub(crate) struct Short(pub(crate) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if value == 0.0 || !value.is_finite() {
            return write!(f, "{value}");
        }
        let magnitude = value.abs().log10().floor();
        if !(-4.0..9.0).contains(&magnitude) {
            return write!(f, "{value:.4e}");
        }
        let decimals = (5.0 - magnitude).clamp(0.0, 9.0) as usize;
        let text = format!("{value:.decimals$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        f.write_str(text)
    }
}

/// What a place in a table is counted in: lines of a text file, as an editor shows them, or rows of numbers; from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Counted {
    #[default]
    Lines,
    Rows,
}

impl Counted {
    pub(crate) fn one(self) -> &'static str {
        match self {
            Counted::Lines => "line",
            Counted::Rows => "row",
        }
    }

    pub(crate) fn several(self) -> &'static str {
        match self {
            Counted::Lines => "lines",
            Counted::Rows => "rows",
        }
    }
}

/// How many, and the line (or row) numbers of the first few.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines {
    counted: Counted,
    count: usize,
    first: Vec<usize>,
}

impl Lines {
    const SHOWN: usize = 8;

    pub(crate) fn of(counted: Counted) -> Self {
        Self { counted, ..Self::default() }
    }

    pub(crate) fn add(&mut self, line: usize) {
        self.count += 1;
        if self.first.len() < Self::SHOWN {
            self.first.push(line);
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// `line 7`, `rows 7, 9, 12` or `lines 7, 9, ... (40 in all)`.
    pub(crate) fn place(&self) -> String {
        let shown: Vec<_> = self.first.iter().map(usize::to_string).collect();
        let shown = shown.join(", ");
        match self.count {
            1 => format!("{} {shown}", self.counted.one()),
            count if count > self.first.len() => {
                format!("{} {shown}, ... ({count} in all)", self.counted.several())
            }
            _ => format!("{} {shown}", self.counted.several()),
        }
    }
}

/// `1 row`, `2 rows`.
pub(crate) fn plural(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers() {
        for (value, text) in [
            (0.0, "0"),
            (0.1, "0.1"),
            (-12.5, "-12.5"),
            (123456.7, "123457"),
            (9.80665, "9.80665"),
            (1e12, "1.0000e12"),
            (2e-7, "2.0000e-7"),
            (1000.0, "1000"),
            (0.001, "0.001"),
        ] {
            assert_eq!(Short(value).to_string(), text);
        }
    }

    #[test]
    fn long_lists_of_lines_are_cut() {
        let mut lines = Lines::default();
        (1..=40).for_each(|line| lines.add(line));
        assert_eq!(lines.place(), "lines 1, 2, 3, 4, 5, 6, 7, 8, ... (40 in all)");
    }
}
