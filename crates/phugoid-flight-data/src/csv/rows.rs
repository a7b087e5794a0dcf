//! Collects the rows of a CSV file, and counts what is wrong with those that are left out.

use super::cells::{self, Cell, Evidence};
use super::format::{Cells, Format, Scratch};
use super::text_file::Row;
use super::{CsvOptions, ReadError};
use crate::memory::{Account, many};
use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::clock::Clock;
use crate::table::columns::{ColumnUse, Plan};
use crate::table::time_base::Table;
use crate::table::{self, BYTES_PER_ROW, Read, TableError, TableOptions};
use crate::wording::{Counted, Lines, cut, plural};

/// Where the header of a file is, and how many names it has.
pub(super) struct Header {
    pub(super) line: usize,
    /// Number of names.
    pub(super) fields: usize,
    /// Number of empty cells behind the last name.
    pub(super) empty_names: usize,
}

impl Header {
    /// Which names are empty, as a clause.
    fn empty(&self) -> Option<String> {
        let (line, first, last) = (self.line, self.fields + 1, self.fields + self.empty_names);
        match self.empty_names {
            0 => None,
            1 => Some(format!("the last name of the header (line {line}, column {last}) is empty")),
            count => {
                Some(format!("the last {count} names of the header (line {line}, columns {first} to {last}) are empty"))
            }
        }
    }
}

/// The rows read so far, and what was wrong with those that were left out.
pub(super) struct Rows {
    plan: Plan,
    header: Header,
    format: Format,
    table: Table,
    seen: usize,
    too_short: Lines,
    too_long: Lines,
    blank_at_end: Lines,
    no_time: Lines,
    /// The time's cell of the first row without a time.
    untimed: String,
    cut: Option<usize>,
    unended: Option<usize>,
    /// Smallest number of characters in the last cell of the rows that have a line end.
    shortest_last: usize,
    /// Line and text of the last number of the file, if it is shorter than in all other rows and has no line end: the
    /// file was probably cut off inside it.
    truncated_number: Option<(usize, String)>,
    /// Per channel: the rows whose cell is text, and the first such text.
    text: Vec<(Lines, String)>,
    /// Per channel: what its numbers say about marks of thousands.
    grouped: Vec<Grouped>,
    /// Set by the first time that is written as a clock.
    clock: Option<Clock>,
    scratch: Scratch,
}

/// Numbers of one channel that tell how its points and commas are meant.
#[derive(Clone, Default)]
struct Grouped {
    /// The first number whose thousands are separated by a point or a comma, and what it was read as.
    first: Option<(String, f64)>,
    /// The first number that contradicts: the same mark stands before decimals.
    contradicts: Option<String>,
}

impl Rows {
    pub(super) fn new(plan: Plan, header: Header, format: Format) -> Self {
        let count = plan.channels.len();
        Self {
            plan,
            header,
            format,
            table: Table {
                time: Vec::new(),
                counted: Counted::Lines,
                lines: Vec::new(),
                columns: vec![Vec::new(); count],
            },
            seen: 0,
            too_short: Lines::default(),
            too_long: Lines::default(),
            blank_at_end: Lines::default(),
            no_time: Lines::default(),
            untimed: String::new(),
            cut: None,
            unended: None,
            shortest_last: usize::MAX,
            truncated_number: None,
            text: vec![(Lines::default(), String::new()); count],
            grouped: vec![Grouped::default(); count],
            clock: None,
            scratch: Scratch::default(),
        }
    }

