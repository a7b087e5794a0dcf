//! What a source hands over: bytes, or a sender that came or went, with the time at which it happened.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Something that happened at a source, with its times.
///
/// ```
/// use phugoid_live::arrival::{Clock, Content};
///
/// let clock = Clock::start();
/// let first = clock.stamp(0, Content::Opened("udp 127.0.0.1:50000".to_owned()));
/// let second = clock.stamp(0, Content::Datagram(b"time_s,alpha_deg".to_vec()));
/// assert!(second.arrival_ns >= first.arrival_ns);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// Monotonic time since the start of the reception, ns. It never decreases within a recording; every decision of
    /// the receiver depends on this time only.
    pub arrival_ns: u64,
    /// Wall clock, ns since 1970-01-01 UTC. It is recorded for people; no decision depends on it.
    pub wall_ns: u64,
    /// Number of the sender among those of the source, from 0.
    pub origin: u16,
    /// What happened, with the bytes that came.
    pub content: Content,
}

impl Arrival {
    /// Memory that it takes, bytes.
    pub(crate) fn size(&self) -> usize {
        let content = match &self.content {
            Content::Opened(text) | Content::Closed(text) => text.len(),
            Content::Datagram(bytes) | Content::Piece(bytes) => bytes.len(),
        };
        content + size_of::<Self>()
    }
}

/// What happened at a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Content {
    /// A sender appeared; the text is its address or name. What was kept of an earlier sender with the same number is
    /// discarded.
    Opened(String),
    /// A datagram. A line or a frame ends where the datagram ends.
    Datagram(Vec<u8>),
    /// Bytes of a stream. They may end in the middle of a line or of a frame.
    Piece(Vec<u8>),
    /// A sender is gone; the text is the reason, for people.
    Closed(String),
}

/// The monotonic clock of one reception.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    start: Instant,
}

impl Clock {
    /// A clock that counts from this call.
    pub fn start() -> Self {
        Self { start: Instant::now() }
    }

    /// Time since the start, ns. It saturates after 584 years.
    pub fn now_ns(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// An arrival with the present time, monotonic and wall clock.
    pub fn stamp(&self, origin: u16, content: Content) -> Arrival {
        Arrival { arrival_ns: self.now_ns(), wall_ns: wall_ns(), origin, content }
    }
}

/// Wall clock, ns since 1970-01-01 UTC; 0 if the clock of the machine stands before that date.
pub fn wall_ns() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .ok()
        .and_then(|since| u64::try_from(since.as_nanos()).ok())
        .unwrap_or(0)
}
