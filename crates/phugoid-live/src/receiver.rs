//! From what arrives to samples on one time base. Nothing here depends on anything but arrivals and their stamps, so that a
//! recording gives the same samples as the flight.

mod stream;

use std::collections::{BTreeMap, HashMap};

use phugoid_flight_data::csv::{ColumnMapping, CsvOptions};

use crate::airspeed::{self, TrueAirspeed};
use crate::arrival::{Arrival, Content};
use crate::link::Counts;
use crate::mavlink::map::{Assembler, MavlinkOptions};
use crate::timing::{Judgement, SenderClock};
use stream::{Piece, Stream};

/// How what arrives is to be understood.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReceiverOptions {
    /// Columns mapped by hand (the model file's `[channels]`): headers of CSV, keys of JSON, or `MESSAGE.field` of MAVLink.
    pub columns: Vec<ColumnMapping>,
    /// What is particular to MAVLink.
    pub mavlink: MavlinkOptions,
}

/// What reception gives.
#[derive(Debug, PartialEq)]
pub enum Reception<'a> {
    /// A sample: values in the order of the channels that were asked for, SI, NaN where missing.
    Sample {
        /// Time of the sender, s.
        time_s: f64,
        /// When what completed it arrived, ns.
        arrival_ns: u64,
        /// Values.
        values: &'a [f64],
    },
    /// The sender's clock has begun anew: what follows is another flight.
    Restart {
        /// The last time before, s.
        from_s: f64,
        /// The first time after, s.
        to_s: f64,
    },
    /// Something worth a sentence.
    Event {
        /// One word: `origin`, `payload`, `columns`, `airspeed`, `refused`, `late`, `stalled`, `silent`.
        kind: &'static str,
        /// The sentence.
        message: String,
    },
}

/// Says of each kind of trouble only this many times; the counts go on.
const SAID: u32 = 5;
/// Another peer is heard only when the one that was heard has been silent for this long, ns.
const HANDOVER_NS: u64 = 1_000_000_000;
/// No data at all for this long, ns, is worth a word.
const SILENCE_NS: u64 = 2_000_000_000;

/// Understands what arrives.
pub struct Receiver {
    /// Those that were asked for, then those of which others are computed.
    channels: Vec<String>,
    asked: usize,
    airspeed: Option<TrueAirspeed>,
    csv: CsvOptions,
    streams: HashMap<u16, Stream>,
    clock: SenderClock,
    mavlink: Assembler,
    counts: Counts,
    said: BTreeMap<&'static str, u32>,
    /// The text stream that is heard, and when it was last.
    heard: Option<(u16, u64)>,
    row: Vec<f64>,
    values: Vec<f64>,
    newest_ns: u64,
    silence_said: bool,
}

impl Receiver {
    /// `asked_for`: canonical names of what the samples hold, in this order.
    ///
    /// # Errors
    /// A mapping of the model file that no stream could fulfil, in words.
    pub fn new(asked_for: &[String], options: &ReceiverOptions) -> Result<Self, String> {
        let asked = asked_for.len();
        let mut channels = asked_for.to_vec();
        if channels.iter().any(|channel| channel == "true_airspeed") {
            let is_new = |name: &&str| !asked_for.iter().any(|channel| channel == name);
            channels.extend(airspeed::NEEDED.into_iter().filter(is_new).map(str::to_owned));
        }
        Ok(Self {
            asked,
            airspeed: TrueAirspeed::new(&channels),
            csv: CsvOptions { columns: options.columns.clone(), ..CsvOptions::default() },
            mavlink: Assembler::new(&channels, asked, &options.columns, &options.mavlink)?,
            streams: HashMap::new(),
            clock: SenderClock::default(),
            counts: Counts::default(),
            said: BTreeMap::new(),
            heard: None,
            row: Vec::new(),
            values: vec![f64::NAN; channels.len()],
            channels,
            newest_ns: 0,
            silence_said: false,
        })
    }

