//! The few numbers of every entry that are committed as CSV and compared, so that a change of behaviour is seen.

use std::fmt;

use phugoid_evaluation::table::{Cell, Column, Table};

/// Largest difference that counts as none, in the range of the column's committed numbers (at least a hundredth of their
/// size: an estimate that rests on the truth has a range of rounding errors), or, in a list of results whose rows begin with
/// words, in the size of the number itself. Estimates on one platform repeat bit for bit; between platforms the last bits of sine, exponential and power
/// differ (1e-16), and a run of some thousand steps with its ill-conditioned first ones multiplies that. A change of
/// behaviour worth a look is far above 1e-6.
pub const TOLERANCE: f64 = 1e-6;

/// Numbers of a list below this are rounding errors, and compared as if they were of this size.
const SMALLEST: f64 = 1e-9;

/// Digits written: three more than are compared.
const DIGITS: usize = 10;

/// Instants of a record of which the estimates are committed.
const INSTANTS: usize = 40;

/// Estimates at forty instants, evenly spread over a record of these times (s) and ending with it: a row is the time and the
/// `cells` of the sample of that number, which fill `columns`.
pub(super) fn instants(time: &[f64], columns: Vec<Column>, cells: impl Fn(usize) -> Vec<Cell>) -> Table {
    let mut table = Table { title: "Estimates".to_owned(), columns: vec![Column::new("time", "s")], rows: Vec::new() };
    table.columns.extend(columns);
    let Some(last) = time.len().checked_sub(1) else { return table };
    for instant in 1..=INSTANTS {
        let sample = instant * last / INSTANTS;
        let mut row = vec![Cell::from(time[sample])];
        row.extend(cells(sample));
        table.rows.push(row);
    }
    table
}

/// Where the numbers of an entry are kept: `second-order/3` in `second-order-3.csv`.
pub fn file_name(id: &str) -> String {
    format!("{}.csv", id.replace('/', "-"))
}

/// The table as CSV: a header `name [unit]` per column, numbers with ten significant digits, an empty cell for a number
/// that does not exist.
///
/// # Errors
/// [`GoldenError`] if the rows are not as long as the header, which no CSV can hold.
pub fn write(table: &Table) -> Result<String, GoldenError> {
    let mut writer = csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(Vec::new());
    writer.write_record(table.columns.iter().map(header))?;
    for row in &table.rows {
        writer.write_record(row.iter().map(|cell| match cell {
            Cell::Number(value) => number(*value),
            Cell::Text(words) => words.clone(),
        }))?;
    }
    let bytes = writer.into_inner().map_err(|e| GoldenError(e.to_string()))?;
    String::from_utf8(bytes).map_err(|e| GoldenError(e.to_string()))
}

/// A table that [`write()`] has written; its title is not kept. A cell that reads as a number is one.
///
/// # Errors
/// [`GoldenError`] with the line, if it is no CSV.
pub fn read(text: &str) -> Result<Table, GoldenError> {
    let mut reader = csv::ReaderBuilder::new().from_reader(text.as_bytes());
    let columns = reader
        .headers()?
        .iter()
        .map(|header| match header.strip_suffix(']').and_then(|h| h.rsplit_once(" [")) {
            Some((name, unit)) => Column::new(name, unit),
            None => Column::new(header, ""),
        })
        .collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let cell = |text: &str| match text {
            "" => Cell::Number(f64::NAN),
            text => text.parse().map_or_else(|_| Cell::Text(text.to_owned()), Cell::Number),
        };
        rows.push(record?.iter().map(cell).collect());
    }
    Ok(Table { title: String::new(), columns, rows })
}

/// A CSV that cannot be written or read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct GoldenError(String);

impl From<csv::Error> for GoldenError {
    fn from(error: csv::Error) -> Self {
        Self(error.to_string())
    }
}

