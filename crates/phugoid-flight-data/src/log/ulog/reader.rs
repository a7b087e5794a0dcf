//! Reads the messages of a log, one after the other.

use std::collections::{BTreeMap, HashMap};
use std::io::Read;

use super::definitions::{Definitions, State, Subscription};
use super::format;
use super::message::{self, HEADER, LONGEST, Trust};
use crate::format::ULOG_MAGIC as MAGIC;
use crate::log::decode::{Kind, Place, Scale};
use crate::log::sink::{Full, Head, Sink, Stop};
use crate::log::skipped::Skipped;
use crate::log::window::Window;
use crate::log::{LogError, Message};
use crate::memory::{Account, Excess, many};
use crate::quality::{QualityReport, Severity};
use crate::wording::{Short, plural};

/// Largest number of messages and entries of information that are kept; no flight has nearly as many.
const MAX_TEXTS: usize = 10_000;
/// Largest length of a text that is kept, bytes.
const LONGEST_TEXT: usize = 400;
/// Largest length of an entry of information that is kept, bytes.
const LONGEST_INFORMATION: usize = 4096;
/// What a parameter, an entry of information or a subscription takes besides its texts, bytes.
const BYTES_PER_ENTRY: usize = 200;
/// Number of dropouts and changes that are reported one by one.
const MAX_SHOWN: usize = 5;

/// Reads all messages into the sink. What the log defines is counted in the account.
pub(in crate::log) fn run<R: Read, S: Sink>(
    reader: R,
    source: &str,
    sink: &mut S,
    account: &Account,
) -> Result<Head, Stop> {
    let io = |error| LogError::Io { source_name: source.to_owned(), error };
    let mut window = Window::new(reader);
    window.fill(16).map_err(io)?;
    let start = window.bytes().get(..16).filter(|start| start.starts_with(&MAGIC));
    let Some(&[.., version, _, _, _, _, _, _, _, _]) = start else {
        let problem = match window.bytes().starts_with(&MAGIC) {
            true => {
                "the file ends within its head of 16 bytes; it was cut when it was copied, or never written".to_owned()
            }
            false => format!("byte 0: the bytes 55 4c 6f 67 01 12 35 are expected, found {}", hex(window.bytes())),
        };
        let source_name = source.to_owned();
        return Err(LogError::NotThisFormat { source_name, format: "ULog", problem }.into());
    };
    let stamp = Place { offset: 8, kind: Kind::U64, scale: Scale::ONE }.read(window.bytes());
    let head = Head { source: source.to_owned(), start_us: Some(stamp), ..Head::default() };
    let mut log = Reading::new(head, stamp, account);
    if version > 1 {
        log.head.quality.note("byte 7", format!("version {version} of the format is not known; read as version 1"));
    }
    window.advance(16);
    log.messages(&mut window, source, sink)?;
    Ok(log.finish(source)?)
}

fn hex(bytes: &[u8]) -> String {
    let shown: Vec<String> = bytes.iter().take(7).map(|byte| format!("{byte:02x}")).collect();
    if shown.is_empty() { "an empty file".into() } else { shown.join(" ") }
}

/// The state of the reader: what was read of a log so far.
#[derive(Debug)]
struct Reading {
    account: Account,
    head: Head,
    definitions: Definitions,
    /// Positions at which appended data begin, bytes from the start of the file, rising.
    appended: Vec<u64>,
    in_data: bool,
    last_us: f64,
    samples: u64,
    skipped: Skipped,
    barren: Barren,
    /// Positions that were judged in search of a message.
    #[cfg(test)]
    judged: std::cell::Cell<u64>,
    cut: Vec<(u64, usize)>,
    parameters: HashMap<String, usize>,
    changes: Vec<(f64, String, f64)>,
    change_count: usize,
    information: HashMap<String, usize>,
    dropouts: Vec<(f64, f64)>,
    dropout_count: usize,
    dropout_ms: f64,
    unannounced: u64,
    left_out: BTreeMap<String, String>,
    unknown_kinds: BTreeMap<char, u64>,
    row: Vec<f64>,
}

/// Whether the last part of the log that was searched holds a message that is certain.
#[derive(Debug, Default)]
struct Barren {
    /// Its end, bytes from the start of the file.
    end: u64,
    /// From the present position on there is none.
    is_barren: bool,
    /// How often definitions were changed after that was found.
    changed: u32,
}

/// Why a message ends the reading of the log.
#[derive(Debug)]
enum Halt {
    /// The log has flags which say that a reader that does not know them must not read it.
    UnknownFlags(Vec<u8>),
    /// The sink, or the account of what the log defines, is full.
    Full(Full),
}

