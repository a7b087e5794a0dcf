//! Reads one cell of text as a number.

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

/// The longest number with a decimal comma that is read, bytes: no number of a recorder has as many digits.
const LONGEST_WITH_COMMA: usize = 64;

/// A cell without the blanks around it.
#[inline]
pub(super) fn trim(text: &str) -> &str {
    // Nearly every cell begins and ends with a visible character of ASCII; blanks of other alphabets are looked for in others.
    match text.as_bytes() {
        [first, .., last] if first.is_ascii_graphic() && last.is_ascii_graphic() => text,
        [only] if only.is_ascii_graphic() => text,
        _ => text.trim(),
    }
}

/// Reads a cell. With `decimal_comma`, `1,5` is one and a half, and `1.5` is text because the point may separate
/// thousands.
#[inline]
pub(super) fn parse(text: &str, decimal_comma: bool) -> Cell {
    let text = trim(text);
    let number = match decimal_comma {
        true => with_decimal_comma(text),
        false => fast_float2::parse(text).ok(),
    };
    match number {
        Some(value) if f64::is_finite(value) => Cell::Value(value),
        number => unusual(text, number.is_some()),
    }
}

/// What a cell holds that is no finite number in the usual way of writing; `is_number` if it is one that is not finite.
#[cold]
fn unusual(text: &str, is_number: bool) -> Cell {
    if text.is_empty() || is_number {
        return Cell::Missing;
    }
    match fortran(text) {
        Some(value) if value.is_finite() => Cell::Value(value),
        Some(_) => Cell::Missing,
        None if is_word_for_missing(text) => Cell::Missing,
        None => Cell::Text,
    }
}

/// A number with a comma or nothing before its decimals; `None` where there is a point or more than one comma.
fn with_decimal_comma(text: &str) -> Option<f64> {
    let mut written = [0; LONGEST_WITH_COMMA];
    let written = written.get_mut(..text.len())?;
    let mut commas = 0;
    for (to, &from) in written.iter_mut().zip(text.as_bytes()) {
        *to = match from {
            b'.' => return None,
            b',' => {
                commas += 1;
                b'.'
            }
            other => other,
        };
    }
    (commas <= 1).then(|| fast_float2::parse(&*written).ok()).flatten()
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
    text.contains(',') && with_decimal_comma(text).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(21), ..ProptestConfig::with_cases(20_000) })]

        /// What is a number, and which, is decided as the standard library decides it.
        #[test]
        fn numbers_are_those_of_the_standard_library(text in "[+-]?[0-9.]{0,20}([eE][+-]?[0-9]{0,3})?|[-+.0-9eEdinfaNt]{1,6}") {
            let expected = text.parse::<f64>().ok().filter(|value| value.is_finite()).map(f64::to_bits);
            let commas = text.replacen('.', ",", 1);
            let without_points = !commas.contains('.');
            for (text, decimal_comma, applies) in [(&text, false, true), (&commas, true, without_points)] {
                match parse(text, decimal_comma) {
                    Cell::Value(value) if fortran(text).is_none() => prop_assert_eq!(Some(value.to_bits()), expected.filter(|_| applies), "{}", text),
                    Cell::Value(_) => {}
                    Cell::Missing | Cell::Text => prop_assert!(expected.is_none() || !applies, "{}", text),
                }
            }
        }

        #[test]
        fn every_number_comes_back_from_its_shortest_text(bits: u64) {
            let value = f64::from_bits(bits);
            if value.is_finite() {
                prop_assert_eq!(parse(&value.to_string(), false), Cell::Value(value));
                prop_assert_eq!(parse(&format!("{value:e}"), false), Cell::Value(value));
            }
        }
    }

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
}
