//! Finds the time of a table whose headers do not say `time`: a column of clock times, or one of another name for it.

use crate::channels;
use crate::quality::QualityReport;
use crate::table::clock::Clock;
use crate::table::columns::{ColumnUse, Head};
use crate::table::header;
use crate::units::Quantity;

/// Names of time columns in the languages of spreadsheets and recorders, in lower case and letters alone. They are taken for
/// the time only where nothing else in the table is.
const NAMES: &[&str] = &[
    "datetime",
    "dateandtime",
    "timeofday",
    "tod",
    "utc",
    "utctime",
    "timeutc",
    "timestamputc",
    "gpstime",
    "localtime",
    "clock",
    "clocktime",
    "systemtime",
    "unixtime",
    "unix",
    "epoch",
    "epochtime",
    "posixtime",
    "irig",
    "irigtime",
    "sec",
    "secs",
    "second",
    "seconds",
    "msec",
    "millis",
    "milliseconds",
    "zeit",
    "uhrzeit",
    "zeitstempel",
    "heure",
    "temps",
    "horodatage",
    "hora",
    "tiempo",
    "tempo",
    "ora",
    "tid",
    "tijd",
    "czas",
];

/// Takes the column of the time from the columns whose names are not known, and says so in the report; `None` if none or
/// several could be it.
pub(super) fn take(head: &Head<'_>, uses: &mut Vec<ColumnUse>, report: &mut QualityReport) -> Option<ColumnUse> {
    let clock = |column: &ColumnUse| {
        head.first_row.and_then(|cells| cells.get(column.column)).is_some_and(|cell| Clock::is_one(cell))
    };
    let unknown = || uses.iter().filter(|column| column.spec.is_none());
    let (found, by_content) = match unknown().find(|column| clock(column)) {
        Some(first) => (first.column, true),
        None => {
            // Of a header line alone it is not even known yet what separates its cells.
            let whole = head.line.is_some() || head.units.is_some();
            let alike = || only(unknown().filter(|c| whole && is_alike(c)));
            (only(unknown().filter(|c| is_named(c))).or_else(alike)?, false)
        }
    };
    let others: Vec<&str> =
        unknown().filter(|c| by_content && c.column != found && clock(c)).map(|c| c.header.as_str()).collect();
    let others = match others.as_slice() {
        [] => String::new(),
        others => format!("; the clock times in '{}' are left out", others.join("', '")),
    };
    let index = uses.iter().position(|column| column.column == found)?;
    let mut time = uses.remove(index);
    let place = format!("column '{}'", time.header);
    // What was doubted about it is settled.
    report.findings.retain(|finding| finding.place != place);
    if by_content {
        report.note(place, format!("taken as the time: it holds clock times{others}"));
    } else {
        report.note(place, "taken as the time: no other column can be it");
    }
    let stated = (time.unit.quantity == Quantity::Time).then_some(time.unit).or_else(|| unit_in_name(&time.header));
    time.name = "time".to_owned();
    time.spec = channels::by_name("time");
    time.unit_assumed = stated.is_none() && !by_content;
    time.unit = stated.unwrap_or_else(|| super::columns::si(Quantity::Time));
    Some(time)
}

fn only<'a>(mut columns: impl Iterator<Item = &'a ColumnUse>) -> Option<usize> {
    columns.next().filter(|_| columns.next().is_none()).map(|column| column.column)
}

/// The unit that a name is by itself: `seconds`, `msec`.
fn unit_in_name(header: &str) -> Option<crate::units::Unit> {
    let key = channels::key(header);
    let symbol = match key.as_str() {
        "sec" | "secs" | "second" | "seconds" => "s",
        "msec" | "millis" | "milliseconds" => "ms",
        _ => return header::unit_for(header, None, Quantity::Time),
    };
    crate::units::find_for(symbol, Quantity::Time)
}

/// Whether the unit of a column, where one is known, is one of time.
fn may_be_time(column: &ColumnUse) -> bool {
    matches!(column.unit.quantity, Quantity::Time | Quantity::Number)
}

fn is_named(column: &ColumnUse) -> bool {
    let names = header::names(&column.header);
    may_be_time(column) && names.iter().any(|name| NAMES.contains(&channels::key(name).as_str()))
}

fn is_alike(column: &ColumnUse) -> bool {
    let key = channels::key(&column.header);
    may_be_time(column) && (key.contains("time") || key.contains("zeit"))
}