impl From<Full> for Halt {
    fn from(full: Full) -> Self {
        Halt::Full(full)
    }
}

impl From<Excess> for Halt {
    fn from(excess: Excess) -> Self {
        Halt::Full(Full(excess))
    }
}

impl Halt {
    fn into_stop(self, source: &str) -> Stop {
        let flags = match self {
            Halt::UnknownFlags(flags) => flags,
            Halt::Full(full) => return full.into(),
        };
        let flags: Vec<String> = flags.iter().map(|flag| format!("{flag:02x}")).collect();
        let feature = format!("incompatible flags {}", flags.join(" "));
        LogError::Incompatible { source_name: source.to_owned(), feature }.into()
    }
}

impl Reading {
    fn new(head: Head, last_us: f64, account: &Account) -> Self {
        Self {
            account: account.clone(),
            head,
            definitions: Definitions::default(),
            appended: Vec::new(),
            in_data: false,
            last_us,
            samples: 0,
            skipped: Skipped::default(),
            barren: Barren::default(),
            #[cfg(test)]
            judged: std::cell::Cell::new(0),
            cut: Vec::new(),
            parameters: HashMap::new(),
            changes: Vec::new(),
            change_count: 0,
            information: HashMap::new(),
            dropouts: Vec::new(),
            dropout_count: 0,
            dropout_ms: 0.0,
            unannounced: 0,
            left_out: BTreeMap::new(),
            unknown_kinds: BTreeMap::new(),
            row: Vec::new(),
        }
    }

    /// Reads all messages of the log, and skips what is none.
    fn messages<R: Read, S: Sink>(&mut self, window: &mut Window<R>, source: &str, sink: &mut S) -> Result<(), Stop> {
        let io = |error| LogError::Io { source_name: source.to_owned(), error };
        let mut lost = false;
        loop {
            // Room for two messages: whether a doubtful one is valid depends on the next one.
            window.fill(2 * LONGEST).map_err(io)?;
            let offset = window.offset();
            let cut = self.appended.iter().copied().find(|&begin| begin > offset).map(|begin| begin - offset);
            let bytes = window.bytes();
            let bytes = cut.and_then(|cut| bytes.get(..usize::try_from(cut).ok()?)).unwrap_or(bytes);
            if bytes.is_empty() {
                break;
            }
            let Some((kind, payload)) = message::split(bytes) else {
                // The log ends here, or the length is wrong. There may still be messages inside.
                let rest = bytes.len();
                match self.next_certain(bytes, offset) {
                    Some(step) => {
                        self.skipped.add(offset, step as u64);
                        window.advance(step);
                    }
                    None => {
                        self.cut.push((offset, rest));
                        window.advance(rest);
                    }
                }
                continue;
            };
            let trust = message::trust(kind, payload, &self.definitions);
            let length = HEADER + payload.len();
            let follows = bytes.get(length..).is_some_and(|rest| message::may_begin(rest, &self.definitions));
            let good = match trust {
                // If no message follows, bytes may be missing inside this one, and the next message begins within its
                // length. Whether one begins behind it does not matter, and is not looked for: every byte is looked at once.
                Trust::Strong => follows || self.find(bytes.get(..length + LONGEST).unwrap_or(bytes), length).is_none(),
                Trust::Weak => follows && !lost,
                Trust::No => false,
            };
            if good {
                lost = false;
                self.take(kind, payload, sink, offset).map_err(|halt| halt.into_stop(source))?;
                window.advance(length);
            } else {
                let next = self.next_certain(bytes, offset);
                let step = next.unwrap_or(bytes.len().saturating_sub(LONGEST).max(1)).min(bytes.len());
                self.skipped.add(offset, step as u64);
                window.advance(step);
                lost = true;
            }
        }
        Ok(())
    }

    /// The nearest position after the first byte at which there certainly is a message. `offset` is that of the first
    /// byte in the file.
    fn next_certain(&mut self, bytes: &[u8], offset: u64) -> Option<usize> {
        // The last part of the log becomes shorter byte by byte, and with the same end nothing else is in it. Without
        // this, nonsense would be searched to its end from each of its last 65,000 bytes.
        let end = offset + bytes.len() as u64;
        if self.barren.end != end {
            self.barren = Barren { end, ..Barren::default() };
        } else if self.barren.is_barren {
            return None;
        }
        let found = self.find(bytes, bytes.len());
        self.barren.is_barren = found.is_none();
        found
    }

