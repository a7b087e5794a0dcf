//! Where the reader of a format puts the samples: into tables that keep them, or into a survey that only counts.

use std::collections::HashMap;

use super::decode::Scale;
use super::{Field, Log, LogError, Message, Selection, Topic};
use crate::memory::{Account, Excess, many};
use crate::quality::{Finding, QualityReport, Severity, Start};

/// Largest number of fields of one topic; further ones are left out with a warning.
const MAX_FIELDS: usize = 4096;
/// Largest number of fields of all topics together.
const MAX_FIELDS_IN_ALL: usize = 200_000;
/// Number of findings about definitions that are reported one by one.
const MAX_FINDINGS: usize = 50;
/// Largest number of topics, each instance counted.
const MAX_TOPICS: usize = 4096;

/// What a reader learns about a log apart from its samples.
#[derive(Clone, Debug, Default)]
pub(super) struct Head {
    pub(super) source: String,
    pub(super) information: Vec<(String, String)>,
    pub(super) parameters: Vec<(String, f64)>,
    /// Times in microseconds of the autopilot's clock.
    pub(super) messages: Vec<Message>,
    pub(super) quality: QualityReport,
    /// Time zero of the log, microseconds of the autopilot's clock, the same for every selection; `None` without
    /// samples.
    pub(super) start_us: Option<f64>,
    /// Offset from the autopilot's clock to seconds from 1970, UTC, if a satellite receiver gave the time.
    pub(super) utc_offset_s: Option<f64>,
    /// Number of findings about definitions, of which only the first are in the report.
    pub(super) findings: usize,
}

impl Head {
    /// Reports something about a definition, unless very much was reported already: a damaged log may hold millions of
    /// definitions.
    pub(super) fn find(&mut self, severity: Severity, place: impl Into<String>, message: impl Into<String>) {
        self.findings += 1;
        if self.findings <= MAX_FINDINGS {
            let (place, message) = (place.into(), message.into());
            self.quality.findings.push(Finding { severity, place, message });
        }
    }

    /// Converts the times of messages to seconds from the start of the log, and notes its date. Returns time zero,
    /// microseconds.
    pub(super) fn settle(&mut self) -> f64 {
        let start_us = self.start_us.unwrap_or_default();
        if self.findings > MAX_FINDINGS {
            let message = format!("{} findings about definitions; the first {MAX_FINDINGS} are listed", self.findings);
            self.quality.warn("", message);
        }
        for message in &mut self.messages {
            // A message before the first time stamp is put at the start.
            message.time_s = if message.time_s.is_nan() { 0.0 } else { (message.time_s - start_us) * 1e-6 };
        }
        // A conversion of a number that is negative or none gives zero.
        self.quality.clock_at_zero_us = Some(start_us as u64).filter(|clock_us| *clock_us > 0);
        if let Some(offset_s) = self.utc_offset_s {
            let unix_s = offset_s + start_us * 1e-6;
            let words = super::utc::information(unix_s);
            // A clock that was never set says 1970 or 1980, which is no date.
            self.quality.start = (!words.is_empty()).then_some(Start { unix_s, is_utc: true });
            self.information.extend(words);
        }
        start_us
    }
}

/// Describes how samples of one layout go into the columns of a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Stream {
    topic: usize,
    /// Indices, among the fields of the samples, of those that are kept.
    pub(super) kept: Vec<usize>,
    /// The column of the topic into which each of them goes.
    columns: Vec<usize>,
    in_order: bool,
    /// For a second sink that takes a part of the values: its stream, and the indices of its values among those kept
    /// here.
    selected: Option<Box<(Stream, Vec<usize>)>>,
}

