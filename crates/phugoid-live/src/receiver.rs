//! From arrivals to samples on one time base. The result depends on the arrivals and their stamps only, so a recording
//! gives the same samples as the flight.

mod pin;
mod quota;
mod stream;

use std::collections::HashMap;

use phugoid_flight_data::csv::{ColumnMapping, CsvOptions};

use crate::airspeed::{self, TrueAirspeed};
use crate::arrival::{Arrival, Content};
use crate::event::LiveEventKind;
use crate::link::Counts;
use crate::mavlink::Verifier;
use crate::mavlink::map::{Assembler, MavlinkOptions};
use crate::source::SenderSpec;
use crate::timing::{Judgement, SenderClock};
use pin::{Pin, Standing};
use quota::Quota;
use stream::{Payload, Piece, Stream};

/// How the bytes that arrive are interpreted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReceiverOptions {
    /// Columns that the model file maps to channels (`[channels]`): headers of CSV, keys of JSON, or `MESSAGE.field` of
    /// MAVLink.
    pub columns: Vec<ColumnMapping>,
    /// Options that concern MAVLink only.
    pub mavlink: MavlinkOptions,
    /// The sender that alone is used. `None` uses the first that gives a sample, until it is silent for five seconds.
    pub sender: Option<SenderSpec>,
}

impl ReceiverOptions {
    /// The same without the column mappings: for rows that have canonical names and SI units already.
    #[must_use]
    pub fn without_columns(&self) -> Self {
        Self { columns: Vec::new(), ..self.clone() }
    }
}

/// What the receiver hands over.
#[derive(Debug, PartialEq)]
pub enum Reception<'a> {
    /// A sample. The times of the samples increase, except after [`Reception::Restart`].
    Sample {
        /// Time by the sender's clock, s.
        time_s: f64,
        /// Arrival of the message or row that completed the sample, ns.
        arrival_ns: u64,
        /// Values in the order of the channels that were asked for, SI; NaN where a value is missing.
        values: &'a [f64],
    },
    /// The sender's clock has started again, or was set. The samples that follow have its new time.
    Restart {
        /// Last time before the restart, s.
        from_s: f64,
        /// First time after the restart, s.
        to_s: f64,
        /// Time of arrival since the last sample, ns.
        pause_ns: u64,
    },
    /// Something happened that a person should know.
    Event {
        /// What the event is about.
        kind: LiveEventKind,
        /// What happened, as one sentence for people.
        message: String,
    },
}

/// Longest message of an event, characters: a part of it may be what a stranger sent.
const LONGEST_MESSAGE: usize = 1000;
/// An event is published if nothing has arrived for this long, ns.
const SILENCE_NS: u64 = 2_000_000_000;

/// Turns bytes into samples. It recognises MAVLink, CSV and JSON lines by their content.
///
/// ```
/// use phugoid_live::arrival::{Arrival, Content};
/// use phugoid_live::receiver::{Receiver, ReceiverOptions, Reception};
///
/// let channels = ["alpha", "q"].map(str::to_owned);
/// let mut receiver = Receiver::new(&channels, &ReceiverOptions::default())?;
/// let line = br#"{"time_s": 1.25, "alpha_deg": 90.0}"#.to_vec();
/// let arrival = Arrival { arrival_ns: 1, wall_ns: 0, origin: 0, content: Content::Datagram(line) };
/// let mut samples = Vec::new();
/// receiver.take(&arrival, &mut |reception| {
///     if let Reception::Sample { time_s, values, .. } = reception {
///         samples.push((time_s, values.to_vec()));
///     }
/// });
/// let [(time_s, values)] = samples.as_slice() else { panic!("one sample is expected") };
/// assert_eq!(*time_s, 1.25);
/// assert!((values[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12, "degrees become radians");
/// assert!(values[1].is_nan(), "the pitch rate was not sent");
/// # Ok::<(), String>(())
/// ```
pub struct Receiver {
    /// Channels that were asked for, then those from which the true airspeed can be computed.
    channels: Vec<String>,
    /// How many of the channels were asked for.
    asked: usize,
    airspeed: Option<TrueAirspeed>,
    csv: CsvOptions,
    streams: HashMap<u16, Stream>,
    clock: SenderClock,
    mavlink: Assembler,
    counts: Counts,
    quota: Quota,
    pin: Pin,
    /// Verifies signatures, where a key is given.
    verifier: Option<Verifier>,
    /// What the first stream that was recognised gives.
    payload: Option<Payload>,
    /// Why something was left out for the first time.
    first_refusal: Option<String>,
    row: Vec<f64>,
    values: Vec<f64>,
    /// Which of the channels that were asked for have come with a value.
    came: Vec<bool>,
    /// Arrival of the last packet, ns.
    newest_ns: u64,
    silence_published: bool,
}

