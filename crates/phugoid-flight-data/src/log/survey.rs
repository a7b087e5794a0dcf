//! A survey of a log: counts, times, gaps and ranges of every topic, in memory that does not grow with the log.

use serde::Serialize;

use super::decode::Scale;
use super::sink::{self, Full, Head, Layout, Sink, Stop, Stream};
use super::{Log, LogError, Message};
use crate::memory::{Account, Memory};
use crate::quality::QualityReport;

/// A time step longer than this many median steps is counted as a gap, as for records.
const GAP_FACTOR: f64 = 3.5;
/// Classes per doubling of the time step in the histogram for the median, which so is accurate to 1/16 of its value.
const CLASSES_PER_OCTAVE: usize = 8;
/// Number of classes of the histogram, from 1 to 2^36 microseconds (nineteen hours).
const CLASSES: usize = 36 * 8;

/// What is in a log, without its values.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Survey {
    /// Name of the file or stream.
    pub source: String,
    /// What the log states about itself, as pairs of name and value.
    pub information: Vec<(String, String)>,
    /// Parameters of the autopilot at the start of the log.
    pub parameters: Vec<(String, f64)>,
    /// Text messages of the autopilot.
    pub messages: Vec<Message>,
    /// Topics in the order of their first appearance.
    pub topics: Vec<TopicSurvey>,
    /// What the reader found, skipped and left out.
    pub quality: QualityReport,
}

/// Counts, times and gaps of one topic.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TopicSurvey {
    /// Name of the topic in the log.
    pub name: String,
    /// Number of the instance, from 0.
    pub instance: u16,
    /// Number of samples.
    pub samples: usize,
    /// Time of the first sample, s from the start of the log.
    pub first_s: f64,
    /// Time of the last sample, s from the start of the log.
    pub last_s: f64,
    /// Median time from sample to sample, s, accurate to 1/16 of its value; 0 if there are fewer than two samples.
    pub step_s: f64,
    /// Number of time steps longer than 3.5 median steps.
    pub gaps: usize,
    /// The longest time from one sample to the next, s.
    pub longest_step_s: f64,
    /// Time at which the longest step begins, s from the start of the log.
    pub longest_step_at_s: f64,
    /// Number of samples that are not later than the one before.
    pub backwards: usize,
    /// The fields in the order of the log.
    pub fields: Vec<FieldSurvey>,
}

/// Range and missing values of one field.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FieldSurvey {
    /// Name of the field within the topic.
    pub name: String,
    /// Unit as the log states it; `None` if it does not.
    pub unit: Option<String>,
    /// Smallest finite value; `None` if there is no finite value.
    pub min: Option<f64>,
    /// Largest finite value; `None` if there is no finite value.
    pub max: Option<f64>,
    /// Number of samples without a finite value.
    pub missing: usize,
}

impl Survey {
    /// The topic with this name and instance, or `None`.
    pub fn topic(&self, name: &str, instance: u16) -> Option<&TopicSurvey> {
        self.topics.iter().find(|topic| topic.name == name && topic.instance == instance)
    }

    /// Makes the survey of a log that is in memory.
    pub fn of(log: &Log) -> Self {
        let mut counts = Counts::new(&Account::new(Memory::default()));
        for topic in &log.topics {
            let names: Vec<String> = topic.fields.iter().map(|field| field.name.clone()).collect();
            let Some(stream) = counts.open(&topic.name, topic.instance, &names) else { continue };
            for (kept, &field) in stream.kept.iter().enumerate() {
                let unit = topic.fields.get(field).and_then(|field| field.unit.as_deref());
                counts.describe(&stream, kept, unit, Scale::ONE);
            }
            let mut row = vec![f64::NAN; stream.kept.len()];
            for (sample, &time_s) in topic.time_s.iter().enumerate() {
                for (value, &field) in row.iter_mut().zip(&stream.kept) {
                    *value = topic.fields.get(field).and_then(|f| f.values.get(sample)).copied().unwrap_or(f64::NAN);
                }
                // A survey is never full.
                let _ = counts.row(&stream, time_s * 1e6, &row);
            }
        }
        let head = Head { source: log.source.clone(), start_us: Some(0.0), ..Head::default() };
        Self {
            information: log.information.clone(),
            parameters: log.parameters.clone(),
            messages: log.messages.clone(),
            quality: log.quality.clone(),
            ..counts.finish(head)
        }
    }
}

/// A sink that counts samples and keeps none.
#[derive(Debug)]
pub(super) struct Counts {
    layout: Layout,
    topics: Vec<TopicCount>,
}

