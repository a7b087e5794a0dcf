//! The layout of a CSV file: what separates cells and lines, and the decimal marks.

use std::cmp::Ordering;

use super::ReadError;
use super::cells::{self, Cell, Evidence, Mark};

/// What separates the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Delimiter {
    Byte(u8),
    Blanks,
}

/// What cells may be separated by; the first ones are preferred.
pub(super) const DELIMITERS: [Delimiter; 5] =
    [Delimiter::Byte(b','), Delimiter::Byte(b';'), Delimiter::Byte(b'\t'), Delimiter::Byte(b'|'), Delimiter::Blanks];

/// The layout of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Format {
    pub(super) delimiter: Delimiter,
    pub(super) decimal_comma: bool,
    /// Whether numbers of the file that can be read in one way alone all have this mark, so that the other one, where it stands,
    /// separates thousands.
    pub(super) certain: bool,
    /// Columns that are read by a mark of their own.
    pub(super) marks: Vec<(usize, Mark)>,
    /// The last byte of a line.
    pub(super) line_end: u8,
    /// Number of rows above the header that are no part of the table.
    pub(super) titles: usize,
}

impl Format {
    /// Whether the last cell of a line begins with a quote that does not end on it.
    pub(super) fn is_open(&self, line: &str) -> bool {
        let Delimiter::Byte(delimiter) = self.delimiter else { return false };
        let (mut quoted, mut at_start) = (false, true);
        for byte in line.bytes() {
            match byte {
                b'"' if quoted || at_start => quoted = !quoted,
                _ => {}
            }
            // Within quotes a doubled quote closes and opens again.
            at_start = (byte == delimiter && !quoted) || (at_start && byte == b' ') || byte == b'"';
        }
        quoted
    }

    /// The cells of a line, without blanks around them. What `scratch` holds is used again from line to line.
    pub(super) fn cells<'a>(&'a self, line: &'a str, scratch: &'a mut Scratch) -> Cells<'a> {
        let Scratch { unquoted, places, with_points } = scratch;
        places.clear();
        let text = match self.delimiter {
            Delimiter::Blanks => {
                let mut start = None;
                for (at, character) in line.char_indices() {
                    match (character.is_whitespace(), start) {
                        (true, Some(from)) => {
                            places.push(Place::of(from, at));
                            start = None;
                        }
                        (false, None) => start = Some(at),
                        _ => {}
                    }
                }
                places.extend(start.map(|from| Place::of(from, line.len())));
                line
            }
            Delimiter::Byte(byte) if memchr::memchr(b'"', line.as_bytes()).is_none() => {
                let mut numbers = line.as_bytes();
                if self.decimal_comma {
                    // What a point becomes is no part of a number: it may separate thousands.
                    let swapped = |byte: u8| {
                        if byte == b',' {
                            b'.'
                        } else if byte == b'.' {
                            b'?'
                        } else {
                            byte
                        }
                    };
                    with_points.clear();
                    with_points.extend(line.bytes().map(swapped));
                    numbers = with_points;
                }
                self.divide(line.as_bytes(), numbers, byte, places);
                line
            }
            Delimiter::Byte(byte) => {
                unquoted.read(line, byte, places);
                &unquoted.text
            }
        };
        Cells { text, places, format: self }
    }

    /// Where the cells of a line without quotes lie. A cell that is a number is read on the way to its end, so that no byte of it
    /// is looked at twice. `numbers` is the line with points in its numbers.
    fn divide(&self, line: &[u8], numbers: &[u8], delimiter: u8, places: &mut Vec<Place>) {
        // A character of numbers may separate cells: where a line `sep=` says so, or a comma beside decimal commas in quotes.
        let is_usual = DELIMITERS.contains(&Delimiter::Byte(delimiter));
        let numbers_first = is_usual && !(self.decimal_comma && delimiter == b',');
        let mut from = 0;
        loop {
            let rest = line.get(from..).unwrap_or_default();
            let number = || fast_float2::parse_partial(numbers.get(from..).unwrap_or_default()).ok();
            let number = numbers_first.then(number).flatten();
            let ends_at = |length: usize| rest.get(length).is_none_or(|next| *next == delimiter);
            let place = match number {
                Some((value, length)) if ends_at(length) => Place { from, to: from + length, number: Some(value) },
                _ => Place::of(from, from + memchr::memchr(delimiter, rest).unwrap_or(rest.len())),
            };
            places.push(place);
            if place.to >= line.len() {
                return;
            }
            from = place.to + 1;
        }
    }
}

