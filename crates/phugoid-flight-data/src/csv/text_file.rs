//! The lines of a text file, its header and its row of units.

use std::io::{BufRead, BufReader, Chain, Cursor, Read};

use super::ReadError;
use super::cells::{self, Cell};
use super::format::{self, Format, Scratch};
use super::utf16::AsUtf8;
use crate::quality::QualityReport;
use crate::table::clock::Clock;
use crate::table::columns;
use crate::units;
use crate::wording::cut;

/// Number of bytes at the beginning from which the layout is found.
const SAMPLE: usize = 64 * 1024;
/// Further lines that names in quotes may take at most.
const MOST_HEADER_LINES: usize = 64;
/// The longest line accepted, bytes.
const LONGEST_LINE: usize = 1024 * 1024;

/// One line that is neither blank nor a comment.
#[derive(Default)]
pub(super) struct Row {
    pub(super) line: usize,
    pub(super) text: String,
    /// True if a line end follows; false for the last line of a file without one.
    pub(super) ended: bool,
}

/// The lines of a text file, with their numbers, in bounded memory.
pub(super) struct TextFile<'s, R: Read> {
    source: &'s str,
    lines: BufReader<Chain<Cursor<Vec<u8>>, AsUtf8<R>>>,
    pub(super) format: Format,
    line: usize,
    last_comment: Option<(usize, String)>,
    /// Number of cells at the end of the header that are empty and are not counted as columns.
    pub(super) empty_names: usize,
}

impl<'s, R: Read> TextFile<'s, R> {
    pub(super) fn open(reader: R, source: &'s str, delimiter: Option<char>) -> Result<Self, ReadError> {
        let io = |error| ReadError::Io { source_name: source.to_owned(), error };
        let mut reader = AsUtf8::new(reader);
        let mut sample = Vec::new();
        reader.by_ref().take(SAMPLE as u64).read_to_end(&mut sample).map_err(io)?;
        let complete = sample.len() < SAMPLE;
        format::refuse_binary(source, &sample)?;
        if sample.starts_with(&[0xEF, 0xBB, 0xBF]) {
            sample.drain(..3);
        }
        let format = format::sniff(&sample, complete, delimiter);
        let lines = BufReader::new(Cursor::new(sample).chain(reader));
        Ok(Self { source, lines, format, line: 0, last_comment: None, empty_names: 0 })
    }

    pub(super) fn next_row(&mut self) -> Result<Option<Row>, ReadError> {
        let mut row = Row::default();
        Ok(self.read_row(&mut row)?.then_some(row))
    }

    /// Reads the next row in place of what `row` holds, whose memory is used again; false at the end of the file.
    pub(super) fn read_row(&mut self, row: &mut Row) -> Result<bool, ReadError> {
        loop {
            let mut bytes = std::mem::take(&mut row.text).into_bytes();
            bytes.clear();
            let bound = LONGEST_LINE as u64 + 1;
            let read = (&mut self.lines).take(bound).read_until(self.format.line_end, &mut bytes);
            let read = read.map_err(|error| ReadError::Io { source_name: self.source.to_owned(), error })?;
            if read == 0 {
                return Ok(false);
            }
            self.line += 1;
            if read > LONGEST_LINE {
                return Err(self.too_long(self.line));
            }
            row.line = self.line;
            row.ended = bytes.ends_with(&[self.format.line_end]);
            while bytes.ends_with(b"\n") || bytes.ends_with(b"\r") {
                bytes.pop();
            }
            row.text = match String::from_utf8(bytes) {
                Ok(text) => text,
                Err(error) => format::decode(error.as_bytes()).into_owned(),
            };
            if format::is_row(&row.text) {
                return Ok(true);
            }
            if let Some(comment) = row.text.trim_start().strip_prefix('#') {
                self.last_comment = Some((self.line, comment.trim().to_owned()));
            }
        }
    }

    fn too_long(&self, line: usize) -> ReadError {
        ReadError::LineTooLong { source_name: self.source.to_owned(), line, max_bytes: LONGEST_LINE }
    }

    /// The cells of a row.
    pub(super) fn cells(&self, text: &str) -> Vec<String> {
        self.format.cells(text, &mut Scratch::default()).iter().map(str::to_owned).collect()
    }

    /// Line number and cells of the header, and the row after it if that had to be read to find the header. `given` are
    /// the names that stand for those of the file; none if it is empty.
    pub(super) fn header(
        &mut self,
        given: &[String],
        report: &mut QualityReport,
    ) -> Result<(usize, Vec<String>, Option<Row>), ReadError> {
        let mut above = Vec::new();
        for _ in 0..self.format.titles {
            above.extend(self.next_row()?.map(|row| row.line));
        }
        if let (Some(first), Some(last)) = (above.first(), above.last()) {
            let place = if first == last { format!("line {first}") } else { format!("lines {first} to {last}") };
            report.note(place, "not part of the table: titles above it");
        }
        let first = self.next_row()?;
        let comment = self.last_comment.take();
        let Some(mut first) = first else { return Err(ReadError::Empty { source_name: self.source.to_owned() }) };
        // A name in quotes may hold line ends.
        for _ in 0..MOST_HEADER_LINES {
            if !self.format.is_open(&first.text) {
                break;
            }
            let Some(more) = self.next_row()? else { break };
            if first.text.len() + more.text.len() > LONGEST_LINE {
                return Err(self.too_long(first.line));
            }
            first.text = format!("{}\n{}", first.text, more.text);
        }
        let mut cells = self.cells(&first.text);
        if !given.is_empty() {
            return self.named(given, first, &cells, report);
        }
        let word =
            |cell: &String| matches!(cells::parse(cell, self.format.decimal_comma), Cell::Text) && !Clock::is_one(cell);
        if cells.iter().any(word) {
            // Blank cells at the end of the header are the traces of a delimiter at the end of every line.
            while cells.last().is_some_and(|cell| cell.trim().is_empty()) {
                cells.pop();
                self.empty_names += 1;
            }
            columns::check_count(self.source, Some(first.line), cells.len())?;
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
        Err(ReadError::NoHeader { source_name: self.source.to_owned(), line: first.line, found: cut(&first.text, 60) })
    }

    /// The header that the caller gave, for a file whose first row has these cells.
    fn named(
        &self,
        given: &[String],
        first: Row,
        cells: &[String],
        report: &mut QualityReport,
    ) -> Result<(usize, Vec<String>, Option<Row>), ReadError> {
        if given.len() != cells.len() {
            let (source_name, line) = (self.source.to_owned(), first.line);
            return Err(ReadError::Names { source_name, line, given: given.len(), found: cells.len() });
        }
        columns::check_count(self.source, Some(first.line), given.len())?;
        let number = |cell: &String| !matches!(cells::parse(cell, self.format.decimal_comma), Cell::Text);
        let is_data = cells.iter().all(|cell| number(cell) || Clock::is_one(cell));
        let line = first.line;
        if !is_data {
            report.note(format!("line {line}"), "the names in the file are replaced by those that were given");
        }
        Ok((line, given.to_vec(), is_data.then_some(first)))
    }

    /// The row of units below the header, if there is one, else the first row of data, which had to be read.
    pub(super) fn unit_row(
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
        let no_number = |cell: &&String| {
            !matches!(cells::parse(cell, self.format.decimal_comma), Cell::Value(_) | Cell::Grouped(_))
        };
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
