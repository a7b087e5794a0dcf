//! From the text of a CSV file to a record.

use std::fs::File;
use std::io::{BufRead, BufReader, Chain, Cursor, Read};
use std::path::Path;

use super::cells::{self, Cell};
use super::format::{self, Format};
use super::{CsvOptions, ReadError};
use crate::channels;
use crate::columns::{self, ColumnUse, Head, Plan};
use crate::quality::{ChannelQuality, Lines, QualityReport, Short, plural};
use crate::record::{Channel, Quantity, Record};
use crate::time_base::{self, Table};
use crate::{plausibility, signals, units};

/// How much of the beginning is looked at to find the layout, bytes.
const SAMPLE: usize = 64 * 1024;
/// The most columns accepted.
const MOST_COLUMNS: usize = 5000;
/// The longest line accepted, bytes.
const LONGEST_LINE: usize = 1024 * 1024;

/// Reads a CSV file from the disk; otherwise as [`read`].
///
/// # Errors
/// As [`read`], with the path as the source's name.
pub fn read_path(path: &Path, options: &CsvOptions) -> Result<Record, ReadError> {
    let source_name = path.display().to_string();
    match File::open(path) {
        Ok(file) => read(file, &source_name, options),
        Err(error) => Err(ReadError::Io { source_name, error }),
    }
}

/// Reads CSV text into a record in SI units. `source` is its name in messages and reports.
///
/// Channels get their canonical names where the header (or a mapping) tells which they are, and keep their own name
/// otherwise. Rows keep the order of time: rows that go back in time are left out, rows of equal time merged, and a
/// record whose clock starts again ends there. Missing values are NaN. All of it is said in `record.quality`.
///
/// # Errors
/// [`ReadError`] if the file cannot be read, is no table of text, has no header, no time, two columns for one channel,
/// contradicting units, no usable row, or is larger than `options.max_values`; or if a mapping is wrong.
pub fn read(reader: impl Read, source: &str, options: &CsvOptions) -> Result<Record, ReadError> {
    check(options)?;
    let mut file = TextFile::open(reader, source, options.delimiter)?;
    let mut report = QualityReport::default();
    let (line, headers, carried) = file.header(&mut report)?;
    if headers.len() > MOST_COLUMNS {
        return Err(ReadError::TooManyColumns {
            source_name: source.to_owned(),
            line,
            columns: headers.len(),
            max_columns: MOST_COLUMNS,
        });
    }
    let (units, carried) = file.unit_row(&headers, carried)?;
    let head = Head { source, line, headers: &headers, units: units.as_deref() };
    let plan = columns::plan(&head, options, &mut report)?;
    let mut rows = Rows::new(plan, headers.len(), line, file.format);
    if let Some(row) = carried {
        rows.add(&row, &file, options)?;
    }
    while let Some(row) = file.next_row()? {
        rows.add(&row, &file, options)?;
    }
    rows.finish(source, options, report)
}

fn check(options: &CsvOptions) -> Result<(), ReadError> {
    if options.gap_factor.is_nan() || options.gap_factor <= 1.0 {
        let problem = format!("is {}; it counts median time steps and must be more than 1", options.gap_factor);
        return Err(ReadError::BadOption { option: "gap_factor", problem });
    }
    if let Some(step) = options.sample_time_s.filter(|step| !step.is_finite() || *step <= 0.0) {
        let problem = format!("is {step}; it must be a positive number of seconds");
        return Err(ReadError::BadOption { option: "sample_time_s", problem });
    }
    if let Some(mark) = options.delimiter.filter(|mark| ![',', ';', '\t', '|', ' '].contains(mark)) {
        let problem = format!("is {mark:?}; use one of ',' ';' tab '|' ' '");
        return Err(ReadError::BadOption { option: "delimiter", problem });
    }
    Ok(())
}

/// One line that is neither blank nor a comment.
struct Row {
    line: usize,
    text: String,
    /// Did it end with a line end?
    ended: bool,
}

