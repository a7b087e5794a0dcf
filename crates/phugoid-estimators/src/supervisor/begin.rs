//! The state begins: median start of the first frames, start anew after a gap or when the state is lost.

use super::{Stage, Supervisor};
use crate::estimate::Phase;
use crate::innovation::{Innovations, RowPhase};
use crate::model::{Model, Sample};
use crate::supervisor::faults::Faults;
use crate::supervisor::slot::Slot;
use crate::supervisor::start::Start;

/// When more than half of the rows have been rejected in every frame for this long, s, the estimated state is lost (an
/// input that was not recorded, say): what no parameter explains, no further prediction will bring back.
const LOST_STATE_S: f64 = 0.5;
/// The same with change detection: a large change looks like this too, and the detector is to find it first.
const LOST_STATE_WATCHED_S: f64 = 1.5;
/// ... and for at least this many frames.
const LOST_STATE_FRAMES: u32 = 5;

impl<S, M, const N: usize, const R: usize, const P: usize> Supervisor<S, M, N, R, P>
where
    S: Slot<N, R, P>,
    M: Model<N, R, P>,
{
    pub(super) fn collect(&mut self, sample: &Sample<M::Input, R>) {
        self.phase = Phase::Starting;
        self.innovations = Innovations::EMPTY;
        self.surfaces = [0.0; P];
        self.start.push(sample);
        self.last_s = sample.time_s;
        // Again only where a gap inside the window has left fewer frames.
        while self.replay() {}
    }

    /// Starts the state and replays the collected frames, if there are enough. True if a gap among them has begun a new
    /// start with fewer frames.
    fn replay(&mut self) -> bool {
        let Some(started) = self.start.state(self.shared(), &self.columns) else { return false };
        self.champion.start_state(started.x, &started.variances, &started.measured, &self.columns);
        if self.in_doubt {
            self.challenger.start_state(started.x, &started.variances, &started.measured, &self.columns);
        }
        self.stage = Stage::Running;
        let collected = core::mem::replace(&mut self.start, Start::new());
        for index in 0..collected.len() {
            let Some(frame) = collected.frame(index) else { continue };
            if matches!(self.stage, Stage::Starting) {
                // A gap, or a failure of the model, inside the window: an earlier frame has begun a new start.
                self.start.push(&frame);
                self.last_s = frame.time_s;
                continue;
            }
            if index == 0 {
                self.last_s = frame.time_s;
                self.last_input = Some(frame.input);
                if self.first_s.is_nan() {
                    self.first_s = frame.time_s;
                }
                if self.shared().correct_first_sample {
                    self.correct(&frame, frame.input);
                }
            } else {
                self.advance(&frame);
            }
        }
        matches!(self.stage, Stage::Starting) && self.start.len() < collected.len()
    }

    /// Starts the state again from measurements; parameters and covariance are kept, and so is a doubt about them.
    pub(super) fn restart(&mut self, sample: &Sample<M::Input, R>) {
        self.restarts = self.restarts.saturating_add(1);
        self.lost_frames = 0;
        self.catch_up_at_once();
        self.history.clear();
        if self.in_doubt && !self.challenger.is_sound(self.columns.count) {
            self.drop_challenger();
        }
        if let Some((detector, _)) = &mut self.detection {
            detector.clear();
        }
        if !self.champion.is_sound(self.columns.count) {
            if self.in_doubt {
                self.adopt_challenger(sample.time_s);
            } else {
                // Nothing of the estimate can be trusted: back to the prior.
                self.champion = S::prior(&self.settings, &self.columns);
            }
        }
        self.stage = Stage::Starting;
        self.faults = [Faults::NONE; 2];
        self.start = Start::new();
        self.start.push(sample);
        self.last_s = sample.time_s;
        self.phase = Phase::Starting;
        self.innovations = Innovations::EMPTY;
        self.surfaces = [0.0; P];
    }

    /// The first start was none: nothing that was learnt from it is kept.
    pub(super) fn start_over(&mut self, sample: &Sample<M::Input, R>) {
        self.champion = S::prior(&self.settings, &self.columns);
        self.in_doubt = false;
        self.behind = None;
        self.restart(sample);
    }

    /// Whether the estimated state no longer has to do with the measurements.
    pub(super) fn is_lost(&mut self, time_s: f64) -> bool {
        let count = |wanted: RowPhase| self.innovations.phase.iter().filter(|phase| **phase == wanted).count();
        let rejected = count(RowPhase::Rejected);
        if self.phase == Phase::Predicting {
            return false;
        }
        if 2 * rejected <= R - count(RowPhase::Missing) {
            self.lost_frames = 0;
            return false;
        }
        if self.lost_frames == 0 {
            self.lost_since_s = time_s;
        }
        self.lost_frames += 1;
        let limit_s = if self.detection.is_some() { LOST_STATE_WATCHED_S } else { LOST_STATE_S };
        // While a change is in doubt the challenger has the word.
        !self.in_doubt && self.lost_frames >= LOST_STATE_FRAMES && time_s - self.lost_since_s >= limit_s
    }
}
