//! The wish that a live estimation end, and why.

use std::sync::atomic::{AtomicU8, Ordering};

/// Says to all threads that they are to end.
#[derive(Debug, Default)]
pub struct Stop(AtomicU8);

/// Why it is to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Ctrl-C, or a signal of the system.
    Signal,
    /// The terminal view was left.
    ViewLeft,
    /// There is nothing more to be done.
    Over,
}

impl Why {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Signal => "it was ended by Ctrl-C, or by a signal of the system",
            Self::ViewLeft => "the terminal view was left",
            Self::Over => "it is over",
        }
    }
}

impl Stop {
    /// Asks for the end. The first reason stays; false if there was one already.
    pub fn ask(&self, why: Why) -> bool {
        let code = match why {
            Why::Signal => 1,
            Why::ViewLeft => 2,
            Why::Over => 3,
        };
        self.0.compare_exchange(0, code, Ordering::Relaxed, Ordering::Relaxed).is_ok()
    }

    /// Why it is to end, if it is.
    pub fn asked(&self) -> Option<Why> {
        match self.0.load(Ordering::Relaxed) {
            0 => None,
            1 => Some(Why::Signal),
            2 => Some(Why::ViewLeft),
            _ => Some(Why::Over),
        }
    }
}