/// The lines of a text file, with their numbers, in bounded memory.
struct TextFile<'s, R: Read> {
    source: &'s str,
    lines: BufReader<Chain<Cursor<Vec<u8>>, R>>,
    format: Format,
    line: usize,
    last_comment: Option<(usize, String)>,
}

impl<'s, R: Read> TextFile<'s, R> {
    fn open(mut reader: R, source: &'s str, delimiter: Option<char>) -> Result<Self, ReadError> {
        let io = |error| ReadError::Io { source_name: source.to_owned(), error };
        let mut sample = Vec::new();
        reader.by_ref().take(SAMPLE as u64).read_to_end(&mut sample).map_err(io)?;
        let complete = sample.len() < SAMPLE;
        format::refuse_binary(source, &sample)?;
        if sample.starts_with(&[0xEF, 0xBB, 0xBF]) {
            sample.drain(..3);
        }
        let format = format::sniff(&sample, complete, delimiter);
        let lines = BufReader::new(Cursor::new(sample).chain(reader));
        Ok(Self { source, lines, format, line: 0, last_comment: None })
    }

    fn next_row(&mut self) -> Result<Option<Row>, ReadError> {
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            let bound = LONGEST_LINE as u64 + 1;
            let read = (&mut self.lines).take(bound).read_until(self.format.line_end, &mut bytes);
            let read = read.map_err(|error| ReadError::Io { source_name: self.source.to_owned(), error })?;
            if read == 0 {
                return Ok(None);
            }
            self.line += 1;
            if read > LONGEST_LINE {
                return Err(ReadError::LineTooLong {
                    source_name: self.source.to_owned(),
                    line: self.line,
                    max_bytes: LONGEST_LINE,
                });
            }
            let ended = bytes.ends_with(&[self.format.line_end]);
            let text = format::decode(&bytes);
            let text = text.trim_end_matches(['\n', '\r']);
            if format::is_row(text) {
                return Ok(Some(Row { line: self.line, text: text.to_owned(), ended }));
            }
            if let Some(comment) = text.trim_start().strip_prefix('#') {
                self.last_comment = Some((self.line, comment.trim().to_owned()));
            }
        }
    }

    fn cells(&self, text: &str) -> Vec<String> {
        let mut scratch = ::csv::StringRecord::new();
        self.format.cells(text, &mut scratch).into_iter().map(str::to_owned).collect()
    }

    /// The header's line and cells, and a row that was read beyond it.
    fn header(&mut self, report: &mut QualityReport) -> Result<(usize, Vec<String>, Option<Row>), ReadError> {
        let first = self.next_row()?;
        let comment = self.last_comment.take();
        let Some(first) = first else { return Err(ReadError::Empty { source_name: self.source.to_owned() }) };
        let mut cells = self.cells(&first.text);
        let word = |cell: &String| {
            matches!(cells::parse(cell, self.format.decimal_comma), Cell::Text) && cells::clock(cell).is_none()
        };
        if cells.iter().any(word) {
            // Blank cells at the end of the header are the traces of a delimiter at the end of every line.
            while cells.last().is_some_and(|cell| cell.trim().is_empty()) {
                cells.pop();
            }
            return Ok((first.line, cells, None));
        }
        if let Some((line, text)) = comment {
            let names = self.cells(&text);
            let all_names = names.iter().all(|name| matches!(cells::parse(name, false), Cell::Text));
            if all_names && names.len() == cells.len() {
                report.note(format!("line {line}"), "the comment above the numbers is taken as the header");
                return Ok((line, names, Some(first)));
            }
        }
        Err(ReadError::NoHeader {
            source_name: self.source.to_owned(),
            line: first.line,
            found: columns::cut(&first.text, 60),
        })
    }

    /// A row of units below the header, if there is one, else the row that was read in looking for it.
    fn unit_row(
        &mut self,
        headers: &[String],
        carried: Option<Row>,
    ) -> Result<(Option<Vec<String>>, Option<Row>), ReadError> {
        if carried.is_some() {
            return Ok((None, carried));
        }
        let Some(row) = self.next_row()? else { return Ok((None, None)) };
        let cells = self.cells(&row.text);
        let filled: Vec<&String> = cells.iter().filter(|cell| !cell.trim().is_empty()).collect();
        let unit = |cell: &&&String| !units::find(cell.trim_matches(['[', ']', '(', ')'])).is_empty();
        let no_number = |cell: &&String| !matches!(cells::parse(cell, self.format.decimal_comma), Cell::Value(_));
        let is_unit_row = cells.len() <= headers.len()
            && filled.iter().all(no_number)
            && 2 * filled.iter().filter(unit).count() > filled.len();
        if !is_unit_row {
            return Ok((None, Some(row)));
        }
        let strip = |cell: String| cell.trim().trim_matches(['[', ']', '(', ')']).to_owned();
        Ok((Some(cells.into_iter().map(strip).collect()), None))
    }
}

