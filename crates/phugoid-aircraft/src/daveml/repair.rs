//! Markup in free text, which makes some published files no XML.

/// Elements that consist of text alone.
const TEXTS: [&str; 4] = ["description", "fileVersion", "address", "contactInfo"];

/// The text with every markup in elements that consist of text turned into text, and the lines where it stood; none where
/// there is nothing of the kind. Lines stay where they are.
pub(super) fn repaired(text: &str) -> Option<(String, Vec<u32>)> {
    let mut result = String::with_capacity(text.len() + 64);
    let mut lines = Vec::new();
    let (mut line, mut counted) = (1, 0);
    let mut rest = 0;
    while let Some(found) = text[rest..].find('<') {
        let at = rest + found;
        // What has rules of its own is passed over as a whole.
        let whole = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((_, close)) = whole.iter().find(|(open, _)| text[at..].starts_with(open)) {
            let end = text[at..].find(close).map_or(text.len(), |end| at + end + close.len());
            result.push_str(&text[rest..end]);
            rest = end;
            continue;
        }
        let Some(close) = text[at..].find('>') else { break };
        let tag = &text[at + 1..at + close];
        let after = at + close + 1;
        result.push_str(&text[rest..after]);
        rest = after;
        let element = TEXTS.iter().find(|element| {
            let named = tag.strip_prefix(**element);
            named.is_some_and(|more| more.is_empty() || more.starts_with(char::is_whitespace)) && !tag.ends_with('/')
        });
        let Some(element) = element else { continue };
        // Without an end it cannot be repaired, and every search for one would take the length of the text.
        let Some(length) = text[after..].find(&format!("</{element}")) else { break };
        let end = after + length;
        for (position, part) in text[after..end].split('<').enumerate() {
            if position > 0 {
                result.push_str("&lt;");
                let here = part.as_ptr() as usize - text.as_ptr() as usize;
                line += text[counted..here].bytes().filter(|byte| *byte == b'\n').count();
                counted = here;
                lines.push(u32::try_from(line).unwrap_or(u32::MAX));
            }
            result.push_str(part);
        }
        rest = end;
    }
    result.push_str(&text[rest..]);
    lines.dedup();
    if lines.is_empty() { None } else { Some((result, lines)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_a_description_becomes_text() {
        let (text, lines) =
            repaired("<a>\n<description>one <math> or\n<b></description><c/>\n</a>").unwrap_or_default();
        assert_eq!(text, "<a>\n<description>one &lt;math> or\n&lt;b></description><c/>\n</a>");
        assert_eq!(lines, [2, 3]);
    }

    #[test]
    fn what_is_sound_stays() {
        for text in [
            "",
            "<a><description>x</description></a>",
            "<a",
            "<description>",
            "<!-- <description> < -->",
            "<description/><b>",
        ] {
            assert_eq!(repaired(text), None, "{text}");
        }
    }
}
