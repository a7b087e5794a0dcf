//! Reads the records of a file: channels and their messages.

use std::collections::{BTreeMap, HashMap};
use std::io::{self, BufReader, Read};

use ::mcap::parse_record;
use ::mcap::records::{MessageHeader, Record, op};

use super::chunk::{self, LONGEST};
use super::flatten::flatten;
use crate::format::MCAP_MAGIC as MAGIC;
use crate::log::LogError;
use crate::log::sink::{Full, Head, Sink, Stream};
use crate::quality::QualityReport;
use crate::wording::cut;
use crate::wording::plural;

/// The longest message that is read, bytes: the parsed document needs many times the memory of its text.
const LONGEST_MESSAGE: usize = 4 << 20;
/// Number of damaged chunks that are reported one by one.
const MAX_FINDINGS: usize = 10;

/// Reads a file into a sink; `None` if the sink is full.
pub(in crate::log) fn run(reader: impl Read, source: &str, sink: &mut dyn Sink) -> Result<Option<Head>, LogError> {
    let io = |error| LogError::Io { source_name: source.to_owned(), error };
    let mut reader = BufReader::with_capacity(1 << 16, reader);
    let mut start = [0; MAGIC.len()];
    let found = take(&mut reader, &mut start).map_err(io)?;
    if found < MAGIC.len() || start != MAGIC {
        let problem = "it does not begin with its eight bytes".to_owned();
        return Err(LogError::NotThisFormat { source_name: source.to_owned(), format: "MCAP file", problem });
    }
    let mut state = State::new(sink, source);
    let mut offset = MAGIC.len() as u64;
    let mut damaged = 0;
    loop {
        let mut tag = [0; 9];
        let found = take(&mut reader, &mut tag).map_err(io)?;
        let [opcode, length @ ..] = tag;
        if found < tag.len() || opcode == op::FOOTER {
            if opcode != op::FOOTER || found < tag.len() {
                state.head.quality.warn(
                    format!("byte {offset}"),
                    "the file ends here without its footer: it was cut off, or the recorder was; what is before is read",
                );
            }
            break;
        }
        let length = u64::from_le_bytes(length);
        let kept =
            matches!(opcode, op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK) && length <= LONGEST;
        let mut record = Vec::new();
        let mut body = reader.by_ref().take(length);
        let read = match kept {
            true => body.read_to_end(&mut record).map(|read| read as u64),
            false => io::copy(&mut body, &mut io::sink()),
        };
        if read.map_err(io)? < length {
            let place = format!("byte {offset}");
            let message =
                format!("the file ends in this record of {length} bytes, which is left out; what is before is read");
            state.head.quality.warn(place, message);
            break;
        }
        let result = match opcode {
            op::CHUNK | op::MESSAGE if !kept => {
                Err(format!("{length} bytes, more than the {LONGEST} of a chunk or message that are read"))
            }
            op::CHUNK => chunk::each_record(&record, |opcode, data| state.record(opcode, data).is_ok()),
            _ => {
                // If the sink is full, `state.full` is set and is checked below.
                let _ = state.record(opcode, &record);
                Ok(())
            }
        };
        if state.full {
            return Ok(None);
        }
        if let Err(problem) = result {
            damaged += 1;
            if damaged <= MAX_FINDINGS {
                let message = format!("the record that begins here is left out, it is damaged: {}", cut(&problem, 200));
                state.head.quality.warn(format!("byte {offset}"), message);
            }
        }
        offset = offset.saturating_add(9).saturating_add(length);
    }
    if damaged > MAX_FINDINGS {
        state.head.quality.warn("", format!("{damaged} damaged records in all; the first {MAX_FINDINGS} are listed"));
    }
    state.finish(source).map(Some)
}

