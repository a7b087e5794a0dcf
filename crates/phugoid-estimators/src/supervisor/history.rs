//! The last frames of the flight (160, 1.6 s at 100 Hz), and snapshots of the estimate before them. With them a
//! challenger starts from before a suspected change, so that the challenger learns from the data since the change and
//! not only from those since the suspicion, and so that what the champion has made of the changed aircraft meanwhile
//! (state, sensor biases, process noise) does not stick to it.

use crate::levels::LearntLevels;
use crate::model::Sample;
use crate::supervisor::faults::Merit;

/// Frames kept: the older snapshot is at most two spacings old.
pub(super) const FRAMES: usize = 160;
const SNAPSHOTS: usize = 2;
/// Frames between snapshots, at most.
const SPACING: u64 = 75;

#[derive(Clone, Copy)]
pub(super) struct Snapshot<S, const R: usize> {
    pub(super) slot: S,
    /// The noise levels that were learnt by then, if any are.
    pub(super) levels: Option<LearntLevels<R>>,
    /// Number of the last frame that the slot has seen.
    pub(super) frame: u64,
}

/// Frames and snapshots, the frames numbered from one. `F` of them are kept: tests try small rooms.
pub(crate) struct History<I, S, const R: usize, const F: usize = FRAMES> {
    frames: [Option<Sample<I, R>>; F],
    /// How well the running estimate has predicted them.
    merits: [Merit; F],
    /// Number of the newest frame.
    newest: u64,
    /// Of the oldest frame that belongs to the present run of the state.
    first: u64,
    snapshots: [Option<Snapshot<S, R>>; SNAPSHOTS],
    spacing: u64,
}

impl<I: Copy, S: Copy, const R: usize, const F: usize> History<I, S, R, F> {
    /// Where the frame of a number is kept.
    fn place(number: u64) -> usize {
        (number % F as u64) as usize
    }

    /// `window` is the length of the detector's window in frames.
    pub(crate) fn new(window: usize) -> Self {
        let spacing = (window as u64 * 3 / 4).clamp(1, SPACING);
        Self { frames: [None; F], merits: [Merit::NONE; F], newest: 0, first: 1, snapshots: [None; SNAPSHOTS], spacing }
    }

    /// Number of the newest frame.
    pub(crate) fn newest(&self) -> u64 {
        self.newest
    }

    /// A frame, if it is still there.
    pub(crate) fn frame(&self, number: u64) -> Option<&Sample<I, R>> {
        let kept = number >= self.first && number <= self.newest && self.newest - number < F as u64;
        if kept { self.frames[Self::place(number)].as_ref() } else { None }
    }

    /// Keeps the next frame in place of the oldest one.
    pub(crate) fn push(&mut self, sample: &Sample<I, R>) {
        self.newest += 1;
        self.frames[Self::place(self.newest)] = Some(*sample);
    }

    /// Notes how well the newest frame was predicted.
    pub(crate) fn judge(&mut self, merit: Merit) {
        self.merits[Self::place(self.newest)] = merit;
    }

    /// How well a frame that is still there was predicted when it was new.
    pub(crate) fn merit(&self, number: u64) -> &Merit {
        &self.merits[Self::place(number)]
    }

    /// Takes a snapshot after the newest frame if one is due; the oldest one goes.
    pub(super) fn note(&mut self, slot: &S, levels: impl FnOnce() -> Option<LearntLevels<R>>) {
        let last = self.snapshots.iter().flatten().map(|snapshot| snapshot.frame).max();
        if last.is_some_and(|last| self.newest < last + self.spacing) {
            return;
        }
        let oldest = (0..SNAPSHOTS).min_by_key(|i| self.snapshots[*i].as_ref().map_or(0, |snapshot| snapshot.frame));
        if let Some(place) = oldest.and_then(|i| self.snapshots.get_mut(i)) {
            *place = Some(Snapshot { slot: *slot, levels: levels(), frame: self.newest });
        }
    }

    /// The newest snapshot before a frame from which everything since is still there; the oldest such one if all are
    /// later than that.
    pub(super) fn before(&self, frame: u64) -> Option<&Snapshot<S, R>> {
        let complete =
            |snapshot: &&Snapshot<S, R>| snapshot.frame >= self.first && self.newest - snapshot.frame < F as u64 - 1;
        let usable = || self.snapshots.iter().flatten().filter(complete);
        let earlier = usable().filter(|snapshot| snapshot.frame < frame).max_by_key(|snapshot| snapshot.frame);
        earlier.or_else(|| usable().min_by_key(|snapshot| snapshot.frame))
    }

    /// The estimate is another one from the newest frame on.
    pub(crate) fn forget_snapshots(&mut self) {
        self.snapshots = [None; SNAPSHOTS];
    }

