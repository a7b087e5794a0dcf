//! The flight record: time and named channels in SI units.

use crate::channels;
use crate::quality::QualityReport;
use crate::statistics;
use crate::table::clock::{self, Clock};
pub use crate::units::Quantity;

/// One measured or computed signal, with one value per time of its record.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Canonical name without a unit, such as `alpha`, `q`, `true_airspeed`, `elevator`, `ax`.
    pub name: String,
    /// Its physical quantity; the values are in the SI unit of this quantity.
    pub quantity: Quantity,
    /// One value per time, SI; NaN where the value is missing.
    pub values: Vec<f64>,
}

/// A flight record: strictly increasing time, and channels of the same length.
///
/// Channels have the canonical names of [`crate::channels::CHANNELS`] where they are known, else names of their own.
/// Readers make records that keep these rules; who fills the public fields has to keep them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Where it came from (a file name or the name of a scenario), for messages and reports.
    pub source: String,
    /// Times of the samples, s, finite and strictly increasing.
    pub time: Vec<f64>,
    /// The channels in the order of the file, without the time.
    pub channels: Vec<Channel>,
    /// What the reader found, assumed and left out; empty for a record that was filled in memory.
    pub quality: QualityReport,
}

impl Record {
    /// The channel with this name (the exact canonical name, no synonym), or `None`.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// The channel with this name, or an error that names the channels that there are.
    ///
    /// ```
    /// use phugoid_flight_data::record::Record;
    /// let record = Record::from_columns("example", [("time_s", vec![0.0, 0.1]), ("alpha_rad", vec![0.05, 0.06])])?;
    /// assert_eq!(record.require("alpha")?.values, [0.05, 0.06]);
    /// let error = record.require("alhpa").expect_err("it is misspelt");
    /// assert_eq!(error.alike.as_deref(), Some("alpha"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MissingChannel`] if the record has no channel of this name.
    pub fn require(&self, name: &str) -> Result<&Channel, MissingChannel> {
        self.channel(name).ok_or_else(|| MissingChannel {
            source_name: self.source.clone(),
            channel: name.to_owned(),
            header: match channels::by_name(name) {
                Some(spec) if spec.quantity != Quantity::Number => {
                    format!("{name}_{}", spec.quantity.si_suffix())
                }
                _ => name.to_owned(),
            },
            alike: self.similar_channel(name).map(str::to_owned),
            available: self.channels.iter().map(|channel| channel.name.clone()).collect(),
        })
    }

