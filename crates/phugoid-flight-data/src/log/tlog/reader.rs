//! Reads the messages of a log, one after the other.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::Read;

use super::clock::{Clock, EPOCH_US};
use crate::log::decode::Scale;
use crate::log::sink::{Head, Sink, Stop, Stream};
use crate::log::skipped::Skipped;
use crate::log::window::Window;
use crate::log::{LogError, Message};
use crate::mavlink::definitions::{self, Field, NAMED_VALUE_FLOAT};
use crate::mavlink::frame::{self, Found, Frame, START_1, START_2};
use crate::mavlink::{time_field, units};
use crate::printable;
use crate::wording::{Short, plural};

/// Bytes of the time before every frame.
const STAMP: usize = 8;
/// Longest message with its time, bytes.
const LONGEST: usize = STAMP + 10 + 255 + 2 + frame::SIGNATURE;
/// Number of bytes that are examined together, for a message and the search for the next one.
const VIEW: usize = 64 * 1024;
/// The vehicle and its clock are looked for within so many bytes from the start.
const LOOK_AHEAD: usize = 1 << 20;
/// Largest number of texts and of parameters that are kept; no flight has nearly as many.
const MAX_TEXTS: usize = 10_000;
/// Names of `NAMED_VALUE_FLOAT` that are kept; a sender has some dozens.
const MAX_NAMES: usize = 1024;
/// Kinds of messages that are kept; one vehicle sends some dozens.
const MAX_KINDS: usize = 4096;
/// Number of changes that are reported one by one.
const MAX_SHOWN: usize = 5;
/// The messages that tell which system is the vehicle: its motion.
const MOTION: [&str; 5] = ["HIGHRES_IMU", "SCALED_IMU", "RAW_IMU", "ATTITUDE", "ATTITUDE_QUATERNION"];
/// Messages whose field `id` numbers equal sensors.
const WITH_ID: [&str; 4] = ["AIRSPEED", "HIGHRES_IMU", "RAW_IMU", "HYGROMETER_SENSOR"];
/// `MAV_AUTOPILOT_PX4`, which sends the bits of integer parameters in place of a number.
const PX4: f64 = 12.0;
/// `MAV_PARAM_TYPE` of a signed integer of 32 bits; smaller numbers are those of shorter integers, 5 of an unsigned one.
const INT32: f64 = 6.0;

/// What begins at a place.
enum Entry<'a> {
    /// A message: its arrival, us, and its length with the time.
    Message(f64, Frame<'a>, usize),
    /// So many bytes of a message whose checksum is wrong, with another message, or the end, behind it.
    Wrong(usize),
    /// No message, or only the beginning of one.
    None,
}

/// Reads all messages into the sink.
pub(in crate::log) fn run<R: Read, S: Sink>(reader: R, source: &str, sink: &mut S) -> Result<Head, Stop> {
    let io = |error| LogError::Io { source_name: source.to_owned(), error };
    let mut window = Window::new(reader);
    window.fill(LOOK_AHEAD).map_err(io)?;
    if frame::length(window.bytes().get(STAMP..).unwrap_or_default()).is_none() {
        let problem = "after a time in eight bytes a frame of MAVLink has to begin (fe or fd)".to_owned();
        let source_name = source.to_owned();
        return Err(LogError::NotThisFormat { source_name, format: "telemetry log (.tlog)", problem }.into());
    }
    let mut log = Reading::new(source, window.bytes());
    loop {
        window.fill(VIEW).map_err(io)?;
        let (offset, bytes) = (window.offset(), window.bytes());
        if bytes.is_empty() {
            break;
        }
        let step = match entry(bytes) {
            Entry::Message(arrival_us, frame, length) => {
                log.take(arrival_us, &frame, sink)?;
                length
            }
            Entry::Wrong(length) => {
                log.wrong += 1;
                length
            }
            Entry::None => match find(bytes) {
                Some(step) => {
                    log.skipped.add(offset, step as u64);
                    step
                }
                None if window.has_end() && bytes.len() < VIEW => {
                    log.cut = Some((offset, bytes.len()));
                    bytes.len()
                }
                None => {
                    let step = bytes.len().saturating_sub(LONGEST).max(1);
                    log.skipped.add(offset, step as u64);
                    step
                }
            },
        };
        window.advance(step);
    }
    Ok(log.finish(source)?)
}