/// Receives the samples of a log from the reader of a format.
pub(super) trait Sink {
    /// Announces samples of a topic with these fields; `None` if the sink needs none of them.
    fn open(&mut self, topic: &str, instance: u16, fields: &[String]) -> Option<Stream>;
    /// Receives one sample: the values of the fields in `stream.kept`, in this order.
    fn row(&mut self, stream: &Stream, time_us: f64, values: &[f64]) -> Result<(), Full>;
    /// Sets the unit of the field with index `kept` in `stream.kept`, and multiplies its values received so far by a
    /// factor.
    fn describe(&mut self, stream: &Stream, kept: usize, unit: Option<&str>, factor: Scale);
    /// Drops all samples received of a topic, and returns their number.
    fn forget(&mut self, stream: &Stream) -> usize;
}

/// Error of a sink: what it keeps needs more memory than the budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Full(pub(super) Excess);

/// What a column takes besides its values and twice its name, bytes.
const BYTES_PER_COLUMN: usize = 200;

/// The columns of every topic, which all kinds of sinks share.
#[derive(Debug)]
pub(super) struct Layout {
    account: Account,
    topics: HashMap<(String, u16), usize>,
    columns: Vec<HashMap<String, usize>>,
    fields: usize,
    left_out: Vec<(String, usize)>,
    topics_left_out: usize,
    /// What the names of fields that had no room in the budget would have needed.
    excess: Option<Excess>,
}

impl Layout {
    pub(super) fn new(account: &Account) -> Self {
        Self {
            account: account.clone(),
            topics: HashMap::new(),
            columns: Vec::new(),
            fields: 0,
            left_out: Vec::new(),
            topics_left_out: 0,
            excess: None,
        }
    }

    /// The stream for samples of a topic; columns are added for new fields. `wanted` selects the fields that are kept.
    fn stream(
        &mut self,
        topic: &str,
        instance: u16,
        fields: &[String],
        wanted: impl Fn(&str) -> bool,
    ) -> Option<Stream> {
        let (next, key) = (self.topics.len(), (topic.to_owned(), instance));
        let index = match self.topics.get(&key) {
            Some(&index) => index,
            None if next < MAX_TOPICS => {
                self.topics.insert(key, next);
                self.columns.push(HashMap::new());
                next
            }
            None => {
                self.topics_left_out += 1;
                return None;
            }
        };
        let mut stream = Stream { topic: index, kept: Vec::new(), columns: Vec::new(), in_order: true, selected: None };
        let columns = self.columns.get_mut(index)?;
        let mut left_out = 0;
        for (field, name) in fields.iter().enumerate().filter(|(_, name)| wanted(name)) {
            let next = columns.len();
            let column = match columns.get(name) {
                Some(&column) => column,
                None if next < MAX_FIELDS && self.fields < MAX_FIELDS_IN_ALL => {
                    // The name stands here and in the topic.
                    if let Err(excess) = self.account.take(many(2, name.len() + BYTES_PER_COLUMN / 2)) {
                        self.excess.get_or_insert(excess);
                        left_out += 1;
                        continue;
                    }
                    columns.insert(name.clone(), next);
                    self.fields += 1;
                    next
                }
                None => {
                    left_out += 1;
                    continue;
                }
            };
            // Of two fields with the same name the first is kept.
            if !stream.columns.contains(&column) {
                stream.kept.push(field);
                stream.columns.push(column);
            }
        }
        if left_out > 0 && self.left_out.len() < 100 {
            self.left_out.push((topic.to_owned(), left_out));
        }
        stream.in_order = stream.columns.iter().enumerate().all(|(index, &column)| index == column);
        Some(stream)
    }

    pub(super) fn report(&self, quality: &mut QualityReport) {
        for (topic, count) in &self.left_out {
            quality.warn(
                topic.as_str(),
                format!("{count} fields left out: a topic may have {MAX_FIELDS} fields, a log {MAX_FIELDS_IN_ALL}"),
            );
        }
        if self.excess.is_some() {
            quality.warn("", "fields left out: their names alone need more memory than the budget");
        }
        if self.topics_left_out > 0 {
            quality.warn("", format!("{} topics left out: a log may have {MAX_TOPICS}", self.topics_left_out));
        }
    }
}