/// Something in which found numbers differ from committed ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The columns are not the same.
    Columns {
        /// Headers of the table that was computed now.
        found: Vec<String>,
        /// Headers of the table that is committed.
        committed: Vec<String>,
    },
    /// There are more or fewer rows.
    Rows {
        /// Number of rows computed now.
        found: usize,
        /// Number of rows in the committed table.
        committed: usize,
    },
    /// A cell of both tables differs by more than the tolerance.
    Cell {
        /// Row, counted from 1 below the header.
        row: usize,
        /// The first cell of the row: its time, say.
        at: String,
        /// Header of the cell's column.
        column: String,
        /// What the cell holds in the table that was computed now.
        found: String,
        /// What the cell holds in the committed table.
        committed: String,
        /// Difference of the numbers in the measure of [`TOLERANCE`]; none for words.
        relative: Option<f64>,
    },
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Columns { found, committed } => {
                write!(f, "columns are {}; committed are {}", found.join(", "), committed.join(", "))
            }
            Self::Rows { found, committed } => write!(f, "{found} rows; committed are {committed}"),
            Self::Cell { row, at, column, found, committed, relative } => {
                write!(f, "row {row} ({at}), column `{column}`: {found}; committed is {committed}")?;
                match relative {
                    Some(relative) => write!(f, " (differs by {relative:.1e}, allowed is {TOLERANCE:.0e})"),
                    None => Ok(()),
                }
            }
        }
    }
}

/// Everything in which `found` differs from what was committed by more than [`TOLERANCE`].
pub fn differences(found: &Table, committed: &Table) -> Vec<Difference> {
    let headers = |table: &Table| table.columns.iter().map(header).collect::<Vec<_>>();
    if headers(found) != headers(committed) {
        return vec![Difference::Columns { found: headers(found), committed: headers(committed) }];
    }
    let mut differences = Vec::new();
    if found.rows.len() != committed.rows.len() {
        differences.push(Difference::Rows { found: found.rows.len(), committed: committed.rows.len() });
    }
    for (column, name) in headers(committed).into_iter().enumerate() {
        let range = scale(committed, column);
        for (row, pair) in found.rows.iter().zip(&committed.rows).enumerate() {
            let (Some(new), Some(old)) = (pair.0.get(column), pair.1.get(column)) else { continue };
            let relative = match (new, old) {
                (Cell::Number(new), Cell::Number(old)) => {
                    // What is missing in both, or infinite in the same direction, is equal.
                    let same = new == old || (new.is_nan() && old.is_nan());
                    let listed = matches!(pair.1.first(), Some(Cell::Text(_))) && *old != 0.0 && old.is_finite();
                    let scale = if listed { old.abs().max(SMALLEST) } else { range };
                    let relative = if same { 0.0 } else { (new - old).abs() / scale };
                    if relative <= TOLERANCE {
                        continue;
                    }
                    Some(relative)
                }
                (Cell::Text(new), Cell::Text(old)) if new == old => continue,
                _ => None,
            };
            differences.push(Difference::Cell {
                row: row + 1,
                at: pair.1.first().map_or_else(String::new, printed),
                column: name.clone(),
                found: printed(new),
                committed: printed(old),
                relative,
            });
        }
    }
    differences
}

/// The range of a column's finite numbers, at least a hundredth of the largest.
fn scale(table: &Table, column: usize) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for row in &table.rows {
        if let Some(Cell::Number(value)) = row.get(column)
            && value.is_finite()
        {
            low = low.min(*value);
            high = high.max(*value);
        }
    }
    let scale = (high - low).max(0.01 * low.abs().max(high.abs()));
    // A column of zeros, or without numbers, has no scale of its own.
    if scale > 0.0 && scale.is_finite() { scale } else { 1.0 }
}

fn header(column: &Column) -> String {
    if column.unit.is_empty() { column.name.clone() } else { format!("{} [{}]", column.name, column.unit) }
}

fn printed(cell: &Cell) -> String {
    match cell {
        Cell::Number(value) if value.is_nan() => "no number".to_owned(),
        Cell::Number(value) => number(*value),
        Cell::Text(words) => format!("`{words}`"),
    }
}

