//! The first start on trial. The state starts from a few frames and the parameters from little more than nothing: when
//! a burst of outliers falls on these frames, or many columns at once run away with them, an output may be rejected for
//! good afterwards, and the others teach the parameters nonsense. Then half a second is given up and everything starts
//! again.

use crate::innovation::{Innovations, RowPhase};

/// Frames that an output must have been measured in.
const TRIAL_FRAMES: u16 = 10;
/// Starts at most. An output that contradicts them all is wrong itself.
const STARTS: u8 = 3;

#[derive(Clone, Copy, Debug)]
pub(super) struct Trial<const R: usize> {
    begun_s: f64,
    measured: [u16; R],
    rejected: [u16; R],
    starts_left: u8,
}

impl<const R: usize> Trial<R> {
    pub(super) const NEW: Self =
        Self { begun_s: f64::NAN, measured: [0; R], rejected: [0; R], starts_left: STARTS - 1 };

    /// Takes a frame; true if the start has to be given up because an output was rejected more often than not.
    pub(super) fn contradicts(&mut self, innovations: &Innovations<R>, time_s: f64, trial_s: f64) -> bool {
        if self.starts_left == 0 || trial_s == 0.0 {
            return false;
        }
        if self.begun_s.is_nan() {
            self.begun_s = time_s;
        }
        for (i, phase) in innovations.phase.iter().enumerate() {
            if *phase != RowPhase::Missing {
                self.measured[i] += 1;
                self.rejected[i] += u16::from(*phase == RowPhase::Rejected);
            }
        }
        if time_s - self.begun_s < trial_s || self.measured.iter().all(|n| *n < TRIAL_FRAMES) {
            return false;
        }
        let judged = || self.measured.iter().zip(&self.rejected).filter(|(measured, _)| **measured >= TRIAL_FRAMES);
        let contradicted = judged().any(|(measured, rejected)| 2 * rejected > *measured);
        let starts_left = if contradicted { self.starts_left - 1 } else { 0 };
        *self = Self { starts_left, ..Self::NEW };
        contradicted
    }
}

#[cfg(test)]
mod tests {
    use super::{Innovations, RowPhase, STARTS, Trial};

    fn frame(rejected: bool) -> Innovations<3> {
        let phase =
            [RowPhase::Sliding, if rejected { RowPhase::Rejected } else { RowPhase::Sliding }, RowPhase::Missing];
        Innovations { phase, ..Innovations::EMPTY }
    }

    /// Given up at the end of the trial and not before; a burst is borne; after the last start nothing is given up any
    /// more.
    #[test]
    fn a_start_that_an_output_contradicts_is_given_up_a_few_times() {
        let at = |k: u32| 3.0 + 0.01 * f64::from(k);
        let mut trial = Trial::NEW;
        let mut given_up = 0;
        for k in 0..500 {
            // The first 20 frames fit: a burst that both the start and they have seen.
            given_up += u8::from(trial.contradicts(&frame(k >= 20), at(k), 0.6));
            assert!(k >= 60 || given_up == 0);
        }
        assert_eq!(given_up, STARTS - 1);
        let mut trial = Trial::NEW;
        assert!((0..500).all(|k| !trial.contradicts(&frame((10..35).contains(&k) || k > 100), at(k), 0.6)));
        // At 10 Hz it takes a second.
        let mut trial = Trial::NEW;
        let first = (0..20).find(|k| trial.contradicts(&frame(*k > 0), 0.1 * f64::from(*k), 0.6));
        assert_eq!(first, Some(9));
    }
}
