//! How the outputs of a run agreed with their predictions: the size of the innovations, and for how long one was locked
//! out by the gate.

use phugoid_estimators::{Innovations, RowPhase};

/// Rejected time that an accepted row of the same length takes back: an output of which one row in five is accepted is
/// locked out as well.
const TAKEN_BACK: f64 = 4.0;

/// Sums over a run, by output.
#[derive(Clone, Copy, Debug)]
pub(super) struct Consistency<const R: usize> {
    squares: [f64; R],
    rows: [f64; R],
    last_s: [f64; R],
    locked_out_s: [f64; R],
    longest_s: [f64; R],
}

/// What came of one output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OutputUse {
    /// Mean square of the normalised innovations since the first motion; NaN without one.
    pub(crate) mean_square: f64,
    /// Longest time in which more than four of five measured rows were rejected, s.
    pub(crate) longest_rejected_s: f64,
}

impl<const R: usize> Consistency<R> {
    pub(super) const NONE: Self =
        Self { squares: [0.0; R], rows: [0.0; R], last_s: [f64::NAN; R], locked_out_s: [0.0; R], longest_s: [0.0; R] };

    /// Takes the rows of the frame at `time_s`; their squares count once something has moved. What is not measured is
    /// neither accepted nor rejected; what is measured and makes no row of the method is not rejected.
    pub(super) fn note(&mut self, time_s: f64, measured: &[f64; R], innovations: &Innovations<R>, has_moved: bool) {
        for i in 0..R {
            let xi = innovations.normalised[i];
            if has_moved && xi.is_finite() {
                self.squares[i] += xi * xi;
                self.rows[i] += 1.0;
            }
            if !measured[i].is_finite() {
                continue;
            }
            let interval_s = time_s - self.last_s[i];
            self.last_s[i] = time_s;
            if interval_s.is_nan() {
                continue;
            }
            let locked_out_s = &mut self.locked_out_s[i];
            if innovations.phase[i] == RowPhase::Rejected {
                *locked_out_s += interval_s;
                self.longest_s[i] = self.longest_s[i].max(*locked_out_s);
            } else {
                *locked_out_s = (*locked_out_s - TAKEN_BACK * interval_s).max(0.0);
            }
        }
    }

    pub(super) fn outputs(&self) -> Vec<OutputUse> {
        let of =
            |i: usize| OutputUse { mean_square: self.squares[i] / self.rows[i], longest_rejected_s: self.longest_s[i] };
        (0..R).map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Consistency, Innovations, OutputUse, RowPhase};

    fn after(frames: u32, phase: impl Fn(u32) -> RowPhase) -> OutputUse {
        let mut consistency = Consistency::<1>::NONE;
        for k in 0..frames {
            let phase = phase(k);
            let xi = if phase == RowPhase::Missing { f64::NAN } else { 2.0 };
            let of =
                Innovations { predicted: [0.0], normalised: [xi], whitened: [xi], variance: [1.0], phase: [phase] };
            let measured = if phase == RowPhase::Missing { f64::NAN } else { 1.0 };
            consistency.note(0.1 * f64::from(k), &[measured], &of, k >= 50);
        }
        consistency.outputs()[0]
    }

    /// Neither a lost row nor one accepted row lets a locked channel look open; when it is accepted again, the time ends.
    #[test]
    fn the_longest_rejection_is_the_time_with_hardly_an_accepted_row() {
        let found = after(100, |k| match k {
            40 => RowPhase::Missing,
            20..70 => RowPhase::Rejected,
            _ => RowPhase::Sliding,
        });
        assert!((found.longest_rejected_s - 5.0).abs() < 1e-9, "{found:?}");
        assert!((found.mean_square - 4.0).abs() < 1e-12, "{found:?}");
        // One row in ten is accepted: nine are counted less four.
        let hardly = after(1001, |k| if k % 10 == 0 { RowPhase::Sliding } else { RowPhase::Rejected });
        assert!((hardly.longest_rejected_s - 50.4).abs() < 1.0, "{hardly:?}");
        // Outliers, even in many rows, lock nothing out.
        let outliers = after(1001, |k| if k % 2 == 0 { RowPhase::Sliding } else { RowPhase::Rejected });
        assert!(outliers.longest_rejected_s < 0.11, "{outliers:?}");
    }
}
