//! JSON for pages, terminals and lines: in its texts is nothing that a terminal or a browser would take for a command.

use std::io::{self, Write};

use phugoid_flight_data::printable::{REPLACEMENT, one_line};
use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::{CharEscape, Formatter};

/// Writes compact JSON, with U+FFFD in place of control characters and of those that change the direction of text. Line
/// ends and tabs stay, as escapes.
struct Shown;

impl Formatter for Shown {
    fn write_string_fragment<W: ?Sized + Write>(&mut self, writer: &mut W, fragment: &str) -> io::Result<()> {
        writer.write_all(one_line(fragment).as_bytes())
    }

    fn write_char_escape<W: ?Sized + Write>(&mut self, writer: &mut W, escape: CharEscape) -> io::Result<()> {
        let text = match escape {
            CharEscape::Quote => "\\\"",
            CharEscape::ReverseSolidus => "\\\\",
            CharEscape::Solidus => "\\/",
            CharEscape::LineFeed => "\\n",
            CharEscape::CarriageReturn => "\\r",
            CharEscape::Tab => "\\t",
            CharEscape::Backspace | CharEscape::FormFeed | CharEscape::AsciiControl(_) => {
                return write!(writer, "{REPLACEMENT}");
            }
        };
        writer.write_all(text.as_bytes())
    }
}

/// A value as one line of JSON. Numbers that are not finite become `null`.
pub(crate) fn shown<T: Serialize + ?Sized>(value: &T) -> Result<String, serde_json::Error> {
    let mut text = Vec::new();
    value.serialize(&mut Serializer::with_formatter(&mut text, Shown))?;
    // What serde_json writes is UTF-8.
    Ok(String::from_utf8(text).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_shown_and_everything_else_is_as_usual() {
        let value =
            serde_json::json!({"a\u{1b}[2J": [1.5e-7, null, true, -3], "b": "\"\\ / \n\t\u{8}\u{9b}\u{202e}x\u{7f}"});
        let text = shown(&value).unwrap();
        assert!(!text.contains(phugoid_flight_data::printable::is_command), "{text}");
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        let expected = serde_json::json!({"a\u{fffd}[2J": [1.5e-7, null, true, -3],
            "b": "\"\\ / \n\t\u{fffd}\u{fffd}\u{fffd}x\u{fffd}"});
        assert_eq!(read, expected);
        for usual in [serde_json::json!({"x": [0.1, 1e300, 7], "y": "a\"b\\c"}), serde_json::json!([])] {
            assert_eq!(shown(&usual).unwrap(), serde_json::to_string(&usual).unwrap());
        }
    }
}
