//! Reads rows one at a time, for streams without an end. Headers and units are understood as in files.

use super::cells::{self, Cell};
use super::format::{self, Format, Scratch};
use super::{CsvOptions, ReadError};
use crate::channels;
use crate::quality::QualityReport;
use crate::table::clock::Clock;
use crate::table::columns::{self, Head, Plan};
use crate::table::{TableError, TableOptions};
use crate::wording::cut;

/// The columns of a stream: how numbers under given headers become channels in SI.
///
/// ```
/// use phugoid_flight_data::csv::StreamColumns;
/// use phugoid_flight_data::table::TableOptions;
/// let headers = ["time_ms".to_owned(), "alpha_deg".to_owned()];
/// let columns = StreamColumns::new("telemetry", &headers, &TableOptions::default())?;
/// let mut values = Vec::new();
/// let time_s = columns.row(|column| [Some(1500.0), Some(2.0)][column], &mut values);
/// assert_eq!(time_s, Some(1.5));
/// assert!((values[0] - 2.0_f64.to_radians()).abs() < 1e-15);
/// # Ok::<(), phugoid_flight_data::table::TableError>(())
/// ```
pub struct StreamColumns {
    plan: Plan,
    quality: QualityReport,
}

impl StreamColumns {
    /// Interprets the headers as the reader of a file does. `source` is the name of the stream in messages.
    ///
    /// # Errors
    /// [`TableError`]: no time, two columns for the same channel, contradicting units, or a wrong mapping.
    pub fn new(source: &str, headers: &[String], options: &TableOptions) -> Result<Self, TableError> {
        let mut quality = QualityReport::default();
        let head = Head { source, line: None, headers, units: None, first_row: None };
        let plan = columns::plan(&head, options, &mut quality)?;
        Ok(Self { plan, quality })
    }

    /// Names of the channels in the order of the values: canonical where the header is known, else the name in the
    /// header.
    pub fn channels(&self) -> impl Iterator<Item = &str> {
        self.plan.channels.iter().map(|column| column.name.as_str())
    }

    /// What was assumed about the headers, and what is doubtful in them.
    pub fn quality(&self) -> &QualityReport {
        &self.quality
    }

    /// Converts one row. `number(column)` gives the finite number in a column, counted from 0 in the order of the
    /// headers, or `None`. `values` is filled with one value per channel in SI, NaN where there is no number. Returns
    /// the time, s, or `None` if the row has none.
    pub fn row(&self, number: impl Fn(usize) -> Option<f64>, values: &mut Vec<f64>) -> Option<f64> {
        values.clear();
        let number = |column| number(column).unwrap_or(f64::NAN);
        values.extend(self.plan.channels.iter().map(|column| column.value(number)));
        let time = self.plan.time.as_ref()?;
        Some(time.value(number)).filter(|time| time.is_finite())
    }
}

/// Reads the lines of a CSV stream one at a time.
///
/// ```
/// use phugoid_flight_data::csv::{BadRow, CsvOptions, RowReader};
/// let reader = RowReader::new("telemetry", "time_s,tas_kt", "", &CsvOptions::default())?;
/// let mut values = Vec::new();
/// assert_eq!(reader.row("0.5,100", &mut values), Ok(0.5));
/// assert!((values[0] - 51.444).abs() < 1e-3); // m/s
/// assert_eq!(reader.row("0.6", &mut values), Err(BadRow::Cells { found: 1, expected: 2 }));
/// # Ok::<(), phugoid_flight_data::csv::ReadError>(())
/// ```
pub struct RowReader {
    columns: StreamColumns,
    format: Format,
    fields: usize,
}

/// Why a row of a stream was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadRow {
    /// The row has more or fewer cells than the header.
    Cells {
        /// Number of cells in the row.
        found: usize,
        /// Number of cells in the header.
        expected: usize,
    },
    /// The cell of the time is empty or holds no time.
    NoTime,
}