    /// With the density of the air that the model states, kg/m^3, if it does: with it another airspeed becomes the true one.
    pub fn with_air_density(mut self, stated: Option<f64>) -> Self {
        self.airspeed = self.airspeed.map(|airspeed| airspeed.with_density(stated));
        self
    }

    /// Counts so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// What is missing for a sample to be of use although something like it comes, in words.
    pub fn lacking(&self) -> Option<String> {
        self.airspeed.as_ref().and_then(TrueAirspeed::lacking)
    }

    /// When [`Receiver::advance`] has to be called if nothing arrives before, ns.
    pub fn deadline_ns(&self) -> Option<u64> {
        let silence = (!self.silence_said && self.newest_ns > 0).then_some(self.newest_ns.saturating_add(SILENCE_NS));
        [self.mavlink.deadline_ns(), silence].into_iter().flatten().min()
    }

    /// Does what was due at or before this time, ns.
    pub fn advance(&mut self, now_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        while let Some(due_ns) = self.deadline_ns().filter(|due| *due <= now_ns) {
            if !self.silence_said && self.newest_ns > 0 && due_ns >= self.newest_ns.saturating_add(SILENCE_NS) {
                self.silence_said = true;
                out(event("silent", format!("nothing has arrived for {:.0} s", SILENCE_NS as f64 / 1e9)));
            }
            self.emit_mavlink(due_ns, out);
        }
    }