impl Receiver {
    /// A receiver for samples that hold the channels `asked_for` (canonical names), in this order.
    ///
    /// # Errors
    /// A sentence for people, if a column mapping names a field that its MAVLink message does not have, a unit that
    /// does not suit the channel, or a command without a scale.
    pub fn new(asked_for: &[String], options: &ReceiverOptions) -> Result<Self, String> {
        let asked = asked_for.len();
        let mut channels = asked_for.to_vec();
        if channels.iter().any(|channel| channel == "true_airspeed") {
            let is_new = |name: &&str| !asked_for.iter().any(|channel| channel == name);
            channels.extend(airspeed::SOURCES.into_iter().filter(is_new).map(str::to_owned));
        }
        Ok(Self {
            asked,
            airspeed: TrueAirspeed::new(&channels),
            csv: CsvOptions { columns: options.columns.clone(), ..CsvOptions::default() },
            mavlink: Assembler::new(&channels, asked, &options.columns, &options.mavlink)?,
            streams: HashMap::new(),
            clock: SenderClock::default(),
            counts: Counts::default(),
            quota: Quota::default(),
            pin: Pin::new(options.sender.clone()),
            verifier: options.mavlink.key.clone().map(Verifier::new),
            payload: None,
            first_refusal: None,
            row: Vec::new(),
            values: vec![f64::NAN; channels.len()],
            came: vec![false; asked],
            channels,
            newest_ns: 0,
            silence_published: false,
        })
    }

    /// Sets the density of the air that the model file states, kg/m^3. The true airspeed is then computed with it from
    /// another airspeed, if the sender gives no true one. `None` leaves the density to the channels that arrive.
    pub fn with_air_density(mut self, density: Option<f64>) -> Self {
        self.airspeed = self.airspeed.map(|airspeed| airspeed.with_density(density));
        self
    }

    /// Counts of the link since the start.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// What is missing for the true airspeed although another airspeed arrives, as a sentence; `None` if nothing is
    /// missing.
    pub fn missing(&self) -> Option<String> {
        self.airspeed.as_ref().and_then(TrueAirspeed::missing)
    }

    /// The channels that were asked for and have not come with a single value, as a sentence; `None` if there are none, or if
    /// nothing has arrived.
    pub fn never_came(&self) -> Option<String> {
        let absent = self.channels.iter().zip(&self.came).filter(|(_, came)| !**came).map(|(name, _)| name.as_str());
        let absent: Vec<&str> = absent.collect();
        let (count, names) = (absent.len(), absent.join(", "));
        (self.counts.samples > 0 && count > 0).then(|| {
            let (channels, are, them) = if count == 1 { ("channel", "is", "it") } else { ("channels", "are", "them") };
            format!(
                "the {channels} {names} {are} missing: none of the {} samples holds a value of {them}. Look at the names of \
                 what is sent, or name it under [channels] in the model file",
                self.counts.samples
            )
        })
    }

    /// Why what arrived so far gave no sample, as a sentence for people; `None` if there is a sample, or if nothing
    /// arrived.
    pub fn no_sample(&self) -> Option<String> {
        let Counts { packets, bytes, received, samples, .. } = self.counts;
        if packets == 0 || samples > 0 {
            return None;
        }
        let why = match (&self.first_refusal, self.payload) {
            (Some(refusal), _) => refusal.clone(),
            (None, Some(Payload::Mavlink)) => format!(
                "{received} MAVLink messages were read, and none of them gives a sample its time: the vehicle sends no \
                 HIGHRES_IMU, SCALED_IMU, RAW_IMU, ATTITUDE or ATTITUDE_QUATERNION, or another vehicle or message was \
                 asked for"
            ),
            (None, Some(Payload::Text)) => format!("a header line came, and {received} rows of numbers below it"),
            (None, None) => "it holds no MAVLink frame, no JSON line and no header line with a time".to_owned(),
        };
        Some(format!("no sample could be made of the {bytes} bytes that arrived: {why}"))
    }