    /// What is certain may have become so by a definition. Of a part where none was certain, it is asked again so often.
    fn definitions_have_changed(&mut self) {
        const AGAIN: u32 = 100;
        if self.barren.is_barren && self.barren.changed < AGAIN {
            self.barren.changed += 1;
            self.barren.is_barren = false;
        }
    }

    /// The nearest position between the first byte and `before` at which there certainly is a message.
    fn find(&self, bytes: &[u8], before: usize) -> Option<usize> {
        // If a message does not end within the window, it is judged when more of the stream has been read.
        (1..before.min(bytes.len())).find(|&at| {
            #[cfg(test)]
            self.judged.set(self.judged.get() + 1);
            let kind = bytes.get(at + 2).copied().unwrap_or_default();
            matches!(kind, b'D' | b'S' | b'A' | b'F' | b'I' | b'P' | b'M' | b'Q')
                && bytes.get(at..).and_then(message::split).is_some_and(|(kind, payload)| {
                    message::trust(kind, payload, &self.definitions) == Trust::Strong
                        && bytes
                            .get(at + HEADER + payload.len()..)
                            .is_some_and(|rest| message::may_begin(rest, &self.definitions))
                })
        })
    }

    #[inline]
    fn take<S: Sink>(&mut self, kind: u8, payload: &[u8], sink: &mut S, offset: u64) -> Result<(), Halt> {
        if matches!(kind, b'F' | b'A' | b'R') {
            self.definitions_have_changed();
        }
        match kind {
            b'D' => self.sample(payload, sink)?,
            b'B' => self.flags(payload)?,
            b'F' => {
                let text = std::str::from_utf8(payload).ok();
                let added = text.map_or(Ok(None), |text| self.definitions.formats.add(text, &self.account))?;
                if added.is_none() {
                    let message = "a definition that cannot be understood is left out";
                    self.head.find(Severity::Warning, format!("byte {offset}"), message);
                }
            }
            b'I' => self.inform(payload, false)?,
            b'M' => self.inform(payload.get(1..).unwrap_or_default(), payload.first() == Some(&1))?,
            b'P' => self.parameter(payload)?,
            b'A' => self.announce(payload)?,
            b'R' => {
                if let Some(id) = payload.first_chunk().map(|id| u16::from_le_bytes(*id))
                    && let Some(topic) = self.definitions.topics.get_mut(usize::from(id))
                {
                    *topic = None;
                }
            }
            b'L' => self.text(payload, 1, 9),
            b'C' => self.text(payload, 3, 11),
            b'O' => {
                let milliseconds = Place { offset: 0, kind: Kind::U16, scale: Scale::ONE }.read(payload);
                self.dropout_count += 1;
                self.dropout_ms += milliseconds;
                if self.dropouts.len() < MAX_SHOWN {
                    self.dropouts.push((self.last_us, milliseconds));
                }
            }
            b'S' | b'Q' => {}
            kind => *self.unknown_kinds.entry(char::from(kind)).or_default() += 1,
        }
        Ok(())
    }

    #[inline]
    fn sample<S: Sink>(&mut self, payload: &[u8], sink: &mut S) -> Result<(), Full> {
        self.in_data = true;
        let Some((id, data)) = payload.split_first_chunk() else { return Ok(()) };
        let topic =
            self.definitions.topics.get_mut(usize::from(u16::from_le_bytes(*id))).and_then(Option::as_deref_mut);
        let Some(topic) = topic else {
            self.unannounced += 1;
            return Ok(());
        };
        let Some(stamp) = topic.layout.timestamp else { return Ok(()) };
        let time_us = stamp.read(data);
        if let Some(utc) = topic.utc
            && self.head.utc_offset_s.is_none()
        {
            let utc_us = utc.read(data);
            // A receiver that does not know the time yet gives 0.
            if utc_us > 0.0 {
                self.head.utc_offset_s = Some((utc_us - time_us) * 1e-6);
            }
        }
        if matches!(topic.state, State::Announced) {
            topic.state = match sink.open(&topic.name, topic.instance, &topic.layout.names) {
                Some(stream) => {
                    let place = |&field: &usize| topic.layout.places.get(field).copied();
                    let places = stream.kept.iter().filter_map(place).collect();
                    State::Open { stream, places }
                }
                None => State::Unwanted,
            };
        }
        self.samples += 1;
        self.last_us = time_us;
        if let State::Open { stream, places } = &topic.state {
            self.row.clear();
            self.row.extend(places.iter().map(|place| place.read(data)));
            sink.row(stream, time_us, &self.row)?;
        }
        Ok(())
    }

