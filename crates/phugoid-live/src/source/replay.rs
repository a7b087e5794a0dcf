//! Replays: recordings and flight records, received as if they were happening now.

use std::time::{Duration, Instant};

use phugoid_flight_data::csv;
use phugoid_flight_data::record::{Channel, Record};

use super::outlet::{LOOK, Outlet};
use crate::arrival::{Arrival, Content};
use crate::recording::{Damage, Reader, RecordingError};

/// The speed of a replay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// So many times as fast as it happened; 1 is real time. It has to be positive.
    Times(f64),
    /// As fast as the machine can estimate.
    Unlimited,
}

/// A recording or a flight record that is received again.
///
/// ```
/// use std::sync::{Arc, mpsc};
///
/// use phugoid_flight_data::record::{Channel, Quantity, Record};
/// use phugoid_live::arrival::{Clock, Content};
/// use phugoid_live::source::{Outlet, Pace, Replay, Source};
/// use phugoid_live::stop::Stop;
///
/// let alpha = Channel { name: "alpha".to_owned(), quantity: Quantity::Angle, values: vec![0.04, 0.05] };
/// let record = Record { time: vec![0.0, 0.1], channels: vec![alpha], ..Record::default() };
/// let source = Source::from(Replay::flight(record, Pace::Unlimited)?);
/// let (queue, arrivals) = mpsc::sync_channel(16);
/// source.run(&Outlet::new(queue, Arc::new(Stop::default()), Clock::start()));
/// let contents: Vec<Content> = arrivals.try_iter().map(|arrival| arrival.content).collect();
/// // The sender appears, the header line, two rows, the end of the flight.
/// assert_eq!(contents.len(), 5);
/// assert_eq!(contents[2], Content::Datagram(b"0,0.04".to_vec()));
/// # Ok::<(), phugoid_live::source::ReplayError>(())
/// ```
pub struct Replay {
    name: String,
    pace: Pace,
    what: What,
}

/// What is replayed.
enum What {
    Recording(Box<Reader>),
    Flight(Box<Record>),
}

/// Why a flight cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The flight record cannot be written as text; the sentence says why.
    #[error("{0}")]
    Flight(String),
}

/// Rows of a flight record that are written as text at one time.
const ROWS: usize = 256;

impl Replay {
    /// Replays a recording: the same arrivals with the same stamps. `name` is shown as the source.
    pub fn recording(reader: Reader, name: &str, pace: Pace) -> Self {
        Self { name: name.to_owned(), pace, what: What::Recording(Box::new(reader)) }
    }

    /// Replays a flight record as a stream of CSV rows, each at its time. The rows have the names and units of the
    /// record, which are canonical: see [`Replay::is_mapped`].
    ///
    /// # Errors
    /// [`ReplayError::Flight`] if the record cannot be written as CSV, such as with the name of a channel that could
    /// not be read back.
    pub fn flight(record: Record, pace: Pace) -> Result<Self, ReplayError> {
        rows(&record, 0, 0)?;
        Ok(Self { name: record.source.clone(), pace, what: What::Flight(Box::new(record)) })
    }

    /// Name of the file that is replayed.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// True if the rows have canonical channel names and SI units already: those of a flight record, and those of a
    /// recording that was made while a flight record was replayed.
    pub fn is_mapped(&self) -> bool {
        match &self.what {
            What::Recording(reader) => reader.header().mapped,
            What::Flight(_) => true,
        }
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
                        if let Some(sentence) = damage(reader.damage()) {
                            outlet.pass(outlet.clock.stamp(u16::MAX, Content::Closed(sentence)));
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

/// A sentence about the damage of a recording; `None` if it is whole.
fn damage(damage: Damage) -> Option<String> {
    let mut findings = Vec::new();
    if damage.skipped_bytes > 0 {
        let at = damage.first_at.unwrap_or_default();
        findings.push(format!("{} damaged bytes were skipped, the first at byte {at}", damage.skipped_bytes));
    }
    if damage.cut_off_bytes > 0 {
        findings.push(format!("the last block was cut off ({} bytes)", damage.cut_off_bytes));
    }
    if damage.lost_arrivals > 0 {
        findings.push(format!("{} packets were not recorded, for want of disk", damage.lost_arrivals));
    }
    if !damage.ended {
        findings.push("the recording was not ended in order, as after a kill".to_owned());
    }
    (!findings.is_empty()).then(|| format!("the recording: {}", findings.join("; ")))
}

/// Passes a flight record on as CSV.
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

/// The header line and the rows `from..to` as text that gives exactly the same numbers when it is read.
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

/// Delays each arrival until its time.
struct Pacer {
    pace: Pace,
    /// When the first arrival was passed on, and its stamp, ns.
    start: Option<(Instant, u64)>,
}

impl Pacer {
    /// Waits for the time of an arrival and passes it on; false if the source has to end.
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