/// The rows read so far and what was wrong with the others.
struct Rows {
    plan: Plan,
    fields: usize,
    header_line: usize,
    format: Format,
    table: Table,
    seen: usize,
    too_short: Lines,
    too_long: Lines,
    blank_at_end: Lines,
    no_time: Lines,
    cut: Option<usize>,
    unended: Option<usize>,
    /// Cells per channel that are text, and the first of them.
    text: Vec<(Lines, String)>,
    clock: bool,
    midnights: f64,
}

impl Rows {
    fn new(plan: Plan, fields: usize, header_line: usize, format: Format) -> Self {
        let count = plan.channels.len();
        Self {
            plan,
            fields,
            header_line,
            format,
            table: Table { time: Vec::new(), lines: Vec::new(), columns: vec![Vec::new(); count] },
            seen: 0,
            too_short: Lines::default(),
            too_long: Lines::default(),
            blank_at_end: Lines::default(),
            no_time: Lines::default(),
            cut: None,
            unended: None,
            text: vec![(Lines::default(), String::new()); count],
            clock: false,
            midnights: 0.0,
        }
    }

    fn add<R: Read>(&mut self, row: &Row, file: &TextFile<'_, R>, options: &CsvOptions) -> Result<(), ReadError> {
        let row_index = self.seen;
        self.seen += 1;
        let mut scratch = ::csv::StringRecord::new();
        let cells = self.format.cells(&row.text, &mut scratch);
        if cells.len() < self.fields {
            match row.ended {
                true => self.too_short.add(row.line),
                false => self.cut = Some(row.line),
            }
            return Ok(());
        }
        if cells.len() > self.fields {
            if cells.iter().skip(self.fields).any(|cell| !cell.trim().is_empty()) {
                self.too_long.add(row.line);
                return Ok(());
            }
            self.blank_at_end.add(row.line);
        }
        if !row.ended {
            self.unended = Some(row.line);
        }
        let Some(time) = self.time(&cells, row_index, options) else {
            self.no_time.add(row.line);
            return Ok(());
        };
        // Two more per row: its time and its line.
        if (self.table.time.len() + 1).saturating_mul(self.table.columns.len() + 2) > options.max_values {
            return Err(ReadError::TooLarge {
                source_name: file.source.to_owned(),
                line: row.line,
                max_values: options.max_values,
            });
        }
        self.table.time.push(time);
        self.table.lines.push(row.line);
        for ((channel, values), text) in self.plan.channels.iter().zip(&mut self.table.columns).zip(&mut self.text) {
            let cell = cells.get(channel.column).copied().unwrap_or_default();
            let value = match cells::parse(cell, self.format.decimal_comma) {
                Cell::Value(value) => channel.to_si(value),
                Cell::Missing => f64::NAN,
                Cell::Text => {
                    if text.0.count() == 0 {
                        text.1 = columns::cut(cell, 20);
                    }
                    text.0.add(row.line);
                    f64::NAN
                }
            };
            // A finite number may overflow in the conversion.
            let value = if value.is_finite() { value } else { f64::NAN };
            values.push(value);
        }
        Ok(())
    }