/// What begins here. A message that the definitions do not know has no checksum that could be verified, and counts only
/// if another one, or the end, follows it.
fn entry(bytes: &[u8]) -> Entry<'_> {
    let (Some(stamp), Some(rest)) = (bytes.first_chunk::<STAMP>(), bytes.get(STAMP..)) else { return Entry::None };
    let Some(length) = frame::length(rest) else { return Entry::None };
    let (Some(whole), 0) = (rest.get(..length), stamp[0]) else { return Entry::None };
    let follows = begins(rest.get(length..).unwrap_or_default());
    match frame::next(whole) {
        Found::Frame(frame, _) if frame.known || follows => {
            Entry::Message(u64::from_be_bytes(*stamp) as f64, frame, STAMP + length)
        }
        Found::BadChecksum(_) if follows => Entry::Wrong(STAMP + length),
        _ => Entry::None,
    }
}

/// True if a message may begin here, or if there are too few bytes to decide.
fn begins(bytes: &[u8]) -> bool {
    bytes.first().is_none_or(|first| *first == 0) && bytes.get(STAMP).is_none_or(|start| is_start(*start))
}

fn is_start(byte: u8) -> bool {
    [START_1, START_2].contains(&byte)
}

/// The nearest position after the first byte at which a message with the right checksum begins.
fn find(bytes: &[u8]) -> Option<usize> {
    let mut from = 1;
    while let Some(at) = bytes.get(from + STAMP..)?.iter().position(|byte| is_start(*byte)).map(|at| from + at) {
        if bytes.get(at..).is_some_and(|rest| matches!(entry(rest), Entry::Message(_, Frame { known: true, .. }, _))) {
            return Some(at);
        }
        from = at + 1;
    }
    None
}

/// What is kept of a kind of messages of one instance.
struct Opened {
    stream: Stream,
    /// Field, element and factor of each value that is kept.
    places: Vec<(&'static Field, usize, Scale)>,
}

/// The state of the reader: what was read of a log so far.
struct Reading {
    head: Head,
    /// The system and component of the vehicle; a system alone if no component has sent the motion yet.
    vehicle: Option<(u8, u8)>,
    /// True if the times of the log count from 1970: no stamp counts from the start of the vehicle.
    of_epoch: bool,
    clock: Clock,
    opened: HashMap<(u32, u16), Option<Opened>>,
    named: HashMap<String, Option<Stream>>,
    row: Vec<f64>,
    skipped: Skipped,
    cut: Option<(u64, usize)>,
    samples: u64,
    /// Messages with a wrong checksum, ...
    wrong: u64,
    /// ... those that came before the first time, ...
    early: u64,
    /// ... those that the definitions do not know, by number, ...
    unknown: BTreeMap<u32, u64>,
    /// ... and those of other systems, by system.
    others: BTreeMap<u8, u64>,
    stampless: BTreeSet<&'static str>,
    parameters: HashMap<String, f64>,
    changes: Vec<(String, f64)>,
    change_count: usize,
    autopilot: Option<f64>,
    kind: Option<f64>,
}

impl Reading {
    /// `start` is the beginning of the log, in which the vehicle and its clock are looked for.
    fn new(source: &str, start: &[u8]) -> Self {
        let mut log = Self {
            head: Head { source: source.to_owned(), ..Head::default() },
            vehicle: None,
            of_epoch: true,
            clock: Clock::default(),
            opened: HashMap::new(),
            named: HashMap::new(),
            row: Vec::new(),
            skipped: Skipped::default(),
            cut: None,
            samples: 0,
            wrong: 0,
            early: 0,
            unknown: BTreeMap::new(),
            others: BTreeMap::new(),
            stampless: BTreeSet::new(),
            parameters: HashMap::new(),
            changes: Vec::new(),
            change_count: 0,
            autopilot: None,
            kind: None,
        };
        let frames = || Frames { bytes: start };
        let moves = |frame: &Frame<'_>| definition(frame).is_some_and(|message| MOTION.contains(&message.name));
        log.vehicle = frames()
            .find(moves)
            .or_else(|| frames().find(|frame| stamp_us(frame).is_some()))
            .map(|frame| (frame.system, frame.component));
        let mut stamps = frames().filter(|frame| log.is_of_vehicle(frame)).filter_map(|frame| stamp_us(&frame));
        log.of_epoch = !stamps.any(|stamp| stamp < EPOCH_US);
        log
    }

