//! What a record holds, before anything is estimated from it: channels, gaps, doubts, manoeuvres, and what they could tell.

mod model;

use std::collections::BTreeMap;

use phugoid_flight_data::plausibility;
use phugoid_flight_data::quality::{Finding, QualityReport};
use phugoid_flight_data::record::{Channel, Record};
use phugoid_flight_data::statistics::median;
use serde::{Deserialize, Serialize};

pub use crate::methods::{Predicted, PredictedParameter};
pub use model::{ModelSupport, ParameterSupport, SegmentSupport, model_support};

use crate::manoeuvres::{CoefficientSupport, Found, Settings, Support, find};
use crate::model_file::ModelFile;
use crate::preparation::noise::measure_noise;

/// What a record holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inspection {
    /// Where the record came from.
    pub source: String,
    /// Number of times.
    pub samples: usize,
    /// First and last time, s; none of an empty record.
    pub span_s: Option<[f64; 2]>,
    /// Median step of the time base, s.
    pub sample_time_s: f64,
    /// Stretches of the time base without any sample, longer than three steps: from and to, s; the longest ten.
    pub gaps_s: Vec<[f64; 2]>,
    /// Channels in the order of the file.
    pub channels: Vec<ChannelSurvey>,
    /// What the reader found, mended and left out.
    pub quality: QualityReport,
    /// Units and signs that cannot be, or hardly.
    pub doubts: Vec<Finding>,
    /// Manoeuvres, motion without input, and why nothing can be told where nothing can.
    pub found: Found,
    /// The best that any useful manoeuvre says of each derivative, and which manoeuvre that is.
    pub derivatives: Vec<Derivative>,
    /// The model files that were asked about, and what the record lacks for each.
    pub models: Vec<ModelNeeds>,
    /// What the record could tell of the parameters of one model, where that was asked ([`model_support`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub support: Option<ModelSupport>,
}

/// What one channel holds. Values in SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelSurvey {
    /// Canonical name.
    pub name: String,
    /// Header it was read from; empty for a record made in memory.
    pub header: String,
    /// Unit as given in the file, as the header says it; empty for a record made in memory.
    pub unit_given: String,
    /// Whether the file did not say the unit.
    pub unit_assumed: bool,
    /// Unit of the numbers here.
    pub unit: String,
    /// Values that are there.
    pub values: usize,
    /// Values that are missing.
    pub missing: usize,
    /// Values per second from the first to the last; none with fewer than two.
    pub rate_hz: Option<f64>,
    /// Longest time between two values, s.
    pub longest_gap_s: Option<f64>,
    /// Smallest value.
    pub minimum: Option<f64>,
    /// Median.
    pub median: Option<f64>,
    /// Largest value.
    pub maximum: Option<f64>,
    /// One sigma of its noise; none if it does not move.
    pub noise: Option<f64>,
    /// Whether the recorder's steps decided that, not the noise.
    pub quantised: bool,
}

/// The best that a record says of a derivative.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Derivative {
    /// Number of the manoeuvre.
    pub manoeuvre: usize,
    /// What it says.
    #[serde(flatten)]
    pub coefficient: CoefficientSupport,
}

/// What a record lacks for a model file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelNeeds {
    /// File or built-in name.
    pub model: String,
    /// Aircraft.
    pub aircraft: String,
    /// Channels that it reads and the record does not have.
    pub missing: Vec<String>,
    /// Channels that it reads and that have no value.
    pub empty: Vec<String>,
}

/// Looks at a record, and at what it lacks for some model files. What it could tell of their parameters is [`model_support`].
pub fn inspect(record: &Record, models: &[ModelFile], settings: &Settings) -> Inspection {
    let found = find(record, settings);
    let ends = record.time.first().zip(record.time.last());
    Inspection {
        source: record.source.clone(),
        samples: record.len(),
        span_s: ends.map(|(first, last)| [*first, *last]),
        sample_time_s: record.sample_time_s(),
        gaps_s: gaps(record),
        channels: record.channels.iter().map(|channel| survey(record, channel)).collect(),
        quality: record.quality.clone(),
        doubts: plausibility::check(record).into_iter().map(Finding::from).collect(),
        derivatives: derivatives(&found),
        found,
        models: models.iter().map(|model| needs(record, model)).collect(),
        support: None,
    }
}

impl Inspection {
    /// The manoeuvre of a number, or the sentence that says which there are.
    ///
    /// # Errors
    /// That sentence.
    pub fn segment(&self, number: usize) -> Result<[f64; 2], String> {
        segment(&self.found, number)
    }
}