#[derive(Debug)]
struct TopicCount {
    name: String,
    instance: u16,
    samples: usize,
    first_us: f64,
    last_us: f64,
    longest_us: f64,
    longest_at_us: f64,
    backwards: usize,
    /// Histogram of the time steps, in classes of equal ratio.
    steps: Vec<u32>,
    fields: Vec<FieldCount>,
    /// Smallest and largest finite value and number of finite values, per field. They are not in [`FieldCount`], so
    /// that a row is one fast pass over numbers.
    min: Vec<f64>,
    max: Vec<f64>,
    present: Vec<u64>,
}

#[derive(Clone, Debug)]
struct FieldCount {
    name: String,
    unit: Option<String>,
}

impl TopicCount {
    fn new(name: &str, instance: u16) -> Self {
        Self {
            name: name.to_owned(),
            instance,
            samples: 0,
            first_us: f64::NAN,
            last_us: f64::NAN,
            longest_us: 0.0,
            longest_at_us: 0.0,
            backwards: 0,
            steps: Vec::new(),
            fields: Vec::new(),
            min: Vec::new(),
            max: Vec::new(),
            present: Vec::new(),
        }
    }

    fn clear(&mut self) {
        let mut empty = Self::new(&self.name, self.instance);
        let fields = std::mem::take(&mut self.fields);
        fields.into_iter().for_each(|field| empty.add(field));
        *self = empty;
    }

    fn add(&mut self, field: FieldCount) {
        self.fields.push(field);
        self.min.push(f64::INFINITY);
        self.max.push(f64::NEG_INFINITY);
        self.present.push(0);
    }

    /// Counts the finite ones of these values, field by field.
    #[inline]
    fn values(&mut self, values: &[f64]) {
        let ranges = self.min.iter_mut().zip(&mut self.max).zip(&mut self.present);
        for (((min, max), present), &value) in ranges.zip(values) {
            let finite = value.abs() < f64::INFINITY;
            *min = if finite && value < *min { value } else { *min };
            *max = if finite && value > *max { value } else { *max };
            *present += u64::from(finite);
        }
    }

    #[inline]
    fn step(&mut self, time_us: f64) {
        if self.samples == 0 {
            self.first_us = time_us;
        } else {
            let step = time_us - self.last_us;
            if step <= 0.0 {
                self.backwards += 1;
            } else {
                if step > self.longest_us {
                    (self.longest_us, self.longest_at_us) = (step, self.last_us);
                }
                if self.steps.is_empty() {
                    self.steps.resize(CLASSES, 0);
                }
                if let Some(class) = self.steps.get_mut(class_of(step)) {
                    *class = class.saturating_add(1);
                }
            }
        }
        self.samples += 1;
        self.last_us = time_us;
    }

    fn finish(self, start_us: f64) -> TopicSurvey {
        let seconds = |time_us: f64| (time_us - start_us) * 1e-6;
        let all: u64 = self.steps.iter().map(|&count| u64::from(count)).sum();
        let mut below = 0;
        let median = self.steps.iter().position(|&count| {
            below += u64::from(count);
            2 * below >= all && all > 0
        });
        let step_us = median.map_or(0.0, |class| 0.5 * (class_begin(class) + class_begin(class + 1)));
        let longer = |class: usize| median.is_some() && class_begin(class) > GAP_FACTOR * step_us;
        let gaps = self.steps.iter().enumerate().filter(|(class, _)| longer(*class)).map(|(_, &count)| count as usize);
        let samples = self.samples;
        let ranges = self.min.iter().zip(&self.max).zip(&self.present);
        let fields = self.fields.into_iter().zip(ranges).map(|(field, ((min, max), &present))| FieldSurvey {
            min: (present > 0).then_some(*min),
            max: (present > 0).then_some(*max),
            missing: samples.saturating_sub(present as usize),
            name: field.name,
            unit: field.unit,
        });
        TopicSurvey {
            samples,
            first_s: seconds(self.first_us),
            last_s: seconds(self.last_us),
            step_s: step_us * 1e-6,
            gaps: gaps.sum(),
            longest_step_s: self.longest_us * 1e-6,
            longest_step_at_s: if self.longest_us > 0.0 { seconds(self.longest_at_us) } else { 0.0 },
            backwards: self.backwards,
            fields: fields.collect(),
            name: self.name,
            instance: self.instance,
        }
    }
}

/// The class of a time step, microseconds: exponent and first three bits of the fraction of the double, which is faster
/// than a logarithm per sample.
fn class_of(step_us: f64) -> usize {
    let bits = step_us.max(1.0).to_bits() >> (52 - 3);
    ((bits - (1023 << 3)) as usize).min(CLASSES - 1)
}

/// Lower limit of a class, microseconds.
fn class_begin(class: usize) -> f64 {
    let (octave, part) = (class / CLASSES_PER_OCTAVE, class % CLASSES_PER_OCTAVE);
    2_f64.powi(octave as i32) * (1.0 + part as f64 / CLASSES_PER_OCTAVE as f64)
}