/// Memory that the division of lines into cells needs, used again from line to line.
#[derive(Default)]
pub(super) struct Scratch {
    unquoted: Unquoted,
    places: Vec<Place>,
    /// A line with points in place of its decimal commas.
    with_points: Vec<u8>,
}

/// Where a cell begins and ends in its line, or in the text without quotes.
#[derive(Clone, Copy)]
struct Place {
    from: usize,
    to: usize,
    /// The number in it, if it was read already.
    number: Option<f64>,
}

impl Place {
    fn of(from: usize, to: usize) -> Self {
        Self { from, to, number: None }
    }
}

/// The cells of a line.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a> {
    text: &'a str,
    places: &'a [Place],
    format: &'a Format,
}

impl<'a> Cells<'a> {
    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    /// A cell without blanks around it; an empty text where there is none.
    #[inline]
    pub(super) fn get(&self, column: usize) -> &'a str {
        let cell = self.places.get(column).and_then(|place| self.text.get(place.from..place.to));
        cells::trim(cell.unwrap_or_default())
    }

    /// What a cell holds; nothing where there is none.
    #[inline]
    pub(super) fn read(&self, column: usize) -> Cell {
        let Format { decimal_comma, certain, marks, .. } = self.format;
        if !marks.is_empty()
            && let Some((_, mark)) = marks.iter().find(|(of, _)| *of == column)
        {
            return cells::parse_marked(self.get(column), *mark);
        }
        match self.places.get(column).and_then(|place| place.number) {
            Some(value) if value.is_finite() => Cell::Value(value),
            Some(_) => Cell::Missing,
            None if *certain => {
                cells::parse_marked(self.get(column), if *decimal_comma { Mark::Comma } else { Mark::Point })
            }
            None => cells::parse(self.get(column), *decimal_comma),
        }
    }

    pub(super) fn iter(self) -> impl Iterator<Item = &'a str> {
        (0..self.len()).map(move |column| self.get(column))
    }
}

/// Cells whose quotes are taken away (RFC 4180).
#[derive(Default)]
struct Unquoted {
    text: String,
    ends: Vec<usize>,
    /// With the character between cells that it was made for.
    reader: Option<(u8, csv_core::Reader)>,
}

impl Unquoted {
    /// Writes the cells of a line to `text`, one behind the other, and where each lies to `places`.
    fn read(&mut self, line: &str, delimiter: u8, places: &mut Vec<Place>) {
        let reader = match &mut self.reader {
            Some((made_for, reader)) if *made_for == delimiter => reader,
            other => &mut other.insert((delimiter, csv_core::ReaderBuilder::new().delimiter(delimiter).build())).1,
        };
        reader.reset();
        // Without its quotes a line is not longer, and it has at most one cell more than bytes. The reader asks for room
        // that it does not use.
        let mut text = std::mem::take(&mut self.text).into_bytes();
        text.resize(line.len() + 1, 0);
        self.ends.resize(line.len() + 2, 0);
        let (mut input, mut written, mut count) = (line.as_bytes(), 0, 0);
        loop {
            let (text, ends) = (text.get_mut(written..), self.ends.get_mut(count..));
            let (state, taken, wrote, ended) =
                reader.read_record(input, text.unwrap_or_default(), ends.unwrap_or_default());
            (written, count) = (written + wrote, count + ended);
            input = input.get(taken..).unwrap_or_default();
            // A line is one record: its end is told by one more call without input.
            if !matches!(state, csv_core::ReadRecordResult::InputEmpty) {
                break;
            }
        }
        text.truncate(written);
        // Cells end at characters of ASCII, so that what was UTF-8 stays so.
        self.text = String::from_utf8(text).unwrap_or_default();
        let mut from = 0;
        for &to in self.ends.iter().take(count) {
            places.push(Place::of(from, to));
            from = to;
        }
    }
}

