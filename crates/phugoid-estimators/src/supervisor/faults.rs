//! Weights of rejected rows as evidence of a change. Damage disturbs several outputs at once, a failing sensor only its
//! own output: an output that is rejected while the others are predicted well is not taken for a change of the
//! aircraft.

use crate::bounded::at;
use crate::change_detection::ChangeDetector;
use crate::innovation::{Innovations, ScoredRow};
use crate::statistics::median;

/// Weight of a rejected row when others are disturbed too: outliers that coincide must not look like a change.
const REJECTED_WEIGHT: f64 = 0.05;
/// ... until the output has been rejected for this long, s: a change so violent that it throws rows beyond the
/// rejection limit is found after it.
const BORNE_S: f64 = 0.5;
/// Part of a frame by which that time shrinks with each frame that is not rejected.
const RECOVERY: f64 = 0.25;
/// Memory of the mean squares of the other outputs, s: a burst lasts about as long.
const MEMORY_S: f64 = 0.2;
/// Median of their mean squares below which the other outputs do not show what one output shows. It is one if the model
/// is right, with a scatter of 0.3 at 100 Hz, and nine at most.
const UNDISTURBED: f64 = 2.0;
/// Largest square of a normalised surface that counts.
const LARGEST_SQUARE: f64 = 9.0;

/// For how long each output has been rejected, and how well it has been predicted of late.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faults<const R: usize> {
    rejected_s: [f64; R],
    /// Bounded mean squares; NaN of an output that has not been seen.
    mean_square: [f64; R],
}

impl<const R: usize> Faults<R> {
    pub(crate) const NONE: Self = Self { rejected_s: [0.0; R], mean_square: [f64::NAN; R] };

    /// What a row counts as evidence.
    #[inline]
    pub(crate) fn weight(&self, output: usize, xi: f64, rejection_limit: f64) -> f64 {
        if xi.abs() <= rejection_limit {
            1.0
        } else if self.is_alone(output) {
            0.0
        } else if at(&self.rejected_s, output) < BORNE_S {
            REJECTED_WEIGHT
        } else {
            1.0
        }
    }

    /// True of an output that has not been beyond the limit of rejection for long while the others are undisturbed: what
    /// lies beyond it is a burst of outliers of this output.
    pub(crate) fn bursts(&self, output: usize) -> bool {
        at(&self.rejected_s, output) < BORNE_S && self.is_alone(output)
    }

    /// The outputs that the gate has refused for half a second while at least half of them are used. Where most are
    /// refused the state is lost, and is started again.
    pub(crate) fn locked_out(&self) -> [bool; R] {
        let locked_out = self.rejected_s.map(|time_s| time_s >= BORNE_S);
        let locked = locked_out.iter().filter(|locked| **locked).count();
        let seen = self.mean_square.iter().filter(|mean| mean.is_finite()).count();
        if 2 * locked <= seen { locked_out } else { [false; R] }
    }

    /// True if there are other outputs and they do not show what this one shows. Their median is used, so that
    /// overlapping bursts of outliers in two outputs do not confirm each other.
    fn is_alone(&self, output: usize) -> bool {
        let mut others = [0.0; R];
        let mut count = 0;
        for (i, mean) in self.mean_square.iter().enumerate() {
            if i != output && mean.is_finite() {
                others[count] = *mean;
                count += 1;
            }
        }
        count > 0 && median(&mut others[..count.min(R)]) < UNDISTURBED
    }

    /// How well a frame was predicted.
    pub(crate) fn merit(&self, innovations: &Innovations<R>, rejection_limit: f64) -> Merit {
        let mut merit = Merit::NONE;
        for (output, (xi, variance)) in innovations.normalised.iter().zip(&innovations.variance).enumerate() {
            if xi.is_finite() {
                merit.misfit += self.weight(output, *xi, rejection_limit) * (xi * xi).min(LARGEST_SQUARE);
                merit.variance *= variance;
                merit.rows += 1;
            }
        }
        merit
    }

    /// Learns from a frame how well each output is predicted and for how long it has been rejected.
    /// `gate` is the limit beyond which the filter does not use a row.
    pub(crate) fn note(&mut self, innovations: &Innovations<R>, gate: f64, sample_time_s: f64) {
        let forgotten = (sample_time_s / MEMORY_S).min(1.0);
        let outputs = self.rejected_s.iter_mut().zip(&mut self.mean_square);
        for ((time_s, mean), xi) in outputs.zip(&innovations.normalised) {
            if !xi.is_finite() {
                continue;
            }
            let before = if mean.is_finite() { *mean } else { 1.0 };
            *mean = before + forgotten * ((xi * xi).min(LARGEST_SQUARE) - before);
            if xi.abs() > gate {
                *time_s = (*time_s + sample_time_s).min(2.0 * BORNE_S);
            } else {
                *time_s = (*time_s - RECOVERY * sample_time_s).max(0.0);
            }
        }
    }
}

