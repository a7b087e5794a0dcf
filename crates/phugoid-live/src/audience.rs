//! Receivers of the published documents beside the lines of text: the server, the terminal view, MAVLink debug
//! messages.

use crate::document::DocumentKind;

/// A receiver of the published documents.
pub trait Audience: Send {
    /// Takes a document, which is one line of JSON without its end. It is called by the estimation's thread, so it has
    /// to return at once; a receiver that is slow has to leave documents out.
    fn hear(&mut self, kind: DocumentKind, document: &str);
}
