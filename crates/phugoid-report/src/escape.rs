//! Escaping of text for HTML and SVG.

use phugoid_flight_data::printable::is_command;

/// The text with the five special characters of HTML and SVG replaced, line ends and tabs as blanks, and control
/// characters (which XML does not allow but a file name may hold) and those that change the direction of text as
/// U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            c if is_command(c) || c == '\u{fffe}' || c == '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn markup_cannot_pass() {
        assert_eq!(
            super::escape("<img src='x' onerror=\"a\">&\u{0}\u{9b}\u{202e}"),
            "&lt;img src=&#39;x&#39; onerror=&quot;a&quot;&gt;&amp;\u{fffd}\u{fffd}\u{fffd}"
        );
    }
}
