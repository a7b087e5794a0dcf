//! Where a source puts what arrives.

use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use crate::arrival::{Arrival, Clock, Content};
use crate::stop::Stop;

/// How often a source that hears nothing looks whether it is to stop.
pub(super) const LOOK: Duration = Duration::from_millis(100);

/// Where a source puts what arrives, and how it hears that it is to stop.
#[derive(Clone)]
pub struct Outlet {
    queue: SyncSender<Arrival>,
    stop: Arc<Stop>,
    pub(super) clock: Clock,
}

impl Outlet {
    /// An outlet into a queue.
    pub fn new(queue: SyncSender<Arrival>, stop: Arc<Stop>, clock: Clock) -> Self {
        Self { queue, stop, clock }
    }

    pub(super) fn stopped(&self) -> bool {
        self.stop.asked().is_some()
    }

    /// Puts what has just arrived; false when nobody wants more. It waits where the estimation is behind: then the operating
    /// system's buffers hold what comes.
    pub(super) fn put(&self, origin: u16, content: Content) -> bool {
        self.pass(self.clock.stamp(origin, content))
    }

    pub(super) fn pass(&self, arrival: Arrival) -> bool {
        !self.stopped() && self.queue.send(arrival).is_ok()
    }
}

/// Receives until its source ends or is stopped.
pub(super) type Run = Box<dyn FnOnce(&Outlet) + Send>;