/// From and to (s) of the manoeuvre of a number.
///
/// # Errors
/// A sentence that says which manoeuvres there are.
pub fn segment(found: &Found, number: usize) -> Result<[f64; 2], String> {
    if let Some(manoeuvre) = found.manoeuvres.iter().find(|m| m.number == number) {
        return Ok([manoeuvre.from_s, manoeuvre.to_s]);
    }
    let listed: Vec<String> = found
        .manoeuvres
        .iter()
        .map(|m| format!("{} ({:.2} s to {:.2} s, {})", m.number, m.from_s, m.to_s, m.words()))
        .collect();
    Err(match listed.len() {
        0 => format!("no manoeuvre was found: {}", found.reasons.join("; ")),
        _ => format!("there is no manoeuvre {number}; there are {}", listed.join(", ")),
    })
}

fn gaps(record: &Record) -> Vec<[f64; 2]> {
    const SHOWN: usize = 10;
    let step = record.sample_time_s();
    let long = |pair: &&[f64]| pair[1] - pair[0] > 3.0 * step;
    let mut gaps: Vec<[f64; 2]> = record.time.windows(2).filter(long).map(|pair| [pair[0], pair[1]]).collect();
    gaps.sort_by(|a, b| (b[1] - b[0]).total_cmp(&(a[1] - a[0])));
    gaps.truncate(SHOWN);
    gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
    gaps
}

fn survey(record: &Record, channel: &Channel) -> ChannelSurvey {
    let given = record.quality.channels.iter().find(|entry| entry.name == channel.name);
    let (time, mut values): (Vec<f64>, Vec<f64>) =
        record.time.iter().zip(&channel.values).filter(|(_, v)| v.is_finite()).map(|(t, v)| (*t, *v)).unzip();
    let span = time.last().zip(time.first()).map(|(last, first)| last - first).filter(|span| *span > 0.0);
    let noise = measure_noise(&values);
    ChannelSurvey {
        name: channel.name.clone(),
        header: given.map(|g| g.header.clone()).unwrap_or_default(),
        unit_given: given.map(|g| g.unit.clone()).unwrap_or_default(),
        unit_assumed: given.is_some_and(|g| g.unit_assumed),
        unit: channel.quantity.si_unit().to_owned(),
        values: values.len(),
        missing: channel.values.len() - values.len(),
        rate_hz: span.map(|span| (time.len() - 1) as f64 / span),
        longest_gap_s: time.windows(2).map(|pair| pair[1] - pair[0]).max_by(f64::total_cmp),
        minimum: values.iter().copied().min_by(f64::total_cmp),
        maximum: values.iter().copied().max_by(f64::total_cmp),
        noise: noise.map(|n| n.std),
        quantised: noise.is_some_and(|n| n.quantised),
        median: median(&mut values),
    }
}

fn derivatives(found: &Found) -> Vec<Derivative> {
    let mut best: Vec<Derivative> = Vec::new();
    let mut place: BTreeMap<&str, usize> = BTreeMap::new();
    for manoeuvre in found.manoeuvres.iter().filter(|m| m.useful) {
        for coefficient in &manoeuvre.coefficients {
            let candidate = Derivative { manoeuvre: manoeuvre.number, coefficient: coefficient.clone() };
            match place.get(coefficient.name.as_str()).and_then(|&i| best.get_mut(i)) {
                Some(known) => {
                    if rank(coefficient) > rank(&known.coefficient) {
                        *known = candidate;
                    }
                }
                None => {
                    place.insert(&coefficient.name, best.len());
                    best.push(candidate);
                }
            }
        }
    }
    best
}

fn rank(coefficient: &CoefficientSupport) -> (Support, u64) {
    // The smaller bound is the better one: in tenths of a percent.
    let bound = coefficient.two_sigma_over_value.map_or(u64::MAX, |b| (1000.0 * b) as u64);
    (coefficient.support, u64::MAX - bound)
}

fn needs(record: &Record, model: &ModelFile) -> ModelNeeds {
    let (mut missing, mut empty) = (Vec::new(), Vec::new());
    for name in model.channels_used() {
        match record.channel(name) {
            None if !missing.iter().any(|m| m == name) => missing.push(name.to_owned()),
            Some(channel) if !channel.values.iter().any(|v| v.is_finite()) => empty.push(name.to_owned()),
            _ => {}
        }
    }
    ModelNeeds { model: model.source.clone(), aircraft: model.name.clone(), missing, empty }
}
