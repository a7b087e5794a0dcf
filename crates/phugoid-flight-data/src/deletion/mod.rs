//! Deletion of values that are known to be bad, each with its reason.
//!
//! What an engineer knows of a flight (a bird strike, a dropout of the telemetry, a vane that iced up) is in no channel.
//! A [`Deletion`] says where the bad values are and why they are bad. [`Record::delete`] makes them missing (NaN) and
//! writes into the quality report how many values of which channel are gone, when, and why, so that every result made of
//! the record says it too.
//!
//! ```
//! use phugoid_flight_data::deletion::Deletion;
//! use phugoid_flight_data::record::Record;
//! let mut flight = Record::open("examples/flight.csv")?;
//! let strike: Deletion = "alpha@2.5s..2.6s: bird strike".parse()?;
//! let deleted = flight.delete(&strike)?;
//! assert_eq!(deleted.reason, "bird strike");
//! assert!(flight.quality.to_string().contains("alpha: 3 values deleted from 2.5 s to 2.6 s: bird strike"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod file;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::printable;
pub use crate::quality::{Deleted, DeletedValues};
use crate::quantity::{Dimension, QuantityError};
use crate::record::Record;
use crate::wording::Precise;
pub use file::{DeletionFile, DeletionFileError};

/// Tolerance for a time that was read off a file, s.
const SAME_TIME_S: f64 = 1e-9;

/// Which values of a record are bad, and why.
///
/// As text it is `CHANNEL@TIME: REASON`, `CHANNEL@FROM..TO: REASON`, `CHANNEL,CHANNEL@TIME: REASON`, or without a channel
/// for all of them: `12.5s..12.8s: telemetry dropout`. Times carry their unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deletion {
    /// Canonical names of the channels; empty for every channel of the record.
    pub channels: Vec<String>,
    /// First time, s.
    pub from_s: f64,
    /// Last time, s, included. Equal to the first for a single sample: the nearest within half a median step.
    pub to_s: f64,
    /// Why the values are bad, on one line.
    pub reason: String,
}

impl Deletion {
    /// A deletion of some channels (of all where there is none) from one time (s) to another, both included.
    ///
    /// # Errors
    /// [`DeletionError::NoReason`], [`DeletionError::NotATime`] for a time that is not finite,
    /// [`DeletionError::Backwards`].
    pub fn new(channels: Vec<String>, from_s: f64, to_s: f64, reason: &str) -> Result<Self, DeletionError> {
        let reason = printable::one_line(reason).trim().to_owned();
        let place = || place(&channels, from_s, to_s);
        if !reason.chars().any(char::is_alphanumeric) {
            return Err(DeletionError::NoReason { place: place() });
        }
        if !(from_s.is_finite() && to_s.is_finite()) {
            return Err(DeletionError::NotATime { place: place() });
        }
        if to_s < from_s {
            return Err(DeletionError::Backwards { place: place() });
        }
        Ok(Self { channels, from_s, to_s, reason })
    }

    /// Where the values are, e.g. `alpha@12.34s`.
    fn place(&self) -> String {
        place(&self.channels, self.from_s, self.to_s)
    }
}

fn place(channels: &[String], from_s: f64, to_s: f64) -> String {
    let names = channels.iter().map(|name| printable::one_line(name).into_owned()).collect::<Vec<_>>().join(",");
    let at = if names.is_empty() { "" } else { "@" };
    if from_s == to_s {
        format!("{names}{at}{}s", Precise(from_s))
    } else {
        format!("{names}{at}{}s..{}s", Precise(from_s), Precise(to_s))
    }
}

impl fmt::Display for Deletion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place(), self.reason)
    }
}

impl FromStr for Deletion {
    type Err = DeletionError;

