//! Recordings, and recorded flights of any kind, as if they were happening.

use std::time::{Duration, Instant};

use phugoid_flight_data::csv;
use phugoid_flight_data::record::{Channel, Record};

use super::outlet::{LOOK, Outlet};
use crate::arrival::{Arrival, Content};
use crate::recording::{Damage, Reader, RecordingError};

/// How fast a replay goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// This many times as fast as it happened.
    Times(f64),
    /// As fast as the machine can.
    Unlimited,
}

/// Something that happened before, to be received again.
pub struct Replay {
    name: String,
    pace: Pace,
    what: What,
}

enum What {
    Recording(Box<Reader>),
    Flight(Box<Record>),
}

/// Why a flight cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The flight, as text.
    #[error("{0}")]
    Flight(String),
}

/// Rows of a flight that are put into text at one time.
const ROWS: usize = 256;

impl Replay {
    /// Replays a recording.
    pub fn recording(reader: Reader, name: &str, pace: Pace) -> Self {
        Self { name: name.to_owned(), pace, what: What::Recording(Box::new(reader)) }
    }

    /// Replays a record as a stream of CSV rows, each at its time.
    ///
    /// # Errors
    /// [`ReplayError::Flight`] if a channel's name could not be read back.
    pub fn flight(record: Record, pace: Pace) -> Result<Self, ReplayError> {
        rows(&record, 0, 0)?;
        Ok(Self { name: record.source.clone(), pace, what: What::Flight(Box::new(record)) })
    }

    /// The file.
    pub fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn run(self, outlet: &Outlet) {
        let mut pacer = Pacer { pace: self.pace, start: None };
        match self.what {
            What::Recording(mut reader) => loop {
                match reader.next_arrival() {
                    Ok(Some(arrival)) => {
                        if !pacer.pass(arrival, outlet) {
                            return;
                        }
                    }
                    Ok(None) => {
                        if let Some(said) = damage(reader.damage()) {
                            outlet.pass(outlet.clock.stamp(u16::MAX, Content::Closed(said)));
                        }
                        return;
                    }
                    Err(error) => {
                        outlet.pass(outlet.clock.stamp(u16::MAX, Content::Closed(error.to_string())));
                        return;
                    }
                }
            },
            What::Flight(record) => {
                let _ = flight(&record, &self.name, &mut pacer, outlet);
            }
        }
    }
}

/// What is to be said about a recording that is not whole.
fn damage(damage: Damage) -> Option<String> {
    let mut said = Vec::new();
    if damage.skipped_bytes > 0 {
        let at = damage.first_at.unwrap_or_default();
        said.push(format!("{} damaged bytes were skipped, the first at byte {at}", damage.skipped_bytes));
    }
    if damage.cut_off_bytes > 0 {
        said.push(format!("the last block was cut off ({} bytes)", damage.cut_off_bytes));
    }
    if !damage.ended {
        said.push("the recording was not ended in order, as after a kill".to_owned());
    }
    (!said.is_empty()).then(|| format!("the recording: {}", said.join("; ")))
}

fn flight(record: &Record, name: &str, pacer: &mut Pacer, outlet: &Outlet) -> Result<(), ReplayError> {
    let first_s = record.time.first().copied().unwrap_or_default();
    let arrival = |time_s: f64, content| Arrival {
        arrival_ns: 1 + ((time_s - first_s) * 1e9) as u64,
        wall_ns: crate::arrival::wall_ns(),
        origin: 0,
        content,
    };
    if !pacer.pass(arrival(first_s, Content::Opened(name.to_owned())), outlet) {
        return Ok(());
    }
    for start in (0..record.len()).step_by(ROWS) {
        let (header, lines) = rows(record, start, (start + ROWS).min(record.len()))?;
        if start == 0 && !pacer.pass(arrival(first_s, Content::Datagram(header.into_bytes())), outlet) {
            return Ok(());
        }
        for (line, time_s) in lines.lines().zip(record.time.iter().skip(start)) {
            if !pacer.pass(arrival(*time_s, Content::Datagram(line.as_bytes().to_vec())), outlet) {
                return Ok(());
            }
        }
    }
    let last_s = record.time.last().copied().unwrap_or_default();
    pacer.pass(arrival(last_s, Content::Closed("the end of the flight".to_owned())), outlet);
    Ok(())
}

/// The header and some rows, as text that gives the same numbers when it is read.
fn rows(record: &Record, from: usize, to: usize) -> Result<(String, String), ReplayError> {
    let part = |values: &[f64]| values.get(from..to).unwrap_or_default().to_vec();
    let cut = Record {
        source: record.source.clone(),
        time: part(&record.time),
        channels: record
            .channels
            .iter()
            .map(|channel| Channel {
                name: channel.name.clone(),
                quantity: channel.quantity,
                values: part(&channel.values),
            })
            .collect(),
        ..Record::default()
    };
    let mut text = Vec::new();
    csv::write(&cut, &mut text).map_err(|error| ReplayError::Flight(error.to_string()))?;
    let text = String::from_utf8(text).map_err(|error| ReplayError::Flight(error.to_string()))?;
    let (header, lines) = text.split_once('\n').unwrap_or((&text, ""));
    Ok((header.trim_end().to_owned(), lines.to_owned()))
}

/// Lets things happen at their times.
struct Pacer {
    pace: Pace,
    /// When the first happened, and its stamp, ns.
    start: Option<(Instant, u64)>,
}

impl Pacer {
    fn pass(&mut self, arrival: Arrival, outlet: &Outlet) -> bool {
        if let Pace::Times(times) = self.pace {
            let (start, first_ns) = *self.start.get_or_insert_with(|| (Instant::now(), arrival.arrival_ns));
            let due =
                Duration::from_secs_f64((arrival.arrival_ns.saturating_sub(first_ns) as f64 / 1e9 / times).min(1e9));
            while let Some(left) = due.checked_sub(start.elapsed()).filter(|left| !left.is_zero()) {
                if outlet.stopped() {
                    return false;
                }
                std::thread::sleep(left.min(LOOK));
            }
        }
        outlet.pass(arrival)
    }
}