    /// Forgets all frames and snapshots, because the state is started again.
    pub(crate) fn clear(&mut self) {
        self.forget_snapshots();
        self.first = self.newest + 1;
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::{FRAMES, History};
    use crate::model::Sample;
    use crate::supervisor::faults::Merit;
    use std::vec::Vec;

    fn at(number: u64) -> Sample<(), 1> {
        Sample { time_s: number as f64, input: (), outputs: [0.0] }
    }

    /// The slot is the number of the frame it has seen last.
    fn flown(frames: u64) -> History<(), u64, 1> {
        let mut history = History::new(20);
        for number in 1..=frames {
            history.push(&at(number));
            history.note(&number, || None);
        }
        history
    }

    #[test]
    fn frames_are_kept_by_number_and_no_longer_than_there_is_room() {
        let history = flown(400);
        assert_eq!(history.newest(), 400);
        for number in [400, 399, 401 - FRAMES as u64] {
            assert_eq!(history.frame(number).map(|frame| frame.time_s), Some(number as f64));
        }
        assert!(history.frame(400 - FRAMES as u64).is_none() && history.frame(401).is_none());
    }

    #[test]
    fn the_snapshot_is_the_newest_before_the_change_with_all_frames_since() {
        // A window of 20 frames: snapshots every 15, so that there are those of 391 and 376.
        let history = flown(400);
        let found = |frame| history.before(frame).map(|snapshot| (snapshot.slot, snapshot.frame));
        assert_eq!(found(395), Some((391, 391)));
        assert_eq!(found(391), Some((376, 376)));
        // Too long ago: from the oldest one on.
        assert_eq!(found(300), Some((376, 376)));
        assert!(flown(0).before(1).is_none());
    }

    /// What a history of room `F` and its model, plain lists that forget nothing they should keep, are told.
    #[derive(Clone, Copy)]
    enum Step {
        /// A frame and, if one is due, a snapshot.
        Fly,
        /// A frame alone, as while a challenger is followed.
        Push,
        Forget,
        Clear,
    }

    const STEPS: [Step; 4] = [Step::Fly, Step::Push, Step::Forget, Step::Clear];
    /// Length of the sequences that are tried, all of them.
    const LENGTH: u32 = if cfg!(miri) { 4 } else { 8 };

    /// Every sequence of steps, against plain lists: each frame that is kept is the one of its number, and each snapshot
    /// that is handed out has all frames since, and the one before it.
    fn agrees_with_plain_lists<const F: usize>(window: usize) {
        for sequence in 0..STEPS.len().pow(LENGTH) {
            let mut history = History::<(), u64, 1, F>::new(window);
            let (mut newest, mut first, mut snapshots) = (0, 1, Vec::new());
            for step in 0..LENGTH {
                match STEPS[sequence / STEPS.len().pow(step) % STEPS.len()] {
                    what @ (Step::Fly | Step::Push) => {
                        newest += 1;
                        history.push(&at(newest));
                        history.judge(Merit::NONE);
                        if matches!(what, Step::Fly) {
                            history.note(&newest, || None);
                            let due = |last: &u64| newest >= *last + (window as u64 * 3 / 4).clamp(1, 75);
                            if snapshots.last().is_none_or(due) {
                                snapshots.push(newest);
                            }
                        }
                    }
                    Step::Forget => {
                        history.forget_snapshots();
                        snapshots.clear();
                    }
                    Step::Clear => {
                        history.clear();
                        snapshots.clear();
                        first = newest + 1;
                    }
                }
                assert_eq!(history.newest(), newest);
                let in_room = |number: u64| (newest + 1).saturating_sub(F as u64) <= number && number <= newest;
                for number in 0..newest + 2 {
                    let kept = in_room(number) && number >= first;
                    assert_eq!(history.frame(number).map(|frame| frame.time_s), kept.then_some(number as f64));
                    if kept {
                        // No merit beyond the room.
                        let _ = history.merit(number);
                    }
                }
                let two = &snapshots[snapshots.len().saturating_sub(2)..];
                let usable: Vec<u64> = two
                    .iter()
                    .copied()
                    .filter(|frame| in_room(frame - 1) || (*frame == 1 && newest < F as u64 - 1))
                    .collect();
                for frame in 0..newest + 2 {
                    let earlier = usable.iter().copied().filter(|snapshot| *snapshot < frame).max();
                    let found = history.before(frame);
                    assert_eq!(found.map(|snapshot| snapshot.frame), earlier.or(usable.iter().copied().min()));
                    assert!(found.is_none_or(|snapshot| snapshot.slot == snapshot.frame));
                }
            }
        }
    }

    #[test]
    fn every_short_flight_in_every_small_room_agrees_with_plain_lists() {
        for window in [0, 3] {
            agrees_with_plain_lists::<1>(window);
            agrees_with_plain_lists::<2>(window);
            agrees_with_plain_lists::<3>(window);
            agrees_with_plain_lists::<4>(window);
        }
    }

    #[test]
    fn another_estimate_or_a_new_start_forgets() {
        let mut history = flown(400);
        history.forget_snapshots();
        assert!(history.before(395).is_none());
        assert!(history.frame(395).is_some());
        history.note(&0, || None);
        assert_eq!(history.before(401).map(|snapshot| (snapshot.slot, snapshot.frame)), Some((0, 400)));
        history.clear();
        assert!(history.before(401).is_none() && history.frame(400).is_none());
        history.push(&at(401));
        assert!(history.frame(401).is_some());
    }
}
