//! Tables of numbers over one, two or three properties, interpolated linearly and held constant beyond their ends.

use std::cell::Cell;

use roxmltree::Node;

use super::error::JsbsimError;
use super::source::{Source, child, children, parse, shortened, tag, text};

/// One table: rows, columns and pages, of which a table of one variable has only rows.
#[derive(Debug, Clone)]
pub(super) struct Table {
    /// The two-dimensional tables; one, unless the table has breakpoints over a third variable.
    pages: Vec<Page>,
    /// Values of the third variable.
    breaks: Vec<f64>,
}

/// A table of one or two variables.
#[derive(Debug, Clone)]
struct Page {
    rows: Vec<f64>,
    /// Empty for a table of one variable.
    columns: Vec<f64>,
    /// Row by row.
    values: Vec<f64>,
}

impl Table {
    /// The data of a `<table>` with a number of variables.
    pub(super) fn read(source: &Source, node: Node<'_, '_>, dimensions: usize) -> Result<Self, JsbsimError> {
        let data: Vec<_> = children(node).filter(|part| tag(*part) == "tableData").collect();
        match (dimensions, data.as_slice()) {
            (_, []) => Err(source.refuse(node, "the table has no <tableData>")),
            (1 | 2, [one]) => Ok(Self { pages: vec![Page::read(source, *one, dimensions == 2)?], breaks: Vec::new() }),
            (3, pages) => {
                let mut table = Self { pages: Vec::new(), breaks: Vec::new() };
                for &page in pages {
                    let at = page.attribute("breakPoint").and_then(parse);
                    let at = at.ok_or_else(|| source.refuse(page, "the attribute breakPoint holds no number"))?;
                    if table.breaks.last().is_some_and(|&last| last >= at) {
                        return Err(source.refuse(page, format!("the breakpoint {at} does not increase")));
                    }
                    table.breaks.push(at);
                    table.pages.push(Page::read(source, page, true)?);
                }
                Ok(table)
            }
            (1 | 2, _) => Err(source.refuse(node, "a table of one or two variables has more than one <tableData>")),
            _ => Err(source.refuse(node, format!("a table of {dimensions} variables is not supported"))),
        }
    }

    /// A table of numbers, row by row; without columns it has one variable. Keys have to increase, and there has to be a value for
    /// each pair of them.
    pub(super) fn of_numbers(rows: Vec<f64>, columns: Vec<f64>, values: Vec<f64>) -> Self {
        Self { pages: vec![Page { rows, columns, values }], breaks: Vec::new() }
    }

    /// Number of variables that the data of a table without `<independentVar>` are for.
    pub(super) fn dimensions(node: Node<'_, '_>) -> usize {
        let pages = children(node).filter(|part| tag(*part) == "tableData").count();
        let width =
            child(node, "tableData").map_or(0, |data| lines(data).iter().map(|line| line.len()).max().unwrap_or(0));
        if pages > 1 {
            3
        } else if width > 2 {
            2
        } else {
            1
        }
    }

    /// Rows, columns (none for a table of one variable) and values row by row; `None` for a table of three variables.
    pub(super) fn flat(&self) -> Option<(&[f64], &[f64], &[f64])> {
        match self.pages.as_slice() {
            [page] if self.breaks.is_empty() => Some((&page.rows, &page.columns, &page.values)),
            _ => None,
        }
    }

    /// It at a value of the second variable, to be asked at several of the first, near a row that was found before.
    pub(super) fn at_column(&self, column: f64, near: usize) -> Column<'_> {
        let flat = self.flat().map(|(rows, columns, values)| {
            let (place, share) = if columns.is_empty() { (0, 0.0) } else { place(columns, column) };
            Flat { rows, values, width: columns.len().max(1), column: place, share }
        });
        Column { table: self, column, flat, near: Cell::new(near) }
    }

    /// First and last value of a variable: 0 the row, 1 the column, 2 the page.
    pub(super) fn ends(&self, variable: usize) -> Option<[f64; 2]> {
        let page = self.pages.first()?;
        let keys = match variable {
            0 => &page.rows,
            1 => &page.columns,
            _ => &self.breaks,
        };
        Some([*keys.first()?, *keys.last()?])
    }

    /// The value at a row, a column and a page; those that the table does not have are not looked at.
    pub(super) fn value(&self, at: [f64; 3]) -> f64 {
        let page = |index: usize| self.pages.get(index).map_or(f64::NAN, |page| page.value(at[0], at[1]));
        if self.breaks.is_empty() {
            return page(0);
        }
        let (below, share) = place(&self.breaks, at[2]);
        let first = page(below);
        if share == 0.0 { first } else { first + share * (page(below + 1) - first) }
    }
}

