//! From arrivals to samples on one time base. The result depends on the arrivals and their stamps only, so a recording
//! gives the same samples as the flight.

mod stream;

use std::collections::{BTreeMap, HashMap};

use phugoid_flight_data::csv::{ColumnMapping, CsvOptions};

use crate::airspeed::{self, TrueAirspeed};
use crate::arrival::{Arrival, Content};
use crate::event::LiveEventKind;
use crate::link::Counts;
use crate::mavlink::map::{Assembler, MavlinkOptions};
use crate::timing::{Judgement, SenderClock};
use stream::{Payload, Piece, Stream};

/// How the bytes that arrive are interpreted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReceiverOptions {
    /// Columns that the model file maps to channels (`[channels]`): headers of CSV, keys of JSON, or `MESSAGE.field` of
    /// MAVLink.
    pub columns: Vec<ColumnMapping>,
    /// Options that concern MAVLink only.
    pub mavlink: MavlinkOptions,
}

impl ReceiverOptions {
    /// The same without the column mappings: for rows that have canonical names and SI units already.
    #[must_use]
    pub fn without_columns(&self) -> Self {
        Self { columns: Vec::new(), mavlink: self.mavlink.clone() }
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
    /// The sender's clock has started again. The samples that follow belong to another flight.
    Restart {
        /// Last time before the restart, s.
        from_s: f64,
        /// First time after the restart, s.
        to_s: f64,
    },
    /// Something happened that a person should know.
    Event {
        /// What the event is about.
        kind: LiveEventKind,
        /// What happened, as one sentence for people.
        message: String,
    },
}

/// Events of one kind that are published at most; further ones only count.
const MOST_EVENTS: u32 = 5;
/// Rows of another sender are used only if the current one has been silent for this long, ns.
const HANDOVER_NS: u64 = 1_000_000_000;
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
    /// How many events of each kind have been published.
    published: BTreeMap<LiveEventKind, u32>,
    /// What the first stream that was recognised gives.
    payload: Option<Payload>,
    /// Why something was left out for the first time.
    first_refusal: Option<String>,
    /// The sender whose rows of text are used, and the arrival of its last row, ns.
    text_sender: Option<(u16, u64)>,
    row: Vec<f64>,
    values: Vec<f64>,
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
            published: BTreeMap::new(),
            payload: None,
            first_refusal: None,
            text_sender: None,
            row: Vec::new(),
            values: vec![f64::NAN; channels.len()],
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
                out(event(LiveEventKind::Silent, format!("nothing has arrived for {:.0} s", SILENCE_NS as f64 / 1e9)));
            }
            self.emit_mavlink(due_ns, out);
        }
    }

    /// Takes an arrival and hands over the samples and events that follow from it. What was due before its time is done
    /// first.
    pub fn take(&mut self, arrival: &Arrival, out: &mut dyn FnMut(Reception<'_>)) {
        let now_ns = arrival.arrival_ns;
        self.advance(now_ns, out);
        match &arrival.content {
            Content::Opened(peer) => {
                self.streams.insert(arrival.origin, Stream::new(peer));
                self.mavlink.forget(arrival.origin);
                out(event(LiveEventKind::Origin, format!("receiving from {peer}")));
            }
            Content::Closed(reason) => {
                let mut stream = self.streams.remove(&arrival.origin).unwrap_or_else(|| Stream::new(""));
                self.pieces(&mut stream, arrival, &[], true, out);
                if self.text_sender.is_some_and(|(origin, _)| origin == arrival.origin) {
                    self.text_sender = None;
                }
                out(event(LiveEventKind::Origin, format!("{}: {reason}", stream.peer())));
            }
            Content::Datagram(bytes) | Content::Piece(bytes) => {
                self.counts.packets += 1;
                self.counts.bytes += bytes.len() as u64;
                if self.silence_published {
                    let silent_s = now_ns.saturating_sub(self.newest_ns) as f64 / 1e9;
                    out(event(LiveEventKind::Silent, format!("data again, after {silent_s:.1} s without")));
                }
                (self.newest_ns, self.silence_published) = (now_ns.max(1), false);
                let ends = matches!(arrival.content, Content::Datagram(_));
                let mut stream = self.streams.remove(&arrival.origin).unwrap_or_else(|| Stream::new("the stream"));
                self.pieces(&mut stream, arrival, bytes, ends, out);
                self.streams.insert(arrival.origin, stream);
            }
        }
    }

    /// Hands over the samples that still wait. To be called at the end.
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
            Piece::Payload(payload) => {
                self.payload.get_or_insert(payload);
                out(event(LiveEventKind::Payload, format!("this is {}", payload.words())));
            }
            Piece::Columns(notes) => notes.into_iter().for_each(|message| out(event(LiveEventKind::Columns, message))),
            Piece::Row { time_s, names, values } => self.row(arrival, time_s, names, values, out),
            Piece::Refused(reason) => {
                self.counts.refused += 1;
                self.publish(LiveEventKind::Refused, reason, out);
            }
            Piece::Garbage(bytes) => self.counts.garbage_bytes += bytes as u64,
            Piece::BadChecksum => self.counts.checksum_failures += 1,
            Piece::Frame(frame) => {
                self.counts.received += 1;
                let mut events = Vec::new();
                self.mavlink.take(&frame, arrival.origin, arrival.arrival_ns, &mut self.counts, &mut events);
                if self.counts.received == 1 {
                    self.mavlink
                        .warnings()
                        .into_iter()
                        .for_each(|message| out(event(LiveEventKind::Airspeed, message)));
                }
                events.into_iter().for_each(|(kind, message)| self.publish(kind, message, out));
                self.emit_mavlink(arrival.arrival_ns, out);
            }
        });
        (self.csv, self.row) = (csv, row);
    }

    /// Hands over the MAVLink samples that are ready at this time.
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
        match self.text_sender {
            Some((origin, last_ns))
                if origin != arrival.origin && arrival.arrival_ns.saturating_sub(last_ns) < HANDOVER_NS =>
            {
                self.counts.refused += 1;
                self.publish(
                    LiveEventKind::Refused,
                    "a second sender at the same time: only the first is used".to_owned(),
                    out,
                );
                return;
            }
            _ => self.text_sender = Some((arrival.origin, arrival.arrival_ns)),
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

    /// Computes the true airspeed where that is needed, and hands the sample over.
    fn sample(&mut self, time_s: f64, arrival_ns: u64, out: &mut dyn FnMut(Reception<'_>)) {
        if let Some(airspeed) = &mut self.airspeed {
            airspeed.fill(time_s, &mut self.values, &mut |message| out(event(LiveEventKind::Airspeed, message)));
        }
        self.counts.samples += 1;
        out(Reception::Sample { time_s, arrival_ns, values: self.values.get(..self.asked).unwrap_or_default() });
    }

    /// Whether a sample with this time is to be used. Counts and publishes what its time means.
    fn judge(&mut self, time_s: f64, arrival_ns: u64, out: &mut dyn FnMut(Reception<'_>)) -> bool {
        match self.clock.judge(time_s, arrival_ns) {
            Judgement::Forward => return true,
            Judgement::Repeated => self.counts.duplicated += 1,
            Judgement::Stalled => {
                self.counts.stalled += 1;
                out(event(
                    LiveEventKind::Stalled,
                    format!("samples come, but the sender's clock stands still at {time_s:.3} s"),
                ));
            }
            Judgement::Late => self.counts.late += 1,
            Judgement::Doubtful => {
                self.counts.refused += 1;
                self.publish(
                    LiveEventKind::Refused,
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

    /// Publishes an event, unless there have been too many of its kind.
    fn publish(&mut self, kind: LiveEventKind, message: String, out: &mut dyn FnMut(Reception<'_>)) {
        if kind == LiveEventKind::Refused {
            self.first_refusal.get_or_insert_with(|| message.clone());
        }
        let published = self.published.entry(kind).or_default();
        *published += 1;
        match *published {
            0..MOST_EVENTS => out(event(kind, message)),
            MOST_EVENTS => out(event(kind, format!("{message} (further ones are counted, not said)"))),
            _ => {}
        }
    }
}

fn event(kind: LiveEventKind, message: String) -> Reception<'static> {
    Reception::Event { kind, message }
}
