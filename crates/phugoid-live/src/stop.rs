//! The wish that a live estimation end, shared by its threads, with the reason.

use std::sync::atomic::{AtomicU8, Ordering};

/// A flag that asks all threads to end.
///
/// ```
/// use phugoid_live::stop::{Stop, Why};
///
/// let stop = Stop::default();
/// assert_eq!(stop.asked(), None);
/// assert!(stop.ask(Why::Signal));
/// // The first reason stays.
/// assert!(!stop.ask(Why::Over));
/// assert_eq!(stop.asked(), Some(Why::Signal));
/// ```
#[derive(Debug, Default)]
pub struct Stop(AtomicU8);

/// Why the estimation has to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Ctrl-C was pressed, or the operating system sent a signal.
    Signal,
    /// The terminal view was left.
    ViewLeft,
    /// The estimation is finished, so the other threads have nothing more to do.
    Over,
}

impl Why {
    /// The reason as a clause for people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Signal => "it was ended by Ctrl-C, or by a signal of the system",
            Self::ViewLeft => "the terminal view was left",
            Self::Over => "it is over",
        }
    }
}

impl Stop {
    /// Asks all threads to end. Returns false if that had been asked before; the first reason stays.
    pub fn ask(&self, why: Why) -> bool {
        let code = match why {
            Why::Signal => 1,
            Why::ViewLeft => 2,
            Why::Over => 3,
        };
        self.0.compare_exchange(0, code, Ordering::Relaxed, Ordering::Relaxed).is_ok()
    }

    /// The reason, once the end has been asked for.
    pub fn asked(&self) -> Option<Why> {
        match self.0.load(Ordering::Relaxed) {
            0 => None,
            1 => Some(Why::Signal),
            2 => Some(Why::ViewLeft),
            _ => Some(Why::Over),
        }
    }
}