    /// Takes what arrived. What was due before is done first.
    pub fn take(&mut self, arrival: &Arrival, out: &mut dyn FnMut(Reception<'_>)) {
        let now_ns = arrival.arrival_ns;
        self.advance(now_ns, out);
        match &arrival.content {
            Content::Opened(peer) => {
                self.streams.insert(arrival.origin, Stream::new(peer));
                self.mavlink.forget(arrival.origin);
                out(event("origin", format!("receiving from {peer}")));
            }
            Content::Closed(reason) => {
                let mut stream = self.streams.remove(&arrival.origin).unwrap_or_else(|| Stream::new(""));
                self.pieces(&mut stream, arrival, &[], true, out);
                if self.heard.is_some_and(|(origin, _)| origin == arrival.origin) {
                    self.heard = None;
                }
                out(event("origin", format!("{}: {reason}", stream.peer())));
            }
            Content::Datagram(bytes) | Content::Piece(bytes) => {
                self.counts.packets += 1;
                self.counts.bytes += bytes.len() as u64;
                if self.silence_said {
                    let silent_s = now_ns.saturating_sub(self.newest_ns) as f64 / 1e9;
                    out(event("silent", format!("data again, after {silent_s:.1} s without")));
                }
                (self.newest_ns, self.silence_said) = (now_ns.max(1), false);
                let ends = matches!(arrival.content, Content::Datagram(_));
                let mut stream = self.streams.remove(&arrival.origin).unwrap_or_else(|| Stream::new("the stream"));
                self.pieces(&mut stream, arrival, bytes, ends, out);
                self.streams.insert(arrival.origin, stream);
            }
        }
    }

    /// Does what is still waiting, at the end.
    pub fn finish(&mut self, out: &mut dyn FnMut(Reception<'_>)) {
        self.emit_mavlink(u64::MAX, out);
    }

    fn pieces(
        &mut self,
        stream: &mut Stream,
        arrival: &Arrival,
        bytes: &[u8],
        ends: bool,
        out: &mut dyn FnMut(Reception<'_>),
    ) {
        let csv = std::mem::take(&mut self.csv);
        let mut row = std::mem::take(&mut self.row);
        stream.push(bytes, ends, &csv, &mut row, &mut |piece| match piece {
            Piece::Payload(name) => out(event("payload", format!("this is {name}"))),
            Piece::Columns(told) => told.into_iter().for_each(|message| out(event("columns", message))),
            Piece::Row { time_s, names, values } => self.row(arrival, time_s, names, values, out),
            Piece::Refused(reason) => {
                self.counts.refused += 1;
                self.say("refused", reason, out);
            }
            Piece::Garbage(bytes) => self.counts.garbage_bytes += bytes as u64,
            Piece::BadChecksum => self.counts.checksum_failures += 1,
            Piece::Frame(frame) => {
                self.counts.received += 1;
                let mut events = Vec::new();
                self.mavlink.take(&frame, arrival.origin, arrival.arrival_ns, &mut self.counts, &mut events);
                if self.counts.received == 1 {
                    self.mavlink.doubts().into_iter().for_each(|message| out(event("airspeed", message)));
                }
                events.into_iter().for_each(|(kind, message)| self.say(kind, message, out));
                self.emit_mavlink(arrival.arrival_ns, out);
            }
        });
        (self.csv, self.row) = (csv, row);
    }

    /// Hands over what MAVLink has ready at this time.
    fn emit_mavlink(&mut self, now_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        while let Some(base) = self.mavlink.ready(now_ns) {
            if !self.judge(base.time_s, base.arrival_ns, out) {
                continue;
            }
            self.mavlink.frame(base.time_s, &mut self.values);
            self.sample(base.time_s, base.arrival_ns, out);
        }
    }

    fn row(
        &mut self,
        arrival: &Arrival,
        time_s: f64,
        names: &[String],
        row: &[f64],
        out: &mut dyn FnMut(Reception<'_>),
    ) {
        self.counts.received += 1;
        match self.heard {
            Some((origin, last_ns))
                if origin != arrival.origin && arrival.arrival_ns.saturating_sub(last_ns) < HANDOVER_NS =>
            {
                self.counts.refused += 1;
                self.say("refused", "a second sender at the same time: only the first is used".to_owned(), out);
                return;
            }
            _ => self.heard = Some((arrival.origin, arrival.arrival_ns)),
        }
        if !self.judge(time_s, arrival.arrival_ns, out) {
            return;
        }
        for (value, channel) in self.values.iter_mut().zip(&self.channels) {
            let column = names.iter().position(|name| name == channel);
            *value = column.and_then(|column| row.get(column)).copied().unwrap_or(f64::NAN);
        }
        self.sample(time_s, arrival.arrival_ns, out);
    }

    /// Completes the values of a sample and hands it over.
    fn sample(&mut self, time_s: f64, arrival_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        if let Some(airspeed) = &mut self.airspeed {
            airspeed.fill(time_s, &mut self.values, &mut |message| out(event("airspeed", message)));
        }
        self.counts.samples += 1;
        out(Reception::Sample { time_s, arrival_ns, values: self.values.get(..self.asked).unwrap_or_default() });
    }

    /// Is a sample of this time to be used?
    fn judge(&mut self, time_s: f64, arrival_ns: u64, out: &mut dyn FnMut(Reception<'_>)) -> bool {
        match self.clock.judge(time_s, arrival_ns) {
            Judgement::Forward => return true,
            Judgement::Repeated => self.counts.duplicated += 1,
            Judgement::Stalled => {
                self.counts.stalled += 1;
                out(event("stalled", format!("samples come, but the sender's clock stands still at {time_s:.3} s")));
            }
            Judgement::Late => self.counts.late += 1,
            Judgement::Doubtful => {
                self.counts.refused += 1;
                self.say(
                    "refused",
                    format!("a time far from the others, {time_s} s: left out unless it goes on so"),
                    out,
                );
            }
            Judgement::Restarted { from_s } => {
                self.counts.restarts += 1;
                self.mavlink.restart(&mut self.counts);
                self.airspeed.iter_mut().for_each(TrueAirspeed::restart);
                out(Reception::Restart { from_s, to_s: time_s });
                return true;
            }
        }
        false
    }

    fn say(&mut self, kind: &'static str, message: String, out: &mut dyn FnMut(Reception<'_>)) {
        let said = self.said.entry(kind).or_default();
        *said += 1;
        match *said {
            0..SAID => out(event(kind, message)),
            SAID => out(event(kind, format!("{message} (further ones are counted, not said)"))),
            _ => {}
        }
    }
}

fn event(kind: &'static str, message: String) -> Reception<'static> {
    Reception::Event { kind, message }
}
