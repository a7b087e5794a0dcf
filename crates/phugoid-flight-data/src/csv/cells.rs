//! Reads one cell of text as a number or a time.

/// The content of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// The cell holds a finite number.
    Value(f64),
    /// The cell is empty, or holds a word for a missing value or a number that is not finite.
    Missing,
    /// The cell holds text that is no number.
    Text,
}

/// Reads a cell. With `decimal_comma`, `1,5` is one and a half, and `1.5` is text because the point may separate
/// thousands.
pub(super) fn parse(text: &str, decimal_comma: bool) -> Cell {
    let text = text.trim();
    if text.is_empty() {
        return Cell::Missing;
    }
    let number = match decimal_comma {
        true if text.contains('.') => None,
        true => text.replacen(',', ".", 1).parse::<f64>().ok(),
        false => text.parse::<f64>().ok(),
    };
    match number.or_else(|| fortran(text)) {
        Some(value) if value.is_finite() => Cell::Value(value),
        Some(_) => Cell::Missing,
        None if is_word_for_missing(text) => Cell::Missing,
        None => Cell::Text,
    }
}

/// Reads a number such as `1.5D+03`, as Fortran writes double precision.
fn fortran(text: &str) -> Option<f64> {
    let first = text.bytes().next()?;
    let is_number = first.is_ascii_digit() || matches!(first, b'+' | b'-' | b'.');
    (is_number && text.len() < 40 && text.contains(['d', 'D']))
        .then(|| text.replacen(['d', 'D'], "e", 1).parse().ok())?
}

fn is_word_for_missing(text: &str) -> bool {
    const WORDS: [&str; 14] =
        ["na", "n/a", "#n/a", "null", "none", "nil", "-", "--", "---", "?", "*", "missing", "-nan", "#num!"];
    WORDS.iter().any(|word| text.eq_ignore_ascii_case(word)) || is_nan_with_payload(text)
}

/// True for `nan(ind)`, `-1.#IND`, `1.#QNAN`, `1.#INF`, as C libraries print them.
fn is_nan_with_payload(text: &str) -> bool {
    let lower = text.to_ascii_lowercase();
    let body = lower.trim_start_matches(['+', '-']);
    body.starts_with("nan(") || body.starts_with("1.#")
}

/// True for a number with a decimal comma, such as `1,5` or `-0,03e-2`.
pub(super) fn has_decimal_comma(text: &str) -> bool {
    let text = text.trim();
    text.matches(',').count() == 1 && !text.contains('.') && text.replacen(',', ".", 1).parse::<f64>().is_ok()
}

/// Reads a time of day such as `12:34:56.78` as seconds from midnight, and one with a date such as
/// `2024-05-01T12:34:56Z` as seconds from 1970. The second value is true if there was a date.
pub(super) fn clock(text: &str) -> Option<(f64, bool)> {
    let text = text.trim().trim_end_matches(['Z', 'z']);
    let (date, time) = match text.split_once(['T', 't', ' ']) {
        Some((date, time)) => (Some(date), time),
        None => (None, text),
    };
    let digits = |part: &str, most: usize| -> Option<u32> {
        let good = !part.is_empty() && part.len() <= most && part.bytes().all(|b| b.is_ascii_digit());
        good.then(|| part.parse().ok()).flatten()
    };
    let mut parts = time.trim().splitn(3, ':');
    let (hours, minutes, seconds) = (digits(parts.next()?, 2)?, digits(parts.next()?, 2)?, parts.next()?);
    let plain = seconds.bytes().all(|b| b.is_ascii_digit() || b == b'.' || b == b',');
    let seconds: f64 = plain.then(|| seconds.replacen(',', ".", 1).parse().ok()).flatten()?;
    if hours > 23 || minutes > 59 || !(0.0..61.0).contains(&seconds) {
        return None;
    }
    let of_day = f64::from(hours * 3600 + minutes * 60) + seconds;
    let Some(date) = date else { return Some((of_day, false)) };
    let mut parts = date.trim().splitn(3, '-');
    let (year, month, day) = (digits(parts.next()?, 4)?, digits(parts.next()?, 2)?, digits(parts.next()?, 2)?);
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    // Days since 1970-01-01 in the Gregorian calendar, counted with years that begin in March (a leap day is the last).
    let (year, month) = (i64::from(year) - i64::from(month <= 2), i64::from((month + 9) % 12));
    let days = 365 * year + year.div_euclid(4) - year.div_euclid(100)
        + year.div_euclid(400)
        + (153 * month + 2) / 5
        + i64::from(day)
        - 1
        - 719_468;
    Some((days as f64 * 86_400.0 + of_day, true))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_gaps() {
        assert_eq!(parse(" 1.5e-3 ", false), Cell::Value(1.5e-3));
        assert_eq!(parse("1.5D+03", false), Cell::Value(1500.0));
        assert_eq!(parse("1,5", true), Cell::Value(1.5));
        assert_eq!(parse("1.5", true), Cell::Text);
        assert_eq!(parse("1,5", false), Cell::Text);
        assert_eq!(parse("1.234,5", true), Cell::Text);
        for missing in ["", "  ", "nan", "NaN", "inf", "-Infinity", "1e999", "NULL", "n/a", "-", "nan(ind)", "-1.#IND"]
        {
            assert_eq!(parse(missing, false), Cell::Missing, "{missing}");
        }
        for text in ["abc", "1_000", "0x10", "12 deg", "d", "1..2"] {
            assert_eq!(parse(text, false), Cell::Text, "{text}");
        }
    }

    #[test]
    fn clocks() {
        assert_eq!(clock("00:01:02.5"), Some((62.5, false)));
        assert_eq!(clock("1970-01-01T00:00:00Z"), Some((0.0, true)));
        // `date -u -d 2024-05-01T12:34:56Z +%s`
        assert_eq!(clock("2024-05-01T12:34:56Z"), Some((1_714_566_896.0, true)));
        assert_eq!(clock("2024-02-29 00:00:00"), Some((1_709_164_800.0, true)));
        for text in ["", "1.5", "12:34", "25:00:00", "12:60:00", "12:00:99", "a:b:c", "2024-13-01T00:00:00", "1:2:3:4"]
        {
            assert_eq!(clock(text), None, "{text}");
        }
    }
}