    pub(super) fn add(
        &mut self,
        row: &Row,
        source: &str,
        options: &CsvOptions,
        account: &Account,
    ) -> Result<(), ReadError> {
        let row_index = self.seen;
        self.seen += 1;
        let cells = self.format.cells(&row.text, &mut self.scratch);
        if cells.len() < self.header.fields {
            match row.ended {
                true => self.too_short.add(row.line),
                false => self.cut = Some(row.line),
            }
            return Ok(());
        }
        if cells.len() > self.header.fields {
            if cells.iter().skip(self.header.fields).any(|cell| !cell.is_empty()) {
                self.too_long.add(row.line);
                return Ok(());
            }
            self.blank_at_end.add(row.line);
        }
        let last = self.header.fields.saturating_sub(1);
        let last_cell = cells.get(last);
        // With fewer than two rows before it the length of the cell cannot be judged.
        let half = !row.ended && self.table.time.len() >= 2 && last_cell.len() < self.shortest_last;
        if row.ended {
            self.shortest_last = self.shortest_last.min(last_cell.len());
        } else if half && self.plan.time.as_ref().is_some_and(|time| time.column == last) {
            self.cut = Some(row.line);
            return Ok(());
        } else if half {
            self.truncated_number = Some((row.line, cut(last_cell, 20)));
        } else {
            self.unended = Some(row.line);
        }
        let Some(time) = time(self.plan.time.as_ref(), &mut self.clock, cells, row_index, options) else {
            if let (0, Some(column)) = (self.no_time.count(), &self.plan.time) {
                self.untimed = cut(cells.get(column.column), 20);
            }
            self.no_time.add(row.line);
            return Ok(());
        };
        let taken = account.take(many(1, BYTES_PER_ROW + 8 * self.table.columns.len()));
        taken.map_err(|excess| TableError::from(account.over_so_far(excess, source, format!("line {}", row.line))))?;
        self.table.time.push(time);
        self.table.lines.push(row.line);
        let channels = self.plan.channels.iter().zip(&mut self.table.columns);
        for (((channel, values), text), grouped) in channels.zip(&mut self.text).zip(&mut self.grouped) {
            values.push(channel.value(|column| {
                let cell = if half && column == last { Cell::Missing } else { cells.read(column) };
                match cell {
                    Cell::Value(value) => value,
                    Cell::Grouped(value) => {
                        let cell = cells.get(column);
                        if grouped.first.is_none() && cell.contains(['.', ',']) {
                            grouped.first = Some((cut(cell, 20), value));
                        }
                        value
                    }
                    Cell::Missing => f64::NAN,
                    Cell::Text => {
                        let cell = cells.get(column);
                        if text.0.count() == 0 {
                            text.1 = cut(cell, 20);
                        }
                        if grouped.first.is_some() && grouped.contradicts.is_none() && is_of_another_mark(cell) {
                            grouped.contradicts = Some(cut(cell, 20));
                        }
                        text.0.add(row.line);
                        f64::NAN
                    }
                }
            }));
        }
        Ok(())
    }