    fn flags(&mut self, payload: &[u8]) -> Result<(), Halt> {
        let Some((incompatible, offsets)) = payload.get(8..40).and_then(|rest| rest.split_at_checked(8)) else {
            return Ok(());
        };
        // Bit 0 of byte 0 means that data are appended to the log; no other flag is known.
        let unknown = incompatible.iter().enumerate().any(|(index, &flags)| flags & !u8::from(index == 0) != 0);
        if unknown && !self.in_data {
            return Err(Halt::UnknownFlags(incompatible.to_vec()));
        }
        if incompatible.first().is_some_and(|flags| flags & 1 == 1) {
            let offsets = offsets.chunks_exact(8).filter_map(|bytes| bytes.first_chunk());
            self.appended = offsets.map(|bytes| u64::from_le_bytes(*bytes)).filter(|&offset| offset > 0).collect();
            self.appended.sort_unstable();
        }
        Ok(())
    }

    fn inform(&mut self, payload: &[u8], continued: bool) -> Result<(), Excess> {
        let Some((key, value)) = message::key_and_value(payload) else { return Ok(()) };
        let Some((type_name, name)) = key.split_once(' ') else { return Ok(()) };
        let value = value.get(..LONGEST_INFORMATION).unwrap_or(value);
        let text = match (type_name.starts_with("char["), format::kind(type_name)) {
            (true, _) => String::from_utf8_lossy(value).trim_end_matches('\0').to_owned(),
            (false, Some((Some(kind), _))) => Place { offset: 0, kind, scale: Scale::ONE }.read(value).to_string(),
            _ => return Ok(()),
        };
        let room = self.head.information.len() < MAX_TEXTS;
        match self.information.get(name).and_then(|&index| self.head.information.get_mut(index)) {
            Some((_, known)) if continued && known.len() < LONGEST_TEXT => *known += &text,
            Some(_) if continued => {}
            Some((_, known)) => *known = text,
            None if room => {
                self.account.take(many(2, name.len() + BYTES_PER_ENTRY / 2) + LONGEST_INFORMATION as u64)?;
                self.information.insert(name.to_owned(), self.head.information.len());
                self.head.information.push((name.to_owned(), text));
            }
            None => {}
        }
        Ok(())
    }

    fn parameter(&mut self, payload: &[u8]) -> Result<(), Excess> {
        let Some((key, value)) = message::key_and_value(payload) else { return Ok(()) };
        let Some((type_name, name)) = key.split_once(' ') else { return Ok(()) };
        let kind = if type_name == "float" { Kind::F32 } else { Kind::I32 };
        let value = Place { offset: 0, kind, scale: Scale::ONE }.read(value);
        match self.parameters.get(name).and_then(|&index| self.head.parameters.get_mut(index)) {
            Some((_, known)) if !self.in_data => *known = value,
            Some((_, known)) if *known == value => {}
            Some(_) => {
                self.change_count += 1;
                if self.changes.len() < MAX_SHOWN {
                    self.changes.push((self.last_us, name.to_owned(), value));
                }
            }
            None => {
                self.account.take(many(2, name.len() + BYTES_PER_ENTRY / 2))?;
                self.parameters.insert(name.to_owned(), self.head.parameters.len());
                self.head.parameters.push((name.to_owned(), value));
            }
        }
        Ok(())
    }

    fn announce(&mut self, payload: &[u8]) -> Result<(), Excess> {
        self.in_data = true;
        let Some((&[instance, low, high], name)) = payload.split_first_chunk() else { return Ok(()) };
        let (id, name) = (usize::from(u16::from_le_bytes([low, high])), String::from_utf8_lossy(name).into_owned());
        self.account.take(many(1, name.len() + BYTES_PER_ENTRY))?;
        let subscription = match self.definitions.formats.layout(&name, &self.account)? {
            Err(problem) => {
                self.leave_out(&name, &problem);
                None
            }
            Ok(layout) => {
                let state = match layout.timestamp {
                    Some(_) => State::Announced,
                    None => {
                        self.leave_out(&name, "it has no field 'timestamp' of type uint64_t");
                        State::Unwanted
                    }
                };
                let utc = layout.place("time_utc_usec");
                Some(Box::new(Subscription { name, instance: u16::from(instance), layout, state, utc }))
            }
        };
        if id >= self.definitions.topics.len() {
            self.definitions.topics.resize_with(id + 1, || None);
        }
        if let Some(topic) = self.definitions.topics.get_mut(id) {
            *topic = subscription;
        }
        Ok(())
    }

    fn leave_out(&mut self, name: &str, problem: &str) {
        if self.left_out.len() < MAX_TEXTS {
            self.left_out.insert(name.to_owned(), problem.to_owned());
        }
    }

