//! Makes a record of columns of numbers.

use super::assemble::{BYTES_PER_ROW, Read, record};
use super::{ColumnMapping, MappingProblem, TableError, TableOptions};
use crate::memory::{Account, Memory, many};
use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::columns::{self, ColumnUse, Head, Plan};
use crate::table::header::{self, Meaning};
use crate::table::time_base::Table;
use crate::wording::{Counted, Lines, plural};

/// One column of a table: a header and one number per row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// The name in the file, which may contain the unit: `alpha_deg`, `Alpha [deg]`, `KTAS`.
    pub header: String,
    /// The unit, where the file states it apart from the name.
    pub unit: Option<String>,
    /// Values in that unit; NaN where one is missing. An infinity counts as missing.
    pub values: Vec<f64>,
    /// True if the file itself declares the values as points in time. Such a column is the time if no header names it.
    pub is_time: bool,
}

/// A column that is not read as a signal, and the reason, which the quality report names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// The name in the file.
    pub header: String,
    /// What it is instead of a column of numbers, as it follows "it is": `text`, `a list`.
    pub why: String,
}

/// Makes a record in SI units of columns, by their headers and units, exactly as [`crate::csv::read`] does of cells.
/// Rows are counted from 1 in messages. `source` is the name of the table in messages, `left_out` are the columns that
/// its reader did not take, and `report` is what the reader has found so far. [`Record::from_columns`] is the short
/// form.
///
/// # Errors
/// [`TableError`] if the columns differ in length, none is the time, two are the same channel, units contradict each
/// other, there are fewer than two usable rows, they need more than `options.max_memory`, or a mapping is wrong.
pub fn from_columns(
    source: &str,
    columns: Vec<Column>,
    left_out: &[LeftOut],
    options: &TableOptions,
    report: QualityReport,
) -> Result<Record, TableError> {
    let account = Account::new(options.max_memory);
    let values = columns.iter().map(|column| column.values.len()).sum();
    account.take(many(values, 8)).map_err(|excess| account.over(excess, source, ""))?;
    from_counted_columns(source, columns, left_out, options, report, &account)
}

/// As [`from_columns`], for columns whose values the account holds already.
pub(crate) fn from_counted_columns(
    source: &str,
    columns: Vec<Column>,
    left_out: &[LeftOut],
    options: &TableOptions,
    report: QualityReport,
    account: &Account,
) -> Result<Record, TableError> {
    make_record(source, columns, left_out, options, report, false, account)
}

impl Record {
    /// Makes a record of columns that are in memory: pairs of a header and values, all of the same length.
    ///
    /// Headers are read as those of a CSV file: a channel name or a synonym and perhaps a unit (`time_s`, `alpha_deg`,
    /// `tas_kt`, `Alpha [deg]`). Values are converted to SI; without a unit they are taken as SI, which the quality
    /// report says. One column has to be the time; rows without a finite time are left out, and a NaN or an infinity in
    /// another column is a missing value. `source` is the name of the record in messages. For units apart from the
    /// headers, mappings or a given sample time use [`from_columns`].
    ///
    /// ```
    /// use phugoid_flight_data::record::Record;
    /// let columns = [("time_s", vec![0.0, 0.1, 0.2]), ("tas_kt", vec![250.0, f64::NAN, 251.0])];
    /// let record = Record::from_columns("test flight", columns)?;
    /// let speed = &record.require("true_airspeed")?.values;
    /// assert!((speed[0] - 250.0 * 1852.0 / 3600.0).abs() < 1e-9); // m/s
    /// assert!(speed[1].is_nan());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`from_columns`]: no column is the time ([`TableError::NoTime`]), the lengths differ
    /// ([`TableError::Length`]), two columns are the same channel ([`TableError::TwoColumns`]), or fewer than two rows
    /// have a time.
    pub fn from_columns<H: Into<String>>(
        source: &str,
        columns: impl IntoIterator<Item = (H, Vec<f64>)>,
    ) -> Result<Self, TableError> {
        let column = |(header, values): (H, Vec<f64>)| Column { header: header.into(), values, ..Column::default() };
        let columns = columns.into_iter().map(column).collect();
        // They are in memory already.
        let options = TableOptions { max_memory: Memory::UNBOUNDED, ..TableOptions::default() };
        from_columns(source, columns, &[], &options, QualityReport::default())
    }
}