impl Counts {
    pub(super) fn new(account: &Account) -> Self {
        Self { layout: Layout::new(account), topics: Vec::new() }
    }

    pub(super) fn finish(self, mut head: Head) -> Survey {
        self.layout.report(&mut head.quality);
        let start_us = head.settle();
        let topics = self.topics.into_iter().filter(|topic| topic.samples > 0);
        Survey {
            source: head.source,
            information: head.information,
            parameters: head.parameters,
            messages: head.messages,
            topics: topics.map(|topic| topic.finish(start_us)).collect(),
            quality: head.quality,
        }
    }
}

impl Sink for Counts {
    fn open(&mut self, topic: &str, instance: u16, fields: &[String]) -> Option<Stream> {
        let stream = sink::open_all(&mut self.layout, topic, instance, fields)?;
        if stream.topic() == self.topics.len() {
            self.topics.push(TopicCount::new(topic, instance));
        }
        let count = self.topics.get_mut(stream.topic())?;
        for (&field, &column) in stream.kept.iter().zip(stream.columns()) {
            if column == count.fields.len() {
                let name = fields.get(field).cloned().unwrap_or_default();
                count.add(FieldCount { name, unit: None });
            }
        }
        Some(stream)
    }

    #[inline]
    fn row(&mut self, stream: &Stream, time_us: f64, values: &[f64]) -> Result<(), Full> {
        let Some(topic) = self.topics.get_mut(stream.topic()) else { return Ok(()) };
        topic.step(time_us);
        if stream.in_order() {
            topic.values(values);
            return Ok(());
        }
        for (&column, &value) in stream.columns().iter().zip(values) {
            let range = topic.min.get_mut(column).zip(topic.max.get_mut(column)).zip(topic.present.get_mut(column));
            if let Some(((min, max), present)) = range.filter(|_| value.is_finite()) {
                (*min, *max) = (min.min(value), max.max(value));
                *present += 1;
            }
        }
        Ok(())
    }

    fn describe(&mut self, stream: &Stream, kept: usize, unit: Option<&str>, factor: Scale) {
        let Some(topic) = self.topics.get_mut(stream.topic()) else { return };
        let Some(&column) = stream.columns().get(kept) else { return };
        if let Some(field) = topic.fields.get_mut(column) {
            field.unit = unit.map(str::to_owned);
        }
        let range = topic.min.get_mut(column).zip(topic.max.get_mut(column));
        if let Some((min, max)) = range.filter(|(min, max)| factor != Scale::ONE && min <= max) {
            let (a, b) = (factor.apply(*min), factor.apply(*max));
            (*min, *max) = (a.min(b), a.max(b));
        }
    }

    fn forget(&mut self, stream: &Stream) -> usize {
        let Some(topic) = self.topics.get_mut(stream.topic()) else { return 0 };
        let count = topic.samples;
        topic.clear();
        count
    }
}

/// Makes a survey of what the reader of a format gives. A survey keeps no values and is never full, but what a log
/// defines may need more memory than the account has.
pub(super) fn into_survey(
    source: &str,
    account: &Account,
    run: impl FnOnce(&mut Counts) -> Result<Head, Stop>,
) -> Result<Survey, LogError> {
    let mut counts = Counts::new(account);
    match run(&mut counts) {
        Ok(head) => Ok(counts.finish(head)),
        Err(stop) => Err(stop.into_error(source, account)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Field, Topic};

    #[test]
    fn counts_gaps_and_ranges() {
        let mut time_s: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
        time_s.extend((0..100).map(|i| 3.0 + 0.01 * f64::from(i)));
        time_s.push(1.0);
        let mut values: Vec<f64> = (0..201).map(f64::from).collect();
        values[7] = f64::NAN;
        let field = Field { name: "x".into(), unit: Some("m".into()), values };
        let topic = Topic { name: "T".into(), instance: 2, time_s, fields: vec![field] };
        let survey = Survey::of(&Log { topics: vec![topic], ..Log::default() });
        let topic = survey.topic("T", 2).unwrap();
        assert_eq!((topic.samples, topic.gaps, topic.backwards), (201, 1, 1));
        assert!((topic.step_s / 0.01 - 1.0).abs() < 1.0 / 16.0, "{}", topic.step_s);
        assert!((topic.longest_step_s - 2.01).abs() < 1e-9 && (topic.longest_step_at_s - 0.99).abs() < 1e-9);
        let field = &topic.fields[0];
        assert_eq!((field.min, field.max, field.missing), (Some(0.0), Some(200.0), 1));
        assert_eq!(field.unit.as_deref(), Some("m"));
    }
}
