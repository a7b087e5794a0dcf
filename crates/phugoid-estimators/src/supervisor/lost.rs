//! A lost state: the estimated state no longer has to do with the measurements.

use crate::innovation::{Innovations, RowPhase};

/// When more than half of the rows have been rejected in every frame for this long, s, the estimated state is lost (an
/// input that was not recorded, say): what no parameter explains, no further prediction will bring back.
const LOST_STATE_S: f64 = 0.5;
/// The same with change detection: a large change looks like this too, and the detector is to find it first.
const LOST_STATE_WATCHED_S: f64 = 1.5;
/// ... and for at least this many frames.
const LOST_STATE_FRAMES: u32 = 5;

/// The present run of frames that were mostly rejected.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rejections {
    since_s: f64,
    frames: u32,
}

impl Rejections {
    pub(super) const NONE: Self = Self { since_s: 0.0, frames: 0 };

    /// Takes a frame; true if the state is lost. `detecting`: with change detection; `in_doubt`: a challenger runs, and
    /// decides. A frame without measurements changes nothing.
    pub(super) fn are_too_many<const R: usize>(
        &mut self,
        innovations: &Innovations<R>,
        time_s: f64,
        detecting: bool,
        in_doubt: bool,
    ) -> bool {
        let count = |wanted: RowPhase| innovations.phase.iter().filter(|phase| **phase == wanted).count();
        let missing = count(RowPhase::Missing);
        if missing == R {
            return false;
        }
        if 2 * count(RowPhase::Rejected) <= R - missing {
            self.frames = 0;
            return false;
        }
        if self.frames == 0 {
            self.since_s = time_s;
        }
        self.frames += 1;
        let limit_s = if detecting { LOST_STATE_WATCHED_S } else { LOST_STATE_S };
        !in_doubt && self.frames >= LOST_STATE_FRAMES && time_s - self.since_s >= limit_s
    }
}
