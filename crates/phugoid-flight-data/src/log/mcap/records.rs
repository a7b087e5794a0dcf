//! Reads the records of a file: channels and their messages.

use std::collections::{BTreeMap, HashMap};
use std::io::{self, BufReader, Read};

use ::mcap::records::op;

use super::chunk::{self, LONGEST};
use super::content::{self, Content};
use super::flatten::{LONGEST_NAME, flatten};
use crate::format::MCAP_MAGIC as MAGIC;
use crate::log::LogError;
use crate::log::sink::{Full, Head, Sink, Stop, Stream};
use crate::memory::{Account, many};
use crate::quality::QualityReport;
use crate::wording::cut;
use crate::wording::plural;

/// The longest message that is read, bytes: the parsed document needs many times the memory of its text.
const LONGEST_MESSAGE: usize = 4 << 20;
/// What a channel or a schema takes besides its texts, bytes.
const BYTES_PER_ENTRY: usize = 200;
/// What the name of a field and its place take besides the text, bytes.
const BYTES_PER_NAME: usize = 64;
/// Number of damaged chunks that are reported one by one.
const MAX_FINDINGS: usize = 10;

/// Reads a file into a sink. What it defines, and the chunk that is being unpacked, are counted in the account.
pub(in crate::log) fn run(
    reader: impl Read,
    source: &str,
    sink: &mut dyn Sink,
    account: &Account,
) -> Result<Head, Stop> {
    let io = |error| LogError::Io { source_name: source.to_owned(), error };
    let mut reader = BufReader::with_capacity(1 << 16, reader);
    let mut start = [0; MAGIC.len()];
    let found = take(&mut reader, &mut start).map_err(io)?;
    if found < MAGIC.len() || start != MAGIC {
        let problem = "it does not begin with its eight bytes".to_owned();
        let source_name = source.to_owned();
        return Err(LogError::NotThisFormat { source_name, format: "MCAP file", problem }.into());
    }
    let mut state = State::new(sink, source, account);
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
        let over = |excess| Stop::Log(account.over(excess, source, format!("byte {offset}")).into());
        let mut record = Vec::new();
        let mut body = reader.by_ref().take(length);
        // A record that cannot end within the file is not read at all: its length is wrong.
        let there = !account.file_is_shorter_than(offset.saturating_add(9).saturating_add(length));
        let held = if kept && there { length } else { 0 };
        let _held = account.hold(held).map_err(over)?;
        let read = match (kept, there) {
            (_, false) => Ok(0),
            (true, _) => body.read_to_end(&mut record).map(|read| read as u64),
            (false, _) => io::copy(&mut body, &mut io::sink()),
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
            op::CHUNK => match chunk::check(&record) {
                Ok(needed) => {
                    let _held = account.hold(needed).map_err(over)?;
                    chunk::each_record(&record, |opcode, data| state.record(opcode, data).is_ok())
                }
                Err(problem) => Err(problem),
            },
            _ => {
                // If there is no room, `state.full` is set and is checked below.
                let _ = state.record(opcode, &record);
                Ok(())
            }
        };
        if let Some(full) = state.full {
            return Err(full.into());
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
    Ok(state.finish(source)?)
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
    account: Account,
    head: Head,
    schemas: HashMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    /// Number of channels of each topic.
    instances: HashMap<String, u16>,
    /// Log time of the first message, ns. Times are counted from it, because nanoseconds since 1970 have more digits
    /// than a double.
    start_ns: Option<u64>,
    messages: u64,
    unreadable: u64,
    orphans: u64,
    /// Number of values left out because the paths that name them are too long.
    unnamed: u64,
    full: Option<Full>,
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
    fn new(sink: &'s mut dyn Sink, source: &str, account: &Account) -> Self {
        Self {
            sink,
            account: account.clone(),
            instances: HashMap::new(),
            head: Head { source: source.to_owned(), ..Head::default() },
            schemas: HashMap::new(),
            channels: BTreeMap::new(),
            start_ns: None,
            messages: 0,
            unreadable: 0,
            orphans: 0,
            unnamed: 0,
            full: None,
            names: Vec::new(),
            values: Vec::new(),
            row: Vec::new(),
        }
    }

    /// Takes a record. If there is no room for what it says, `full` is set, and the error ends the reading.
    fn record(&mut self, opcode: u8, data: &[u8]) -> Result<(), Full> {
        let content = Content(data);
        let understood = match opcode {
            op::HEADER => content.header().map(|header| {
                // One header is enough; a damaged file may have many.
                let said = header.into_iter().filter(|(_, value)| !value.is_empty());
                if self.head.information.is_empty() {
                    self.head.information.extend(said.map(|(name, value)| (name.to_owned(), cut(value, 200))));
                }
                Ok(())
            }),
            op::SCHEMA => content.schema().map(|(id, name)| self.schema(id, name)),
            op::CHANNEL => content.channel().map(|channel| self.channel(&channel)),
            op::MESSAGE => content.message().map(|message| self.message(&message)),
            _ => return Ok(()),
        };
        match understood {
            Some(Err(full)) => {
                self.full.get_or_insert(full);
                Err(full)
            }
            Some(Ok(())) => Ok(()),
            None => {
                self.unreadable += 1;
                Ok(())
            }
        }
    }

    fn schema(&mut self, id: u16, name: &str) -> Result<(), Full> {
        let name = cut(name, 200);
        if !self.schemas.contains_key(&id) {
            self.account.take(many(1, name.len() + BYTES_PER_ENTRY)).map_err(Full)?;
        }
        self.schemas.insert(id, name);
        Ok(())
    }

    fn channel(&mut self, channel: &content::Channel<'_>) -> Result<(), Full> {
        // Every chunk and the summary repeat the definitions of channels.
        if self.channels.contains_key(&channel.id) {
            return Ok(());
        }
        let topic = cut(channel.topic, 400);
        let schema = self.schemas.get(&channel.schema).cloned().unwrap_or_default();
        let encoding = cut(channel.encoding, 40);
        let texts = 2 * topic.len() + schema.len() + encoding.len();
        self.account.take(many(1, texts + 2 * BYTES_PER_ENTRY)).map_err(Full)?;
        let count = self.instances.entry(topic.clone()).or_default();
        let instance = *count;
        *count = count.saturating_add(1);
        let new = Channel { topic, instance, encoding, schema, skipped: 0, wanted: None, layout: None };
        self.channels.insert(channel.id, new);
        Ok(())
    }

    fn message(&mut self, message: &content::Message<'_>) -> Result<(), Full> {
        let start_ns = *self.start_ns.get_or_insert(message.log_time);
        let Some(channel) = self.channels.get_mut(&message.channel) else {
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
        let text = Some(message.data).filter(|text| text.len() <= LONGEST_MESSAGE);
        let Some(unnamed) = text.and_then(|text| flatten(text, &mut self.names, &mut self.values)) else {
            self.unreadable += 1;
            return Ok(());
        };
        self.unnamed += unnamed;
        if channel.layout.as_ref().is_none_or(|(names, _)| *names != self.names) {
            let needs = |names: &[String]| names.iter().map(|name| many(1, name.len() + BYTES_PER_NAME)).sum::<u64>();
            if let Some((names, _)) = channel.layout.take() {
                self.account.give_back(needs(&names));
            }
            self.account.take(needs(&self.names)).map_err(Full)?;
            let stream = self.sink.open(&channel.topic, channel.instance, &self.names);
            channel.layout = stream.map(|stream| (self.names.clone(), stream));
        }
        let Some((_, stream)) = &channel.layout else { return Ok(()) };
        self.row.clear();
        self.row.extend(stream.kept.iter().map(|&field| self.values.get(field).copied().unwrap_or(f64::NAN)));
        // Messages may be in any order, so that the difference can be negative.
        let time_us = (i128::from(message.log_time) - i128::from(start_ns)) as f64 / 1e3;
        self.sink.row(stream, time_us, &self.row)
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
        if self.unnamed > 0 {
            let count = plural(usize::try_from(self.unnamed).unwrap_or(usize::MAX), "value");
            let message = format!("{count} left out: the names of their fields are longer than {LONGEST_NAME} bytes");
            quality.warn("", message);
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
