//! Reads the messages of a log, one after the other.

use std::collections::{BTreeMap, HashMap};
use std::io::Read;

use super::format::{Format, HEADER, Purpose, Stamp, Tables};
use crate::format::DATAFLASH_MAGIC as MAGIC;
use crate::log::sink::{Full, Head, Sink, Stop};
use crate::log::skipped::Skipped;
use crate::log::utc;
use crate::log::window::Window;
use crate::log::{LogError, Message};
use crate::quality::Severity;
use crate::wording::{Short, plural};

/// Largest size of a message, bytes: lengths are stored in one byte.
const LONGEST: usize = 255;
/// Number of bytes that are examined together, for a message and the search for the next one.
const VIEW: usize = 64 * 1024;
/// Largest number of messages and of parameters that are kept; no flight has nearly as many.
const MAX_TEXTS: usize = 10_000;
/// Number of changes that are reported one by one.
const MAX_SHOWN: usize = 5;
/// How often units that come late may be applied to samples read before: each time all formats are visited.
const MAX_PASSES: usize = 2000;

/// Reads all messages into the sink.
pub(in crate::log) fn run<R: Read, S: Sink>(reader: R, source: &str, sink: &mut S) -> Result<Head, Stop> {
    let io = |error| LogError::Io { source_name: source.to_owned(), error };
    let mut window = Window::new(reader);
    window.fill(HEADER).map_err(io)?;
    if !window.bytes().starts_with(&MAGIC) {
        let found: Vec<String> = window.bytes().iter().take(HEADER).map(|byte| format!("{byte:02x}")).collect();
        let found = if found.is_empty() { "an empty file".to_owned() } else { found.join(" ") };
        let problem = format!("byte 0: a message has to begin with a3 95, found {found}");
        let source_name = source.to_owned();
        return Err(LogError::NotThisFormat { source_name, format: "DataFlash log", problem }.into());
    }
    let mut log = Reading::new(source);
    loop {
        window.fill(VIEW).map_err(io)?;
        let (offset, bytes) = (window.offset(), window.bytes());
        if bytes.is_empty() {
            break;
        }
        let step = match log.length(bytes) {
            Some(length) if length > bytes.len() => {
                log.end(offset, bytes);
                log.find(bytes).unwrap_or(bytes.len())
            }
            // If no message follows, bytes may be missing inside this one, and the next message begins within its
            // length.
            Some(length) if begins(bytes.get(length..)) || log.find(bytes).is_none_or(|next| next >= length) => {
                log.take(bytes.get(..length).unwrap_or_default(), sink, offset)?;
                length
            }
            _ => {
                let step = log.find(bytes);
                let undefined = bytes.starts_with(&MAGIC) && step.is_some_and(|step| step <= LONGEST);
                match (undefined.then(|| bytes.get(2)).flatten(), step) {
                    (Some(kind), Some(step)) if log.formats.get(usize::from(*kind)).is_some_and(Option::is_none) => {
                        let undefined = log.undefined.entry(*kind).or_insert((0, offset, step as u64));
                        undefined.0 += 1;
                        step
                    }
                    (_, Some(step)) => {
                        log.skipped.add(offset, step as u64);
                        step
                    }
                    (_, None) if window.has_end() && bytes.len() < VIEW => {
                        log.end(offset, bytes);
                        bytes.len()
                    }
                    (_, None) => {
                        let step = bytes.len().saturating_sub(LONGEST).max(1);
                        log.skipped.add(offset, step as u64);
                        step
                    }
                }
            }
        };
        window.advance(step);
    }
    Ok(log.finish(source)?)
}

/// True if a message begins here, or if there are too few bytes to decide.
#[inline]
fn begins(bytes: Option<&[u8]>) -> bool {
    match bytes {
        Some([first, second, ..]) => [*first, *second] == MAGIC,
        Some([first]) => *first == MAGIC[0],
        _ => true,
    }
}