/// As [`from_counted_columns`], for the signals of a log: each has its own rate, so that missing values are normal and
/// not reported.
pub(crate) fn from_sparse_columns(
    source: &str,
    columns: Vec<Column>,
    options: &TableOptions,
    report: QualityReport,
    account: &Account,
) -> Result<Record, TableError> {
    make_record(source, columns, &[], options, report, true, account)
}

fn make_record(
    source: &str,
    columns: Vec<Column>,
    left_out: &[LeftOut],
    options: &TableOptions,
    mut report: QualityReport,
    sparse: bool,
    account: &Account,
) -> Result<Record, TableError> {
    options.check()?;
    let rows = same_length(source, &columns)?;
    // Columns that two channels use are copied.
    let copies: usize = options.columns.iter().map(|mapping| mapping.terms().count()).sum();
    let work = many(rows, BYTES_PER_ROW).saturating_add(many(rows, 8 * copies));
    account.take(work).map_err(|excess| account.over(excess, source, ""))?;
    for column in left_out {
        report.note(format!("column '{}'", column.header), format!("left out: it is {}", column.why));
    }
    let headers: Vec<String> = columns.iter().map(|column| column.header.clone()).collect();
    let units: Vec<String> = columns.iter().map(|column| column.unit.clone().unwrap_or_default()).collect();
    let mut options = options.clone();
    refuse_mapped_left_out(&headers, left_out, &options)?;
    time_by_type(&columns, &mut options, &mut report);
    let head = Head { source, line: None, headers: &headers, units: Some(&units), first_row: None };
    let plan = columns::plan(&head, &options, &mut report).map_err(|error| with_hint(error, left_out))?;
    let (table, untimed) = table(&plan, columns, rows, &options);
    if untimed.count() > 0 {
        let what = plural(untimed.count(), "row");
        report.warn(untimed.place(), format!("{what} left out: no time, or one that is no number"));
    }
    if table.time.is_empty() {
        let reason = match untimed.count() {
            0 => "there is none".to_owned(),
            count => format!("{} without a time ({})", plural(count, "row"), untimed.place()),
        };
        return Err(TableError::NoRows { source_name: source.to_owned(), line: None, reason });
    }
    let text = vec![(Lines::of(Counted::Rows), String::new()); plan.channels.len()];
    record(Read { source, header_line: None, seen: rows, plan, table, text, sparse, clock: None }, &options, report)
}

fn same_length(source: &str, columns: &[Column]) -> Result<usize, TableError> {
    let rows = columns.first().map_or(0, |column| column.values.len());
    match columns.iter().find(|column| column.values.len() != rows) {
        Some(other) => Err(TableError::Length {
            source_name: source.to_owned(),
            header: other.header.clone(),
            found: other.values.len(),
            expected: rows,
        }),
        None => Ok(rows),
    }
}

/// Refuses a mapping to a column that was left out, with what the column is.
fn refuse_mapped_left_out(headers: &[String], left_out: &[LeftOut], options: &TableOptions) -> Result<(), TableError> {
    let same = |wanted: &str, header: &str| wanted.trim().eq_ignore_ascii_case(header.trim());
    let terms = options.columns.iter().flat_map(|mapping| mapping.terms().map(move |(wanted, _)| (mapping, wanted)));
    for (mapping, wanted) in terms {
        let text = left_out.iter().find(|column| same(wanted, &column.header));
        if let Some(column) = text.filter(|_| !headers.iter().any(|header| same(wanted, header))) {
            return Err(TableError::BadMapping {
                channel: mapping.channel.clone(),
                header: wanted.to_owned(),
                problem: Box::new(MappingProblem::NoNumbers { why: column.why.clone() }),
            });
        }
    }
    Ok(())
}

