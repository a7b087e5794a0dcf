//! A table of results: plain data, without a word on how it is printed.
//!
//! Numbers are SI and radians unless the unit of the column says otherwise. A number that does not exist is NaN (`null` in
//! JSON).

use serde::Serialize;

/// A table: columns with units, and rows with one cell per column.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// What the table shows, as its heading.
    pub title: String,
    /// The columns, from left to right.
    pub columns: Vec<Column>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

/// A column of a table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Column {
    /// Heading of the column, without its unit.
    pub name: String,
    /// Unit as printed; empty for words and pure numbers.
    pub unit: String,
}

impl Column {
    /// A column with this heading and unit; an empty unit is for words and pure numbers.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// A number, in the unit of its column; NaN prints as a dash.
    Number(f64),
    /// Words instead of a number, printed as they are.
    Text(String),
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        Self::Number(value.unwrap_or(f64::NAN))
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}
