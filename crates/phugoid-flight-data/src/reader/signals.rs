//! One channel of a log, at the times of its topic and in the unit of the log.

use crate::align::Hold;
use crate::log::{Field, Log, Topic};
use crate::profile::{FieldName, Source, Transform};
use crate::table::time_base;

/// A channel of a log at the times of its topic.
#[derive(Clone, Debug)]
pub(super) struct Signal {
    /// Canonical name of the channel.
    pub(super) channel: String,
    /// The field or fields it was made of, in words, for the quality report.
    pub(super) header: String,
    /// Unit of the values; `None` if neither the log nor the profile states one.
    pub(super) unit: Option<String>,
    /// Factor by which the values are to be multiplied before the unit is converted.
    pub(super) scale: f64,
    pub(super) hold: Hold,
    /// The topic it came from, with the instance where there are several.
    pub(super) topic: String,
    /// Times of the samples, s from the start of the log, strictly increasing.
    pub(super) time_s: Vec<f64>,
    pub(super) values: Vec<f64>,
    pub(super) note: Option<String>,
    /// Number of samples left out because their time is not in order.
    pub(super) out_of_order: usize,
}

/// Largest age at which the last value of a factor is used, s.
const FACTOR_STALE_S: f64 = 5.0;

/// The topic with this name and instance; without an instance the one with the lowest number.
pub(super) fn topic<'a>(log: &'a Log, name: &str, instance: Option<u16>) -> Option<&'a Topic> {
    let same = log.topics.iter().filter(|topic| topic.name == name && instance.is_none_or(|one| one == topic.instance));
    same.min_by_key(|topic| topic.instance)
}

/// The name of a topic for messages: `IMU`, or `IMU#1` where the log has several instances.
pub(super) fn label(log: &Log, topic: &Topic) -> String {
    let several = log.topics.iter().filter(|other| other.name == topic.name).count() > 1;
    if several { format!("{}#{}", topic.name, topic.instance) } else { topic.name.clone() }
}

fn field<'a>(log: &'a Log, name: &FieldName) -> Option<(&'a Topic, &'a Field)> {
    // Without an instance, the lowest one that has the field: instances need not have the same.
    let same = log
        .topics
        .iter()
        .filter(|topic| topic.name == name.topic && name.instance.is_none_or(|instance| instance == topic.instance));
    let with_field = same.filter_map(|topic| Some((topic, topic.field(&name.field)?)));
    with_field.min_by_key(|(topic, _)| topic.instance)
}

/// Number of samples that a source would give; `None` if the log lacks one of its fields or has fewer than two samples.
pub(super) fn samples(log: &Log, source: &Source) -> Option<usize> {
    let inputs: Option<Vec<_>> = source.inputs().iter().map(|name| field(log, name)).collect();
    let inputs = inputs?;
    let all_have = inputs.iter().all(|(_, field)| field.values.iter().any(|value| value.is_finite()));
    let first = inputs.first().filter(|_| all_have)?;
    Some(first.1.values.iter().filter(|value| value.is_finite()).count()).filter(|&count| count >= 2)
}