/// Refuses files that are no text, by their first bytes, and says what they are.
pub(super) fn refuse_binary(source: &str, start: &[u8]) -> Result<(), ReadError> {
    let (found, advice) = match start {
        [b'U', b'L', b'o', b'g', 0x01, 0x12, 0x35, ..] => {
            ("a PX4 ULog", "read it with reader::read_path, as every command does")
        }
        [0xA3, 0x95, ..] => ("an ArduPilot DataFlash log", "read it with reader::read_path, as every command does"),
        [b'P', b'K', 3, 4, ..] => ("a zip archive or a spreadsheet", "unpack it, or export the sheet as CSV"),
        [0x1F, 0x8B, ..] => ("compressed by gzip", "unpack it first (gunzip)"),
        [b'P', b'A', b'R', b'1', ..] => ("a Parquet file", "export it as CSV"),
        [0x89, b'H', b'D', b'F', ..] => ("an HDF5 or MATLAB 7.3 file", "export it as CSV"),
        // A text may begin with these letters too, but has no zero bytes.
        _ if start.starts_with(b"PHGL") && start.contains(&0) => (
            "a recording of `phugoid live`",
            "replay it with `phugoid live --replay FILE --speed max`, or show it with `phugoid view FILE`",
        ),
        _ if start.starts_with(b"MATLAB 5.0") => ("a MATLAB file", "export it as CSV, e.g. with writetable"),
        _ if start.contains(&0) => (
            "binary data (there are zero bytes in it)",
            "check that it is the right file. It begins neither as a ULog (`ULog`) nor as a DataFlash log (bytes A3 95), nor as \
             another format that is read",
        ),
        _ => return Ok(()),
    };
    Err(ReadError::NotText { source_name: source.to_owned(), found, advice })
}

/// Finds the layout from the beginning of a file, and how many titles stand above the table. `complete` is true if the sample is
/// the whole file.
pub(super) fn sniff(sample: &[u8], complete: bool, wanted: Option<char>) -> Format {
    let line_end = if sample.contains(&b'\n') || !sample.contains(&b'\r') { b'\n' } else { b'\r' };
    let text = decode(sample);
    let mut lines: Vec<&str> = text.split(char::from(line_end)).map(str::trim_end).collect();
    if !complete && lines.len() > 1 {
        lines.pop();
    }
    let preset = lines.first().and_then(|first| separator_line(first));
    let all: Vec<&str> = lines.iter().copied().filter(|line| is_row(line)).collect();
    let rows = all.get(..MOST_TITLES + 30).unwrap_or(&all);
    let with =
        |delimiter| Format { delimiter, decimal_comma: false, certain: false, marks: Vec::new(), line_end, titles: 0 };
    let chosen = wanted.or(preset).map(|c| match c {
        ' ' => Delimiter::Blanks,
        c => u8::try_from(c).map_or(Delimiter::Byte(b','), Delimiter::Byte),
    });
    let mut format = with(chosen.unwrap_or_else(|| best_delimiter(rows, with)));
    format.titles = titles(rows, &format);
    let table = all.get(format.titles..).unwrap_or_default();
    find_marks(&mut format, table);
    format
}

/// How many cells of a column say what about its decimal mark.
#[derive(Clone, Copy, Default)]
struct Said {
    point: usize,
    comma: usize,
    point_or_thousands: usize,
    comma_or_thousands: usize,
}

/// Finds the decimal marks: of each column by its own numbers, and where those can be read in two ways by the other columns.
fn find_marks(format: &mut Format, rows: &[&str]) {
    let mut said: Vec<Said> = Vec::new();
    let mut scratch = Scratch::default();
    for row in rows.iter().skip(1) {
        for (column, cell) in format.cells(row, &mut scratch).iter().enumerate() {
            let found = cells::evidence(cell);
            if found == Evidence::Nothing {
                continue;
            }
            if said.len() <= column {
                said.resize(column + 1, Said::default());
            }
            let Some(of) = said.get_mut(column) else { continue };
            match found {
                Evidence::Point => of.point += 1,
                Evidence::Comma => of.comma += 1,
                Evidence::PointOrThousands => of.point_or_thousands += 1,
                Evidence::CommaOrThousands => of.comma_or_thousands += 1,
                Evidence::Nothing => {}
            }
        }
    }
    // A number in the wrong column, or a slip, does not outweigh the others of its column.
    let own = |of: &Said| match of.point.cmp(&of.comma) {
        Ordering::Greater => Some(Mark::Point),
        Ordering::Less => Some(Mark::Comma),
        Ordering::Equal => None,
    };
    let count = |mark: Mark| said.iter().filter(|of| own(of) == Some(mark)).count();
    let (points, commas) = (count(Mark::Point), count(Mark::Comma));
    match (points, commas) {
        // Nothing can be read in one way alone: points are decimal ones, and commas where there are no points.
        (0, 0) => {
            let any = |of: fn(&Said) -> usize| said.iter().any(|column| of(column) > 0);
            let points = any(|of| of.point + of.point_or_thousands);
            let commas = any(|of| of.comma + of.comma_or_thousands);
            format.decimal_comma = commas && !points;
        }
        (_, 0) | (0, _) => {
            format.decimal_comma = commas > 0;
            format.certain = true;
        }
        // Columns of two makes: what says nothing about itself is in doubt.
        (_, _) => {
            format.decimal_comma = commas > points;
            format.marks = said.iter().map(|of| own(of).unwrap_or(Mark::Unknown)).enumerate().collect();
        }
    }
}