/// The change detector with what it needs to judge a row. (A closure in its place would be another type at each call,
/// and the whole correction of a frame compiled again for each.)
pub struct Watch<'a, const R: usize, const P: usize> {
    pub(crate) detector: &'a mut ChangeDetector<P>,
    pub(crate) faults: &'a Faults<R>,
    /// Normalised surface up to which a row counts in full.
    pub(crate) reaching_limit: f64,
    /// Normalised surface beyond which it is rejected.
    pub(crate) rejection_limit: f64,
}

impl<const R: usize, const P: usize> Watch<'_, R, P> {
    /// Takes a row before the estimate does.
    #[inline]
    pub(crate) fn see(&mut self, row: &ScoredRow<'_>) {
        let weight = self.faults.weight(row.output, row.xi, self.rejection_limit);
        self.detector.observe(row, self.reaching_limit, weight);
    }
}

/// How well a frame was predicted: one outlier costs 4.5 nats at most, and nothing where it is a sensor's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Merit {
    /// Sum of the weighted bounded squares.
    misfit: f64,
    /// Product of the predicted variances.
    variance: f64,
    /// Number of rows that were measured.
    rows: u16,
}

impl Merit {
    pub(crate) const NONE: Self = Self { misfit: 0.0, variance: 1.0, rows: 0 };

    /// Nats by which another prediction of the same frame explains it better: `sum 1/2 [(f_A min(xi_A^2, 9) - f_B
    /// min(xi_B^2, 9))/lev + ln(s_A (1+v_A)) - ln(s_B (1+v_B))]`, weights `f`. Zero if the two have not predicted the
    /// same rows.
    pub(crate) fn nats_for(&self, other: &Self, leverage: f64) -> f64 {
        if self.rows != other.rows {
            return 0.0;
        }
        0.5 * ((self.misfit - other.misfit) / leverage + libm::log(self.variance / other.variance))
    }
}

#[cfg(test)]
mod tests {
    use super::{Faults, Merit};
    use crate::innovation::Innovations;

    const LIMIT: f64 = 6.0;

    fn rows<const R: usize>(normalised: [f64; R]) -> Innovations<R> {
        Innovations { normalised, variance: [1.0; R], ..Innovations::EMPTY }
    }

    fn after<const R: usize>(frames: usize, normalised: [f64; R]) -> Faults<R> {
        let mut faults = Faults::NONE;
        (0..frames).for_each(|_| faults.note(&rows(normalised), LIMIT, 0.01));
        faults
    }

    /// However long it lasts, what one output shows and the others do not is that output's own; two bursts at once as
    /// well.
    #[test]
    fn a_burst_is_no_evidence_and_a_change_that_all_see_is() {
        for frames in [1, 30, 300] {
            assert_eq!(after(frames, [20.0, 1.0, 1.0, 1.0, 1.0, 1.0]).weight(0, 20.0, LIMIT), 0.0);
            assert_eq!(after(frames, [20.0, -20.0, 1.0, 1.0, 1.0, 1.0]).weight(1, -20.0, LIMIT), 0.0);
        }
        // Half of the others are disturbed: little at first, and fully when it goes on for longer than a burst.
        assert_eq!(after(30, [20.0, 8.0, 4.0, 3.0, 1.0, 1.0]).weight(0, 20.0, LIMIT), 0.05);
        assert_eq!(after(51, [20.0, 8.0, 4.0, 3.0, 1.0, 1.0]).weight(0, 20.0, LIMIT), 1.0);
        // What is not rejected counts.
        assert_eq!(after(51, [5.9, 1.0, 1.0]).weight(0, 5.9, LIMIT), 1.0);
        // Without other outputs the row counts in full; an output that is not measured does not count as another one.
        assert_eq!(after(51, [20.0]).weight(0, 20.0, LIMIT), 1.0);
        assert_eq!(after(51, [20.0, f64::NAN]).weight(0, 20.0, LIMIT), 1.0);
        assert_eq!(after(51, [20.0, f64::NAN, 3.0]).weight(0, 20.0, LIMIT), 1.0);
    }

    /// Against the formula, row by row; a rejected one counts little, and frames of which not the same rows were
    /// predicted not at all.
    #[test]
    fn the_score_is_the_bounded_difference_of_the_log_likelihoods() {
        let of = |normalised: [f64; 3], variance: [f64; 3]| Innovations { normalised, variance, ..Innovations::EMPTY };
        let disturbed = after(5, [8.0, 8.0, 8.0]);
        let champion = disturbed.merit(&of([2.0, 50.0, f64::NAN], [4.0, 2.0, f64::NAN]), LIMIT);
        let challenger = disturbed.merit(&of([0.5, 1.0, f64::NAN], [5.0, 2.5, f64::NAN]), LIMIT);
        let expected = 0.5 * ((4.0 - 0.25 + 0.05 * 9.0 - 1.0) / 2.0 + (4.0_f64 / 5.0).ln() + (2.0_f64 / 2.5).ln());
        let nats = champion.nats_for(&challenger, 2.0);
        assert!((nats - expected).abs() < 1e-12 * expected.abs(), "{nats} {expected}");
        // The other way round takes it back.
        assert!((challenger.nats_for(&champion, 2.0) + nats).abs() < 1e-12);
        assert_eq!(champion.nats_for(&Merit::NONE, 2.0), 0.0);
    }
}
