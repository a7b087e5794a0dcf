//! Makes the record of the rows of a table that are already converted to SI.

use crate::channels;
use crate::plausibility::{self, unit_of_step};
use crate::quality::{ChannelQuality, Finding, QualityReport};
use crate::record::{Channel, Record};
use crate::statistics::median;
use crate::table::clock::{self, Clock};
use crate::table::columns::{self, ColumnUse, Plan};
use crate::table::time_base::{self, Table};
use crate::table::{TableError, TableOptions, derived, markers, stuck_and_spikes};
use crate::wording::{Lines, Precise, Short, plural};

/// What each row takes besides its values, bytes: its time, its number, and what is needed to put the rows in order and
/// to check them (seven lists of numbers at the most, one after the other).
pub(crate) const BYTES_PER_ROW: usize = 9 * 8;

/// The rows of a table that have a time, and what its reader noticed on the way.
pub(crate) struct Read<'a> {
    pub(crate) source: &'a str,
    pub(crate) header_line: Option<usize>,
    /// Number of rows of the table, kept or not.
    pub(crate) seen: usize,
    pub(crate) plan: Plan,
    /// One column per channel of the plan.
    pub(crate) table: Table,
    /// Per channel: the rows whose cell is text, and the first such text.
    pub(crate) text: Vec<(Lines, String)>,
    /// True if the signals have rates of their own, so that missing values are normal and not reported.
    pub(crate) sparse: bool,
    /// The clock that the times were read from; `None` where they are numbers.
    pub(crate) clock: Option<Clock>,
}

/// Puts the rows in the order of time, makes the channels, and completes the quality report.
pub(crate) fn record(read: Read<'_>, options: &TableOptions, mut report: QualityReport) -> Result<Record, TableError> {
    let Read { source, header_line, seen, mut plan, mut table, text, sparse, clock } = read;
    let time_header = plan.time.as_ref().map_or("(row number)", |column| column.header.as_str()).to_owned();
    if let Some(column) = plan.time.as_mut().filter(|column| column.unit_assumed) {
        match unit_of_time(&table.time) {
            Some((symbol, unit)) => read_as(column, symbol, unit, &mut table.time, &mut report),
            None if are_day_numbers(&table.time) => read_as_days(column, &mut table.time, &mut report),
            None => columns::report_assumed_unit(column, &mut report),
        }
    }
    let (timed, first) = (table.time.len(), table.time.first().copied().unwrap_or(f64::NAN));
    let all_equal = timed > 1 && table.time.iter().all(|time| *time == first);
    time_base::put_in_order(&mut table, source, &time_header, &mut report)?;
    if table.time.len() < 2 {
        let reason = match all_equal {
            true => format!(
                "all {timed} rows have the same time, {} s in the column '{time_header}': it is written with too few digits. Write \
                 more digits, or give the time from row to row (--sample-time 0.02s)",
                Precise(first)
            ),
            false => "only one time is left; a record needs at least two".to_owned(),
        };
        return Err(TableError::NoRows { source_name: source.to_owned(), line: header_line, reason });
    }
    count_from_first(&mut table.time, clock.as_ref(), options, &mut report);
    let mut record = Record { source: source.to_owned(), time: table.time, ..Record::default() };
    report.rows_read = seen;
    report.rows_kept = record.time.len();
    report.sample_time_s = record.sample_time_s();
    let assumed = plan.time.as_ref().is_some_and(|column| column.unit_assumed);
    if assumed && report.sample_time_s >= 1.0 {
        let step = Short(report.sample_time_s);
        report.warn("time", format!("the rows are {step} s apart: if the time is in milliseconds, write time_ms"));
    }
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
    let mut few_missing = Vec::new();
    for ((column, mut values), (text, example)) in plan.channels.into_iter().zip(table.columns).zip(text) {
        take_markers(&column, &mut values, &mut report);
        if let Some(channel) = make_channel(&column, values, &text, &example, sparse, &mut few_missing, &mut report) {
            report.channels.push(quality_of(&column, channel.values.iter().filter(|value| value.is_nan()).count()));
            record.channels.push(channel);
        }
    }
    if !few_missing.is_empty() && !sparse {
        report.note(
            "",
            format!("values missing in {} rows: {}; nothing is filled in", report.rows_kept, few_missing.join(", ")),
        );
    }
    // Before the doubts, so that a wrong sign of what it follows from is a doubt about what an estimation reads.
    derived::complete(&mut record, &mut report);
    record.quality = report;
    stuck_and_spikes::check(&mut record);
    let doubts = plausibility::check(&record);
    record.quality.findings.extend(doubts.into_iter().map(Finding::from));
    Ok(record)
}

/// Times from this one on are those of a calendar or of a clock, and no time of a flight, s.
const CALENDAR_S: f64 = 86_400.0;
/// Times that begin within this of zero count from the first row as they are, s: recorders give the first sample the time of its
/// step or of their start.
const NEAR_ZERO_S: f64 = 1.0;