/// A sink that keeps all selected values.
#[derive(Debug)]
pub(super) struct Tables<'s> {
    selection: &'s Selection,
    layout: Layout,
    topics: Vec<Table>,
    others: Vec<String>,
    account: Account,
    /// What the values kept so far take, bytes.
    taken: u64,
    /// Set when a new column had no room.
    full: Option<Full>,
}

#[derive(Debug, Default)]
struct Table {
    name: String,
    instance: u16,
    time_us: Vec<f64>,
    columns: Vec<Field>,
    /// True if its samples had several layouts, so that a sample may lack columns.
    mixed: bool,
}

impl<'s> Tables<'s> {
    pub(super) fn new(selection: &'s Selection, account: &Account) -> Self {
        Self {
            selection,
            layout: Layout::new(account),
            topics: Vec::new(),
            others: Vec::new(),
            account: account.clone(),
            taken: 0,
            full: None,
        }
    }

    /// Frees the memory of all samples.
    pub(super) fn clear(&mut self) {
        self.topics = Vec::new();
        self.account.give_back(std::mem::take(&mut self.taken));
    }

    fn take(&mut self, bytes: u64) -> Result<(), Full> {
        self.account.take(bytes).map_err(Full)?;
        self.taken += bytes;
        Ok(())
    }

    pub(super) fn finish(self, mut head: Head) -> Log {
        self.layout.report(&mut head.quality);
        let start_us = head.settle();
        let topics = self.topics.into_iter().filter(|table| !table.time_us.is_empty()).map(|table| {
            let time_s = table.time_us.iter().map(|time_us| (time_us - start_us) * 1e-6).collect();
            Topic { name: table.name, instance: table.instance, time_s, fields: table.columns }
        });
        Log {
            source: head.source,
            information: head.information,
            parameters: head.parameters,
            messages: head.messages,
            topics: topics.collect(),
            others: self.others,
            quality: head.quality,
        }
    }
}

impl Sink for Tables<'_> {
    fn open(&mut self, topic: &str, instance: u16, fields: &[String]) -> Option<Stream> {
        if !self.selection.has_topic(topic, instance) {
            if self.others.len() < MAX_TOPICS && !self.others.iter().any(|other| other == topic) {
                self.others.push(topic.to_owned());
            }
            return None;
        }
        let wanted = |field: &str| self.selection.has_field(topic, instance, field);
        let stream = self.layout.stream(topic, instance, fields, wanted)?;
        if let Some(excess) = self.layout.excess {
            self.full.get_or_insert(Full(excess));
        }
        if stream.topic == self.topics.len() {
            self.topics.push(Table { name: topic.to_owned(), instance, ..Table::default() });
        }
        let (rows, known) = self.topics.get(stream.topic).map(|table| (table.time_us.len(), table.columns.len()))?;
        let new = stream.columns.iter().filter(|&&column| column >= known).count();
        // The rows so far have no value of the new columns, but room for one.
        if let Err(full) = self.take(many(rows, 8 * new)) {
            self.full.get_or_insert(full);
            return Some(stream);
        }
        let table = self.topics.get_mut(stream.topic)?;
        for (&field, &column) in stream.kept.iter().zip(&stream.columns) {
            if column == table.columns.len() {
                let name = fields.get(field).cloned().unwrap_or_default();
                let values = vec![f64::NAN; table.time_us.len()];
                table.columns.push(Field { name, unit: None, values });
            }
        }
        table.mixed |= stream.columns.len() < table.columns.len() || !table.time_us.is_empty();
        Some(stream)
    }

    #[inline]
    fn row(&mut self, stream: &Stream, time_us: f64, values: &[f64]) -> Result<(), Full> {
        if let Some(full) = self.full {
            return Err(full);
        }
        let Some(table) = self.topics.get(stream.topic) else { return Ok(()) };
        let kept = if table.mixed { table.columns.len() } else { values.len() };
        self.take(many(1, 8 * (kept + 1)))?;
        let Some(table) = self.topics.get_mut(stream.topic) else { return Ok(()) };
        table.time_us.push(time_us);
        for (&column, &value) in stream.columns.iter().zip(values) {
            if let Some(column) = table.columns.get_mut(column) {
                column.values.push(value);
            }
        }
        if table.mixed {
            let rows = table.time_us.len();
            table.columns.iter_mut().for_each(|column| column.values.resize(rows, f64::NAN));
        }
        Ok(())
    }

    fn describe(&mut self, stream: &Stream, kept: usize, unit: Option<&str>, factor: Scale) {
        let Some(table) = self.topics.get_mut(stream.topic) else { return };
        let column = stream.columns.get(kept).and_then(|&column| table.columns.get_mut(column));
        if let Some(column) = column {
            column.unit = unit.map(str::to_owned);
            if factor != Scale::ONE {
                column.values.iter_mut().for_each(|value| *value = factor.apply(*value));
            }
        }
    }

    fn forget(&mut self, stream: &Stream) -> usize {
        let Some(table) = self.topics.get_mut(stream.topic) else { return 0 };
        let count = table.time_us.len();
        // Their memory is kept for the samples to come, and what they take is counted again with those.
        let taken = many(count, 8 * (table.columns.len() + 1)).min(self.taken);
        self.account.give_back(taken);
        self.taken -= taken;
        table.time_us.clear();
        table.columns.iter_mut().for_each(|column| column.values.clear());
        count
    }
}

