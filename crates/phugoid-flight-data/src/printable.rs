//! Text of strangers (headers, names of channels and files, messages of logs) made safe to show.
//!
//! A header can hold the escape sequences of a terminal, a file name a line end, and either the characters that reverse
//! the direction of what follows. They are replaced where names enter ([`one_line`], [`cell`]) and where text leaves
//! for people ([`lines`]) or for programs ([`json`], [`toml_string`]).

use std::borrow::Cow;
use std::path::Path;

/// Takes the place of a character that must not be shown.
pub const REPLACEMENT: char = '\u{fffd}';

/// Whether a character is a command rather than a sign: control characters (C0, delete, C1), and those that change the
/// direction of the text around them (U+202A to U+202E, U+2066 to U+2069).
pub fn is_command(character: char) -> bool {
    character.is_control() || matches!(character, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The text on one line: tabs and line ends become blanks, other commands [`REPLACEMENT`].
///
/// ```
/// use phugoid_flight_data::printable::one_line;
/// assert_eq!(one_line("alpha\n[deg]"), "alpha [deg]");
/// assert_eq!(one_line("red \u{1b}[31m"), "red \u{fffd}[31m");
/// ```
pub fn one_line(text: &str) -> Cow<'_, str> {
    replaced(text, is_command, |character| if matches!(character, '\t' | '\n' | '\r') { ' ' } else { REPLACEMENT })
}

/// The text with its lines and tabs, all other commands replaced by [`REPLACEMENT`].
pub fn lines(text: &str) -> Cow<'_, str> {
    replaced(text, |character| is_command(character) && !matches!(character, '\n' | '\t'), |_| REPLACEMENT)
}

fn replaced(text: &str, wanted: impl Fn(char) -> bool, by: impl Fn(char) -> char) -> Cow<'_, str> {
    match text.contains(&wanted) {
        true => text.chars().map(|character| if wanted(character) { by(character) } else { character }).collect(),
        false => text.into(),
    }
}

/// A JSON document in which the commands that JSON allows as they are (delete, C1, directions) are written as escapes:
/// the same content for whoever reads it.
///
/// ```
/// use phugoid_flight_data::printable::json;
/// assert_eq!(json("{\"name\": \"a\u{202e}b\"}"), "{\"name\": \"a\\u202eb\"}");
/// ```
pub fn json(document: &str) -> Cow<'_, str> {
    let hidden = |character: char| is_command(character) && !character.is_ascii_whitespace();
    if !document.contains(hidden) {
        return document.into();
    }
    let mut text = String::with_capacity(document.len());
    for character in document.chars() {
        match hidden(character) {
            // All of them have sixteen bits.
            true => text.push_str(&format!("\\u{:04x}", u32::from(character))),
            false => text.push(character),
        }
    }
    text.into()
}

/// A string of TOML with its quotes, whatever the text is.
///
/// ```
/// use phugoid_flight_data::printable::toml_string;
/// assert_eq!(toml_string("a \"b\" \\ \u{1b}"), r#""a \"b\" \\ \u001B""#);
/// ```
pub fn toml_string(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => quoted.extend(['\\', character]),
            command if is_command(command) => quoted.push_str(&format!("\\u{:04X}", u32::from(command))),
            other => quoted.push(other),
        }
    }
    quoted + "\""
}

/// Whether a table calculation would take the text of a cell for a formula.
pub fn is_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@'])
}

/// A text as a cell of a table that no table calculation takes for a formula: on one line, and with an apostrophe
/// before `=`, `+`, `-` and `@`. Numbers are not for this function.
pub fn cell(text: &str) -> Cow<'_, str> {
    let text = one_line(text);
    if is_formula(&text) { format!("'{text}").into() } else { text }
}

/// A header as the name of a channel of its own: a [`cell`], so that it can be written as a header again.
pub(crate) fn channel_name(header: &str) -> String {
    cell(header).into_owned()
}

/// The name of a file for people, on one line.
pub fn path(path: &Path) -> String {
    one_line(&path.display().to_string()).into_owned()
}

/// Longest word that a message shows whole, characters: no name of a file is longer.
const LONGEST_WORD: usize = 255;
/// What is shown of a longer one.
const SHOWN_OF_WORD: usize = 60;
/// Longest line of a message, characters.
const LONGEST_LINE: usize = 2000;
/// More digits than these before the point say nothing to a person.
const MOST_DIGITS: usize = 20;

/// A message in which nothing is too long to be read, whatever a file has put into it: of a word of more than 255 characters the
/// beginning is shown, of a line its first 2000 characters, and a number of more than 20 digits before the point has an exponent.
///
/// ```
/// use phugoid_flight_data::printable::brief;
/// assert_eq!(brief(&format!("speed {:.1} m/s", -1e300)), "speed -1.000e300 m/s");
/// assert!(brief(&format!("unknown key `{}`: leave it out", "A".repeat(1000))).ends_with("AAA...`: leave it out"));
/// assert_eq!(brief("airspeed 104.6 m/s"), "airspeed 104.6 m/s");
/// ```
pub fn brief(text: &str) -> Cow<'_, str> {
    let is_long_word = |word: &str| word.len() > LONGEST_WORD && word.chars().count() > LONGEST_WORD;
    let has_digits = text
        .as_bytes()
        .chunk_by(|a, b| a.is_ascii_digit() == b.is_ascii_digit())
        .any(|part| part.len() > MOST_DIGITS && part.first().is_some_and(u8::is_ascii_digit));
    let is_long =
        has_digits || text.split_whitespace().any(is_long_word) || text.lines().any(|l| l.len() > LONGEST_LINE);
    if !is_long {
        return text.into();
    }
    let mut shown = String::new();
    for line in text.split_inclusive('\n') {
        let mut of_line = String::new();
        for word in line.split_inclusive(char::is_whitespace) {
            let number = with_exponents(word);
            match is_long_word(number.trim_end()) {
                true => of_line.push_str(&beginning(&number)),
                false => of_line.push_str(&number),
            }
        }
        match of_line.char_indices().nth(LONGEST_LINE) {
            Some((end, _)) => {
                shown.push_str(of_line.get(..end).unwrap_or_default());
                shown.push_str(if of_line.ends_with('\n') { " ...\n" } else { " ..." });
            }
            None => shown.push_str(&of_line),
        }
    }
    shown.into()
}