/// The delimiter with which most of the first rows have as many cells as the header; of equally good ones, that with
/// more cells.
fn best_delimiter(rows: &[&str], with: impl Fn(Delimiter) -> Format) -> Delimiter {
    let mut best = (Delimiter::Byte(b','), 0, 1);
    let mut scratch = Scratch::default();
    for candidate in DELIMITERS {
        let format = with(candidate);
        let counts: Vec<usize> = rows.iter().map(|row| format.cells(row, &mut scratch).len()).collect();
        let Some((&header, below)) = counts.split_first() else { continue };
        let agreeing = 1 + below.iter().filter(|&&count| count == header).count();
        if header >= 2 && (agreeing, header) > (best.1, best.2) {
            best = (candidate, agreeing, header);
        }
    }
    // Below titles the header is not the first row: the number of cells that most rows have tells. Two titles may agree with each
    // other by chance, as in their blanks.
    let few_as_first = best.1 <= 1 || 2 * best.1 < rows.len();
    for candidate in DELIMITERS.into_iter().filter(|_| few_as_first && rows.len() > 3) {
        let format = with(candidate);
        let counts: Vec<usize> = rows.iter().map(|row| format.cells(row, &mut scratch).len()).collect();
        let (cells, agreeing) = most_frequent(&counts);
        if cells >= 2 && 2 * agreeing > rows.len() && (agreeing, cells) > (best.1, best.2) {
            best = (candidate, agreeing, cells);
        }
    }
    best.0
}

/// Most rows above a table that are taken for titles.
const MOST_TITLES: usize = 30;

/// The most frequent number and how often it stands; of equally frequent ones the largest.
fn most_frequent(counts: &[usize]) -> (usize, usize) {
    let often = |count: usize| counts.iter().filter(|other| **other == count).count();
    counts.iter().map(|&count| (often(count), count)).max().map_or((0, 0), |(often, count)| (count, often))
}

/// Number of the first rows that are titles above a table: less than half as many filled cells as most rows have.
fn titles(rows: &[&str], format: &Format) -> usize {
    let mut scratch = Scratch::default();
    let mut filled_of = |row: &&str| format.cells(row, &mut scratch).iter().filter(|cell| !cell.is_empty()).count();
    let filled: Vec<usize> = rows.iter().map(&mut filled_of).collect();
    let (cells, often) = most_frequent(&filled);
    // A name in quotes may hold a line end: its beginning is no title.
    let is_title = |(row, &count): (&&str, &usize)| 2 * count < cells && !format.is_open(row);
    let titles = rows.iter().zip(&filled).take_while(|&row| is_title(row)).count();
    // The table has to be there: a header and rows of numbers below the titles.
    if titles <= MOST_TITLES && often >= 3 { titles } else { 0 }
}

/// The separator of a first line such as `sep=;`, as spreadsheets write it; `None` for other lines.
pub(super) fn separator_line(line: &str) -> Option<char> {
    let mark = line.trim_end_matches(['\r', '\n']).strip_prefix("sep=")?;
    let mut chars = mark.chars();
    chars.next().filter(|c| c.is_ascii() && !c.is_alphanumeric() && chars.next().is_none())
}

/// True for a line that is neither blank, nor a comment, nor the `sep=` line of a spreadsheet.
pub(super) fn is_row(line: &str) -> bool {
    let line = line.trim();
    !line.is_empty() && !line.starts_with('#') && separator_line(line).is_none()
}