/// Ten significant digits without idle zeros; nothing for a number that does not exist.
fn number(value: f64) -> String {
    if value.is_nan() {
        return String::new();
    }
    // Rounded in decimals and read back: the shortest text of that number has no more digits.
    let rounded = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
    // Zero has no sign.
    let rounded = if rounded == 0.0 { 0.0 } else { rounded };
    let size = rounded.abs();
    if size == 0.0 || (1e-5..1e12).contains(&size) || !size.is_finite() {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn table(values: &[f64]) -> Table {
        Table {
            title: String::new(),
            columns: vec![Column::new("time", "s"), Column::new("a1", "1/s^2"), Column::new("verdict", "")],
            rows: values
                .iter()
                .enumerate()
                .map(|(k, v)| vec![Cell::Number(0.5 * k as f64), Cell::Number(*v), "rests, biased".into()])
                .collect(),
        }
    }

    #[test]
    fn what_is_written_can_be_read_by_people_and_by_us() {
        let text = write(&table(&[1.0 / 3.0, f64::NAN, -1e-9])).unwrap();
        assert_eq!(
            text,
            "time [s],a1 [1/s^2],verdict\n0,0.3333333333,\"rests, biased\"\n0.5,,\"rests, biased\"\n\
             1,-1e-9,\"rests, biased\"\n"
        );
        assert!(differences(&table(&[1.0 / 3.0, f64::NAN, -1e-9]), &read(&text).unwrap()).is_empty());
    }

    #[test]
    fn a_difference_is_told_with_its_place_and_size() {
        let committed = table(&[8.0, 6.0, 7.0]);
        let mut found = committed.clone();
        // A millionth of the column's range of 2 is still equal; twice that is not.
        found.rows[1][1] = Cell::Number(6.0 + 1.9e-6);
        assert_eq!(differences(&found, &committed), []);
        found.rows[1][1] = Cell::Number(6.0 + 4e-6);
        found.rows[2][2] = "diverges".into();
        let told: Vec<String> = differences(&found, &committed).iter().map(ToString::to_string).collect();
        assert_eq!(
            told,
            [
                "row 2 (0.5), column `a1 [1/s^2]`: 6.000004; committed is 6 (differs by 2.0e-6, allowed is 1e-6)",
                "row 3 (1), column `verdict`: `diverges`; committed is `rests, biased`",
            ]
        );
        found.rows.pop();
        assert_eq!(differences(&found, &committed)[0].to_string(), "2 rows; committed are 3");
        found.columns[1].unit = "s".to_owned();
        assert!(matches!(differences(&found, &committed).as_slice(), [Difference::Columns { .. }]));
        // An estimate that rests on the truth has a range of rounding errors, which nobody compares.
        assert_eq!(differences(&table(&[6.0, 6.0 + 2e-10, 6.0]), &table(&[6.0, 6.0 + 1e-10, 6.0])), []);
        assert_eq!(differences(&table(&[6.0, 6.0 + 1e-7, 6.0]), &table(&[6.0, 6.0, 6.0])).len(), 1);
        // A number that has gone missing, or come, is a difference.
        let gone = differences(&table(&[8.0, f64::NAN, 7.0]), &committed);
        assert!(gone[0].to_string().contains("no number; committed is 6"), "{}", gone[0]);
        assert_eq!(differences(&committed, &table(&[8.0, f64::NAN, 7.0])).len(), 1);
    }

    #[test]
    fn results_in_a_list_are_each_compared_in_their_own_size() {
        let list = |small: f64| Table {
            title: String::new(),
            columns: vec![Column::new("what", ""), Column::new("value", "")],
            rows: vec![vec!["gain".into(), 1e6.into()], vec!["error".into(), small.into()]],
        };
        assert_eq!(differences(&list(1e-3), &list(1e-3 + 1e-10)), []);
        assert_eq!(differences(&list(1e-3 + 1e-8), &list(1e-3)).len(), 1);
        // Rounding errors are nobody's behaviour.
        assert_eq!(differences(&list(3e-16), &list(1e-16)), []);
    }

    proptest! {
        #[test]
        fn any_numbers_survive_within_the_tolerance(
            values in prop::collection::vec(prop::num::f64::ANY, 1..20), words in "[ -~]{0,12}",
        ) {
            let mut table = table(&values);
            table.rows[0][2] = Cell::Text(format!("w{words}"));
            let back = read(&write(&table).unwrap()).unwrap();
            prop_assert_eq!(differences(&table, &back), []);
        }
    }
}