/// The beginning of a long word, with the signs at its end that belong to the sentence.
fn beginning(word: &str) -> String {
    let is_sign = |character: char| character.is_whitespace() || "`'\"()[]{},.:;".contains(character);
    let kept = word.trim_end_matches(is_sign).len();
    let mut shown: String = word.chars().take(SHOWN_OF_WORD).collect();
    shown.push_str("...");
    shown.extend(word.get(kept..).unwrap_or_default().chars().take(SHOWN_OF_WORD));
    shown
}

/// A word with an exponent in each number that has too many digits before its point.
fn with_exponents(word: &str) -> String {
    let mut shown = String::new();
    let mut rest = word;
    while let Some(start) = rest.find(|character: char| character.is_ascii_digit()) {
        let (before, from) = rest.split_at(start);
        shown.push_str(before);
        let digits = from.find(|character: char| !character.is_ascii_digit()).unwrap_or(from.len());
        let (whole, after) = from.split_at(digits);
        // Digits behind a point, and those in a name or a hash, are no whole number.
        let is_number = !shown.ends_with(|c: char| c.is_alphanumeric() || matches!(c, '.' | '_'))
            && !after.starts_with(|c: char| c.is_alphabetic() || c == '_');
        if digits <= MOST_DIGITS || !is_number {
            shown.push_str(whole);
            rest = after;
            continue;
        }
        let fraction = after.strip_prefix('.').map_or(0, |decimals| {
            let count = decimals.find(|character: char| !character.is_ascii_digit()).unwrap_or(decimals.len());
            if count > 0 { count + 1 } else { 0 }
        });
        match whole.parse::<f64>() {
            Ok(value) => shown.push_str(&format!("{value:.3e}")),
            Err(_) => shown.push_str(whole),
        }
        rest = after.get(fraction..).unwrap_or_default();
    }
    shown + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_replaced_and_nothing_else() {
        let commands = (0..=0x1f).chain(0x7f..=0x9f).chain(0x202a..=0x202e).chain(0x2066..=0x2069);
        for code in commands {
            let character = char::from_u32(code).unwrap();
            let shown = one_line(&character.to_string()).into_owned();
            assert!(shown == " " || shown == "\u{fffd}", "{code:x}");
            let text = format!("\"a{character}b\"");
            let read: toml::Value = format!("x = {}", toml_string(&text)).parse::<toml::Table>().unwrap()["x"].clone();
            assert_eq!(read.as_str(), Some(text.as_str()), "{code:x}");
        }
        assert_eq!(lines("a\n\tb\r\u{9b}2J\u{2067}c"), "a\n\tb\u{fffd}\u{fffd}2J\u{fffd}c");
        for text in ["alpha [\u{b0}]", "Höhe über Grund", "攻角", "a\u{a0}b", "\u{5d0}\u{5d1}"] {
            assert!(matches!(one_line(text), Cow::Borrowed(same) if same == text), "{text}");
        }
    }

    #[test]
    fn what_is_long_is_shortened_and_nothing_else() {
        for text in
            ["", "a b\n  12 | x = 0.30000000000000000000000000000004\n", "sha 1234567890123456789012345abc", "12.5 s"]
        {
            assert!(matches!(brief(text), Cow::Borrowed(_)) || brief(text) == text, "{text}");
        }
        let key = "A".repeat(1_000_000);
        let message = format!("mine.toml:34:1: unknown parameter `{key}`: leave it out\n    34 | {key}\n       | ^");
        let shown = format!("{}...", "A".repeat(59));
        let wanted =
            format!("mine.toml:34:1: unknown parameter `{shown}`: leave it out\n    34 | A{shown}\n       | ^");
        assert_eq!(brief(&message), wanted);
        assert_eq!(brief(&format!("from {:.3} s, {} m", 1e300, -1.5e42)), "from 1.000e300 s, -1.500e42 m");
        let row = "1 ".repeat(100_000);
        assert_eq!(brief(&row).chars().count(), 2004);
        let letters = "\u{e4}".repeat(256);
        assert_eq!(brief(&letters), format!("{}...", "\u{e4}".repeat(60)));
    }

    #[test]
    fn a_formula_becomes_text() {
        for (text, shown) in
            [("=1+1", "'=1+1"), ("+a", "'+a"), ("-a", "'-a"), ("@a", "'@a"), ("'=a", "'=a"), ("a=b", "a=b"), ("", "")]
        {
            assert_eq!(cell(text), shown);
            assert_eq!(cell(&cell(text)), shown);
        }
    }
}
