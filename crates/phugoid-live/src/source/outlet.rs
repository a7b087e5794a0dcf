//! Where a source puts its arrivals.

use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use crate::arrival::{Arrival, Clock, Content};
use crate::stop::Stop;

/// How often a source that receives nothing checks whether it has to stop.
pub(super) const LOOK: Duration = Duration::from_millis(100);

/// The queue into which a source puts its arrivals, the clock that stamps them, and the wish to stop.
#[derive(Clone)]
pub struct Outlet {
    queue: SyncSender<Arrival>,
    stop: Arc<Stop>,
    pub(super) clock: Clock,
}

impl Outlet {
    /// An outlet into a queue, whose arrivals are stamped by `clock`.
    pub fn new(queue: SyncSender<Arrival>, stop: Arc<Stop>, clock: Clock) -> Self {
        Self { queue, stop, clock }
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
        !self.stopped() && self.queue.send(arrival).is_ok()
    }
}

/// Receives until the source ends or has to stop.
pub(super) type Run = Box<dyn FnOnce(&Outlet) + Send>;
