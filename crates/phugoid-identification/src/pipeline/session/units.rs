//! Units and signs, asked again and again while a session runs: what is collected for its start is often too quiet to tell,
//! and a channel may change later.

use phugoid_flight_data::plausibility::{Cause, Certainty, Doubt};
use phugoid_flight_data::record::{Channel, Record};

use crate::core::estimation::{Event, EventKind, ParameterReadiness, ReasonCode};
use crate::judge::reasons::put_in_doubt;
use crate::model_file::ModelFile;
use crate::preparation::checks::all_doubts;

/// The last samples that are asked, s, ...
const WINDOW_S: f64 = 60.0;
/// ... and at most this many, so that memory and work stay bounded at any rate.
const MOST_SAMPLES: usize = 6_000;
/// They are asked again after this part of what they last, ...
const AGAIN: f64 = 1.0 / 6.0;
/// ... but not more often than this, s.
const SHORTEST_S: f64 = 1.0;
/// What is only unusual has to stand in this much of a flight, s: a few seconds of gusts are unusual by themselves.
const UNUSUAL_S: f64 = 20.0;

/// The last samples of a session, and what speaks against their units.
pub(super) struct UnitWatch {
    recent: Record,
    /// Time at which they are asked again, s.
    due_s: f64,
    /// What was found so far. It stays: the estimate contains the samples that it was found in.
    found: Vec<Doubt>,
}

impl UnitWatch {
    /// A watch that has seen nothing, for samples with the channels of this empty record.
    pub(super) fn new(channels: &Record) -> Self {
        Self { recent: channels.clone(), due_s: f64::NEG_INFINITY, found: Vec::new() }
    }

    /// Forgets the samples, as where the sender's clock was set; what was found stays.
    pub(super) fn begin_again(&mut self) {
        self.drop_before(f64::INFINITY);
        self.due_s = f64::NEG_INFINITY;
    }

    /// Takes a sample. Where the last samples are due, they are asked, and each new doubt becomes an event.
    pub(super) fn take(&mut self, time_s: f64, values: &[f64], model: &ModelFile, events: &mut Vec<Event>) {
        self.recent.time.push(time_s);
        for (channel, value) in self.recent.channels.iter_mut().zip(values) {
            channel.values.push(*value);
        }
        if self.due_s == f64::NEG_INFINITY {
            self.due_s = time_s + SHORTEST_S;
        }
        if time_s < self.due_s {
            return;
        }
        self.drop_before(time_s - WINDOW_S);
        let span_s = time_s - self.recent.time.first().copied().unwrap_or(time_s);
        self.due_s = time_s + SHORTEST_S.max(AGAIN * span_s);
        let mut doubts = in_doubt(&self.recent, model);
        // Right samples before hide a channel that has become wrong, until most of what is asked is wrong.
        if span_s > UNUSUAL_S {
            doubts.extend(in_doubt(&since(&self.recent, time_s - UNUSUAL_S), model));
        }
        for doubt in doubts {
            if self.found.iter().any(|known| known.channels == doubt.channels) {
                continue;
            }
            let message = format!(
                "check the unit and the sign: {}. Until this is settled and the estimation begun again, no parameter counts as ready",
                doubt.to_string().trim_end_matches('.')
            );
            events.push(Event { time_s, kind: EventKind::Units, message });
            self.found.push(doubt);
        }
    }

    /// Takes "ready" from a parameter if anything speaks against the units.
    pub(super) fn judge(&self, readiness: Option<&mut ParameterReadiness>) {
        if let (false, Some(readiness)) = (self.found.is_empty(), readiness) {
            put_in_doubt(readiness, ReasonCode::Units);
        }
    }

    fn drop_before(&mut self, from_s: f64) {
        let times = &mut self.recent.time;
        let old = times.partition_point(|time| *time < from_s).max(times.len().saturating_sub(MOST_SAMPLES));
        times.drain(..old);
        for channel in &mut self.recent.channels {
            channel.values.drain(..old);
        }
    }
}

/// What is doubtful about the units of a record.
fn in_doubt(record: &Record, model: &ModelFile) -> Vec<Doubt> {
    let span_s = record.time.first().zip(record.time.last()).map_or(0.0, |(first, last)| last - first);
    let mut doubts = all_doubts(record, model);
    // A sensor that stands still may stand still because the aircraft does: only the whole record tells that.
    doubts.retain(|doubt| {
        // Rounding may make the twenty seconds a little shorter.
        doubt.cause == Cause::Unit && (doubt.certainty == Certainty::Certain || span_s >= UNUSUAL_S - SHORTEST_S)
    });
    doubts
}

/// The samples of a record from a time on.
fn since(record: &Record, from_s: f64) -> Record {
    let old = record.time.partition_point(|time| *time < from_s);
    let newest = |values: &[f64]| values.get(old..).unwrap_or_default().to_vec();
    let channels = record.channels.iter().map(|c| Channel {
        name: c.name.clone(),
        quantity: c.quantity,
        values: newest(&c.values),
    });
    Record {
        source: record.source.clone(),
        time: newest(&record.time),
        channels: channels.collect(),
        ..Record::default()
    }
}