impl RowReader {
    /// Interprets the header line. The first rows (`rows`, may be empty) help to find the layout: what separates cells,
    /// and whether there are decimal commas. Of a header alone the cells are taken that give the most known channels.
    ///
    /// # Errors
    /// [`ReadError`]: as [`StreamColumns::new`], and [`ReadError::NoHeader`] if the header holds numbers.
    pub fn new(source: &str, header: &str, rows: &str, options: &CsvOptions) -> Result<Self, ReadError> {
        let format = format::sniff(format!("{header}\n{rows}").as_bytes(), true, options.delimiter);
        let found = Self::with_format(source, header, format.clone(), options);
        if options.delimiter.is_some() || !rows.trim().is_empty() {
            return found;
        }
        // A name may hold blanks, commas and semicolons, and no row tells yet which of them separate cells.
        let known = |reader: &Self| reader.columns.channels().filter(|name| channels::by_name(name).is_some()).count();
        let others = format::DELIMITERS.into_iter().filter(|delimiter| *delimiter != format.delimiter);
        let others = others.filter_map(|delimiter| {
            Self::with_format(source, header, Format { delimiter, ..format.clone() }, options).ok()
        });
        let score = |reader: &Result<Self, ReadError>| reader.as_ref().ok().map(known);
        others.map(Ok).fold(found, |best, other| if score(&other) > score(&best) { other } else { best })
    }

    fn with_format(source: &str, header: &str, format: Format, options: &CsvOptions) -> Result<Self, ReadError> {
        let mut scratch = Scratch::default();
        let header = header.trim_start_matches('\u{feff}').trim_start_matches('#').trim();
        let cells = format.cells(header, &mut scratch);
        if cells
            .iter()
            .any(|cell| matches!(cells::parse(cell, format.decimal_comma), Cell::Value(_) | Cell::Grouped(_)))
        {
            let found = cut(header, 60);
            return Err(ReadError::NoHeader { source_name: source.to_owned(), line: 1, found });
        }
        let headers: Vec<String> = cells.iter().map(str::to_owned).collect();
        let columns = StreamColumns::new(source, &headers, &options.table())?;
        Ok(Self { columns, format, fields: headers.len() })
    }

    /// The columns of the stream and the channels that they become.
    pub fn columns(&self) -> &StreamColumns {
        &self.columns
    }

    /// Converts one line. Returns its time, s, and fills `values` with one value per channel in SI, NaN where a cell is
    /// empty or holds no number.
    ///
    /// # Errors
    /// [`BadRow`]; `values` is then undefined.
    pub fn row(&self, line: &str, values: &mut Vec<f64>) -> Result<f64, BadRow> {
        let mut scratch = Scratch::default();
        let cells = self.format.cells(line, &mut scratch);
        if cells.len() != self.fields {
            return Err(BadRow::Cells { found: cells.len(), expected: self.fields });
        }
        let number = |column: usize| match cells.read(column) {
            Cell::Value(value) | Cell::Grouped(value) => Some(value),
            Cell::Missing | Cell::Text => None,
        };
        let clock = || {
            let column = self.columns.plan.time.as_ref()?.column;
            Clock::default().seconds(cells.get(column))
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

    /// Before the first row only the channels tell what separates the cells: none of these names is divided.
    #[test]
    fn a_header_alone_is_cut_where_it_gives_channels() {
        for (header, channels) in [
            ("time_s, alpha [deg], body q", &["alpha", "body q"][..]),
            ("time_s,left elevator position [deg]", &["left elevator position"]),
            ("time_s;Alpha, deg;q_deg_s", &["alpha", "q"]),
            ("time_s,a;b;c,alpha_deg", &["a;b;c", "alpha"]),
            ("\"time_s\",\"the \"\"true\"\" one, or not\",\"alpha_deg\"", &["the \"true\" one, or not", "alpha"]),
            ("time_s alpha_deg q_deg_s", &["alpha", "q"]),
        ] {
            let reader = RowReader::new("stream", header, "", &CsvOptions::default());
            let reader = reader.unwrap_or_else(|error| panic!("{header}: {error}"));
            assert_eq!(reader.columns().channels().collect::<Vec<_>>(), channels, "{header}");
        }
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
