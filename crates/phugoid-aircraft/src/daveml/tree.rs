//! The elements of an XML text as the readers of DAVE-ML want them: local names, numbers, lines.

use roxmltree::Node;

use super::error::{DavemlError, brief};

/// Elements that say where data come from and change nothing.
pub(super) const PASSED_OVER: [&str; 4] = ["description", "provenance", "provenanceRef", "confidenceBound"];

pub(super) type Element<'t> = Node<'t, 't>;

/// Lines of a text by position: asking the parser costs the length of the text each time.
pub(super) struct Lines(Vec<usize>);

impl Lines {
    pub(super) fn of(text: &str) -> Self {
        Self(text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect())
    }

    /// Line of an element, from 1.
    pub(super) fn line(&self, node: Element<'_>) -> u32 {
        let start = node.range().start;
        u32::try_from(self.0.partition_point(|&end| end < start) + 1).unwrap_or(u32::MAX)
    }

    pub(super) fn unknown(&self, node: Element<'_>) -> DavemlError {
        let parent = node.parent_element().map_or_else(String::new, |parent| brief(name(parent)));
        DavemlError::UnknownElement { element: brief(name(node)), parent, line: self.line(node) }
    }

    pub(super) fn unsupported(&self, node: Element<'_>, what: impl Into<String>) -> DavemlError {
        DavemlError::Unsupported { what: what.into(), line: self.line(node) }
    }

    pub(super) fn missing(&self, node: Element<'_>, element: &'static str) -> DavemlError {
        DavemlError::MissingElement { element, parent: brief(name(node)), line: self.line(node) }
    }

    /// An attribute that has to be there and not be empty, without surrounding blanks.
    pub(super) fn attribute<'t>(&self, node: Element<'t>, attribute: &'static str) -> Result<&'t str, DavemlError> {
        node.attribute(attribute).map(str::trim).filter(|text| !text.is_empty()).ok_or_else(|| {
            let element = brief(name(node));
            DavemlError::MissingAttribute { attribute, element, line: self.line(node) }
        })
    }

    /// A number in an attribute, if that is there.
    pub(super) fn optional_number(
        &self,
        node: Element<'_>,
        attribute: &'static str,
    ) -> Result<Option<f64>, DavemlError> {
        match node.attribute(attribute) {
            None => Ok(None),
            Some(text) => self.number(node, text, &format!("the attribute `{attribute}`")).map(Some),
        }
    }

    /// A finite number.
    pub(super) fn number(&self, node: Element<'_>, text: &str, place: &str) -> Result<f64, DavemlError> {
        text.trim().parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
            // A long text would make a long message.
            let text = brief(text);
            DavemlError::Number { text, place: place.to_owned(), line: self.line(node) }
        })
    }

    /// The number that an element consists of.
    pub(super) fn content_number(&self, node: Element<'_>) -> Result<f64, DavemlError> {
        self.number(node, &content(node), &format!("<{}>", name(node)))
    }

    /// The numbers that an element consists of, with blanks or commas between them.
    pub(super) fn numbers(&self, node: Element<'_>) -> Result<Vec<f64>, DavemlError> {
        if let Some(child) = elements(node).next() {
            return Err(self.unknown(child));
        }
        let place = format!("<{}>", name(node));
        let text = content(node);
        let parts = text.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|part| !part.is_empty());
        parts.map(|part| self.number(node, part, &place)).collect()
    }

    /// An attribute with one of several values, the first of which is what counts without it.
    pub(super) fn choice<T: Copy>(
        &self,
        node: Element<'_>,
        attribute: &'static str,
        values: &[(&str, T)],
        default: T,
        allowed: &'static str,
    ) -> Result<T, DavemlError> {
        let Some(text) = node.attribute(attribute).map(str::trim).filter(|text| !text.is_empty()) else {
            return Ok(default);
        };
        values.iter().find(|(value, _)| *value == text).map(|(_, value)| *value).ok_or_else(|| DavemlError::Choice {
            attribute,
            value: brief(text),
            allowed,
            line: self.line(node),
        })
    }
}

/// Local name of an element, whatever its namespace.
pub(super) fn name<'t>(node: Element<'t>) -> &'t str {
    node.tag_name().name()
}

/// Elements inside an element.
pub(super) fn elements<'t>(node: Element<'t>) -> impl Iterator<Item = Element<'t>> {
    node.children().filter(Node::is_element)
}

/// The first element with this local name.
pub(super) fn child<'t>(node: Element<'t>, local: &str) -> Option<Element<'t>> {
    elements(node).find(|element| name(*element) == local)
}

/// The text of an element without that of elements inside it; comments may stand between its parts.
pub(super) fn content(node: Element<'_>) -> String {
    node.children().filter(Node::is_text).filter_map(|text| text.text()).collect()
}

/// The text of an element with its blanks run together; empty if the element is not there.
pub(super) fn words(node: Option<Element<'_>>) -> String {
    node.map_or_else(String::new, |node| content(node).split_whitespace().collect::<Vec<_>>().join(" "))
}

/// An attribute with its blanks run together; empty if it is not there.
pub(super) fn label(node: Element<'_>, attribute: &str) -> String {
    node.attribute(attribute).unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ")
}
