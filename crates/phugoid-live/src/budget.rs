//! A bound in bytes for what waits in a queue, beside its bound in entries.

use std::sync::{Condvar, Mutex, MutexGuard};
use std::time::Duration;

/// Bytes that may wait, shared by those who put entries into a queue and those who take them out.
#[derive(Debug)]
pub(crate) struct Budget {
    limit: usize,
    used: Mutex<usize>,
    freed: Condvar,
}

/// How often whoever waits looks at whether to give up.
const LOOK: Duration = Duration::from_millis(100);

impl Budget {
    pub(crate) fn new(limit: usize) -> Self {
        Self { limit, used: Mutex::new(0), freed: Condvar::new() }
    }

    /// Takes so many bytes if they are free. An entry that is larger than the limit gets it all.
    pub(crate) fn try_take(&self, bytes: usize) -> bool {
        let mut used = self.lock();
        let fits = self.fits(*used, bytes);
        if fits {
            *used = used.saturating_add(bytes);
        }
        fits
    }

    /// Waits until so many bytes are free, and takes them; false if `give_up` says so before.
    pub(crate) fn take(&self, bytes: usize, give_up: &dyn Fn() -> bool) -> bool {
        let mut used = self.lock();
        while !self.fits(*used, bytes) {
            if give_up() {
                return false;
            }
            let waited = self.freed.wait_timeout(used, LOOK);
            used = waited.unwrap_or_else(std::sync::PoisonError::into_inner).0;
        }
        *used = used.saturating_add(bytes);
        true
    }

    fn fits(&self, used: usize, bytes: usize) -> bool {
        used == 0 || used.saturating_add(bytes) <= self.limit
    }

    /// Gives bytes back that were taken.
    pub(crate) fn give_back(&self, bytes: usize) {
        let mut used = self.lock();
        *used = used.saturating_sub(bytes);
        self.freed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, usize> {
        // No code panics while it holds the lock, and a number is always whole.
        self.used.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn no_more_than_the_limit_waits() {
        let budget = Arc::new(Budget::new(100));
        assert!(budget.try_take(60) && !budget.try_take(41) && budget.try_take(40));
        assert!(!budget.take(1, &|| true));
        let other = Arc::clone(&budget);
        let waiting = std::thread::spawn(move || other.take(50, &|| false));
        budget.give_back(60);
        assert!(waiting.join().unwrap());
        budget.give_back(90);
        // One entry is let through, however large.
        assert!(budget.try_take(1000) && !budget.try_take(1));
    }
}