/// The state of the reader: what was read of a log so far.
struct Reading {
    head: Head,
    formats: Vec<Option<Box<Format>>>,
    tables: Tables,
    last_us: Option<f64>,
    samples: u64,
    skipped: Skipped,
    cut: Option<(u64, usize)>,
    filling: usize,
    parameters: HashMap<String, usize>,
    changes: Vec<(f64, String, f64)>,
    change_count: usize,
    /// Messages whose type was never defined, by type: their number, and position and length of the first.
    undefined: BTreeMap<u8, (u64, u64, u64)>,
    /// Messages without a stamp of their own.
    stampless: BTreeMap<String, u64>,
    passes: usize,
    row: Vec<f64>,
}

impl Reading {
    fn new(source: &str) -> Self {
        let mut formats: Vec<Option<Box<Format>>> = (0..256).map(|_| None).collect();
        if let Some(format) = formats.get_mut(0x80) {
            *format = Some(Box::new(Format::of_formats()));
        }
        Self {
            head: Head { source: source.to_owned(), ..Head::default() },
            formats,
            tables: Tables::default(),
            last_us: None,
            samples: 0,
            skipped: Skipped::default(),
            cut: None,
            filling: 0,
            parameters: HashMap::new(),
            changes: Vec::new(),
            change_count: 0,
            undefined: BTreeMap::new(),
            stampless: BTreeMap::new(),
            passes: 0,
            row: Vec::new(),
        }
    }

    /// Length of the message that begins here; `None` if no message begins here or its type is not defined.
    #[inline]
    fn length(&self, bytes: &[u8]) -> Option<usize> {
        let &[first, second, kind] = bytes.first_chunk::<HEADER>()?;
        let format = self.formats.get(usize::from(kind))?.as_ref();
        format.filter(|_| [first, second] == MAGIC).map(|format| format.length)
    }

    /// The nearest position after the first byte at which a defined message begins, followed by another one or by the
    /// end.
    fn find(&self, bytes: &[u8]) -> Option<usize> {
        let mut from = 1;
        while let Some(at) = bytes.get(from..)?.iter().position(|&byte| byte == MAGIC[0]).map(|at| from + at) {
            let rest = bytes.get(at..)?;
            if self.length(rest).is_some_and(|length| length <= rest.len() && begins(rest.get(length..))) {
                return Some(at);
            }
            from = at + 1;
        }
        None
    }

    /// Notes that the log ends with bytes that are no whole message.
    fn end(&mut self, offset: u64, bytes: &[u8]) {
        if bytes.iter().all(|&byte| matches!(byte, 0 | 0xFF)) {
            self.filling = bytes.len();
        } else {
            self.cut = Some((offset, bytes.len()));
        }
    }

    #[inline]
    fn take<S: Sink>(&mut self, message: &[u8], sink: &mut S, offset: u64) -> Result<(), Full> {
        let (Some(&kind), Some(payload)) = (message.get(2), message.get(HEADER..)) else { return Ok(()) };
        let Some(format) = self.formats.get_mut(usize::from(kind)).and_then(Option::as_deref_mut) else {
            return Ok(());
        };
        let time_us = match format.stamp {
            Stamp::Field(place) => {
                let time_us = place.read(payload);
                self.last_us = Some(time_us);
                Some(time_us)
            }
            Stamp::Before => self.last_us,
        };
        if format.purpose != Purpose::Data {
            self.special(kind, payload, time_us.unwrap_or(f64::NAN), sink, offset);
            return Ok(());
        }
        if !format.has_numbers() {
            return Ok(());
        }
        if format.stamp == Stamp::Before {
            let room = self.stampless.len() < MAX_TEXTS;
            match self.stampless.get_mut(&format.name) {
                Some(count) => *count += 1,
                None if room => drop(self.stampless.insert(format.name.clone(), 1)),
                None => {}
            }
        }
        let Some(time_us) = time_us else { return Ok(()) };
        // Set for samples that are not kept too, so that a survey and every selection of the log have the same time
        // zero.
        self.head.start_us.get_or_insert(time_us);
        self.samples += 1;
        if self.head.utc_offset_s.is_none() && format.name == "GPS" {
            self.head.utc_offset_s = satellite_clock(format, payload, time_us);
        }
        let instance = format.instance(payload);
        if let Some(open) = format.open(instance, &self.tables, sink) {
            self.row.clear();
            self.row.extend(open.places.iter().map(|place| place.read(payload)));
            return sink.row(&open.stream, time_us, &self.row);
        }
        Ok(())
    }