impl Page {
    fn read(source: &Source, node: Node<'_, '_>, two: bool) -> Result<Self, JsbsimError> {
        let mut lines = lines(node).into_iter();
        let mut page = Self { rows: Vec::new(), columns: Vec::new(), values: Vec::new() };
        let numbers = |line: &[String]| {
            let parsed: Option<Vec<f64>> = line.iter().map(|word| parse(word)).collect();
            parsed.ok_or_else(|| {
                source.refuse(
                    node,
                    format!("the table holds something else than numbers: \"{}\"", shortened(&line.join(" "))),
                )
            })
        };
        if two {
            page.columns = numbers(&lines.next().unwrap_or_default())?;
        }
        let width = if two { page.columns.len() } else { 1 };
        for line in lines {
            let row = numbers(&line)?;
            if row.len() != width + 1 {
                let row_number = page.rows.len() + 1;
                return Err(source.refuse(
                    node,
                    format!("row {row_number} of the table has {} numbers, not {}", row.len(), width + 1),
                ));
            }
            page.rows.extend_from_slice(&row[..1]);
            page.values.extend_from_slice(&row[1..]);
        }
        if page.rows.is_empty() || width == 0 {
            return Err(source.refuse(node, "the table is empty"));
        }
        for (keys, what) in [(&page.rows, "row"), (&page.columns, "column")] {
            if let Some(pair) = keys.windows(2).find(|pair| pair[0] >= pair[1]) {
                return Err(source.refuse(
                    node,
                    format!("the {what} keys of the table do not increase: {} is followed by {}", pair[0], pair[1]),
                ));
            }
        }
        Ok(page)
    }

    fn value(&self, row: f64, column: f64) -> f64 {
        let (r, row_share) = place(&self.rows, row);
        let width = self.columns.len().max(1);
        let at = |r: usize, c: usize| self.values.get(r * width + c).copied().unwrap_or(f64::NAN);
        let along = |c: usize| {
            let first = at(r, c);
            if row_share == 0.0 { first } else { first + row_share * (at(r + 1, c) - first) }
        };
        if self.columns.is_empty() {
            return along(0);
        }
        let (c, column_share) = place(&self.columns, column);
        let first = along(c);
        if column_share == 0.0 { first } else { first + column_share * (along(c + 1) - first) }
    }
}

/// A table at a value of its second variable.
#[derive(Debug)]
pub(super) struct Column<'a> {
    table: &'a Table,
    column: f64,
    /// Without a third variable.
    flat: Option<Flat<'a>>,
    /// Where the row before was.
    near: Cell<usize>,
}

#[derive(Debug)]
struct Flat<'a> {
    rows: &'a [f64],
    values: &'a [f64],
    width: usize,
    column: usize,
    share: f64,
}

impl Column<'_> {
    /// The row that was found last.
    pub(super) fn row(&self) -> usize {
        self.near.get()
    }

    /// Whether it has, between two rows, nowhere less than at the second; `false` with a third variable.
    pub(super) fn is_least_at_end(&self, [low, high]: [f64; 2]) -> bool {
        let Some(Flat { rows, .. }) = &self.flat else { return false };
        let end = self.value(high);
        // From the end down, and one key below the lower end too: between two keys there is nothing less than at both.
        let (from, _) = place_from(rows, high, self.near.get());
        for &key in rows[..=from].iter().rev().filter(|&&key| key < high) {
            // What is not a number is not least either.
            if self.value(key).partial_cmp(&end).is_none_or(std::cmp::Ordering::is_lt) {
                return false;
            }
            if key <= low {
                break;
            }
        }
        true
    }

    /// The value at a row.
    #[inline]
    pub(super) fn value(&self, row: f64) -> f64 {
        let Some(Flat { rows, values, width, column, share }) = &self.flat else {
            return self.table.value([row, self.column, 0.0]);
        };
        let (r, row_share) = place_from(rows, row, self.near.get());
        self.near.set(r);
        let at = |index: usize| values.get(index).copied().unwrap_or(f64::NAN);
        let along = |start: usize| {
            let first = at(start);
            if row_share == 0.0 { first } else { first + row_share * (at(start + width) - first) }
        };
        let start = r * width + column;
        let first = along(start);
        if *share == 0.0 { first } else { first + share * (along(start + 1) - first) }
    }
}

/// The words of each line that is not empty.
fn lines(node: Node<'_, '_>) -> Vec<Vec<String>> {
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    text(node).lines().map(words).filter(|words| !words.is_empty()).collect()
}

/// As [`place`]; an interval that was found before is looked at first.
#[inline]
pub(super) fn place_from(keys: &[f64], value: f64, before: usize) -> (usize, f64) {
    if let Some(&[low, high]) = keys.get(before..).and_then(<[f64]>::first_chunk)
        && low <= value
        && value < high
    {
        return (before, (value - low) / (high - low));
    }
    match keys {
        [first, ..] if value < *first => (0, 0.0),
        [.., last] if value >= *last => (keys.len() - 1, 0.0),
        _ => place(keys, value),
    }
}

/// The interval of increasing keys that a value lies in, and how far in it from 0 to 1; beyond the ends, the end.
fn place(keys: &[f64], value: f64) -> (usize, f64) {
    let above = keys.partition_point(|&key| key <= value);
    if value.is_nan() {
        return (0, f64::NAN);
    }
    if above == 0 || above >= keys.len() {
        return (above.saturating_sub(1), 0.0);
    }
    let (low, high) = (keys[above - 1], keys[above]);
    (above - 1, (value - low) / (high - low))
}
