//! One file of an aircraft with its lines, and the parts of an element that every reader asks for.

use std::path::PathBuf;

use roxmltree::Node;

use super::error::{JsbsimError, Omission};
use super::units::Unit;

/// A file whose elements are read: names itself and the line in every message.
pub(super) struct Source {
    /// The file.
    pub(super) file: PathBuf,
    /// Where each line begins, bytes.
    starts: Vec<usize>,
}

impl Source {
    /// A file and its text.
    pub(super) fn new(file: PathBuf, text: &str) -> Self {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { file, starts }
    }

    /// Line of an element, from 1.
    pub(super) fn line(&self, node: Node<'_, '_>) -> u32 {
        let begin = node.range().start;
        u32::try_from(self.starts.partition_point(|&start| start <= begin)).unwrap_or(u32::MAX)
    }

    /// The refusal of an element.
    pub(super) fn refuse(&self, node: Node<'_, '_>, what: impl Into<String>) -> JsbsimError {
        JsbsimError::Refused { file: self.file.clone(), line: self.line(node), what: what.into() }
    }

    /// A note on an element that is left out.
    pub(super) fn omit(&self, node: Node<'_, '_>, what: impl Into<String>) -> Omission {
        Omission { file: self.file.clone(), line: self.line(node), what: what.into() }
    }

    /// The number that an element holds.
    pub(super) fn number(&self, node: Node<'_, '_>) -> Result<f64, JsbsimError> {
        let text = text(node);
        parse(&text)
            .ok_or_else(|| self.refuse(node, format!("<{}> holds no number: \"{}\"", tag(node), shortened(&text))))
    }

    /// The number of a child that may be missing.
    pub(super) fn child_number(&self, node: Node<'_, '_>, name: &str) -> Result<Option<f64>, JsbsimError> {
        child(node, name).map(|found| self.number(found)).transpose()
    }

    /// The number that an element holds, with its unit converted; without a unit it is in the wanted one.
    pub(super) fn quantity(&self, node: Node<'_, '_>, wanted: Unit) -> Result<f64, JsbsimError> {
        Ok(self.number(node)? * self.factor(node, wanted)?)
    }

    /// The quantity of a child, `None` where there is none.
    pub(super) fn child_quantity(
        &self,
        node: Node<'_, '_>,
        name: &str,
        wanted: Unit,
    ) -> Result<Option<f64>, JsbsimError> {
        child(node, name).map(|found| self.quantity(found, wanted)).transpose()
    }

    /// What the unit of an element multiplies its numbers by.
    fn factor(&self, node: Node<'_, '_>, wanted: Unit) -> Result<f64, JsbsimError> {
        match node.attribute("unit").map(str::trim) {
            None | Some("") => Ok(1.0),
            Some(unit) => wanted.factor_from(unit).ok_or_else(|| {
                self.refuse(node, format!("<{}>: the unit \"{}\" is not known", tag(node), shortened(unit)))
            }),
        }
    }

    /// Three coordinates `x`, `y`, `z`; a missing one is 0. Without a unit they are in the wanted one.
    pub(super) fn triplet(&self, node: Node<'_, '_>, wanted: Unit) -> Result<[f64; 3], JsbsimError> {
        let factor = self.factor(node, wanted)?;
        let mut values = [0.0; 3];
        for (value, name) in values.iter_mut().zip(["x", "y", "z"]) {
            *value = factor * self.child_number(node, name)?.unwrap_or(0.0);
        }
        Ok(values)
    }
}

/// The name of an element.
pub(super) fn tag<'a>(node: Node<'a, '_>) -> &'a str {
    node.tag_name().name()
}

/// The first child element with a name.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    children(node).find(|found| tag(*found) == name)
}

/// The child elements, in order.
pub(super) fn children<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

/// The text of an element without that of its children, and without blanks at both ends.
pub(super) fn text(node: Node<'_, '_>) -> String {
    let mut text = String::new();
    for part in node.children().filter(Node::is_text) {
        text.push_str(part.text().unwrap_or_default());
    }
    text.trim().to_owned()
}

/// A finite number.
pub(super) fn parse(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// The beginning of a text, for a message that has to fit on a screen.
pub(super) fn shortened(text: &str) -> String {
    if text.chars().count() <= 60 { text.to_owned() } else { text.chars().take(57).collect::<String>() + "..." }
}
