//! Results on standard output and in files: aligned text for people, one JSON document for programs.

use phugoid_flight_data::{output_file, printable};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use serde::Serialize;

use crate::failure::Failure;

/// Prints text to standard output, without what a terminal would take for a command.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(printable::lines(text).as_bytes())
        .and_then(|()| out.flush())
        .map_err(|e| Failure::standard_output(&e))
}

/// A result as a JSON document that ends with a line feed. Numbers that are not finite become `null`.
pub(crate) fn json<T: Serialize>(document: &T) -> Result<String, Failure> {
    let mut text = serde_json::to_string_pretty(document).map_err(Failure::impossible)?;
    text.push('\n');
    Ok(printable::json(&text).into_owned())
}

/// Prints a result as JSON or as text for people, and writes the JSON to `file` where one is given.
pub(crate) fn deliver<T: Serialize>(
    document: &T,
    as_json: bool,
    file: Option<&Path>,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    if let Some(file) = file {
        output_file::write(file, json(document)?).map_err(|e| Failure::writing(file, e))?;
    }
    if as_json { print(&json(document)?) } else { print(&text()) }
}

/// Columns of text: words aligned left, numbers right.
pub(crate) struct Table {
    rows: Vec<Vec<String>>,
    left: Vec<usize>,
}

impl Table {
    /// A table with words in the first column only.
    pub(crate) fn new(header: &[&str]) -> Self {
        Self::with_words(header, &[0])
    }

    /// A table with words in these columns, counted from 0.
    pub(crate) fn with_words(header: &[&str], left: &[usize]) -> Self {
        Self { rows: vec![header.iter().map(|h| (*h).to_owned()).collect()], left: left.to_vec() }
    }

    /// A table of names and values.
    pub(crate) fn without_header() -> Self {
        Self { rows: Vec::new(), left: vec![0] }
    }

    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// The table with two blanks in front of each row and between the columns.
    pub(crate) fn render(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.rows.iter().filter_map(|r| r.get(column)).map(|c| c.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for (column, cell) in row.iter().enumerate() {
                let width = widths[column];
                // Writing to a string cannot fail.
                let _ = if self.left.contains(&column) {
                    write!(line, "  {cell:<width$}")
                } else {
                    write!(line, "  {cell:>width$}")
                };
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }
}

/// A number with a fixed count of decimals and no negative zero.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| b == b'0' || b == b'.') => rest.to_owned(),
        _ => text,
    }
}

/// A number with `digits` significant digits, without an exponent where that stays readable.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-5..=8).contains(&exponent) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// Notes as wrapped lines, one after the other.
pub(crate) fn notes_text(notes: &[String]) -> String {
    notes.iter().map(|note| wrapped(&format!("Note: {note}"))).collect()
}

/// A sentence in lines of at most a hundred characters, indented by two and from the second line on by four.
pub(crate) fn wrapped(sentence: &str) -> String {
    const WIDTH: usize = 100;
    let mut text = String::new();
    let mut line = String::from("  ");
    // Blanks at the beginning and between the columns of an event are kept.
    for (index, word) in printable::brief(sentence).split(' ').enumerate() {
        if line.chars().count() + 1 + word.chars().count() > WIDTH {
            text.push_str(line.trim_end());
            text.push('\n');
            line = String::from("    ");
        } else if index > 0 {
            line.push(' ');
        }
        line.push_str(word);
    }
    text.push_str(line.trim_end());
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_sentences_are_wrapped_and_nothing_is_lost() {
        let sentence = "word ".repeat(60);
        let text = wrapped(&sentence);
        assert!(text.lines().all(|l| l.chars().count() <= 100) && text.lines().count() > 3);
        assert_eq!(text.split_whitespace().count(), 60);
        assert_eq!(wrapped("   1.20 s  so"), "     1.20 s  so\n");
    }

    #[test]
    fn numbers_keep_their_significant_digits() {
        for (value, text) in [
            (-1.962_541_015_77, "-1.9625"),
            (0.000_142_1, "0.00014210"),
            (12_345.678, "12346"),
            (1.0e-9, "1.0000e-9"),
            (0.0, "0"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(significant(value, 5), text);
        }
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!((fixed(-1e-9, 3), fixed(-0.1234, 3)), ("0.000".to_owned(), "-0.123".to_owned()));
    }

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(&["name", "value"]);
        table.row(["alpha".into(), "1.5".into()]);
        table.row(["q".into(), "-10.25".into()]);
        assert_eq!(table.render(), "  name    value\n  alpha     1.5\n  q      -10.25\n");
    }
}
