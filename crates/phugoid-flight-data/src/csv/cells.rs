//! Reads one cell of text as a number.

/// The content of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// The cell holds a finite number.
    Value(f64),
    /// The cell holds a finite number whose thousands are separated: `5 003`, or `5.003,05` in a file with decimal commas.
    Grouped(f64),
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

/// What stands before the decimals of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Point,
    Comma,
    /// Nothing tells: a number with a point or a comma is none.
    Unknown,
}

/// What the way in which a number is written says about the decimal mark of its column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Evidence {
    Nothing,
    Point,
    Comma,
    /// `1.234`: with decimals, or a thousand and more.
    PointOrThousands,
    /// `1,234`, the other way round.
    CommaOrThousands,
}

/// Separates thousands, and nothing else: blanks (also those that do not break a line) and apostrophes.
const SEPARATORS: [char; 6] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '\u{2019}'];

/// What a cell says about the decimal mark.
pub(super) fn evidence(text: &str) -> Evidence {
    let text = trim(text);
    if memchr::memchr2(b'.', b',', text.as_bytes()).is_none() {
        return Evidence::Nothing;
    }
    let by_point = || fast_float2::parse::<f64, _>(text).is_ok();
    let thousands_by = |separator: char, decimal: char| grouped(text, decimal, &[separator]).is_some();
    if by_point() {
        return if thousands_by('.', ',') { Evidence::PointOrThousands } else { Evidence::Point };
    }
    if with_decimal_comma(text).is_some() {
        return if thousands_by(',', '.') { Evidence::CommaOrThousands } else { Evidence::Comma };
    }
    // Both marks, or thousands by another character.
    if thousands_by('.', ',') || grouped(text, ',', &SEPARATORS).is_some() {
        Evidence::Comma
    } else if thousands_by(',', '.') || grouped(text, '.', &SEPARATORS).is_some() {
        Evidence::Point
    } else {
        Evidence::Nothing
    }
}

/// Reads a cell of a column whose decimal mark is known from others: the other mark separates thousands.
pub(super) fn parse_marked(text: &str, mark: Mark) -> Cell {
    let (decimal_comma, other) = match mark {
        Mark::Point => (false, ','),
        Mark::Comma => (true, '.'),
        Mark::Unknown if memchr::memchr2(b'.', b',', text.as_bytes()).is_some() => return Cell::Text,
        Mark::Unknown => return parse(text, false),
    };
    match parse(text, decimal_comma) {
        Cell::Text => {
            let decimal = if decimal_comma { ',' } else { '.' };
            grouped(trim(text), decimal, &[other]).map_or(Cell::Text, Cell::Grouped)
        }
        read => read,
    }
}

/// A number whose thousands are separated, all by the same one of these characters: one to three digits, then groups of three.
fn grouped(text: &str, decimal: char, separators: &[char]) -> Option<f64> {
    let mut separator = None;
    let mut plain = String::new();
    // Digits since the last separator, and whether the decimals or the exponent have begun.
    let (mut digits, mut whole) = (0, true);
    if text.len() > LONGEST_WITH_COMMA {
        return None;
    }
    for character in text.chars() {
        match character {
            '0'..='9' => {
                // No number of thousands begins with a nought.
                if whole && digits == 0 && separator.is_none() && character == '0' {
                    return None;
                }
                digits += 1;
                plain.push(character);
            }
            '+' | '-' if plain.is_empty() || !whole => plain.push(character),
            _ if whole && character == decimal => {
                ends_a_group(separator.is_some(), digits)?;
                whole = false;
                plain.push('.');
            }
            'e' | 'E' => {
                if whole {
                    ends_a_group(separator.is_some(), digits)?;
                }
                whole = false;
                plain.push('e');
            }
            _ if whole && separators.contains(&character) && separator.is_none_or(|first| first == character) => {
                match separator {
                    None if !(1..=3).contains(&digits) => return None,
                    Some(_) if digits != 3 => return None,
                    _ => {}
                }
                separator = Some(character);
                digits = 0;
            }
            _ => return None,
        }
    }
    separator?;
    if whole {
        ends_a_group(true, digits)?;
    }
    fast_float2::parse(plain).ok().filter(|value: &f64| value.is_finite())
}

/// `None` where a number with separators does not end in three digits before its decimals.
fn ends_a_group(separated: bool, digits: usize) -> Option<()> {
    (separated && digits == 3).then_some(())
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
        number => unusual(text, number.is_some(), decimal_comma),
    }
}

/// What a cell holds that is no finite number in the usual way of writing; `is_number` if it is one that is not finite.
#[cold]
fn unusual(text: &str, is_number: bool, decimal_comma: bool) -> Cell {
    if text.is_empty() || is_number {
        return Cell::Missing;
    }
    match fortran(text) {
        Some(value) if value.is_finite() => Cell::Value(value),
        Some(_) => Cell::Missing,
        None if is_word_for_missing(text) => Cell::Missing,
        None => grouped(text, if decimal_comma { ',' } else { '.' }, &SEPARATORS).map_or(Cell::Text, Cell::Grouped),
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
                    Cell::Grouped(_) => prop_assert!(false, "{} has no separator", text),
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
    fn thousands_are_told_from_decimals() {
        for (text, found) in [
            ("5.003", Evidence::PointOrThousands),
            ("-5,003", Evidence::CommaOrThousands),
            ("0.003", Evidence::Point),
            ("0,003", Evidence::Comma),
            ("5003.123", Evidence::Point),
            ("5,00", Evidence::Comma),
            ("1.234.567", Evidence::Comma),
            ("1,234.5", Evidence::Point),
            ("5.003,05", Evidence::Comma),
            ("5 003,05", Evidence::Comma),
            ("5'003.05", Evidence::Point),
            ("1.234e3", Evidence::PointOrThousands),
            ("1.2.3", Evidence::Nothing),
            ("01.05.2024", Evidence::Nothing),
            ("12:30:05,5", Evidence::Nothing),
            ("5003", Evidence::Nothing),
        ] {
            assert_eq!(evidence(text), found, "{text}");
        }
        for (text, mark, cell) in [
            ("5.003", Mark::Comma, Cell::Grouped(5003.0)),
            ("5.003", Mark::Point, Cell::Value(5.003)),
            ("5.003", Mark::Unknown, Cell::Text),
            ("5.003,05", Mark::Comma, Cell::Grouped(5003.05)),
            ("-1.234.567", Mark::Comma, Cell::Grouped(-1_234_567.0)),
            ("5,003", Mark::Point, Cell::Grouped(5003.0)),
            ("5,003.5e1", Mark::Point, Cell::Grouped(50_035.0)),
            ("5 003", Mark::Unknown, Cell::Grouped(5003.0)),
            ("5\u{202f}003,5", Mark::Comma, Cell::Grouped(5003.5)),
            ("5'003", Mark::Point, Cell::Grouped(5003.0)),
            ("5 03", Mark::Point, Cell::Text),
            ("5.03", Mark::Comma, Cell::Text),
            ("5003.123", Mark::Comma, Cell::Text),
            ("1 234'567", Mark::Point, Cell::Text),
            ("1.234.56", Mark::Comma, Cell::Text),
            ("5 003 ", Mark::Point, Cell::Grouped(5003.0)),
        ] {
            assert_eq!(parse_marked(text, mark), cell, "{text} {mark:?}");
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