    fn is_of_vehicle(&self, frame: &Frame<'_>) -> bool {
        self.vehicle.is_none_or(|(system, _)| system == frame.system)
    }

    fn take<S: Sink>(&mut self, arrival_us: f64, frame: &Frame<'_>, sink: &mut S) -> Result<(), Stop> {
        if !self.is_of_vehicle(frame) {
            *self.others.entry(frame.system).or_default() += 1;
            return Ok(());
        }
        let Some(message) = definition(frame) else {
            if self.unknown.len() < MAX_KINDS || self.unknown.contains_key(&frame.id) {
                *self.unknown.entry(frame.id).or_default() += 1;
            }
            return Ok(());
        };
        let own = stamp_us(frame);
        let time_us = match own.filter(|stamp| (*stamp >= EPOCH_US) == self.of_epoch) {
            Some(stamp) => {
                self.vehicle.get_or_insert((frame.system, frame.component));
                let Some(time_us) = self.clock.take(stamp, arrival_us) else { return Ok(()) };
                if self.head.utc_offset_s.is_none() && arrival_us >= EPOCH_US {
                    self.head.utc_offset_s = Some((arrival_us - time_us) * 1e-6);
                }
                Some(time_us)
            }
            None => {
                let newest = self.clock.newest_us();
                if newest.is_some() && self.stampless.len() < MAX_KINDS {
                    self.stampless.insert(message.name);
                }
                newest
            }
        };
        match message.name {
            "PARAM_VALUE" => {
                self.parameter(message, frame.payload);
                return Ok(());
            }
            "STATUSTEXT" => {
                self.text(message, frame.payload, time_us.unwrap_or(f64::NAN));
                return Ok(());
            }
            "HEARTBEAT" if self.vehicle.is_some_and(|(_, component)| component == frame.component) => {
                let value = |name: &str| message.field(name).and_then(|field| field.value(frame.payload, 0));
                self.autopilot = self.autopilot.or_else(|| value("autopilot"));
                self.kind = self.kind.or_else(|| value("type"));
            }
            _ => {}
        }
        let Some(time_us) = time_us else {
            self.early += 1;
            return Ok(());
        };
        // Set for samples that are not kept too, so that a survey and every selection of the log have the same time
        // zero.
        self.head.start_us.get_or_insert(time_us);
        self.samples += 1;
        if message.id == NAMED_VALUE_FLOAT {
            return self.value_with_a_name(message, frame.payload, time_us, sink);
        }
        let instance = self.instance(message, frame);
        let key = (frame.id, instance);
        if !self.opened.contains_key(&key) {
            if self.opened.len() >= MAX_KINDS {
                return Ok(());
            }
            self.opened.insert(key, open(message, instance, sink));
        }
        let Some(Some(opened)) = self.opened.get(&key) else { return Ok(()) };
        self.row.clear();
        let value = |(field, element, scale): &(&Field, usize, Scale)| {
            let raw = field.value(frame.payload, *element).unwrap_or(f64::NAN);
            if *scale == Scale::ONE { raw } else { scale.apply(raw) }
        };
        self.row.extend(opened.places.iter().map(value));
        Ok(sink.row(&opened.stream, time_us, &self.row)?)
    }

    fn instance(&self, message: &definitions::Message, frame: &Frame<'_>) -> u16 {
        let other = self.vehicle.is_some_and(|(_, component)| component != frame.component);
        let id = message.field("id").filter(|_| WITH_ID.contains(&message.name));
        let id = id.and_then(|field| field.value(frame.payload, 0)).unwrap_or(0.0);
        id as u8 as u16 + if other { 256 * u16::from(frame.component) } else { 0 }
    }

