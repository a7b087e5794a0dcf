//! The pieces of a stream of bytes, from a file, a serial line or a connection.

use std::io::{self, Read};

use super::outlet::Outlet;
use crate::arrival::Content;

/// The largest datagram.
pub(super) const DATAGRAM: usize = 65_536;

/// Passes on a stream until its end.
pub(super) fn read_all(mut input: impl Read, peer: &str, outlet: &Outlet) {
    if !outlet.put(0, Content::Opened(peer.to_owned())) {
        return;
    }
    pieces(&mut input, 0, outlet);
}

/// Passes on the pieces of one peer's stream, and why it ended.
pub(super) fn pieces(input: &mut impl Read, origin: u16, outlet: &Outlet) {
    let mut bytes = vec![0; DATAGRAM];
    let reason = loop {
        match input.read(&mut bytes) {
            Ok(0) => break "the end of the data".to_owned(),
            Ok(read) => {
                let piece = bytes.get(..read).unwrap_or_default().to_vec();
                if !outlet.put(origin, Content::Piece(piece)) {
                    return;
                }
            }
            Err(error) if waits(&error) => {
                if outlet.stopped() {
                    return;
                }
            }
            Err(error) => break format!("reading failed: {error}"),
        }
    };
    outlet.put(origin, Content::Closed(reason));
}

/// Nothing there yet, or interrupted: no error.
pub(super) fn waits(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}
