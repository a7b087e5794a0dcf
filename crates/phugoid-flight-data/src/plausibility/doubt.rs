//! What a check found.

use std::fmt;

use crate::quality::{Finding, Severity};
use crate::record::Record;

/// How sure a check is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// Unusual, but a flight can look like this.
    Doubtful,
    /// No flight looks like this.
    Certain,
}

/// Channels whose unit or sign looks wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    /// The channel to blame; several where they contradict one another and any of them may be wrong.
    pub channels: Vec<String>,
    /// How sure.
    pub certainty: Certainty,
    /// What was found, what was expected, what to do.
    pub message: String,
}

impl Doubt {
    /// The channels in words: `alpha`, `theta and q`.
    pub fn place(&self) -> String {
        self.channels.join(" and ")
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = if self.channels.len() == 1 { "" } else { "s" };
        write!(f, "channel{plural} `{}`: {}", self.channels.join("` and `"), self.message)
    }
}

impl From<Doubt> for Finding {
    /// A warning if it is certain, else a note.
    fn from(doubt: Doubt) -> Self {
        let severity = match doubt.certainty {
            Certainty::Certain => Severity::Warning,
            Certainty::Doubtful => Severity::Note,
        };
        Self { severity, place: doubt.place(), message: doubt.message }
    }
}

/// The findings so far, and the record that they are about.
pub(super) struct Doubts<'a> {
    pub(super) record: &'a Record,
    pub(super) found: Vec<Doubt>,
}

impl<'a> Doubts<'a> {
    /// Values of a channel, if it is there and as long as the time.
    pub(super) fn values(&self, name: &str) -> Option<&'a [f64]> {
        let values = &self.record.channel(name)?.values;
        (values.len() == self.record.time.len()).then_some(values)
    }

    pub(super) fn time(&self) -> &'a [f64] {
        &self.record.time
    }

    /// Unit in which the file gave a channel; none for a record made in memory.
    pub(super) fn unit(&self, name: &str) -> Option<&'a str> {
        self.record.quality.channels.iter().find(|entry| entry.name == name).map(|entry| entry.unit.as_str())
    }

    pub(super) fn any(&self, channels: &[&str]) -> bool {
        self.found.iter().any(|doubt| doubt.channels.iter().any(|name| channels.contains(&name.as_str())))
    }

    pub(super) fn is_certain(&self, channel: &str) -> bool {
        self.found.iter().any(|doubt| doubt.certainty == Certainty::Certain && doubt.channels == [channel])
    }

    pub(super) fn add(&mut self, channels: &[&str], certainty: Certainty, message: String) {
        let channels = channels.iter().map(|name| (*name).to_owned()).collect();
        self.found.push(Doubt { channels, certainty, message });
    }

    /// Like `add`, in place of what was said before about these channels alone: it had the same cause.
    pub(super) fn replace(&mut self, channels: &[&str], certainty: Certainty, message: String) {
        self.found.retain(|doubt| !(doubt.channels.len() == 1 && channels.contains(&doubt.channels[0].as_str())));
        self.add(channels, certainty, message);
    }
}

/// What to do about a channel that is in degrees and was read as radians.
pub(super) fn write_degrees(channel: &str, unit: &str) -> String {
    let suffix = unit.replace('/', "_");
    format!(
        "If it is in {unit}, name the column `{channel}_{suffix}`, or give its unit in the model file: [channels] \
         {channel} = {{ header = \"...\", unit = \"{unit}\" }}"
    )
}