/// Reads until `target` is full or the file ends, and returns the number of bytes read.
fn take(reader: &mut impl Read, target: &mut [u8]) -> io::Result<usize> {
    let mut read = 0;
    while let Some(room) = target.get_mut(read..).filter(|room| !room.is_empty()) {
        match reader.read(room) {
            Ok(0) => break,
            Ok(bytes) => read += bytes,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(read)
}

struct State<'s> {
    sink: &'s mut dyn Sink,
    head: Head,
    schemas: HashMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    /// Log time of the first message, ns. Times are counted from it, because nanoseconds since 1970 have more digits
    /// than a double.
    start_ns: Option<u64>,
    messages: u64,
    unreadable: u64,
    orphans: u64,
    full: bool,
    names: Vec<String>,
    values: Vec<f64>,
    row: Vec<f64>,
}

struct Channel {
    topic: String,
    instance: u16,
    encoding: String,
    schema: String,
    /// Number of messages left out because they are not JSON.
    skipped: u64,
    wanted: Option<bool>,
    /// Names of the fields of the last message, and where its values go.
    layout: Option<(Vec<String>, Stream)>,
}

impl<'s> State<'s> {
    fn new(sink: &'s mut dyn Sink, source: &str) -> Self {
        Self {
            sink,
            head: Head { source: source.to_owned(), ..Head::default() },
            schemas: HashMap::new(),
            channels: BTreeMap::new(),
            start_ns: None,
            messages: 0,
            unreadable: 0,
            orphans: 0,
            full: false,
            names: Vec::new(),
            values: Vec::new(),
            row: Vec::new(),
        }
    }

    fn record(&mut self, opcode: u8, data: &[u8]) -> Result<(), Full> {
        if !matches!(opcode, op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            return Ok(());
        }
        match parse_record(opcode, data) {
            Ok(Record::Header(header)) => {
                let information = [("profile", header.profile), ("library", header.library)];
                let said = information.into_iter().filter(|(_, value)| !value.is_empty());
                self.head.information.extend(said.map(|(name, value)| (name.to_owned(), cut(&value, 200))));
            }
            Ok(Record::Schema { header, .. }) => {
                self.schemas.insert(header.id, cut(&header.name, 200));
            }
            Ok(Record::Channel(channel)) => self.channel(channel),
            Ok(Record::Message { header, data }) => return self.message(&header, &data),
            Ok(_) => {}
            Err(_) => self.unreadable += 1,
        }
        Ok(())
    }

    fn channel(&mut self, channel: ::mcap::records::Channel) {
        // Every chunk and the summary repeat the definitions of channels.
        if self.channels.contains_key(&channel.id) {
            return;
        }
        let topic = cut(&channel.topic, 400);
        let instance = self.channels.values().filter(|other| other.topic == topic).count();
        let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
        let encoding = cut(&channel.message_encoding, 40);
        let instance = u16::try_from(instance).unwrap_or(u16::MAX);
        let channel_id = channel.id;
        let channel = Channel { topic, instance, encoding, schema, skipped: 0, wanted: None, layout: None };
        self.channels.insert(channel_id, channel);
    }

    fn message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), Full> {
        let start_ns = *self.start_ns.get_or_insert(header.log_time);
        let Some(channel) = self.channels.get_mut(&header.channel_id) else {
            self.orphans += 1;
            return Ok(());
        };
        if !channel.encoding.eq_ignore_ascii_case("json") {
            channel.skipped += 1;
            return Ok(());
        }
        let wanted = match channel.wanted {
            Some(wanted) => wanted,
            None => *channel.wanted.insert(self.sink.open(&channel.topic, channel.instance, &[]).is_some()),
        };
        self.messages += 1;
        if !wanted {
            return Ok(());
        }
        let text = Some(data).filter(|text| text.len() <= LONGEST_MESSAGE);
        let Some(document) = text.and_then(|text| serde_json::from_slice(text).ok()) else {
            self.unreadable += 1;
            return Ok(());
        };
        flatten(&document, &mut self.names, &mut self.values);
        if channel.layout.as_ref().is_none_or(|(names, _)| *names != self.names) {
            let stream = self.sink.open(&channel.topic, channel.instance, &self.names);
            channel.layout = stream.map(|stream| (self.names.clone(), stream));
        }
        let Some((_, stream)) = &channel.layout else { return Ok(()) };
        self.row.clear();
        self.row.extend(stream.kept.iter().map(|&field| self.values.get(field).copied().unwrap_or(f64::NAN)));
        // Messages may be in any order, so that the difference can be negative.
        let time_us = (i128::from(header.log_time) - i128::from(start_ns)) as f64 / 1e3;
        let result = self.sink.row(stream, time_us, &self.row);
        self.full |= result.is_err();
        result
    }

    fn finish(mut self, source: &str) -> Result<Head, LogError> {
        let mut other: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for channel in self.channels.values().filter(|channel| channel.skipped > 0) {
            let schema = if channel.schema.is_empty() { String::new() } else { format!(" {}", channel.schema) };
            let counted = plural(usize::try_from(channel.skipped).unwrap_or(usize::MAX), "message");
            other.entry(&channel.encoding).or_default().push(format!("{}{schema} ({counted})", channel.topic));
        }
        let mut said: Vec<String> = other.iter().map(|(encoding, topics)| left_out(encoding, topics)).collect();
        if self.messages == 0 {
            if let Some(finding) = self.head.quality.findings.first() {
                said.push(format!("{}: {}", finding.place, finding.message));
            }
            let reason = if said.is_empty() { String::new() } else { format!(": {}", said.join("; ")) };
            return Err(LogError::NoData { source_name: source.to_owned(), reason });
        }
        let quality: &mut QualityReport = &mut self.head.quality;
        said.into_iter().for_each(|said| quality.warn("", said));
        for (count, what) in [
            (self.unreadable, "left out: their content is not what their encoding says, or longer than 4 MiB"),
            (self.orphans, "left out: it is not said which topic they belong to"),
        ] {
            if count > 0 {
                let count = plural(usize::try_from(count).unwrap_or(usize::MAX), "message");
                quality.warn("", format!("{count} {what}"));
            }
        }
        // Times are counted from the first message already.
        self.head.start_us = Some(0.0);
        // A recorder without a clock counts from its start; such times are no dates and are left out later.
        self.head.utc_offset_s = self.start_ns.map(|start_ns| start_ns as f64 * 1e-9);
        Ok(self.head)
    }
}

/// The message about topics that were left out because of their encoding, with advice.
fn left_out(encoding: &str, topics: &[String]) -> String {
    const MAX_SHOWN: usize = 8;
    let shown = topics.iter().take(MAX_SHOWN).cloned().collect::<Vec<_>>().join(", ");
    let more = topics.len().saturating_sub(MAX_SHOWN);
    let more = if more > 0 { format!(", and {more} more") } else { String::new() };
    let package = match encoding {
        "cdr" | "ros1" => "; for instance with the Python packages mcap-ros2-support or mcap-ros1-support",
        "protobuf" => "; for instance with the Python package mcap-protobuf-support",
        _ => "",
    };
    format!(
        "left out, since only JSON is read and these are in '{encoding}': {shown}{more}. Write the signals that you need as \
         JSON messages, CSV or Parquet{package}"
    )
}