    fn text(&mut self, payload: &[u8], stamp: usize, text: usize) {
        self.in_data = true;
        let time_s = Place { offset: stamp, kind: Kind::U64, scale: Scale::ONE }.read(payload);
        if self.head.messages.len() < MAX_TEXTS {
            let bytes = payload.get(text..).unwrap_or_default();
            let text =
                String::from_utf8_lossy(bytes.get(..LONGEST_TEXT).unwrap_or(bytes)).trim_end_matches('\0').to_owned();
            self.head.messages.push(Message { time_s, text });
        }
    }

    fn finish(mut self, source: &str) -> Result<Head, LogError> {
        let start_us = self.head.start_us.unwrap_or_default();
        let seconds = |time_us: f64| Short((time_us - start_us) * 1e-6);
        let quality: &mut QualityReport = &mut self.head.quality;
        self.skipped.report(quality);
        for (offset, bytes) in &self.cut {
            let place = format!("byte {offset}");
            quality.warn(place, format!("the log ends within a message; its {} are left out", plural(*bytes, "byte")));
        }
        if self.dropout_count > 0 {
            let shown: Vec<String> =
                self.dropouts.iter().map(|(time, ms)| format!("{ms} ms at {} s", seconds(*time))).collect();
            let more = if self.dropout_count > MAX_SHOWN { ", ..." } else { "" };
            quality.warn(
                "",
                format!(
                    "{}: the recorder could not keep up and lost {} ms of data ({}{more}); nothing is filled in",
                    plural(self.dropout_count, "dropout"),
                    self.dropout_ms,
                    shown.join(", ")
                ),
            );
        }
        if self.unannounced > 0 {
            quality.warn(
                "",
                format!("{} left out: what they are was never announced", plural(self.unannounced as usize, "sample")),
            );
        }
        for (name, problem) in &self.left_out {
            quality.warn(name.as_str(), format!("left out: {problem}"));
        }
        if self.change_count > 0 {
            let shown: Vec<String> = self
                .changes
                .iter()
                .map(|(time, name, value)| format!("{name} = {} at {} s", Short(*value), seconds(*time)))
                .collect();
            let more = if self.change_count > MAX_SHOWN { ", ..." } else { "" };
            let count = plural(self.change_count, "parameter");
            quality.note("", format!("{count} changed while the log ran: {}{more}", shown.join(", ")));
        }
        for (kind, count) in &self.unknown_kinds {
            quality.note("", format!("{count} messages of the unknown kind '{kind}' read past"));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::survey::Counts;
    use crate::memory::Memory;

    /// The state of the reader after these bytes.
    fn read(bytes: &[u8]) -> Reading {
        let account = Account::new(Memory::default());
        let mut reading = Reading::new(Head::default(), 0.0, &account);
        let mut sink = Counts::new(&account);
        assert!(reading.messages(&mut Window::new(bytes), "nonsense", &mut sink).is_ok());
        reading
    }

    /// However nonsense is made, each of its bytes is judged a few times at most: before, the last 65 kB of some kinds
    /// were searched from each of their bytes, and others from each of their messages.
    #[test]
    fn nonsense_is_searched_a_few_times_at_most() {
        let message = |kind: u8, payload: &[u8]| [&(payload.len() as u16).to_le_bytes()[..], &[kind], payload].concat();
        let sync = message(b'S', &[0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12]);
        let mut random = 1_u32;
        let mut noise = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 24) as u8
        };
        let kinds: [(&str, Vec<u8>); 6] = [
            ("definitions without a name", b"\x10\0F".repeat(100_000)),
            ("zeros", vec![0; 300_000]),
            ("noise", (0..300_000).map(|_| noise()).collect()),
            ("messages, each with a byte behind it", [&sync[..], b"\xff"].concat().repeat(25_000)),
            (
                "definitions, each with a byte behind it",
                (0..20_000)
                    .flat_map(|k| [message(b'F', format!("n{k}:float x;").as_bytes()), vec![0xFF]].concat())
                    .collect(),
            ),
            (
                "parameters, each with a byte behind it",
                [message(b'P', b"\x07float ab\0\0\0"), vec![0xFF]].concat().repeat(20_000),
            ),
        ];
        for (name, bytes) in kinds {
            let judged = read(&bytes).judged.get();
            // Twice as the window moves on; the last part a hundred times, where definitions change in it.
            let most = 4 * bytes.len() as u64 + 100 * LONGEST as u64;
            assert!(judged <= most, "{name}: {} positions judged of {} bytes", judged, bytes.len());
        }
    }
}