    fn special<S: Sink>(&mut self, kind: u8, payload: &[u8], time_us: f64, sink: &mut S, offset: u64) {
        let Some(format) = self.formats.get(usize::from(kind)).and_then(Option::as_deref) else { return };
        let text =
            |label: &str| format.text(label, payload).map(|text| String::from_utf8_lossy(text).trim().to_owned());
        let byte = |label: &str| format.number(label, payload).map(|number| number as i64 as u8);
        match format.purpose {
            Purpose::Definition => {
                let Some([defines, length]) = payload.first_chunk().copied() else { return };
                let (Some(name), Some(letters), Some(columns)) = (text("Name"), text("Format"), text("Columns")) else {
                    return;
                };
                self.define(defines, usize::from(length), &name, &letters, &columns, offset);
            }
            Purpose::Unit => {
                if let (Some(id), Some(unit)) = (byte("Id"), text("Label"))
                    && self.tables.units.get(&id) != Some(&unit)
                {
                    self.tables.units.insert(id, unit);
                    self.describe_all(sink);
                }
            }
            Purpose::Multiplier => {
                if let (Some(id), Some(factor)) = (byte("Id"), format.number("Mult", payload))
                    && self.tables.multipliers.get(&id) != Some(&factor)
                {
                    self.tables.multipliers.insert(id, factor);
                    self.describe_all(sink);
                }
            }
            Purpose::Units => {
                let ids = (format.text("UnitIds", payload), format.text("MultIds", payload));
                let (Some(kind), (Some(units), Some(multipliers))) = (byte("FmtType"), ids) else { return };
                let Some(format) = self.formats.get_mut(usize::from(kind)).and_then(Option::as_deref_mut) else {
                    return;
                };
                let forgotten = format.take_ids(units, multipliers, &self.tables, sink);
                if forgotten > 0 {
                    self.head.find(
                        Severity::Warning,
                        format.name.as_str(),
                        format!(
                            "{forgotten} samples left out: the log says only after them which field tells the instance"
                        ),
                    );
                }
            }
            Purpose::Parameter => {
                if let (Some(name), Some(value)) = (text("Name"), format.number("Value", payload)) {
                    self.parameter(name, value, time_us);
                }
            }
            Purpose::Text => {
                if self.head.messages.len() < MAX_TEXTS {
                    let text = text("Message").unwrap_or_default();
                    self.head.messages.push(Message { time_s: time_us, text });
                }
            }
            Purpose::Data => {}
        }
    }

    fn define(&mut self, kind: u8, length: usize, name: &str, letters: &str, columns: &str, offset: u64) {
        let Some(known) = self.formats.get_mut(usize::from(kind)) else { return };
        if known.as_ref().is_some_and(|known| known.is(name, length, letters, columns)) {
            return;
        }
        let place = format!("byte {offset}");
        let head = &mut self.head;
        if kind == 0x80 && known.as_ref().is_some_and(|known| known.length != length) {
            head.find(Severity::Warning, place, "a definition that changes the definition of definitions is left out");
            return;
        }
        if length < HEADER || !name.bytes().all(|byte| byte.is_ascii_graphic()) || name.is_empty() {
            head.find(
                Severity::Warning,
                place,
                format!("the definition of message type {kind} is damaged and left out (length {length})"),
            );
            return;
        }
        if let Some(known) = known {
            let message = format!("message type {kind} was {} and is {name} ({columns}) from here on", known.name);
            head.find(Severity::Note, place, message);
        }
        *known = Some(Box::new(match Format::new(name, length, letters, columns) {
            Ok(format) => format,
            Err(problem) => {
                let message = format!("left out: its definition at byte {offset} is wrong: {problem}");
                head.find(Severity::Warning, name, message);
                Format::unreadable(name, length)
            }
        }));
    }

