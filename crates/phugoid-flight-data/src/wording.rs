//! Numbers, counts, places and lists as they stand in messages.

use std::fmt;

/// A number to at most six significant digits without trailing zeros, for messages.
pub(crate) struct Short(pub(crate) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if value == 0.0 || !value.is_finite() {
            return write!(f, "{value}");
        }
        let magnitude = value.abs().log10().floor();
        if !(-4.0..9.0).contains(&magnitude) {
            return write!(f, "{value:.4e}");
        }
        let decimals = (5.0 - magnitude).clamp(0.0, 9.0) as usize;
        let text = format!("{value:.decimals$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        f.write_str(text)
    }
}

/// A time (s) with as many digits as it takes to tell samples apart.
pub(crate) struct Precise(pub(crate) f64);

impl fmt::Display for Precise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Microseconds; zeros behind say nothing.
        let text = format!("{:.6}", self.0);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

/// What a place in a table is counted in, from 1: lines of a text file, as an editor shows them, or rows of numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Counted {
    #[default]
    Lines,
    Rows,
}

impl Counted {
    pub(crate) fn one(self) -> &'static str {
        match self {
            Counted::Lines => "line",
            Counted::Rows => "row",
        }
    }

    pub(crate) fn several(self) -> &'static str {
        match self {
            Counted::Lines => "lines",
            Counted::Rows => "rows",
        }
    }
}

/// A count of lines or rows, with the numbers of the first few.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines {
    counted: Counted,
    count: usize,
    first: Vec<usize>,
}

impl Lines {
    const MAX_SHOWN: usize = 8;

    pub(crate) fn of(counted: Counted) -> Self {
        Self { counted, ..Self::default() }
    }

    pub(crate) fn add(&mut self, line: usize) {
        self.count += 1;
        if self.first.len() < Self::MAX_SHOWN {
            self.first.push(line);
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The lines as text: `line 7`, `rows 7, 9, 12` or `lines 7, 9, ... (40 in all)`.
    pub(crate) fn place(&self) -> String {
        let shown: Vec<_> = self.first.iter().map(usize::to_string).collect();
        let shown = shown.join(", ");
        match self.count {
            1 => format!("{} {shown}", self.counted.one()),
            count if count > self.first.len() => {
                format!("{} {shown}, ... ({count} in all)", self.counted.several())
            }
            _ => format!("{} {shown}", self.counted.several()),
        }
    }
}

/// A count with its noun: `1 row`, `2 rows`.
pub(crate) fn plural(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// The headers in one line, at most 20 of them, for messages.
pub(crate) fn list(headers: &[String]) -> String {
    const MAX_SHOWN: usize = 20;
    let shown: Vec<String> = headers.iter().take(MAX_SHOWN).map(|header| cut(header, 40)).collect();
    let more = headers.len().saturating_sub(MAX_SHOWN);
    if more > 0 { format!("{}, ... and {more} more", shown.join(", ")) } else { shown.join(", ") }
}

/// At most `length` characters of a text, for messages.
pub(crate) fn cut(text: &str, length: usize) -> String {
    match text.char_indices().nth(length) {
        Some((end, _)) => format!("{}...", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers() {
        for (value, text) in [
            (0.0, "0"),
            (0.1, "0.1"),
            (-12.5, "-12.5"),
            (123456.7, "123457"),
            (9.80665, "9.80665"),
            (1e12, "1.0000e12"),
            (2e-7, "2.0000e-7"),
            (1000.0, "1000"),
            (0.001, "0.001"),
        ] {
            assert_eq!(Short(value).to_string(), text);
        }
    }

    #[test]
    fn long_lists_of_lines_are_cut() {
        let mut lines = Lines::default();
        (1..=40).for_each(|line| lines.add(line));
        assert_eq!(lines.place(), "lines 1, 2, 3, 4, 5, 6, 7, 8, ... (40 in all)");
    }
}