/// The signal that a source gives, with its transform, factor and scale applied. `None` if the log lacks one of its
/// fields.
pub(super) fn signal(log: &Log, source: &Source, channel: &str, hold: Hold) -> Option<Signal> {
    let inputs: Option<Vec<_>> = source.inputs().iter().map(|name| field(log, name)).collect();
    let inputs = inputs?;
    let (topic, first) = *inputs.first()?;
    let kept = rising(&topic.time_s);
    let mut factors = vec![LastValue::default(); inputs.len()];
    let mut row = vec![f64::NAN; inputs.len()];
    let (mut time_s, mut values) = (Vec::with_capacity(kept.len()), Vec::with_capacity(kept.len()));
    for &sample in &kept {
        let Some(&time) = topic.time_s.get(sample) else { continue };
        for ((value, (other, field)), held) in row.iter_mut().zip(&inputs).zip(&mut factors) {
            *value = match std::ptr::eq(*other, topic) {
                true => field.values.get(sample).copied().unwrap_or(f64::NAN),
                false => held.at(time, &other.time_s, &field.values, FACTOR_STALE_S),
            };
        }
        time_s.push(time);
        values.push(source.scale * source.value(&row));
    }
    let mut header = source.field.to_string();
    match source.transform {
        Transform::None => {}
        Transform::QuaternionPhi => header = format!("bank angle of {header}"),
        Transform::QuaternionTheta => header = format!("pitch attitude of {header}"),
        Transform::QuaternionPsi => header = format!("heading of {header}"),
    }
    if let Some(factor) = &source.factor {
        header = match factor {
            crate::profile::Factor::Times(field) => format!("{header} times {field}"),
            crate::profile::Factor::Density(field) => format!("{header} at the density {field}"),
        };
    }
    let own_unit = first.unit.as_deref().filter(|_| source.transform == Transform::None).map(plain_unit);
    Some(Signal {
        channel: channel.to_owned(),
        header,
        unit: own_unit.map(str::to_owned).or_else(|| source.unit.clone()),
        scale: 1.0,
        hold,
        topic: label(log, topic),
        out_of_order: topic.time_s.len() - kept.len(),
        time_s,
        values,
        note: source.note.clone(),
    })
}

/// The sum of signals times their factors, at the times of the first one. Signals with other times contribute their
/// last value before, if it is not older than `stale_after_s`, else NaN. Channel, unit and hold are those of the first;
/// `None` without a signal.
pub(super) fn sum(terms: &[(&Signal, f64)], stale_after_s: f64) -> Option<Signal> {
    let (first, _) = *terms.first()?;
    let mut values = vec![0.0; first.time_s.len()];
    for (signal, factor) in terms {
        let mut held = LastValue::default();
        for (sum, &time) in values.iter_mut().zip(&first.time_s) {
            *sum += factor * signal.scale * held.at(time, &signal.time_s, &signal.values, stale_after_s);
        }
    }
    let header: Vec<String> =
        terms.iter().map(|(signal, factor)| format!("{factor} times {}", signal.header)).collect();
    let mut notes: Vec<&str> = terms.iter().filter_map(|(signal, _)| signal.note.as_deref()).collect();
    notes.dedup();
    Some(Signal {
        header: header.join(" plus "),
        scale: 1.0,
        values,
        note: (!notes.is_empty()).then(|| notes.join(", ")),
        ..first.clone()
    })
}

/// Gives the last value at or before a time, for times that rise from call to call.
#[derive(Clone, Debug, Default)]
struct LastValue {
    next: usize,
    last: Option<(f64, f64)>,
}

impl LastValue {
    fn at(&mut self, time_s: f64, times: &[f64], values: &[f64], stale_after_s: f64) -> f64 {
        while let (Some(&stamp), Some(&value)) = (times.get(self.next), values.get(self.next))
            && stamp <= time_s
        {
            if value.is_finite() {
                self.last = Some((stamp, value));
            }
            self.next += 1;
        }
        self.last.filter(|(stamp, _)| time_s - stamp <= stale_after_s).map_or(f64::NAN, |(_, value)| value)
    }
}

/// Indices of the samples whose times are finite and in order; the fewest possible are left out.
pub(super) fn rising(time_s: &[f64]) -> Vec<usize> {
    let rows: Vec<usize> =
        (0..time_s.len()).filter(|&row| time_s.get(row).is_some_and(|time| time.is_finite())).collect();
    time_base::longest_rising(time_s, &rows)
}

/// The plain unit of a unit of ArduPilot's `UNIT` table, some of which also say what is measured.
pub(super) fn plain_unit(unit: &str) -> &str {
    match unit {
        "degheading" | "deglatitude" | "deglongitude" => "deg",
        other => other,
    }
}
