//! Lines of text, one sample each: JSON objects, or rows of CSV below a header line.

use std::collections::HashMap;

use phugoid_flight_data::csv::{BadRow, CsvOptions, RowReader, StreamColumns};
use serde_json::Value;

/// Longest line that is accepted, bytes.
const LONGEST_LINE: usize = 64 * 1024;
/// Different keys of JSON objects that are kept; further ones are ignored.
const MOST_KEYS: usize = 512;

/// Cuts pieces of a stream into lines.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    buffer: Vec<u8>,
}

impl Lines {
    /// Adds bytes and returns the lines that are complete now, without their ends and without blank lines. With `ends`
    /// the last byte ends a line too, as in a datagram. The second value is the number of bytes that were dropped
    /// because a line was longer than 64 KiB.
    pub(crate) fn push(&mut self, bytes: &[u8], ends: bool) -> (Vec<Vec<u8>>, usize) {
        let mut lines = Vec::new();
        self.buffer.extend_from_slice(bytes);
        let mut rest = self.buffer.as_slice();
        while let Some(end) = rest.iter().position(|byte| [b'\n', b'\r'].contains(byte)) {
            let (line, after) = rest.split_at(end);
            lines.push(line.to_vec());
            rest = after.get(1..).unwrap_or_default();
        }
        if ends && !rest.is_empty() {
            lines.push(rest.to_vec());
            rest = &[];
        }
        let dropped = if rest.len() > LONGEST_LINE { rest.len() } else { 0 };
        self.buffer = if dropped > 0 { Vec::new() } else { rest.to_vec() };
        lines.retain(|line| !line.iter().all(u8::is_ascii_whitespace));
        (lines, dropped)
    }
}

/// What was found in a line.
#[derive(Debug, PartialEq)]
pub(crate) enum Row {
    /// A sample with this time, s. Its values are in the caller's buffer, one for each of [`Rows::columns`].
    Sample(f64),
    /// A comment, or the header line once more.
    Nothing,
    /// New columns: notes for people about them.
    Columns(Vec<String>),
    /// The line was left out, for this reason.
    Refused(String),
}

/// Reads the lines of one stream.
pub(crate) struct Rows {
    source: String,
    options: CsvOptions,
    form: Form,
}

enum Form {
    Unknown,
    Csv { header: String, reader: Box<RowReader>, rows: u8 },
    Json(Box<Objects>),
}

/// The columns of JSON objects. Objects of one stream need not all have the same keys.
#[derive(Default)]
struct Objects {
    /// Keys in the order of their first appearance.
    keys: Vec<String>,
    index: HashMap<String, usize>,
    columns: Option<StreamColumns>,
    /// Why the keys give no columns, such as that none is a time.
    failure: Option<String>,
}

impl Rows {
    pub(crate) fn new(source: &str, options: &CsvOptions) -> Self {
        Self { source: source.to_owned(), options: options.clone(), form: Form::Unknown }
    }

    /// The columns; `None` before they are known.
    pub(crate) fn columns(&self) -> Option<&StreamColumns> {
        match &self.form {
            Form::Unknown => None,
            Form::Csv { reader, .. } => Some(reader.columns()),
            Form::Json(objects) => objects.columns.as_ref(),
        }
    }

    /// Reads a line; the values of a sample go into `values`.
    pub(crate) fn take(&mut self, line: &[u8], values: &mut Vec<f64>) -> Row {
        let Ok(line) = std::str::from_utf8(line) else {
            return Row::Refused("a line that is no text (UTF-8)".to_owned());
        };
        let line = line.trim();
        if line.starts_with('{') {
            return self.json(line, values);
        }
        if line.starts_with('#') && !matches!(self.form, Form::Unknown) {
            return Row::Nothing;
        }
        self.csv(line, values)
    }