/// Decodes UTF-8, or Latin-1 if it is not valid UTF-8, as the degree sign of an old instrument.
pub(super) fn decode(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect::<String>().into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format(text: &str) -> (Delimiter, bool) {
        let format = sniff(text.as_bytes(), true, None);
        (format.delimiter, format.decimal_comma)
    }

    /// The cells and what they hold, as [`Format::cells`] gives them, and as they were given before numbers were read on the way:
    /// divided at every delimiter, and read one by one.
    #[test]
    fn numbers_read_on_the_way_are_those_of_their_cells() {
        let lines = [
            "0.01,1,-2.5e-3,+4.,.5,1e400,-inf,NaN, 7 ,8 ,,x,1.2.3,12:30:05.5,1e5x,0x10,-,1,5,1D3,\u{a0}9",
            "1,5;-0,03e-2;1.5;1,5,5;1.234,5; 7,25 ;;5;,5;5,;-;na;1e2;12:30:05,5;1,5D3",
            "1.5\t2\t \t-3e1\t4 5\t",
            "1|2.5|x|",
            "17",
        ];
        for line in lines {
            for (delimiter, decimal_comma) in [
                (',', false),
                (';', true),
                (';', false),
                ('\t', false),
                ('\t', true),
                ('|', false),
                (',', true),
                ('.', false),
                ('-', false),
            ] {
                let byte = delimiter as u8;
                let format = Format {
                    delimiter: Delimiter::Byte(byte),
                    decimal_comma,
                    certain: false,
                    marks: Vec::new(),
                    line_end: b'\n',
                    titles: 0,
                };
                let mut scratch = Scratch::default();
                let cells = format.cells(line, &mut scratch);
                let expected: Vec<&str> = line.split(delimiter).map(str::trim).collect();
                assert_eq!(cells.iter().collect::<Vec<_>>(), expected, "{line:?} at {delimiter:?}");
                for (column, cell) in expected.into_iter().enumerate() {
                    let read = cells::parse(cell, decimal_comma);
                    assert_eq!(cells.read(column), read, "{cell:?} of {line:?} at {delimiter:?}");
                }
            }
        }
    }

    /// What a point or a comma means is asked of the column, and where that does not say it, of the others.
    #[test]
    fn each_column_has_its_decimal_mark() {
        let read = |text: &str| -> Vec<Cell> {
            let format = sniff(text.as_bytes(), true, None);
            let last = text.lines().next_back().unwrap();
            let mut scratch = Scratch::default();
            let cells = format.cells(last, &mut scratch);
            (0..cells.len()).map(|column| cells.read(column)).collect()
        };
        use Cell::{Grouped, Text, Value};
        assert_eq!(read("a;b;c\n0,5;5.003;1 234\n"), [Value(0.5), Grouped(5003.0), Grouped(1234.0)]);
        assert_eq!(read("a;b\n0.5;5,003\n"), [Value(0.5), Grouped(5003.0)]);
        assert_eq!(read("a;b\n0,5;5.1\n"), [Value(0.5), Value(5.1)]);
        // Columns of two makes do not say which of them a third one is.
        assert_eq!(read("a;b;c\n0,5;5.1;5.003\n"), [Value(0.5), Value(5.1), Text]);
        // Nothing but these: with decimals.
        assert_eq!(read("a;b\n1;5.003\n"), [Value(1.0), Value(5.003)]);
        assert_eq!(read("a;b\n1;5,003\n"), [Value(1.0), Value(5.003)]);
    }

    #[test]
    fn delimiters_and_decimal_marks() {
        assert_eq!(format("a,b\n1.5,2\n"), (Delimiter::Byte(b','), false));
        assert_eq!(format("a;b\n1,5;2\n"), (Delimiter::Byte(b';'), true));
        assert_eq!(format("Alpha, deg;Time, s\n1,5;2\n"), (Delimiter::Byte(b';'), true));
        assert_eq!(format("a;b\n1.5;2\n"), (Delimiter::Byte(b';'), false));
        assert_eq!(format("a\tb\n1,5\t2\n"), (Delimiter::Byte(b'\t'), true));
        assert_eq!(format("a  b   c\n1.0  2 3\n"), (Delimiter::Blanks, false));
        assert_eq!(format("\"a, x\",\"b\"\n\"1,5\",\"2\"\n"), (Delimiter::Byte(b','), true));
        assert_eq!(format("sep=;\na;b\n1;2\n"), (Delimiter::Byte(b';'), false));
        assert_eq!(format("True Airspeed,Pitch Rate\n1,2\n"), (Delimiter::Byte(b','), false));
        assert_eq!(sniff(b"a,b\r1,2\r", true, None).line_end, b'\r');
    }
}
