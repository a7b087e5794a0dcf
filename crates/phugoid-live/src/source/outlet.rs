//! Where a source puts its arrivals.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use crate::arrival::{Arrival, Clock, Content};
use crate::budget::Budget;
use crate::stop::Stop;

/// How often a source that receives nothing checks whether it has to stop.
pub(super) const LOOK: Duration = Duration::from_millis(100);

/// The queue into which a source puts its arrivals, the clock that stamps them, and the wish to stop.
#[derive(Clone)]
pub struct Outlet {
    queue: SyncSender<Arrival>,
    stop: Arc<Stop>,
    pub(super) clock: Clock,
    /// Bytes that may wait in the queue; without it only their number is bounded.
    budget: Option<Arc<Budget>>,
    pub(super) attention: Arc<Attention>,
}

/// Whose data the estimation uses, told to the source, so that a flood of others need not go through the queue.
#[derive(Debug)]
pub(crate) struct Attention {
    /// Number of the sender that is pinned, or [`NOBODY`].
    pinned: AtomicU32,
    /// Datagrams of others that the source has thrown away.
    thrown_away: AtomicU64,
}

const NOBODY: u32 = u32::MAX;

impl Default for Attention {
    fn default() -> Self {
        Self { pinned: AtomicU32::new(NOBODY), thrown_away: AtomicU64::new(0) }
    }
}

impl Attention {
    /// Says which sender is pinned.
    pub(crate) fn pin(&self, origin: Option<u16>) {
        self.pinned.store(origin.map_or(NOBODY, u32::from), Ordering::Relaxed);
    }

    /// The number of the sender that is pinned.
    pub(super) fn pinned(&self) -> Option<u16> {
        u16::try_from(self.pinned.load(Ordering::Relaxed)).ok()
    }

    /// A datagram was thrown away.
    pub(super) fn throw_away(&self) {
        self.thrown_away.fetch_add(1, Ordering::Relaxed);
    }

    /// Datagrams that were thrown away so far.
    pub(crate) fn thrown_away(&self) -> u64 {
        self.thrown_away.load(Ordering::Relaxed)
    }
}

impl Outlet {
    /// An outlet into a queue, whose arrivals are stamped by `clock`.
    pub fn new(queue: SyncSender<Arrival>, stop: Arc<Stop>, clock: Clock) -> Self {
        Self { queue, stop, clock, budget: None, attention: Arc::default() }
    }

    /// Lets no more bytes wait in the queue than the budget has. Whoever takes an arrival out gives its bytes back.
    pub(crate) fn with_budget(self, budget: Arc<Budget>) -> Self {
        Self { budget: Some(budget), ..self }
    }

    /// What the source is told about the senders.
    pub(crate) fn attention(&self) -> Arc<Attention> {
        Arc::clone(&self.attention)
    }

    /// Whether the source has to stop.
    pub(super) fn stopped(&self) -> bool {
        self.stop.asked().is_some()
    }

    /// Puts what has just arrived into the queue; false if the source has to end. It waits if the queue is full;
    /// meanwhile the data stay in the buffers of the operating system.
    pub(super) fn put(&self, origin: u16, content: Content) -> bool {
        self.pass(self.clock.stamp(origin, content))
    }

    /// Puts an arrival that has its stamp already; false if the source has to end.
    pub(super) fn pass(&self, arrival: Arrival) -> bool {
        let fits = self.budget.as_ref().is_none_or(|budget| budget.take(arrival.size(), &|| self.stopped()));
        fits && !self.stopped() && self.queue.send(arrival).is_ok()
    }
}

/// Receives until the source ends or has to stop.
pub(super) type Run = Box<dyn FnOnce(&Outlet) + Send>;
