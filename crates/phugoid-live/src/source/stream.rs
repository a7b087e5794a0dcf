//! The pieces of a stream of bytes, from a file, a serial line or a connection.

use std::io::{self, Read};

use super::outlet::Outlet;
use crate::arrival::Content;

/// Largest datagram and largest piece of a stream, bytes.
pub(super) const DATAGRAM: usize = 65_536;

/// Passes a stream on until its end, as the only sender of its source.
pub(super) fn read_all(mut input: impl Read, peer: &str, outlet: &Outlet) {
    if !outlet.put(0, Content::Opened(peer.to_owned())) {
        return;
    }
    pieces(&mut input, 0, outlet);
}

/// Passes the pieces of the stream of one sender on, then the reason for its end.
pub(super) fn pieces(input: &mut impl Read, origin: u16, outlet: &Outlet) {
    if let Some(reason) = until_end(input, origin, outlet) {
        outlet.put(origin, Content::Closed(reason));
    }
}

/// Passes the pieces of the stream of one sender on, and gives the reason for its end; `None` if the source has to end.
pub(super) fn until_end(input: &mut impl Read, origin: u16, outlet: &Outlet) -> Option<String> {
    let mut bytes = vec![0; DATAGRAM];
    loop {
        match input.read(&mut bytes) {
            Ok(0) => return Some("the end of the data".to_owned()),
            Ok(read) => {
                let piece = bytes.get(..read).unwrap_or_default().to_vec();
                if !outlet.put(origin, Content::Piece(piece)) {
                    return None;
                }
            }
            Err(error) if waits(&error) => {
                if outlet.stopped() {
                    return None;
                }
            }
            Err(error) => return Some(format!("reading failed: {error}")),
        }
    }
}

/// Whether an error only means that there are no data yet, or that a signal interrupted the call.
pub(super) fn waits(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}