    fn from_str(text: &str) -> Result<Self, DeletionError> {
        let shown = || printable::one_line(text).into_owned();
        let (place, reason) = text.split_once(':').ok_or_else(|| DeletionError::NoReason { place: shown() })?;
        let (channels, times) = match place.rsplit_once('@') {
            Some((channels, times)) => {
                let names: Vec<String> = channels.split(',').map(|name| name.trim().to_owned()).collect();
                if names.iter().any(String::is_empty) {
                    return Err(DeletionError::NoChannel { text: shown() });
                }
                (names, times)
            }
            None => (Vec::new(), place),
        };
        let time = |text: &str| {
            Dimension::TIME.parse(text).map_err(|error| DeletionError::Time { text: shown(), error: Box::new(error) })
        };
        let (from_s, to_s) = match times.split_once("..") {
            Some((from, to)) => (time(from)?, time(to)?),
            None => time(times).map(|at| (at, at))?,
        };
        Self::new(channels, from_s, to_s, reason)
    }
}

/// Why a deletion cannot be understood or carried out. The record is then as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeletionError {
    /// There is no reason, or it has neither a letter nor a digit.
    #[error("deletion `{place}`: say why the values are bad, as in `{place}: bird strike`; results list the reason")]
    NoReason {
        /// The deletion, without its reason.
        place: String,
    },
    /// There is an `@` without a channel in front of it.
    #[error(
        "deletion `{text}`: write a channel before the @, as in `alpha@12.34s: bird strike`, or no @ for all channels"
    )]
    NoChannel {
        /// The deletion as it was written.
        text: String,
    },
    /// A time cannot be read.
    #[error("deletion `{text}`: {error}; write `CHANNEL@12.34s: REASON` or `CHANNEL@12.3s..12.8s: REASON`")]
    Time {
        /// The deletion as it was written.
        text: String,
        /// What is wrong with the time.
        #[source]
        error: Box<QuantityError>,
    },
    /// A time is infinite or NaN.
    #[error("deletion `{place}`: its times have to be finite")]
    NotATime {
        /// The deletion, without its reason.
        place: String,
    },
    /// The last time is before the first.
    #[error("deletion `{place}`: it ends before it begins; write the earlier time first")]
    Backwards {
        /// The deletion, without its reason.
        place: String,
    },
    /// The record has no such channel.
    #[error(
        "deletion `{place}`: {source_name} has no channel '{channel}'{}. It has: {}",
        alike.as_ref().map(|alike| format!(" (did you mean '{alike}'?)")).unwrap_or_default(),
        available.join(", ")
    )]
    UnknownChannel {
        /// The deletion, without its reason.
        place: String,
        /// The record.
        source_name: String,
        /// The channel that is not there.
        channel: String,
        /// The channel with the most similar name, if one is similar enough to be a misspelling.
        alike: Option<String>,
        /// Names of the channels that the record has.
        available: Vec<String>,
    },
    /// The times are before the first or after the last sample.
    #[error("deletion `{place}`: {source_name} runs from {} s to {} s", Precise(*first_s), Precise(*last_s))]
    Outside {
        /// The deletion, without its reason.
        place: String,
        /// The record.
        source_name: String,
        /// First time of the record, s.
        first_s: f64,
        /// Last time of the record, s.
        last_s: f64,
    },
    /// No value lies there.
    #[error(
        "deletion `{place}`: {source_name} has no value of {channel} there{}",
        match nearest_s.as_slice() {
            [] => ", nor anywhere else".to_owned(),
            times => {
                let times: Vec<String> = times.iter().map(|time| format!("{} s", Precise(*time))).collect();
                format!("; the nearest {} at {}", if times.len() > 1 { "are" } else { "is" }, times.join(" and "))
            }
        }
    )]
    Nothing {
        /// The deletion, without its reason.
        place: String,
        /// The record.
        source_name: String,
        /// The channel, or `any channel`.
        channel: String,
        /// Times of the last value before and of the first one after it, s.
        nearest_s: Vec<f64>,
    },
    /// The record has no samples.
    #[error("deletion `{place}`: {source_name} has no samples")]
    Empty {
        /// The deletion, without its reason.
        place: String,
        /// The record.
        source_name: String,
    },
}

