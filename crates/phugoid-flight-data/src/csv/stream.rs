//! Rows that come one at a time: the same headers and units as in a file, for streams that have no end.

use super::cells::{self, Cell};
use super::format::{self, Format};
use super::{CsvOptions, ReadError};
use crate::quality::QualityReport;
use crate::table::columns::{self, Head, Plan};
use crate::table::{TableError, TableOptions};
use crate::wording::cut;

/// What the columns of a stream are: how numbers under given headers become channels in SI.
pub struct StreamColumns {
    plan: Plan,
    quality: QualityReport,
}

impl StreamColumns {
    /// Decides for every header as a file's reader does. `source` is the stream's name in messages.
    ///
    /// # Errors
    /// [`TableError`]: no time, two columns for one channel, contradicting units, a wrong mapping.
    pub fn new(source: &str, headers: &[String], options: &TableOptions) -> Result<Self, TableError> {
        let mut quality = QualityReport::default();
        let head = Head { source, line: None, headers, units: None };
        let plan = columns::plan(&head, options, &mut quality)?;
        Ok(Self { plan, quality })
    }

    /// Canonical names of the channels (own names where a header is no known one), in the order of the values.
    pub fn channels(&self) -> impl Iterator<Item = &str> {
        self.plan.channels.iter().map(|column| column.name.as_str())
    }

    /// What was assumed and what is doubtful.
    pub fn quality(&self) -> &QualityReport {
        &self.quality
    }

    /// One row: `number(column)` is the finite number that stands in a column, counted from 0 in the order of the headers.
    /// `values` becomes one value per channel, SI, NaN where there is none; the answer is the time, s, if there is one.
    pub fn row(&self, number: impl Fn(usize) -> Option<f64>, values: &mut Vec<f64>) -> Option<f64> {
        values.clear();
        let number = |column| number(column).unwrap_or(f64::NAN);
        values.extend(self.plan.channels.iter().map(|column| column.value(number)));
        let time = self.plan.time.as_ref()?;
        Some(time.value(number)).filter(|time| time.is_finite())
    }
}

/// Reads the rows of a CSV stream one at a time.
pub struct RowReader {
    columns: StreamColumns,
    format: Format,
    fields: usize,
}

/// Why a row of a stream was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadRow {
    /// Other than the header's number of cells.
    Cells {
        /// How many the row has.
        found: usize,
        /// How many the header has.
        expected: usize,
    },
    /// No time in it.
    NoTime,
}

impl RowReader {
    /// Reads the header line. The first rows (`rows`, may be empty) tell the layout: what separates cells, and decimal
    /// commas.
    ///
    /// # Errors
    /// [`ReadError`]: as [`StreamColumns::new`], and a header that is numbers.
    pub fn new(source: &str, header: &str, rows: &str, options: &CsvOptions) -> Result<Self, ReadError> {
        let format = format::sniff(format!("{header}\n{rows}").as_bytes(), true, options.delimiter);
        let mut scratch = ::csv::StringRecord::new();
        let header = header.trim_start_matches('\u{feff}').trim_start_matches('#').trim();
        let cells = format.cells(header, &mut scratch);
        if cells.iter().any(|cell| matches!(cells::parse(cell, format.decimal_comma), Cell::Value(_))) {
            let found = cut(header, 60);
            return Err(ReadError::NoHeader { source_name: source.to_owned(), line: 1, found });
        }
        let headers: Vec<String> = cells.into_iter().map(str::to_owned).collect();
        let columns = StreamColumns::new(source, &headers, &options.table())?;
        Ok(Self { columns, format, fields: headers.len() })
    }

    /// What the columns are.
    pub fn columns(&self) -> &StreamColumns {
        &self.columns
    }

    /// One line: its time, s, and one value per channel in `values`, SI, NaN where a cell is empty or no number.
    ///
    /// # Errors
    /// [`BadRow`]; `values` is then of no use.
    pub fn row(&self, line: &str, values: &mut Vec<f64>) -> Result<f64, BadRow> {
        let mut scratch = ::csv::StringRecord::new();
        let cells = self.format.cells(line, &mut scratch);
        if cells.len() != self.fields {
            return Err(BadRow::Cells { found: cells.len(), expected: self.fields });
        }
        let number = |column: usize| {
            let cell = cells.get(column)?;
            match cells::parse(cell, self.format.decimal_comma) {
                Cell::Value(value) => Some(value),
                Cell::Missing | Cell::Text => None,
            }
        };
        let clock = || {
            let column = self.columns.plan.time.as_ref()?.column;
            cells::clock(cells.get(column)?).map(|(seconds, _)| seconds)
        };
        self.columns.row(number, values).or_else(clock).ok_or(BadRow::NoTime)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_means_what_it_means_in_a_file() {
        let text = "time_s,alpha_deg,tas_kt,q\n0.5,2.5,250,0.1\n1.0,,251,x\n";
        let mut lines = text.lines();
        let reader = RowReader::new("stream", lines.next().unwrap(), "", &CsvOptions::default()).unwrap();
        assert_eq!(reader.columns().channels().collect::<Vec<_>>(), ["alpha", "true_airspeed", "q"]);
        let record = super::super::read(text.as_bytes(), "file", &CsvOptions::default()).unwrap();
        let mut values = Vec::new();
        for (row, line) in lines.enumerate() {
            assert_eq!(reader.row(line, &mut values), Ok(record.time[row]));
            for (channel, value) in record.channels.iter().zip(&values) {
                assert_eq!(channel.values[row].to_bits(), value.to_bits(), "{}", channel.name);
            }
        }
        assert!(reader.columns().quality().findings.iter().any(|finding| finding.place.contains("'q'")));
    }

    #[test]
    fn rows_that_are_none_are_named() {
        let reader = RowReader::new("stream", "time_s;alpha_deg", "0,5;1,5", &CsvOptions::default()).unwrap();
        let mut values = Vec::new();
        assert_eq!(reader.row("0,5;1,5", &mut values), Ok(0.5));
        assert_eq!(reader.row("0,5", &mut values), Err(BadRow::Cells { found: 1, expected: 2 }));
        assert_eq!(reader.row(";1,5", &mut values), Err(BadRow::NoTime));
        assert!(RowReader::new("stream", "0.5,1.5", "", &CsvOptions::default()).is_err());
        assert!(RowReader::new("stream", "alpha_deg,q_deg_s", "", &CsvOptions::default()).is_err());
    }
}