    fn time(&mut self, cells: &[&str], row_index: usize, options: &CsvOptions) -> Option<f64> {
        if let Some(step) = options.sample_time_s {
            return Some(step * row_index as f64).filter(|time| time.is_finite());
        }
        let column = self.plan.time.as_ref()?;
        let cell = cells.get(column.column).copied().unwrap_or_default();
        if let Cell::Value(value) = cells::parse(cell, self.format.decimal_comma) {
            return Some(column.to_si(value)).filter(|time| time.is_finite());
        }
        let (seconds, dated) = cells::clock(cell)?;
        self.clock = true;
        // Without a date the clock starts again at midnight.
        const DAY: f64 = 86_400.0;
        if !dated && self.table.time.last().is_some_and(|last| seconds + self.midnights * DAY < last - 0.5 * DAY) {
            self.midnights += 1.0;
        }
        Some(seconds + if dated { 0.0 } else { self.midnights * DAY })
    }

    fn finish(self, source: &str, options: &CsvOptions, mut report: QualityReport) -> Result<Record, ReadError> {
        let no_rows =
            |reason: String| ReadError::NoRows { source_name: source.to_owned(), line: self.header_line, reason };
        if self.table.time.is_empty() {
            return Err(no_rows(self.why_no_rows()));
        }
        self.report_rows(&mut report);
        let Self { plan, mut table, text, seen, header_line, .. } = self;
        let time_header = plan.time.as_ref().map_or("(row number)", |column| column.header.as_str()).to_owned();
        if let Some(column) = plan.time.as_ref().filter(|column| column.unit_assumed && !self.clock) {
            columns::say_assumed(column, &mut report);
        }
        time_base::put_in_order(&mut table, source, &time_header, &mut report)?;
        if table.time.len() < 2 {
            let reason = "only one time is left; a record needs at least two".to_owned();
            return Err(ReadError::NoRows { source_name: source.to_owned(), line: header_line, reason });
        }
        let mut record = Record { source: source.to_owned(), time: table.time, ..Record::default() };
        report.rows_read = seen;
        report.rows_kept = record.time.len();
        report.sample_time_s = record.sample_time_s();
        time_base::report_steps(&record.time, report.sample_time_s, options.gap_factor, &mut report);

        report.channels.push(match &plan.time {
            Some(column) => quality_of(column, 0),
            None => ChannelQuality {
                name: "time".into(),
                header: String::new(),
                unit: "s".into(),
                scale: 1.0,
                ..ChannelQuality::default()
            },
        });
        let mut holes = Vec::new();
        for ((column, values), (text, example)) in plan.channels.into_iter().zip(table.columns).zip(text) {
            if let Some(channel) = keep(&column, values, &text, &example, &mut holes, &mut report) {
                report.channels.push(quality_of(&column, channel.values.iter().filter(|value| value.is_nan()).count()));
                record.channels.push(channel);
            }
        }
        if !holes.is_empty() {
            report.note(
                "",
                format!("values missing in {} rows: {}; nothing is filled in", report.rows_kept, holes.join(", ")),
            );
        }
        record.quality = report;
        signals::check(&mut record);
        plausibility::check(&mut record);
        Ok(record)
    }

    fn why_no_rows(&self) -> String {
        let (short, long, untimed) = (self.too_short.count(), self.too_long.count(), self.no_time.count());
        if let (Some(line), 0, 0, 0) = (self.cut, short, long, untimed) {
            return format!("the only row, line {line}, is cut off before its end");
        }
        if short == 0 && long == 0 && untimed == 0 {
            return "there is none".into();
        }
        let mut reasons = Vec::new();
        if short > 0 {
            let rows = plural(short, "row");
            reasons.push(format!("{rows} with fewer than {} cells ({})", self.fields, self.too_short.place()));
        }
        if long > 0 {
            let rows = plural(long, "row");
            reasons.push(format!(
                "{rows} with more than {} cells ({}; are there commas in the numbers? then separate the cells by \
                 semicolons)",
                self.fields,
                self.too_long.place()
            ));
        }
        if untimed > 0 {
            reasons.push(format!("{} without a time ({})", plural(untimed, "row"), self.no_time.place()));
        }
        reasons.join("; ")
    }

