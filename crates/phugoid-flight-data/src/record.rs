//! A flight record in memory.

use crate::channels;
use crate::quality::QualityReport;
use crate::statistics;
pub use crate::units::Quantity;

/// One measured or computed signal on the record's time base.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Canonical name without a unit, such as `alpha`, `q`, `true_airspeed`, `elevator`, `ax`.
    pub name: String,
    /// What it is; values are in the SI unit of this quantity.
    pub quantity: Quantity,
    /// One value per time, SI; NaN where the value is missing.
    pub values: Vec<f64>,
}

/// A flight record: strictly increasing time and channels of the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Where it came from (a file name or the name of a scenario), for messages and reports.
    pub source: String,
    /// Time, s, strictly increasing.
    pub time: Vec<f64>,
    /// Channels, in the order of the file.
    pub channels: Vec<Channel>,
    /// What the reader found, mended and left out.
    pub quality: QualityReport,
}

impl Record {
    /// The channel with this canonical name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// The channel with this canonical name, or an error that says what there is instead.
    ///
    /// # Errors
    /// [`MissingChannel`] if the record has no channel of this name.
    pub fn require(&self, name: &str) -> Result<&Channel, MissingChannel> {
        self.channel(name).ok_or_else(|| {
            let alike = self
                .channels
                .iter()
                .map(|channel| (channel, strsim::normalized_damerau_levenshtein(name, &channel.name)))
                .filter(|&(_, likeness)| likeness >= 0.6)
                .max_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(channel, _)| channel.name.clone());
            MissingChannel {
                source_name: self.source.clone(),
                channel: name.to_owned(),
                header: match channels::by_name(name) {
                    Some(spec) if spec.quantity != Quantity::Number => {
                        format!("{name}_{}", spec.quantity.si_suffix())
                    }
                    _ => name.to_owned(),
                },
                alike,
                available: self.channels.iter().map(|channel| channel.name.clone()).collect(),
            }
        })
    }

    /// Number of times.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// True if there is no time at all.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// The part from one time (s) to another, both included; none if no time lies between them.
    pub fn between(&self, from_s: f64, to_s: f64) -> Option<Self> {
        // Times written with few digits: a bound that is meant to be one of them is.
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

    /// Median of the time steps, s; zero if there are fewer than two times.
    pub fn sample_time_s(&self) -> f64 {
        statistics::median_step(&self.time).unwrap_or(0.0)
    }
}

/// A channel that was needed and is not in the record.
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
    /// The channel that was asked for.
    pub channel: String,
    /// A header that would have been read as this channel.
    pub header: String,
    /// A channel of the record with a similar name.
    pub alike: Option<String>,
    /// The channels that there are.
    pub available: Vec<String>,
}