impl Record {
    /// Makes the values of a deletion missing (NaN), adds them to [`QualityReport::deletions`] and says so in a warning
    /// of the quality report for each channel.
    ///
    /// A single time takes the nearest sample within half a median step, a span every sample in it, both ends included.
    /// Values that are missing already do not count. A deletion either is carried out whole or leaves the record as it was.
    ///
    /// [`QualityReport::deletions`]: crate::quality::QualityReport::deletions
    ///
    /// # Errors
    /// [`DeletionError`]: a channel that is not there, a time outside of the record, or no value where one of the channels
    /// should have one (of all channels: where none has one).
    pub fn delete(&mut self, deletion: &Deletion) -> Result<Deleted, DeletionError> {
        let place = deletion.place();
        let (Some(first_s), Some(last_s)) = (self.time.first().copied(), self.time.last().copied()) else {
            return Err(DeletionError::Empty { place, source_name: self.source.clone() });
        };
        let half = (0.5 * self.sample_time_s()).max(SAME_TIME_S);
        let single = deletion.from_s == deletion.to_s;
        let slack = if single { half } else { SAME_TIME_S };
        if deletion.to_s < first_s - slack || deletion.from_s > last_s + slack {
            return Err(DeletionError::Outside { place, source_name: self.source.clone(), first_s, last_s });
        }
        let mut wanted = Vec::new();
        for name in &deletion.channels {
            match self.channels.iter().position(|channel| channel.name == *name) {
                Some(index) if wanted.contains(&index) => {}
                Some(index) => wanted.push(index),
                None => return Err(self.unknown(place, name)),
            }
        }
        let all = wanted.is_empty();
        if all {
            wanted = (0..self.channels.len()).collect();
        }
        let mut found: Vec<(usize, std::ops::Range<usize>)> = Vec::new();
        let mut counts = Vec::new();
        for index in wanted {
            let range = self.range(index, deletion, single.then_some(half));
            let Some(channel) = self.channels.get(index) else { continue };
            let values = channel.values.get(range.clone()).unwrap_or_default();
            let count = values.iter().filter(|value| value.is_finite()).count();
            if count > 0 {
                counts.push(DeletedValues { channel: channel.name.clone(), values: count });
                found.push((index, range));
            } else if !all {
                let channel = channel.name.clone();
                let nearest_s = self.nearest(&[index], deletion);
                return Err(DeletionError::Nothing { place, source_name: self.source.clone(), channel, nearest_s });
            }
        }
        if found.is_empty() {
            let every: Vec<usize> = (0..self.channels.len()).collect();
            let nearest_s = self.nearest(&every, deletion);
            let channel = "any channel".to_owned();
            return Err(DeletionError::Nothing { place, source_name: self.source.clone(), channel, nearest_s });
        }
        let (mut from_s, mut to_s) = (f64::INFINITY, f64::NEG_INFINITY);
        for (index, range) in found {
            let Some(channel) = self.channels.get_mut(index) else { continue };
            for (time, value) in self.time.iter().zip(&mut channel.values).take(range.end).skip(range.start) {
                if value.is_finite() {
                    *value = f64::NAN;
                    (from_s, to_s) = (from_s.min(*time), to_s.max(*time));
                }
            }
        }
        let deleted = Deleted { from_s, to_s, reason: deletion.reason.clone(), channels: counts };
        self.quality.findings.extend(deleted.findings(self.channels.len()));
        self.quality.deletions.push(deleted.clone());
        Ok(deleted)
    }