    fn report_rows(&self, report: &mut QualityReport) {
        let fields = self.fields;
        if self.too_short.count() > 0 {
            let rows = plural(self.too_short.count(), "row");
            report.warn(
                self.too_short.place(),
                format!(
                    "{rows} left out: fewer than the header's {fields} cells, so that it is not known which is missing"
                ),
            );
        }
        if self.too_long.count() > 0 {
            let rows = plural(self.too_long.count(), "row");
            report.warn(self.too_long.place(), format!("{rows} left out: more than the header's {fields} cells"));
        }
        if self.blank_at_end.count() > 0 {
            report.note(self.blank_at_end.place(), "blank cells beyond the header's last column ignored");
        }
        if self.no_time.count() > 0 {
            let rows = plural(self.no_time.count(), "row");
            report.warn(self.no_time.place(), format!("{rows} left out: no time, or one that is no number"));
        }
        if let Some(line) = self.cut {
            report.warn(
                format!("line {line}"),
                "the file ends in the middle of this row, which is left out; the file was probably cut off: if rows are \
                 missing, copy it again",
            );
        }
        if let Some(line) = self.unended {
            report.note(
                format!("line {line}"),
                "the last row has no line end; it is kept, but if the file was cut off there its last number may be short",
            );
        }
        if self.clock {
            report.note("time", "given as a clock; counted in seconds from midnight (from 1970 where there is a date)");
        }
        if self.midnights > 0.0 {
            report.note("time", format!("the clock passes midnight {} times; counted on", Short(self.midnights)));
        }
    }
}

fn quality_of(column: &ColumnUse, missing: usize) -> ChannelQuality {
    ChannelQuality {
        name: column.name.clone(),
        header: column.header.clone(),
        unit: column.unit.symbol.to_owned(),
        unit_assumed: column.unit_assumed,
        scale: column.scale,
        missing,
        spikes: 0,
    }
}

/// The channel of a column, with a word on what is missing in it (a few missing values go to `holes`); none for columns
/// of text.
fn keep(
    column: &ColumnUse,
    values: Vec<f64>,
    text: &Lines,
    example: &str,
    holes: &mut Vec<String>,
    report: &mut QualityReport,
) -> Option<Channel> {
    let place = format!("column '{}'", column.header);
    let known = channels::by_name(&column.name).is_some();
    let missing = values.iter().filter(|value| value.is_nan()).count();
    let any = missing < values.len();
    if !any && !known {
        match (text.count(), column.header.is_empty()) {
            (0, true) => {}
            (0, false) => report.note(place, "left out: it has no values"),
            _ => report.note(place, format!("left out: it holds text such as '{example}', not numbers")),
        }
        return None;
    }
    if text.count() > 0 {
        let cells = plural(text.count(), "cell");
        let message = format!("{cells} of {} no number, such as '{example}'; taken as missing", column.name);
        report.warn(text.place(), message);
    }
    if !any {
        report.warn(place, format!("{} has no value at all", column.name));
    } else if missing > 0 {
        let percent = 100.0 * missing as f64 / values.len() as f64;
        match percent > 10.0 {
            true => report.warn(
                place,
                format!(
                    "{missing} of {} values of {} missing ({} %); kept as missing, nothing is filled in",
                    values.len(),
                    column.name,
                    Short(percent)
                ),
            ),
            false => holes.push(format!("{missing} in {}", column.name)),
        }
    }
    let quantity: Quantity = column.unit.quantity;
    Some(Channel { name: column.name.clone(), quantity, values })
}