    /// The channel of the record whose name is probably another spelling of this one, or is this one with something behind it
    /// (`elevator_left`); `None` if there is none. Of two known channels (`theta`, `beta`) none is a spelling of the other.
    pub fn similar_channel(&self, name: &str) -> Option<&str> {
        let is_known = channels::by_name(name).is_some();
        let names = self.channels.iter().map(|channel| channel.name.as_str());
        let begins = |other: &str| {
            let rest = other.strip_prefix(name).filter(|_| !name.is_empty());
            rest.is_some_and(|rest| rest.starts_with(|c: char| !c.is_alphanumeric()))
        };
        names
            .filter(|other| !is_known || channels::by_name(other).is_none())
            .map(|other| (other, strsim::normalized_damerau_levenshtein(name, other)))
            .filter(|&(other, likeness)| likeness >= channels::MIN_SIMILARITY || begins(other))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(other, _)| other)
    }

    /// Number of samples: times, and values of each channel.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// True if the record has no samples.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// A copy of the part from one time (s) to another, both included (within 1e-9 s); `None` if no sample lies there.
    ///
    /// The quality report is copied whole: it describes the file.
    pub fn between(&self, from_s: f64, to_s: f64) -> Option<Self> {
        // A bound that a user reads off the file may differ from the time in its last digit.
        let first = self.time.partition_point(|time| *time < from_s - 1e-9);
        let end = self.time.partition_point(|time| *time <= to_s + 1e-9);
        let time = self.time.get(first..end).filter(|time| !time.is_empty())?.to_vec();
        let part = |channel: &Channel| Channel {
            name: channel.name.clone(),
            quantity: channel.quantity,
            values: channel.values.get(first..end).unwrap_or_default().to_vec(),
        };
        let channels = self.channels.iter().map(part).collect();
        Some(Self { source: self.source.clone(), time, channels, quality: self.quality.clone() })
    }

    /// The time of the record, s, at which its clock shows a time of day (s from midnight), as
    /// [`QualityReport::time_of_day_at_zero_s`] counts it.
    ///
    /// ```
    /// use phugoid_flight_data::csv::{self, CsvOptions};
    /// use phugoid_flight_data::record::time_of_day;
    /// let text = "clock,alpha_deg\n23:59:59,1\n00:00:00,2\n00:00:01,3\n";
    /// let record = csv::read(text.as_bytes(), "flight.csv", &CsvOptions::default())?;
    /// let midnight = time_of_day("00:00:00").expect("it is one");
    /// assert_eq!(record.at_time_of_day(midnight), Ok(1.0));
    /// assert!(record.at_time_of_day(midnight + 3600.0).is_err());
    /// # Ok::<(), csv::ReadError>(())
    /// ```
    ///
    /// # Errors
    /// [`NoTimeOfDay`]: the record has no such clock, or the clock shows this time never or more than once.
    pub fn at_time_of_day(&self, seconds: f64) -> Result<f64, NoTimeOfDay> {
        let zero = self.quality.time_of_day_at_zero_s.ok_or(NoTimeOfDay::NoClock)?;
        let ends = self.time.first().zip(self.time.last());
        let (&first, &last) = ends.ok_or(NoTimeOfDay::NoClock)?;
        let shown = |time: f64| clock::written(zero + time, false);
        // The first time from the begin of the record on. The last digit of a time that is written may differ.
        let time = first - 1e-6 + (seconds - zero - first + 1e-6).rem_euclid(clock::DAY);
        // Steps of a file are as good as its digits: microseconds.
        let time = (time * 1e6).round() / 1e6;
        if time > last + 1e-6 {
            return Err(NoTimeOfDay::Outside { from: shown(first), to: shown(last) });
        }
        match time + clock::DAY > last {
            true => Ok(time),
            false => Err(NoTimeOfDay::SeveralDays { hours: (last - first) / 3600.0 }),
        }
    }

    /// Median of the time steps, s (see [`statistics::median_step`]); 0 if there are fewer than two samples.
    pub fn sample_time_s(&self) -> f64 {
        statistics::median_step(&self.time).unwrap_or(0.0)
    }
}

/// The seconds from midnight of a time of day (`10:15:31`, `10:15:31.5`, `10:15:31,5`, `10:15:31 PM`, `10:15`); `None` for other
/// texts.
pub fn time_of_day(text: &str) -> Option<f64> {
    Clock::written_time_of_day(text).or_else(|| Clock::written_time_of_day(&format!("{}:00", text.trim())))
}

/// Why a time of day is no time of a record.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoTimeOfDay {
    /// The record does not say which time of day it was.
    #[error(
        "the record has no clock that shows times of day. Its times count from its beginning: write seconds, as in 4.5s"
    )]
    NoClock,
    /// The record begins later or ends before.
    #[error("by its clock the record runs from {from} to {to}")]
    Outside {
        /// What the clock shows at the first sample.
        from: String,
        /// What the clock shows at the last sample.
        to: String,
    },
    /// The record has this time of day on several days.
    #[error(
        "the record is {hours:.0} h long, and its clock shows this time more than once: write seconds from its beginning, as in \
         4.5s"
    )]
    SeveralDays {
        /// How long the record is, h.
        hours: f64,
    },
}

/// Error of [`Record::require`]: the channel is not in the record.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{source_name}: there is no channel '{channel}'{}. The record has: {}. \
     Give the column the header '{header}', or map it in the model file.",
    alike.as_ref().map(|alike| format!(" (did you mean '{alike}'?)")).unwrap_or_default(),
    available.join(", ")
)]
pub struct MissingChannel {
    /// Where the record came from.
    pub source_name: String,
    /// Name of the channel that was asked for.
    pub channel: String,
    /// A header that would have been read as this channel.
    pub header: String,
    /// The channel of the record with the most similar name, if one is similar enough to be a misspelling.
    pub alike: Option<String>,
    /// Names of the channels that the record has.
    pub available: Vec<String>,
}