/// Why the reader of a format stopped before the end of a log.
#[derive(Debug)]
pub(super) enum Stop {
    /// The sink is full.
    Full(Full),
    /// The log cannot be read.
    Log(LogError),
}

impl From<LogError> for Stop {
    fn from(error: LogError) -> Self {
        Stop::Log(error)
    }
}

impl From<Full> for Stop {
    fn from(full: Full) -> Self {
        Stop::Full(full)
    }
}

impl Stop {
    /// The error of a log of which not all that is asked for has room.
    pub(super) fn into_error(self, source: &str, account: &Account) -> LogError {
        match self {
            Stop::Log(error) => error,
            Stop::Full(Full(excess)) => account.over_so_far(excess, source, "").into(),
        }
    }
}

/// Makes a log of what the reader of a format gives; an error if that needs more memory than the account has.
pub(super) fn into_log<'s>(
    source: &str,
    selection: &'s Selection,
    account: &Account,
    run: impl FnOnce(&mut Tables<'s>) -> Result<Head, Stop>,
) -> Result<Log, LogError> {
    let mut tables = Tables::new(selection, account);
    match run(&mut tables) {
        Ok(head) => Ok(tables.finish(head)),
        Err(stop) => Err(stop.into_error(source, account)),
    }
}

/// The stream for all fields of a topic, as a survey needs it.
pub(super) fn open_all(layout: &mut Layout, topic: &str, instance: u16, fields: &[String]) -> Option<Stream> {
    layout.stream(topic, instance, fields, |_| true)
}

impl Stream {
    pub(super) fn topic(&self) -> usize {
        self.topic
    }

    /// True if the columns are 0, 1, 2, ..., so that a sample can be taken as it is.
    #[inline]
    pub(super) fn in_order(&self) -> bool {
        self.in_order
    }

    pub(super) fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// The same stream, of which a second sink takes a part of the values through `selected`.
    pub(super) fn with_selected(self, selected: Option<Stream>) -> Self {
        // A field that is not kept here (the topic has too many) is missing in the second sink.
        let place = |field: &usize| self.kept.iter().position(|own| own == field).unwrap_or(usize::MAX);
        let selected = selected.map(|stream| {
            let places = stream.kept.iter().map(place).collect();
            Box::new((stream, places))
        });
        Self { selected, ..self }
    }

    /// The stream of the second sink, and the indices of its values among those kept here.
    #[inline]
    pub(super) fn selected(&self) -> Option<(&Stream, &[usize])> {
        self.selected.as_deref().map(|(stream, places)| (stream, places.as_slice()))
    }
}
