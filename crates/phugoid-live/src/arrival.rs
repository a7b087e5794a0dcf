//! What comes in, with the time at which it came.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Something that happened at a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// Monotonic time since the start of reception, ns. It never falls within a recording.
    pub arrival_ns: u64,
    /// Wall clock, ns since 1970-01-01 UTC: for people, never for decisions.
    pub wall_ns: u64,
    /// Which peer of the source, from 0.
    pub origin: u16,
    /// What.
    pub content: Content,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Content {
    /// A peer appeared (its address or name): what follows from it starts anew.
    Opened(String),
    /// A datagram: it ends where a line or a frame ends.
    Datagram(Vec<u8>),
    /// A piece of a stream: it may end anywhere.
    Piece(Vec<u8>),
    /// A peer has gone, for this reason.
    Closed(String),
}

/// The clock of one reception.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    start: Instant,
}

impl Clock {
    /// Starts it.
    pub fn start() -> Self {
        Self { start: Instant::now() }
    }

    /// Time since the start, ns.
    pub fn now_ns(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// Something that happens now.
    pub fn stamp(&self, origin: u16, content: Content) -> Arrival {
        Arrival { arrival_ns: self.now_ns(), wall_ns: wall_ns(), origin, content }
    }
}

/// Wall clock, ns since 1970-01-01 UTC; 0 where the system's clock stands before that.
pub fn wall_ns() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .ok()
        .and_then(|since| u64::try_from(since.as_nanos()).ok())
        .unwrap_or(0)
}