    /// The time at which [`Receiver::advance`] has to be called if nothing arrives before, ns; `None` if nothing waits.
    pub fn deadline_ns(&self) -> Option<u64> {
        let silence =
            (!self.silence_published && self.newest_ns > 0).then_some(self.newest_ns.saturating_add(SILENCE_NS));
        [self.mavlink.deadline_ns(), silence].into_iter().flatten().min()
    }

    /// Does what was due until this time, ns: hands over samples that have waited long enough for missing messages, and
    /// reports silence.
    pub fn advance(&mut self, now_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        while let Some(due_ns) = self.deadline_ns().filter(|due| *due <= now_ns) {
            if !self.silence_published && self.newest_ns > 0 && due_ns >= self.newest_ns.saturating_add(SILENCE_NS) {
                self.silence_published = true;
                let message = format!("nothing has arrived for {:.0} s", SILENCE_NS as f64 / 1e9);
                self.say(LiveEventKind::Silent, message, due_ns, out);
            }
            self.emit_mavlink(due_ns, out);
        }
    }

    /// Takes an arrival and hands over the samples and events that follow from it. What was due before its time is done
    /// first.
    pub fn take(&mut self, arrival: &Arrival, out: &mut dyn FnMut(Reception<'_>)) {
        let (now_ns, origin) = (arrival.arrival_ns, arrival.origin);
        self.advance(now_ns, out);
        match &arrival.content {
            Content::Opened(peer) => {
                self.streams.insert(origin, Stream::new(peer));
                self.mavlink.forget(origin);
                // The number may have been that of another sender.
                self.pin.release(origin);
                self.say(LiveEventKind::Origin, format!("receiving from {peer}"), now_ns, out);
            }
            Content::Closed(reason) => {
                let mut stream = self.streams.remove(&origin).unwrap_or_else(|| Stream::new(""));
                let standing = self.pin.standing(origin, stream.peer(), now_ns);
                self.pieces(&mut stream, arrival, &[], true, standing, out);
                self.pin.release(origin);
                self.say(LiveEventKind::Origin, format!("{}: {reason}", stream.peer()), now_ns, out);
            }
            Content::Datagram(bytes) | Content::Piece(bytes) => {
                let ends = matches!(arrival.content, Content::Datagram(_));
                let mut stream = self.streams.remove(&origin).unwrap_or_else(|| Stream::new("the stream"));
                let standing = self.pin.standing(origin, stream.peer(), now_ns);
                if standing == Standing::Stranger {
                    self.counts.strangers += 1;
                } else {
                    self.counts.packets += 1;
                    self.counts.bytes += bytes.len() as u64;
                    if self.silence_published {
                        let silent_s = now_ns.saturating_sub(self.newest_ns) as f64 / 1e9;
                        let message = format!("data again, after {silent_s:.1} s without");
                        self.say(LiveEventKind::Silent, message, now_ns, out);
                    }
                    (self.newest_ns, self.silence_published) = (now_ns.max(1), false);
                }
                self.pieces(&mut stream, arrival, bytes, ends, standing, out);
                self.pin.heard(origin, now_ns);
                self.streams.insert(origin, stream);
            }
        }
    }

    /// Hands over the samples that still wait, and says how many events were not said. To be called at the end.
    pub fn finish(&mut self, out: &mut dyn FnMut(Reception<'_>)) {
        self.emit_mavlink(u64::MAX, out);
        for (kind, unsaid) in self.quota.unsaid() {
            out(event(kind, format!("{unsaid} more of this kind were counted and not said")));
        }
    }

    /// Number of the sender whose samples are used; `None` while there is none.
    pub fn pinned(&self) -> Option<u16> {
        self.pin.origin()
    }

    fn pieces(
        &mut self,
        stream: &mut Stream,
        arrival: &Arrival,
        bytes: &[u8],
        ends: bool,
        standing: Standing,
        out: &mut dyn FnMut(Reception<'_>),
    ) {
        let csv = std::mem::take(&mut self.csv);
        let mut row = std::mem::take(&mut self.row);
        let peer = stream.peer().to_owned();
        if standing == Standing::Stranger {
            // It is read all the same: a header that comes now is needed if its rows are used later.
            let mut alike = false;
            stream.push(bytes, ends, &csv, &mut row, &mut |piece| match piece {
                Piece::Frame(frame) => alike |= self.pin.has_ids(frame.system, frame.component),
                Piece::Row { .. } => alike |= self.pin.is_text(),
                _ => {}
            });
            (self.csv, self.row) = (csv, row);
            self.say_stranger(&peer, alike, arrival.arrival_ns, out);
            return;
        }
        let now_ns = arrival.arrival_ns;
        stream.push(bytes, ends, &csv, &mut row, &mut |piece| match piece {
            Piece::Payload(payload) => {
                self.payload.get_or_insert(payload);
                self.say(LiveEventKind::Payload, format!("this is {}", payload.words()), now_ns, out);
            }
            Piece::Columns(notes) => {
                notes.into_iter().for_each(|message| self.say(LiveEventKind::Columns, message, now_ns, out));
            }
            Piece::Row { .. } if self.verifier.is_some() => {
                self.counts.unverified += 1;
                let message = format!("a row of text of {peer}, which cannot be signed: left out");
                self.say(LiveEventKind::Alarm, message, now_ns, out);
            }
            Piece::Row { time_s, names, values } => self.row(arrival, &peer, time_s, names, values, out),
            Piece::Refused(reason) => {
                self.counts.refused += 1;
                self.say(LiveEventKind::Refused, reason, now_ns, out);
            }
            Piece::Garbage(bytes) => self.counts.garbage_bytes += bytes as u64,
            Piece::BadChecksum => self.counts.checksum_failures += 1,
            Piece::Frame(frame) => {
                let verified = self.verifier.as_mut().map_or(Ok(()), |verifier| verifier.verify(&frame));
                if let Err(refusal) = verified {
                    self.counts.unverified += 1;
                    let message = format!("a frame of {peer} {}: left out", refusal.words());
                    self.say(LiveEventKind::Alarm, message, now_ns, out);
                    return;
                }
                self.counts.received += 1;
                let mut events = Vec::new();
                self.mavlink.take(&frame, arrival.origin, now_ns, &self.clock, &mut self.counts, &mut events);
                if self.counts.received == 1 {
                    let warnings = self.mavlink.warnings();
                    warnings.into_iter().for_each(|message| self.say(LiveEventKind::Airspeed, message, now_ns, out));
                }
                events.into_iter().for_each(|(kind, message)| self.say(kind, message, now_ns, out));
                self.emit_mavlink_of(Some((arrival.origin, &peer)), now_ns, out);
            }
        });
        (self.csv, self.row) = (csv, row);
    }

    /// Says that a sender that is not used sends; `alike` if it could be taken for the one that is.
    fn say_stranger(&mut self, peer: &str, alike: bool, now_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        let pinned = self.pin.name();
        match alike {
            true => self.say(
                LiveEventKind::Alarm,
                format!("{peer} sends as if it were {pinned}: it is not used. Somebody may be sending false data"),
                now_ns,
                out,
            ),
            false => self.say(
                LiveEventKind::Stranger,
                format!("{peer} sends too: it is not used, the samples are those of {pinned}"),
                now_ns,
                out,
            ),
        }
    }

    /// Hands over the MAVLink samples that are ready at this time.
    fn emit_mavlink(&mut self, now_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        self.emit_mavlink_of(None, now_ns, out);
    }

    /// The same while the stream of the sender with this number and name is being read.
    fn emit_mavlink_of(&mut self, read: Option<(u16, &str)>, now_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        while let Some(base) = self.mavlink.ready(now_ns) {
            let (origin, system, component) = base.component;
            let peer = match read {
                Some((reading, peer)) if reading == origin => peer.to_owned(),
                _ => self.streams.get(&origin).map_or_else(String::new, |stream| stream.peer().to_owned()),
            };
            if self.pin.standing(origin, &peer, base.arrival_ns) == Standing::Stranger
                || !self.judge(base.time_s, base.arrival_ns, out)
            {
                continue;
            }
            self.pin(origin, &peer, Some((system, component)), base.arrival_ns, out);
            self.mavlink.frame(base.time_s, &mut self.values);
            self.sample(base.time_s, base.arrival_ns, out);
        }
    }

    fn row(
        &mut self,
        arrival: &Arrival,
        peer: &str,
        time_s: f64,
        names: &[String],
        row: &[f64],
        out: &mut dyn FnMut(Reception<'_>),
    ) {
        self.counts.received += 1;
        // A row that came before in the same datagram may have pinned the sender, but no other one.
        if !self.judge(time_s, arrival.arrival_ns, out) {
            return;
        }
        self.pin(arrival.origin, peer, None, arrival.arrival_ns, out);
        for (value, channel) in self.values.iter_mut().zip(&self.channels) {
            let column = names.iter().position(|name| name == channel);
            *value = column.and_then(|column| row.get(column)).copied().unwrap_or(f64::NAN);
        }
        self.sample(time_s, arrival.arrival_ns, out);
    }

    /// A sample of this sender is used.
    fn pin(&mut self, origin: u16, peer: &str, ids: Option<(u8, u8)>, now_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        if let Some(message) = self.pin.gave(origin, peer, ids, now_ns) {
            self.say(LiveEventKind::Sender, message, now_ns, out);
        }
    }

    /// Computes the true airspeed where that is needed, and hands the sample over.
    fn sample(&mut self, time_s: f64, arrival_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        let mut notes = Vec::new();
        if let Some(airspeed) = &mut self.airspeed {
            airspeed.fill(time_s, &mut self.values, &mut |message| notes.push(message));
        }
        notes.into_iter().for_each(|message| self.say(LiveEventKind::Airspeed, message, arrival_ns, out));
        self.counts.samples += 1;
        self.came.iter_mut().zip(&self.values).for_each(|(came, value)| *came |= value.is_finite());
        out(Reception::Sample { time_s, arrival_ns, values: self.values.get(..self.asked).unwrap_or_default() });
    }

    /// Whether a sample with this time is to be used. Counts and publishes what its time means.
    fn judge(&mut self, time_s: f64, arrival_ns: u64, out: &mut dyn FnMut(Reception<'_>)) -> bool {
        match self.clock.judge(time_s, arrival_ns) {
            Judgement::Forward => return true,
            Judgement::Repeated => self.counts.duplicated += 1,
            Judgement::Stalled => {
                self.counts.stalled += 1;
                let message = format!("samples come, but the sender's clock stands still at {time_s:.3} s");
                self.say(LiveEventKind::Stalled, message, arrival_ns, out);
            }
            Judgement::Late => self.counts.late += 1,
            Judgement::Leap { by_s } => {
                self.counts.leaps += 1;
                let direction = if by_s > 0.0 { "ahead" } else { "back" };
                let message = format!(
                    "a time that leapt {:.3} s {direction} against its arrival, {time_s} s: left out unless it goes on so",
                    by_s.abs()
                );
                self.say(LiveEventKind::Leap, message, arrival_ns, out);
            }
            Judgement::Gap { from_s } => {
                let message = format!(
                    "the time leapt from {from_s:.3} s to {time_s:.3} s and goes on from there: data are missing"
                );
                self.say(LiveEventKind::Leap, message, arrival_ns, out);
                return true;
            }
            Judgement::Restarted { from_s, pause_ns } => {
                self.counts.restarts += 1;
                self.mavlink.restart(time_s, &mut self.counts);
                self.airspeed.iter_mut().for_each(TrueAirspeed::restart);
                out(Reception::Restart { from_s, to_s: time_s, pause_ns });
                return true;
            }
        }
        false
    }

    /// Publishes an event, unless there have been too many of its kind.
    fn say(&mut self, kind: LiveEventKind, message: String, now_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        if kind == LiveEventKind::Refused {
            self.first_refusal.get_or_insert_with(|| message.clone());
        }
        let Some(unsaid) = self.quota.take(kind, now_ns) else { return };
        let mut message = message;
        if let Some((end, _)) = message.char_indices().nth(LONGEST_MESSAGE) {
            message.truncate(end);
            message.push_str(" ...");
        }
        if unsaid > 0 {
            message.push_str(&format!(" ({unsaid} more before it were counted and not said)"));
        }
        out(event(kind, message));
    }
}

fn event(kind: LiveEventKind, message: String) -> Reception<'static> {
    Reception::Event { kind, message }
}
