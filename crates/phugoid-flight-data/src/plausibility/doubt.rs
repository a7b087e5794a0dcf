//! The findings of the checks.

use std::fmt;

use crate::quality::{Finding, Severity};
use crate::record::Record;
use crate::statistics::median_step;

/// How certain it is that a unit or sign is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// The values are unusual, but a flight can look like this.
    Doubtful,
    /// No flight can look like this.
    Certain,
}

/// What is probably wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A unit, a sign or a name.
    Unit,
    /// The sensor or its recorder: a scale factor, a stuck or a saturated channel.
    Sensor,
    /// Nothing of the channel: most of the record was not recorded in flight.
    Standing,
}

/// Channels whose unit, sign or sensor is implausible.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// The channel that is wrong; several if they contradict each other and any of them may be wrong.
    pub channels: Vec<String>,
    /// How certain it is that they are wrong.
    pub certainty: Certainty,
    /// What is probably wrong with them.
    pub cause: Cause,
    /// From when on, s on the clock of the record, where it begins in flight; `None` of the whole record.
    pub since_s: Option<f64>,
    /// What was found, what was expected, and what the user can do, as a sentence without its subject.
    pub message: String,
}

impl Doubt {
    /// The names of the channels in a phrase: `alpha`, `theta and q`.
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
    /// Makes a warning if it is certain, else a note.
    fn from(doubt: Doubt) -> Self {
        let severity = match doubt.certainty {
            Certainty::Certain => Severity::Warning,
            Certainty::Doubtful => Severity::Note,
        };
        Self { severity, place: doubt.place(), message: doubt.message }
    }
}

/// The record that is checked, and the findings so far.
pub(super) struct Doubts<'a> {
    pub(super) record: &'a Record,
    pub(super) found: Vec<Doubt>,
    /// Median step of the time, s: several checks ask for it.
    step: Option<f64>,
}

impl<'a> Doubts<'a> {
    pub(super) fn of(record: &'a Record) -> Self {
        Self { record, found: Vec::new(), step: median_step(&record.time) }
    }

    /// The median step of the time, s; `None` if there is no finite step.
    pub(super) fn step(&self) -> Option<f64> {
        self.step
    }

    /// The values of a channel, if the record has it and it is as long as the time.
    pub(super) fn values(&self, name: &str) -> Option<&'a [f64]> {
        let values = &self.record.channel(name)?.values;
        (values.len() == self.record.time.len()).then_some(values)
    }

    pub(super) fn time(&self) -> &'a [f64] {
        &self.record.time
    }

    /// The unit that the channel had in the file; `None` for a record that was filled in memory.
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
        self.add_cause(channels, certainty, Cause::Unit, message);
    }

    pub(super) fn add_cause(&mut self, channels: &[&str], certainty: Certainty, cause: Cause, message: String) {
        let channels = channels.iter().map(|name| (*name).to_owned()).collect();
        self.found.push(Doubt { channels, certainty, cause, since_s: None, message });
    }

    /// A sensor that fails at a time, s.
    pub(super) fn add_since(&mut self, channel: &str, since_s: f64, message: String) {
        self.add_cause(&[channel], Certainty::Doubtful, Cause::Sensor, message);
        if let Some(last) = self.found.last_mut() {
            last.since_s = Some(since_s);
        }
    }

    /// As `add`, but replaces earlier findings about one of these channels alone, because they have the same cause.
    pub(super) fn replace(&mut self, channels: &[&str], certainty: Certainty, message: String) {
        self.found.retain(|doubt| !(doubt.channels.len() == 1 && channels.contains(&doubt.channels[0].as_str())));
        self.add(channels, certainty, message);
    }
}

/// The advice for a channel that is in degrees and was read as radians.
pub(super) fn write_degrees(channel: &str, unit: &str) -> String {
    let suffix = unit.replace('/', "_");
    format!(
        "If it is in {unit}, name the column `{channel}_{suffix}`, or give its unit in the model file: [channels] \
         {channel} = {{ header = \"...\", unit = \"{unit}\" }}"
    )
}
