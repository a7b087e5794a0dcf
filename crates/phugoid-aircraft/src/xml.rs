//! An XML text under limits, whose errors name the line: what the readers of this crate stand on.
//!
//! Nothing outside the text is ever read: references to a document type on the network are not followed.

use std::path::{Path, PathBuf};

use roxmltree::{Document, Node, ParsingOptions};

/// Largest text that is parsed, bytes. The largest aircraft of JSBSim has 250 kB.
pub const MAX_BYTES: u64 = 32_000_000;
/// Most nodes of a text: its tree takes about 100 bytes for each.
pub const MAX_NODES: u32 = 1_000_000;
/// Deepest nesting of elements that a reader follows; readers call themselves once per level.
pub const MAX_DEPTH: usize = 100;

/// Why a file could not be read as XML.
#[derive(Debug, thiserror::Error)]
pub enum XmlError {
    /// The file could not be opened or read.
    #[error("{} cannot be read: {source}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The file is larger than [`MAX_BYTES`].
    #[error("{} has {bytes} bytes; a description of an aircraft may have {MAX_BYTES}", file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// The text is not XML; the message names line and column.
    #[error("it is no XML: {0}")]
    Malformed(#[from] roxmltree::Error),
    /// Elements are nested deeper than [`MAX_DEPTH`].
    #[error("line {line}: elements are nested more than {MAX_DEPTH} deep")]
    TooDeep {
        /// Line of the first element that is too deep, from 1.
        line: u32,
    },
}

/// The text of a file, refused above [`MAX_BYTES`].
///
/// # Errors
/// [`XmlError::Unreadable`], [`XmlError::TooLarge`].
pub fn text_of(file: &Path) -> Result<String, XmlError> {
    use std::io::Read as _;
    let unreadable = |source| XmlError::Unreadable { file: file.into(), source };
    let mut text = String::new();
    // One byte more than allowed, so that a pipe without a size is bounded too.
    let opened = std::fs::File::open(file).map_err(unreadable)?;
    opened.take(MAX_BYTES + 1).read_to_string(&mut text).map_err(unreadable)?;
    if text.len() as u64 > MAX_BYTES {
        let bytes = std::fs::metadata(file).map_or(text.len() as u64, |metadata| metadata.len());
        return Err(XmlError::TooLarge { file: file.into(), bytes });
    }
    Ok(text)
}

/// The tree of a text. A document type may stand in it and is not fetched.
///
/// # Errors
/// [`XmlError::Malformed`], [`XmlError::TooDeep`].
pub fn parse(text: &str) -> Result<Document<'_>, XmlError> {
    let document = Document::parse_with_options(
        text,
        ParsingOptions { allow_dtd: true, nodes_limit: MAX_NODES, ..ParsingOptions::default() },
    )?;
    let mut depth = 0;
    let mut node = document.root_element();
    // Walks the tree in the order of the text without calling itself, whatever its depth.
    'walk: loop {
        if let Some(child) = node.first_element_child() {
            depth += 1;
            if depth > MAX_DEPTH {
                return Err(XmlError::TooDeep { line: line(child) });
            }
            node = child;
            continue;
        }
        loop {
            if let Some(next) = node.next_sibling_element() {
                node = next;
                continue 'walk;
            }
            match node.parent_element() {
                Some(parent) => (node, depth) = (parent, depth - 1),
                None => break 'walk,
            }
        }
    }
    Ok(document)
}

/// Line of an element in its text, from 1.
pub fn line(node: Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

/// A text as it stands in XML; characters that XML has no place for become blanks.
pub fn escaped(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => result.push_str("&amp;"),
            '<' => result.push_str("&lt;"),
            '>' => result.push_str("&gt;"),
            '"' => result.push_str("&quot;"),
            '\n' | '\t' => result.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => result.push(' '),
            c => result.push(c),
        }
    }
    result
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn lines_count_from_one() {
        let document = parse("<a>\n  <b/>\n</a>").unwrap();
        assert_eq!(line(document.root_element()), 1);
        assert_eq!(line(document.root_element().first_element_child().unwrap()), 2);
    }

    #[test]
    fn an_error_names_its_line() {
        let message = parse("<a>\n  <b>\n</a>").unwrap_err().to_string();
        assert!(message.contains("3:"), "{message}");
    }

    #[test]
    fn nesting_is_bounded() {
        let deep = |levels: usize| format!("{}{}", "<a>".repeat(levels), "</a>".repeat(levels));
        assert!(parse(&deep(MAX_DEPTH + 1)).is_ok());
        assert!(matches!(parse(&deep(MAX_DEPTH + 2)), Err(XmlError::TooDeep { line: 1 })));
        // Far beyond every stack.
        assert!(parse(&deep(2_000_000)).is_err());
    }

    #[test]
    fn entities_do_not_multiply() {
        let mut text = "<!DOCTYPE a [<!ENTITY x0 \"xxxxxxxxxx\">".to_owned();
        for k in 1..30 {
            text += &format!("<!ENTITY x{k} \"&x{0};&x{0};&x{0};&x{0};\">", k - 1);
        }
        assert!(parse(&(text + "]><a>&x29;</a>")).is_err());
    }
}