    fn value_with_a_name<S: Sink>(
        &mut self,
        message: &definitions::Message,
        payload: &[u8],
        time_us: f64,
        sink: &mut S,
    ) -> Result<(), Stop> {
        let name = message.field("name").and_then(|field| field.text(payload));
        let value = message.field("value").and_then(|field| field.value(payload, 0));
        let (Some(name), Some(value)) = (name.filter(|name| !name.is_empty()), value) else { return Ok(()) };
        if !self.named.contains_key(&name) {
            if self.named.len() >= MAX_NAMES {
                return Ok(());
            }
            let fields = [printable::one_line(&name).into_owned()];
            // Each name has a topic of its own: they come one by one, each at its own times.
            let instance = u16::try_from(self.named.len()).unwrap_or(u16::MAX);
            let stream = sink.open(message.name, instance, &fields).filter(|stream| !stream.kept.is_empty());
            self.named.insert(name.clone(), stream);
        }
        match self.named.get(&name) {
            Some(Some(stream)) => Ok(sink.row(stream, time_us, &[value])?),
            _ => Ok(()),
        }
    }

    fn parameter(&mut self, message: &definitions::Message, payload: &[u8]) {
        let number = |name: &str| message.field(name).and_then(|field| field.value(payload, 0));
        let name = message.field("param_id").and_then(|field| field.text(payload));
        let (Some(name), Some(value)) = (name.filter(|name| !name.is_empty()), number("param_value")) else { return };
        let kind = number("param_type").unwrap_or(f64::NAN);
        let value = if self.autopilot == Some(PX4) && kind <= INT32 {
            let bits = (value as f32).to_bits();
            if kind == INT32 { f64::from(bits as i32) } else { f64::from(bits) }
        } else {
            value
        };
        match self.parameters.get(&name) {
            Some(before) if before.to_bits() != value.to_bits() => {
                self.change_count += 1;
                if self.changes.len() < MAX_SHOWN {
                    self.changes.push((name.clone(), value));
                }
                self.parameters.insert(name, value);
            }
            Some(_) => {}
            None if self.parameters.len() < MAX_TEXTS => {
                self.head.parameters.push((name.clone(), value));
                self.parameters.insert(name, value);
            }
            None => {}
        }
    }

    fn text(&mut self, message: &definitions::Message, payload: &[u8], time_us: f64) {
        let text = message.field("text").and_then(|field| field.text(payload));
        if let Some(text) = text.filter(|_| self.head.messages.len() < MAX_TEXTS) {
            self.head.messages.push(Message { time_s: time_us, text: text.trim().to_owned() });
        }
    }

    fn finish(mut self, source: &str) -> Result<Head, LogError> {
        if self.samples == 0 {
            let reason = match (self.early, self.skipped.bytes(), self.others.is_empty()) {
                (0, 0, false) => ": only other systems than a vehicle have sent something".to_owned(),
                (0, 0, true) if self.unknown.is_empty() => String::new(),
                (0, 0, true) => ": its messages are of a dialect that is not known".to_owned(),
                (0, bytes, _) => format!(": {bytes} bytes are no messages that could be understood"),
                _ => ": no message states its time (time_boot_ms or time_usec)".to_owned(),
            };
            return Err(LogError::NoData { source_name: source.to_owned(), reason });
        }
        if let Some((system, _)) = self.vehicle {
            self.head.information.push(("MAVLink system".to_owned(), system.to_string()));
        }
        let known = self.autopilot.map(|number| match number as u8 {
            3 => "ArduPilot".to_owned(),
            12 => "PX4".to_owned(),
            other => format!("MAV_AUTOPILOT {other}"),
        });
        self.head.information.extend(known.map(|name| ("autopilot".to_owned(), name)));
        // The kind of vehicle stands in a message here, and in a parameter in other logs.
        if let Some(kind) = self.kind.filter(|_| !self.parameters.contains_key("MAV_TYPE")) {
            self.head.parameters.push(("MAV_TYPE".to_owned(), kind));
        }
        self.report();
        Ok(self.head)
    }