    /// Applies new units and multipliers to all definitions: they may come after the definitions that use them, and
    /// after data.
    fn describe_all<S: Sink>(&mut self, sink: &mut S) {
        self.passes += 1;
        if self.passes <= MAX_PASSES {
            self.formats.iter_mut().flatten().for_each(|format| format.describe(&self.tables, sink));
        }
    }

    fn parameter(&mut self, name: String, value: f64, time_us: f64) {
        match self.parameters.get(&name).and_then(|&index| self.head.parameters.get(index)) {
            Some((_, known)) if *known == value => {}
            Some(_) => {
                self.change_count += 1;
                if self.changes.len() < MAX_SHOWN {
                    self.changes.push((time_us, name, value));
                }
            }
            None if self.parameters.len() < MAX_TEXTS => {
                self.parameters.insert(name.clone(), self.head.parameters.len());
                self.head.parameters.push((name, value));
            }
            None => {}
        }
    }

    fn finish(mut self, source: &str) -> Result<Head, LogError> {
        let quality = &mut self.head.quality;
        // A type that occurs only once is probably no type, but a damaged header.
        for (_, offset, bytes) in self.undefined.values().filter(|(count, ..)| *count == 1) {
            self.skipped.add(*offset, *bytes);
        }
        self.undefined.retain(|_, (count, ..)| *count > 1);
        self.skipped.report(quality);
        if let Some((offset, bytes)) = self.cut {
            let place = format!("byte {offset}");
            quality.warn(place, format!("the log ends within a message; its {} are left out", plural(bytes, "byte")));
        }
        if self.filling > 0 {
            quality.note("", format!("the log ends with {} of filling", plural(self.filling, "byte")));
        }
        if !self.undefined.is_empty() {
            let count: u64 = self.undefined.values().map(|(count, ..)| count).sum();
            let kinds: Vec<String> = self.undefined.keys().map(u8::to_string).collect();
            quality.warn(
                "",
                format!("{count} messages left out: their types ({}) were never defined in the log", kinds.join(", ")),
            );
        }
        if !self.stampless.is_empty() {
            let names: Vec<&str> = self.stampless.keys().map(String::as_str).collect();
            let message = "have no time of their own and carry that of the message before them";
            quality.note("", format!("{} {message}", names.join(", ")));
        }
        if self.change_count > 0 {
            let shown: Vec<String> =
                self.changes.iter().map(|(_, name, value)| format!("{name} = {}", Short(*value))).collect();
            let more = if self.change_count > MAX_SHOWN { ", ..." } else { "" };
            let count = plural(self.change_count, "parameter");
            quality.note("", format!("{count} changed while the log ran: {}{more}", shown.join(", ")));
        }
        if self.samples == 0 {
            let reason = match self.skipped.bytes() {
                0 => String::new(),
                bytes => format!(": {bytes} bytes are no messages that could be understood"),
            };
            return Err(LogError::NoData { source_name: source.to_owned(), reason });
        }
        Ok(self.head)
    }
}

/// The offset from the clock of the autopilot to seconds from 1970, UTC; `None` while the receiver does not know the
/// time.
fn satellite_clock(format: &Format, payload: &[u8], time_us: f64) -> Option<f64> {
    let number = |label: &str| format.number(label, payload);
    let week = number("GWk").or_else(|| number("Week"))?;
    let milliseconds = number("GMS").or_else(|| number("TimeMS"))?;
    (week > 0.0).then(|| utc::from_gps(week, milliseconds * 1e-3) - time_us * 1e-6)
}
