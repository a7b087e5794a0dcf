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
    fn a_formula_becomes_text() {
        for (text, shown) in
            [("=1+1", "'=1+1"), ("+a", "'+a"), ("-a", "'-a"), ("@a", "'@a"), ("'=a", "'=a"), ("a=b", "a=b"), ("", "")]
        {
            assert_eq!(cell(text), shown);
            assert_eq!(cell(&cell(text)), shown);
        }
    }
}