/// Counts the times of a clock or of a calendar from the first row, and where the options ask for it all others too, so that 4 s is
/// four seconds into the record.
fn count_from_first(time: &mut [f64], clock: Option<&Clock>, options: &TableOptions, report: &mut QualityReport) {
    let Some(&first) = time.first() else { return };
    let stays = if options.count_from_first { NEAR_ZERO_S } else { CALENDAR_S };
    // A given sample time counts the rows already.
    if clock.is_none() && (first.abs() <= stays || options.sample_time_s.is_some()) {
        return;
    }
    time.iter_mut().for_each(|t| *t -= first);
    report.start = clock.and_then(|clock| clock.start(first));
    report.time_of_day_at_zero_s = clock.and_then(|clock| clock.time_of_day(first));
    let first = clock.map_or_else(|| format!("{first:.3} s"), |clock| clock.written(first));
    report.note("time", format!("counts from the first row, which is at {first}"));
    if let Some(turns) = clock.map(Clock::turns).filter(|turns| *turns > 0.0) {
        report.note("time", format!("the clock begins again {}; counted on", plural(turns as usize, "time")));
    }
    if let Some(changes) = clock.map(Clock::changes).filter(|changes| *changes > 0) {
        report.warn(
            "time",
            format!(
                "the local clock is changed by an hour on the full hour {}, as at the begin or the end of summer time; counted on \
                 without the change",
                plural(changes, "time")
            ),
        );
    }
}

/// Rows from which on the step of the time says its unit.
const ENOUGH_ROWS: usize = 20;

/// The unit of times that were read as seconds and cannot be: its symbol and how many seconds it is.
fn unit_of_time(time: &[f64]) -> Option<(&'static str, f64)> {
    // Rows may be in disorder, and rows of equal time are merged later.
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    (steps.len() >= ENOUGH_ROWS).then(|| median(&mut steps).and_then(unit_of_step)).flatten()
}

/// The day numbers of spreadsheets that flights can have, and the steps between rows, s, of a recorder.
const DAY_NUMBERS: std::ops::Range<f64> = 10_000.0..100_000.0;
const STEPS_S: std::ops::RangeInclusive<f64> = 5e-4..=2.0;

/// Whether times are the day numbers in which a spreadsheet keeps dates (45413.5 is noon on 2024-05-01): no recorder has steps
/// of microseconds.
fn are_day_numbers(time: &[f64]) -> bool {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    time.iter().all(|t| DAY_NUMBERS.contains(t))
        && steps.len() >= ENOUGH_ROWS
        && median(&mut steps).is_some_and(|step| STEPS_S.contains(&(step * clock::DAY)))
}

/// Reads day numbers, counted from the first of them so that no digit is lost, and says so.
fn read_as_days(column: &mut ColumnUse, time: &mut [f64], report: &mut QualityReport) {
    let first = time.first().copied().unwrap_or(0.0);
    time.iter_mut().for_each(|t| *t = (*t - first) * clock::DAY);
    column.scale *= clock::DAY;
    report.warn(
        format!("column '{}'", column.header),
        format!(
            "no unit is written, and its values are the day numbers of a spreadsheet, the first of them {first:.6}: taken as \
             days and counted from the first row. Write the times as clock times or as seconds (time_s)",
        ),
    );
}

/// Reads the times in another unit than seconds, and says so.
fn read_as(column: &mut ColumnUse, symbol: &str, seconds: f64, time: &mut [f64], report: &mut QualityReport) {
    time.iter_mut().for_each(|t| *t *= seconds);
    column.scale *= seconds;
    report.warn(
        format!("column '{}'", column.header),
        format!(
            "no unit is written, and its steps are those of a recorder in {symbol}: taken as {symbol}. Write the unit into \
             the header: time_{symbol}, or time_s if it is in seconds",
        ),
    );
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

/// Makes the channel of a column and reports what is missing in it (a few missing values go to `few_missing`, to be
/// reported together). `None` for a column without numbers that is no known channel.
/// Takes the numbers that stand for "no value" out of a column, and says so.
fn take_markers(column: &ColumnUse, values: &mut [f64], report: &mut QualityReport) {
    // A sum of columns has no one number in the file.
    if channels::by_name(&column.name).is_none() || !column.plus.is_empty() {
        return;
    }
    if let Some((marker, count)) = markers::take(values, |raw| column.unit.to_si(column.scale * raw)) {
        let cells = plural(count, "cell");
        let message = format!("{cells} of {} hold {marker}, far from all other values: taken as missing", column.name);
        report.warn(format!("column '{}'", column.header), message);
    }
}

fn make_channel(
    column: &ColumnUse,
    values: Vec<f64>,
    text: &Lines,
    example: &str,
    sparse: bool,
    few_missing: &mut Vec<String>,
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
    } else if missing > 0 && !sparse {
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
            false => few_missing.push(format!("{missing} in {}", column.name)),
        }
    }
    Some(Channel { name: column.name.clone(), quantity: column.unit.quantity, values })
}