    fn csv(&mut self, line: &str, values: &mut Vec<f64>) -> Row {
        if let Form::Csv { header, reader, rows } = &mut self.form {
            // The first row shows whether the decimal separator is a comma.
            if *rows == 0
                && let Ok(better) = RowReader::new(&self.source, header, line, &self.options)
            {
                **reader = better;
                *rows = 1;
            }
            match reader.row(line, values) {
                Ok(time_s) => return Row::Sample(time_s),
                Err(_) if line == *header => return Row::Nothing,
                Err(bad) => {
                    // The sender may have been set up anew and send another header.
                    if !RowReader::new(&self.source, line, "", &self.options)
                        .is_ok_and(|new| new.columns().channels().count() > 0)
                    {
                        return Row::Refused(bad_row(bad));
                    }
                }
            }
        }
        match RowReader::new(&self.source, line, "", &self.options) {
            Ok(reader) => {
                let notes = column_notes(reader.columns());
                self.form = Form::Csv { header: line.to_owned(), reader: Box::new(reader), rows: 0 };
                Row::Columns(notes)
            }
            Err(error) => Row::Refused(error.to_string()),
        }
    }

    fn json(&mut self, line: &str, values: &mut Vec<f64>) -> Row {
        let object = match serde_json::from_str::<Value>(line) {
            Ok(Value::Object(object)) => object,
            Ok(_) => return Row::Refused("a line of JSON that is no object".to_owned()),
            Err(error) => return Row::Refused(format!("a line that begins like JSON and is none: {error}")),
        };
        if !matches!(self.form, Form::Json(_)) {
            self.form = Form::Json(Box::default());
        }
        let Form::Json(objects) = &mut self.form else { return Row::Nothing };
        let Objects { keys, index, columns, failure } = objects.as_mut();
        let known = keys.len();
        for (key, value) in &object {
            if (value.is_number() || value.is_null()) && !index.contains_key(key) && keys.len() < MOST_KEYS {
                index.insert(key.clone(), keys.len());
                keys.push(key.clone());
            }
        }
        let mut news = None;
        if keys.len() > known || (columns.is_none() && failure.is_none()) {
            // A mapping of a key that has not come yet is no error, because later objects may have it.
            let mut options = self.options.table();
            options.columns.retain(|mapping| keys.iter().any(|key| key.eq_ignore_ascii_case(mapping.header.trim())));
            match StreamColumns::new(&self.source, keys, &options) {
                Ok(found) => {
                    news = Some(column_notes(&found));
                    (*columns, *failure) = (Some(found), None);
                }
                Err(error) => (*columns, *failure) = (None, Some(error.to_string())),
            }
        }
        if let Some(news) = news {
            // The caller gets the new columns first and then passes the same line again.
            return Row::Columns(news);
        }
        let Some(columns) = columns else {
            return Row::Refused(failure.clone().unwrap_or_default());
        };
        let number = |column: usize| keys.get(column).and_then(|key| object.get(key)).and_then(Value::as_f64);
        match columns.row(number, values) {
            Some(time_s) => Row::Sample(time_s),
            None => Row::Refused(bad_row(BadRow::NoTime)),
        }
    }

    /// Whether the line that gave new columns is a sample too (JSON), so that it has to be passed once more. A CSV
    /// header is not.
    pub(crate) fn columns_come_with_a_sample(&self) -> bool {
        matches!(self.form, Form::Json(_))
    }
}

/// Whether a text stream can begin with this line: a JSON object, or a header line with a time. The error is the reason
/// why a header line cannot, if the line looks like one.
pub(crate) fn can_begin(line: &[u8], options: &CsvOptions) -> Result<(), Option<String>> {
    let line = std::str::from_utf8(line).map_err(|_| None)?.trim();
    if line.starts_with('{') {
        return serde_json::from_str::<serde_json::Map<String, Value>>(line).map(|_| ()).map_err(|_| None);
    }
    if line.chars().any(|c| c.is_control() && c != '\t') || !line.contains([',', ';', '\t', '|', ' ']) {
        return Err(None);
    }
    RowReader::new("the stream", line, "", options).map(|_| ()).map_err(|error| Some(error.to_string()))
}

fn bad_row(bad: BadRow) -> String {
    match bad {
        BadRow::Cells { found, expected } => format!("a row of {found} cells, expected the header's {expected}"),
        BadRow::NoTime => "a row without a time".to_owned(),
    }
}

/// Notes for people: which channels were found, and what was doubtful about their names and units.
fn column_notes(columns: &StreamColumns) -> Vec<String> {
    let names: Vec<&str> = columns.channels().collect();
    let mut notes = vec![format!("channels: {}", names.join(", "))];
    notes.extend(columns.quality().findings.iter().map(|finding| format!("{}: {}", finding.place, finding.message)));
    notes
}