    /// Carries out several deletions, or none of them if one is wrong.
    ///
    /// # Errors
    /// The first one of [`Record::delete`].
    pub fn delete_all<'a>(&mut self, deletions: impl IntoIterator<Item = &'a Deletion>) -> Result<(), DeletionError> {
        let mut deletions = deletions.into_iter().peekable();
        if deletions.peek().is_none() {
            return Ok(());
        }
        let mut changed = self.clone();
        for deletion in deletions {
            changed.delete(deletion)?;
        }
        *self = changed;
        Ok(())
    }

    /// The samples of a deletion in one channel. `near` is the distance within which a single time takes a sample.
    fn range(&self, channel: usize, deletion: &Deletion, near: Option<f64>) -> std::ops::Range<usize> {
        let Some(near) = near else {
            let first = self.time.partition_point(|time| *time < deletion.from_s - SAME_TIME_S);
            return first..self.time.partition_point(|time| *time <= deletion.to_s + SAME_TIME_S).max(first);
        };
        // The nearest sample of the record, whether the channel has a value there or not: a value that is further away
        // is another one.
        let distance = |index: &usize| (self.time[*index] - deletion.from_s).abs();
        let after = self.time.partition_point(|time| *time < deletion.from_s);
        let sides = [after.checked_sub(1), Some(after).filter(|index| *index < self.time.len())];
        let nearest = sides.into_iter().flatten().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let has = |index: &usize| self.channels.get(channel).is_some_and(|c| index < &c.values.len());
        match nearest.filter(has).filter(|index| distance(index) <= near + SAME_TIME_S) {
            Some(index) => index..index + 1,
            None => 0..0,
        }
    }

    /// Times of the last value before a deletion and of the first one after it, in any of these channels.
    fn nearest(&self, channels: &[usize], deletion: &Deletion) -> Vec<f64> {
        let has = |index: usize| {
            let channels = channels.iter().filter_map(|channel| self.channels.get(*channel));
            channels.into_iter().any(|channel| channel.values.get(index).is_some_and(|value| value.is_finite()))
        };
        let middle = self.time.partition_point(|time| *time < deletion.from_s);
        let before = (0..middle).rev().find(|index| has(*index));
        let after = (middle..self.time.len()).find(|index| has(*index));
        before.into_iter().chain(after).filter_map(|index| self.time.get(index).copied()).collect()
    }

    fn unknown(&self, place: String, name: &str) -> DeletionError {
        match self.require(name) {
            Err(missing) => DeletionError::UnknownChannel {
                place,
                source_name: missing.source_name,
                channel: printable::one_line(&missing.channel).into_owned(),
                alike: missing.alike,
                available: missing.available,
            },
            // `delete` asks only for what is not there.
            Ok(channel) => DeletionError::NoChannel { text: channel.name.clone() },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::Finding;

    fn record() -> Record {
        let time: Vec<f64> = (0..100).map(|k| 0.1 * f64::from(k)).collect();
        let alpha = time.iter().map(|t| t.sin()).collect();
        let mut q = vec![0.5; 100];
        q[50] = f64::NAN;
        Record::from_columns("flight", [("time_s", time), ("alpha_rad", alpha), ("q_rad_s", q)]).unwrap()
    }

    fn delete(text: &str) -> Result<(Record, Deleted), String> {
        let mut record = record();
        let before = record.clone();
        let deletion: Deletion = text.parse().map_err(|e: DeletionError| e.to_string())?;
        match record.delete(&deletion) {
            Ok(deleted) => Ok((record, deleted)),
            Err(error) => {
                // NaN is not equal to itself: by bits.
                let bits = |r: &Record| -> Vec<u64> {
                    r.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect()
                };
                assert_eq!(bits(&record), bits(&before), "an error leaves the record as it was");
                assert_eq!(record.quality, before.quality);
                Err(error.to_string())
            }
        }
    }

    #[test]
    fn values_become_missing_and_the_report_says_why() {
        let (record, deleted) = delete("alpha@1.21s: bird strike").unwrap();
        let alpha = &record.channel("alpha").unwrap().values;
        assert!(alpha[12].is_nan() && alpha.iter().filter(|v| v.is_nan()).count() == 1);
        assert_eq!(deleted.channels, [DeletedValues { channel: "alpha".to_owned(), values: 1 }]);
        assert_eq!(record.quality.deletions, [deleted]);
        let told: Vec<String> = record.quality.warnings().map(|f| format!("{}: {}", f.place, f.message)).collect();
        assert!(told.contains(&"alpha: 1 value deleted at 1.2 s: bird strike".to_owned()), "{told:?}");
        // A span: both ends included; values that are missing already are not counted.
        let (record, deleted) = delete("alpha, q@4.9s..5.1s: the telemetry was lost: no carrier").unwrap();
        let counts: Vec<usize> = deleted.channels.iter().map(|c| c.values).collect();
        assert_eq!((counts, deleted.reason.as_str()), (vec![3, 2], "the telemetry was lost: no carrier"));
        assert!(record.channels.iter().all(|c| c.values[49..=51].iter().all(|v| v.is_nan())));
        // All channels, in other units.
        let (record, _) = delete("2000ms..2.5s: dropout").unwrap();
        assert!(record.channels.iter().all(|c| c.values[20..=25].iter().all(|v| v.is_nan())));
        assert!(record.channels.iter().all(|c| c.values[19].is_finite() && c.values[26].is_finite()));
        // One sample of all channels, of which one has a value.
        let (_, deleted) = delete("5.0s: dropout").unwrap();
        assert_eq!(deleted.channels.len(), 1);
    }

    #[test]
    fn the_text_of_a_deletion_reads_back() {
        for text in ["alpha@12.34s: bird strike", "alpha,q@1s..2.5s: ice", "3.25s: dropout"] {
            assert_eq!(text.parse::<Deletion>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_what_would_be_right() {
        for (text, words) in [
            ("alpha@12.34s", "say why"),
            ("alpha@1.2s:  ", "say why the values are bad, as in `alpha@1.2s: bird strike`"),
            ("alpha@1.2s: \u{1b}\u{7}", "say why"),
            ("alhpa@1.2s: ice", "no channel 'alhpa' (did you mean 'alpha'?). It has: alpha, q"),
            ("@1.2s: ice", "write a channel before the @"),
            ("alpha@1.2: ice", "has no unit"),
            ("alpha@: ice", "alpha@"),
            ("alpha@2s..1s: ice", "it ends before it begins"),
            ("alpha@12.34s: ice", "runs from 0 s to 9.9 s"),
            ("alpha@-3s..-2s: ice", "runs from 0 s to 9.9 s"),
            ("q@5.0s: ice", "no value of q there; the nearest are at 4.9 s and 5.1 s"),
            ("alpha@1.21s..1.29s: ice", "no value of alpha there; the nearest are at 1.2 s and 1.3 s"),
            ("1.21s..1.29s: ice", "no value of any channel there; the nearest are at 1.2 s and 1.3 s"),
        ] {
            let error = delete(text).expect_err(text);
            assert!(error.contains(words), "{text}: {error}");
        }
        let empty: Deletion = "1s: ice".parse().unwrap();
        assert!(Record::default().delete(&empty).unwrap_err().to_string().contains("no samples"));
        assert!(Deletion::new(Vec::new(), f64::NAN, 1.0, "ice").is_err());
    }

    #[test]
    fn no_command_of_a_terminal_gets_into_a_report() {
        let (record, deleted) = delete("alpha@1.2s: red \u{1b}[31m\nsecond line").unwrap();
        assert_eq!(deleted.reason, "red \u{fffd}[31m second line");
        assert!(!record.quality.to_string().contains('\u{1b}'));
        let error = delete("al\u{1b}[2Jpha@1.2s: ice").unwrap_err();
        assert!(!error.contains('\u{1b}'), "{error}");
    }

    #[test]
    fn several_are_carried_out_together_or_not_at_all() {
        let mut record = record();
        let deletions: Vec<Deletion> = ["alpha@1s: ice", "alpha@1s: ice"].map(|text| text.parse().unwrap()).to_vec();
        // The second one finds nothing left.
        assert!(record.delete_all(&deletions).is_err());
        assert!(record.channel("alpha").unwrap().values[10].is_finite() && record.quality.deletions.is_empty());
        record.delete_all(&deletions[..1]).unwrap();
        assert_eq!(record.quality.deletions.len(), 1);
    }

    #[test]
    fn equal_losses_of_all_channels_are_one_finding() {
        let time: Vec<f64> = (0..10).map(f64::from).collect();
        let column = vec![1.0; 10];
        let columns =
            [("time_s", time), ("alpha_rad", column.clone()), ("q_rad_s", column.clone()), ("theta_rad", column)];
        let mut record = Record::from_columns("flight", columns).unwrap();
        record.delete(&"2s..3s: dropout".parse().unwrap()).unwrap();
        let told: Vec<&Finding> = record.quality.warnings().filter(|f| f.message.contains("deleted")).collect();
        assert_eq!((told.len(), told[0].place.as_str()), (1, "all channels"));
        assert_eq!(told[0].message, "2 values of each deleted from 2 s to 3 s: dropout");
    }
}