    pub(super) fn finish(
        mut self,
        source: &str,
        options: &TableOptions,
        mut report: QualityReport,
    ) -> Result<Record, ReadError> {
        if self.table.time.is_empty() {
            let (line, reason) = (Some(self.header.line), self.why_no_rows());
            return Err(TableError::NoRows { source_name: source.to_owned(), line, reason }.into());
        }
        for (channel, grouped) in self.plan.channels.iter().zip(&self.grouped) {
            if let (Some((thousands, _)), Some(decimals)) = (&grouped.first, &grouped.contradicts)
                && matches!(cells::evidence(thousands), Evidence::PointOrThousands | Evidence::CommaOrThousands)
            {
                return Err(ReadError::Marks {
                    source_name: source.to_owned(),
                    header: channel.header.clone(),
                    thousands: thousands.clone(),
                    decimals: decimals.clone(),
                });
            }
        }
        self.report_rows(&mut report);
        if let Some(time) = self.plan.time.as_mut().filter(|_| self.clock.is_some()) {
            time.unit_assumed = false;
        }
        let Self { plan, table, text, seen, header, clock, .. } = self;
        Ok(table::record(
            Read { source, header_line: Some(header.line), seen, plan, table, text, sparse: false, clock },
            options,
            report,
        )?)
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
            reasons.push(format!("{rows} with fewer than {} cells ({})", self.header.fields, self.too_short.place()));
        }
        if long > 0 {
            let (rows, fields, place) = (plural(long, "row"), self.header.fields, self.too_long.place());
            reasons.push(match self.header.empty() {
                Some(empty) => format!(
                    "{empty}, and {rows} have values there ({place}). Write the name of that column into the header, or empty \
                     these cells"
                ),
                None => format!(
                    "{rows} with more than {fields} cells ({place}; are there commas in the numbers? then separate the cells by \
                     semicolons)"
                ),
            });
        }
        if untimed > 0 {
            let found = match self.untimed.as_str() {
                "" => String::new(),
                cell => format!(": '{cell}' is none that is understood"),
            };
            reasons.push(format!("{} without a time ({}){found}", plural(untimed, "row"), self.no_time.place()));
        }
        reasons.join("; ")
    }

    fn report_rows(&self, report: &mut QualityReport) {
        let fields = self.header.fields;
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
            let empty = self.header.empty().map(|empty| format!("; {empty}")).unwrap_or_default();
            report
                .warn(self.too_long.place(), format!("{rows} left out: more than the header's {fields} cells{empty}"));
        }
        if self.blank_at_end.count() > 0 {
            report.note(self.blank_at_end.place(), "blank cells beyond the header's last column ignored");
        }
        if self.no_time.count() > 0 {
            let rows = plural(self.no_time.count(), "row");
            report.warn(self.no_time.place(), format!("{rows} left out: no time, or one that is no number"));
        }
        for ((channel, (text, example)), grouped) in self.plan.channels.iter().zip(&self.text).zip(&self.grouped) {
            let place = || format!("column '{}'", channel.header);
            if let Some((cell, value)) = &grouped.first {
                report.note(place(), format!("'{cell}' is read as {value}: the other mark stands before decimals"));
            }
            if text.count() > 0 && cells::evidence(example) != Evidence::Nothing {
                report.warn(
                    place(),
                    format!(
                        "'{example}' is a number with decimals or with marks of thousands, and the file does not say which: \
                         write it without marks of thousands, and with the decimal mark of the other columns"
                    ),
                );
            }
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
        if let Some((line, cell)) = &self.truncated_number {
            report.warn(
                format!("line {line}"),
                format!(
                    "the file ends without a line end after '{cell}', which is shorter than the last cell of any other row: \
                     taken as a number cut short and left out; the file was probably cut off: if rows are missing, copy it \
                     again"
                ),
            );
        }
    }
}

/// Whether a cell that cannot be read is a number that can be meant in one way only: with the other decimal mark.
fn is_of_another_mark(cell: &str) -> bool {
    matches!(cells::evidence(cell), Evidence::Point | Evidence::Comma)
}

/// The time of a row, s; `None` where it has none.
fn time(
    column: Option<&ColumnUse>,
    clock: &mut Option<Clock>,
    cells: Cells<'_>,
    row_index: usize,
    options: &CsvOptions,
) -> Option<f64> {
    if let Some(step) = options.sample_time_s {
        return Some(step * row_index as f64).filter(|time| time.is_finite());
    }
    let column = column?;
    // A clock time is no number: where there is a clock already, it is asked first.
    if let Some(seconds) = clock.as_mut().and_then(|clock| clock.seconds(cells.get(column.column))) {
        return Some(seconds);
    }
    if let Cell::Value(value) | Cell::Grouped(value) = cells.read(column.column) {
        return Some(column.value(|_| value)).filter(|time| time.is_finite());
    }
    // The first clock time makes the clock, which goes on from row to row.
    let mut new = clock.is_none().then(Clock::default)?;
    let seconds = new.seconds(cells.get(column.column))?;
    *clock = Some(new);
    Some(seconds)
}
