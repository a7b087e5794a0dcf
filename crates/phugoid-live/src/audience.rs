//! Who gets the documents.

use crate::document::Kind;

/// Who gets the documents beside the lines.
pub trait Audience: Send {
    /// A document; it has to return at once.
    fn hear(&mut self, kind: Kind, document: &str);
}
