//! What a record holds, before anything is estimated from it: channels, gaps, doubts, manoeuvres, and which derivatives
//! could be estimated from them.

mod coherence;
mod model;

use std::collections::BTreeMap;

use phugoid_flight_data::plausibility;
use phugoid_flight_data::quality::{Finding, QualityReport};
use phugoid_flight_data::record::{Channel, Record};
use phugoid_flight_data::statistics::median;
use serde::{Deserialize, Serialize};

pub use crate::methods::{Predicted, PredictedParameter};
pub use coherence::{Coherence, CoherenceCurve, coherence};
pub use model::{ModelSupport, ParameterSupport, SegmentSupport, model_support};

use crate::judge::summary::without;
use crate::manoeuvres::{CoefficientSupport, Found, Settings, Support, find};
use crate::model_file::ModelFile;
use crate::preparation::noise::{measure_noise, measure_own_noise};

/// The result of [`inspect`]: channels, data quality, manoeuvres, and what can be estimated from them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inspection {
    /// Source of the record, e.g. its file name.
    pub source: String,
    /// Number of samples of the time base.
    pub samples: usize,
    /// First and last time, s; none of an empty record.
    pub span_s: Option<[f64; 2]>,
    /// Median step of the time base, s.
    pub sample_time_s: f64,
    /// Stretches of the time base without any sample, longer than three steps: from and to, s; the longest ten.
    pub gaps_s: Vec<[f64; 2]>,
    /// Channels in the order of the file.
    pub channels: Vec<ChannelSurvey>,
    /// What the reader of the file found, repaired and left out; without what is in `doubts`.
    pub quality: QualityReport,
    /// Units and signs that are impossible or implausible, by the checks of [`plausibility`].
    pub doubts: Vec<Finding>,
    /// Manoeuvres, motion without input, and why nothing can be estimated, where that is so.
    pub found: Found,
    /// For each derivative the useful manoeuvre from which it can be estimated best.
    pub derivatives: Vec<Derivative>,
    /// Spectral coherence of each surface that was moved and each output.
    #[serde(default)]
    pub coherence: Vec<Coherence>,
    /// The channels that the record lacks for each of the model files given.
    pub models: Vec<ModelNeeds>,
    /// How well the parameters of one model could be estimated; `None` unless [`model_support`] was called and its
    /// result put here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub support: Option<ModelSupport>,
}

/// Statistics of one channel of the record, in SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelSurvey {
    /// Canonical name of the channel, e.g. `alpha`.
    pub name: String,
    /// Header it was read from; empty for a record made in memory.
    pub header: String,
    /// Unit as given in the file, as the header says it; empty for a record made in memory.
    pub unit_given: String,
    /// True if the file did not give the unit, so that SI was assumed.
    pub unit_assumed: bool,
    /// SI unit of the numbers in this survey.
    pub unit: String,
    /// Number of finite values.
    pub values: usize,
    /// Number of samples without a finite value.
    pub missing: usize,
    /// Values per second from the first to the last; none with fewer than two.
    pub rate_hz: Option<f64>,
    /// Longest time between two values, s.
    pub longest_gap_s: Option<f64>,
    /// Smallest finite value, in `unit`.
    pub minimum: Option<f64>,
    /// Median of the finite values, in `unit`.
    pub median: Option<f64>,
    /// Largest finite value, in `unit`.
    pub maximum: Option<f64>,
    /// Standard deviation of its noise, from third differences; `None` if the channel is constant or too short.
    pub noise: Option<f64>,
    /// True if the steps of the recorder are larger than the noise and decide [`noise`](Self::noise).
    pub quantised: bool,
}

/// How well one derivative can be estimated from the best of the useful manoeuvres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Derivative {
    /// Number of the manoeuvre that says it, as in [`Manoeuvre::number`](crate::manoeuvres::Manoeuvre::number).
    pub manoeuvre: usize,
    /// The derivative, and how well it can be estimated from that manoeuvre.
    #[serde(flatten)]
    pub coefficient: CoefficientSupport,
}

/// The channels that a model file needs and the record does not have.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelNeeds {
    /// Name of the model file or of the built-in model.
    pub model: String,
    /// Name of the aircraft that the model file gives.
    pub aircraft: String,
    /// Channels that it reads and the record does not have.
    pub missing: Vec<String>,
    /// Channels that it reads and that have no value.
    pub empty: Vec<String>,
}

/// Surveys a record: channels, gaps, doubtful units, manoeuvres, and the channels that it lacks for some model files.
/// Nothing is estimated, no model is needed (`models` may be empty), and it never fails; NaN values count as missing.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::inspect::inspect;
/// use phugoid_identification::manoeuvres::{Settings, Support};
/// use phugoid_identification::model_file::ModelFile;
/// let flight = Record::open("examples/flight.csv")?;
/// let found = inspect(&flight, &[ModelFile::named("f16-six")?], &Settings::default());
/// assert_eq!(found.found.manoeuvres[0].words(), "elevator 3-2-1-1");
/// let stability = found.derivatives.iter().find(|d| d.coefficient.name == "Cm_alpha").ok_or("not found")?;
/// assert_eq!(stability.coefficient.support, Support::Told);
/// // Nothing lateral was recorded.
/// assert!(found.models[0].missing.contains(&"beta".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inspect(record: &Record, models: &[ModelFile], settings: &Settings) -> Inspection {
    let found = find(record, settings);
    let ends = record.time.first().zip(record.time.last());
    let doubts = plausibility::check(record);
    Inspection {
        source: record.source.clone(),
        samples: record.len(),
        span_s: ends.map(|(first, last)| [*first, *last]),
        sample_time_s: record.sample_time_s(),
        gaps_s: gaps(record),
        channels: record.channels.iter().map(|channel| survey(record, channel)).collect(),
        quality: without(&record.quality, &doubts),
        doubts: doubts.into_iter().map(Finding::from).collect(),
        derivatives: derivatives(&found),
        coherence: coherence(record, &found),
        found,
        models: models.iter().map(|model| needs(record, model)).collect(),
        support: None,
    }
}

impl Inspection {
    /// First and last time (s) of the manoeuvre with this number, counted from 1.
    ///
    /// # Errors
    /// A sentence that says which manoeuvres there are.
    pub fn segment(&self, number: usize) -> Result<[f64; 2], String> {
        segment(&self.found, number)
    }
}

/// First and last time (s) of the manoeuvre with this number, counted from 1.
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
    // Of a slow channel that repeats its last value the rows say nothing of the noise.
    let noise = measure_own_noise(&channel.values).or_else(|| measure_noise(&values));
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