    fn report(&mut self) {
        let quality = &mut self.head.quality;
        self.skipped.report(quality);
        if let Some((offset, bytes)) = self.cut {
            let place = format!("byte {offset}");
            quality.warn(place, format!("the log ends within a message; its {} are left out", plural(bytes, "byte")));
        }
        if self.wrong > 0 {
            let count = plural(self.wrong as usize, "message");
            quality.warn(
                "",
                format!("{count} left out: the checksum is wrong (damaged, or another version of a message)"),
            );
        }
        if !self.unknown.is_empty() {
            let count: u64 = self.unknown.values().sum();
            let kinds: Vec<String> = self.unknown.keys().take(10).map(u32::to_string).collect();
            let more = if self.unknown.len() > 10 { ", ..." } else { "" };
            quality.note(
                "",
                format!(
                    "{} left out: neither `common` nor `ardupilotmega` has the numbers {}{more}",
                    plural(count as usize, "message"),
                    kinds.join(", ")
                ),
            );
        }
        if !self.others.is_empty() {
            let of: Vec<String> = self.others.iter().map(|(system, count)| format!("{count} of {system}")).collect();
            let system = self.vehicle.map_or(0, |(system, _)| system);
            quality.note(
                "",
                format!(
                    "read is system {system}, which sends its motion; messages of other systems: {}",
                    of.join(", ")
                ),
            );
        }
        if !self.stampless.is_empty() {
            let names: Vec<&str> = self.stampless.iter().take(20).copied().collect();
            let more = if self.stampless.len() > 20 { ", ..." } else { "" };
            quality.note(
                "",
                format!(
                    "{}{more} have no time by the vehicle's clock and carry the newest one before them",
                    names.join(", ")
                ),
            );
        }
        if self.clock.restarts > 0 {
            let count = plural(self.clock.restarts as usize, "time");
            quality.warn(
                "time",
                format!(
                    "the vehicle's clock has begun again {count}: from there on the times go on by the ground station's clock"
                ),
            );
        }
        if self.clock.left_out > 0 {
            let count = plural(self.clock.left_out as usize, "message");
            quality.warn("time", format!("{count} left out: their times do not go on from those before"));
        }
        if self.early > 0 {
            let count = plural(self.early as usize, "message");
            quality.note("time", format!("{count} left out: they came before the first time of the vehicle"));
        }
        if self.change_count > 0 {
            let shown: Vec<String> =
                self.changes.iter().map(|(name, value)| format!("{name} = {}", Short(*value))).collect();
            let more = if self.change_count > MAX_SHOWN { ", ..." } else { "" };
            let count = plural(self.change_count, "parameter");
            quality.note("", format!("{count} changed while the log ran: {}{more}", shown.join(", ")));
        }
    }
}

/// The frames at the beginning of a log.
struct Frames<'a> {
    bytes: &'a [u8],
}

impl<'a> Iterator for Frames<'a> {
    type Item = Frame<'a>;

    fn next(&mut self) -> Option<Frame<'a>> {
        loop {
            let (found, step) = match entry(self.bytes) {
                Entry::Message(_, frame, length) => (Some(frame), length),
                Entry::Wrong(length) => (None, length),
                Entry::None => (None, find(self.bytes)?),
            };
            self.bytes = self.bytes.get(step..).unwrap_or_default();
            if found.is_some() {
                return found;
            }
        }
    }
}

fn definition(frame: &Frame<'_>) -> Option<&'static definitions::Message> {
    definitions::messages().get(&frame.id)
}

/// The time that a message states itself, us of whichever clock; `None` if it states none, and for zero, which means that
/// the sender does not know.
fn stamp_us(frame: &Frame<'_>) -> Option<f64> {
    let field = time_field(definition(frame)?)?;
    let factor = if field.unit == "ms" { 1000.0 } else { 1.0 };
    field.value(frame.payload, 0).map(|stamp| factor * stamp).filter(|stamp| *stamp > 0.0)
}

/// Announces a kind of messages; `None` if nothing of it is kept.
fn open<S: Sink>(message: &'static definitions::Message, instance: u16, sink: &mut S) -> Option<Opened> {
    let numbers = message.fields.iter().filter(|field| field.kind != definitions::Kind::Character);
    let all: Vec<(&Field, usize)> =
        numbers.flat_map(|field| (0..field.count.max(1)).map(move |element| (field, element))).collect();
    let name = |(field, element): &(&Field, usize)| match field.count {
        0 => field.name.to_owned(),
        _ => format!("{}[{element}]", field.name),
    };
    let names: Vec<String> = all.iter().map(name).collect();
    let stream = sink.open(message.name, instance, &names)?;
    let mut places = Vec::with_capacity(stream.kept.len());
    for (kept, (field, element)) in stream.kept.iter().filter_map(|index| all.get(*index)).enumerate() {
        let (unit, factor) = units::plain(field.unit);
        sink.describe(&stream, kept, Some(unit).filter(|unit| !unit.is_empty()), Scale::ONE);
        places.push((*field, *element, Scale::new(factor)));
    }
    Some(Opened { stream, places })
}
