//! Room to compute in for threads that evaluate side by side.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, TryLockError};

/// Rooms that are kept. More threads than these share them.
const ROOMS: usize = 16;

static THREADS: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Number of the room of a thread.
    static ROOM: usize = THREADS.fetch_add(1, Ordering::Relaxed) % ROOMS;
}

/// Rooms, which are made when they are needed. As a rule each thread has its own, so that none waits for another.
#[derive(Debug)]
pub(super) struct Pool<T>([Mutex<Option<T>>; ROOMS]);

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(std::array::from_fn(|_| Mutex::new(None)))
    }
}

/// A clone has rooms of its own.
impl<T> Clone for Pool<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<T> Pool<T> {
    /// Lends a room for the time of a call. What is in it from an earlier call, even from one that panicked, is not to matter.
    pub(super) fn lend<R>(&self, make: impl FnOnce() -> T, with: impl FnOnce(&mut T) -> R) -> R {
        let room = ROOM.try_with(|room| *room).unwrap_or(0);
        match self.0[room].try_lock() {
            Ok(mut room) => with(room.get_or_insert_with(make)),
            Err(TryLockError::Poisoned(room)) => with(room.into_inner().get_or_insert_with(make)),
            // Another thread is in it.
            Err(TryLockError::WouldBlock) => with(&mut make()),
        }
    }
}