/// If neither a header nor a mapping names the time, and exactly one column is declared as points in time, it is the
/// time.
fn time_by_type(columns: &[Column], options: &mut TableOptions, report: &mut QualityReport) {
    let mapped = options.sample_time_s.is_some() || options.columns.iter().any(|mapping| mapping.channel == "time");
    let named = columns.iter().any(|column| {
        let meaning = header::interpret(&column.header, column.unit.as_deref());
        matches!(meaning, Ok(Meaning::Known { spec, .. }) if spec.name == "time")
    });
    let mut points = columns.iter().filter(|column| column.is_time);
    if let (false, false, Some(column), None) = (mapped, named, points.next(), points.next()) {
        report
            .note(format!("column '{}'", column.header), "taken as the time: the file says that it is points in time");
        let mapping = ColumnMapping::new("time", &column.header);
        options.columns.push(mapping.with_unit(column.unit.as_deref().unwrap_or("s")));
    }
}

/// Adds to the error "no time" the name of a column that was left out but looks like the time.
fn with_hint(error: TableError, left_out: &[LeftOut]) -> TableError {
    let alike = left_out.iter().find(|column| column.header.to_lowercase().contains("time"));
    match (error, alike) {
        (TableError::NoTime { source_name, line, headers, nearest }, Some(column)) if nearest.is_empty() => {
            let nearest = format!(" '{}' looks like it, but is {}.", column.header, column.why);
            TableError::NoTime { source_name, line, headers, nearest }
        }
        (error, _) => error,
    }
}

/// The rows that have a time, converted to SI, and the numbers of those that have none.
fn table(plan: &Plan, columns: Vec<Column>, rows: usize, options: &TableOptions) -> (Table, Lines) {
    let mut columns: Vec<Vec<f64>> = columns.into_iter().map(|column| column.values).collect();
    // Two mappings may use the same column.
    let mut uses = vec![0_usize; columns.len()];
    let used = plan.time.iter().chain(&plan.channels).flat_map(ColumnUse::columns);
    used.for_each(|column| uses.get_mut(column).into_iter().for_each(|count| *count += 1));
    // A column that nothing else uses is converted in place, without a copy.
    let mut si = |used: &ColumnUse| -> Vec<f64> {
        let mut own = match (columns.get_mut(used.column), uses.get(used.column)) {
            (Some(values), Some(1)) => std::mem::take(values),
            (Some(values), _) => values.clone(),
            (None, _) => Vec::new(),
        };
        for (row, value) in own.iter_mut().enumerate() {
            let first = *value;
            *value = used.value(|column| match column == used.column {
                true => first,
                false => columns.get(column).and_then(|values| values.get(row)).copied().unwrap_or(f64::NAN),
            });
        }
        own
    };
    let mut time = match (&plan.time, options.sample_time_s) {
        (Some(used), None) => si(used),
        (_, step) => (0..rows).map(|row| step.unwrap_or(f64::NAN) * row as f64).collect::<Vec<f64>>(),
    };
    let mut values: Vec<Vec<f64>> = plan.channels.iter().map(si).collect();
    let mut untimed = Lines::of(Counted::Rows);
    let mut lines: Vec<usize> = (1..=rows).collect();
    if time.iter().any(|time| !time.is_finite()) {
        let kept: Vec<bool> = time.iter().map(|time| time.is_finite()).collect();
        (1..=rows).zip(&kept).filter(|(_, kept)| !**kept).for_each(|(row, _)| untimed.add(row));
        values.iter_mut().for_each(|column| keep(column, &kept));
        keep(&mut time, &kept);
        keep(&mut lines, &kept);
    }
    (Table { time, counted: Counted::Rows, lines, columns: values }, untimed)
}

fn keep<T>(values: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    values.retain(|_| kept.next().copied().unwrap_or(false));
}
