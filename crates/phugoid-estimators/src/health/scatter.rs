//! How far the innovations of the reference scatter along the monitored columns, against what white noise of the level
//! in use would do: colour, a level that is too small, and terms that the model lacks, which grow with the motion.
//!
//! Time is cut into blocks. If the healthy deviation explains the flight, what a block says of another one is noise: its
//! score `s = sum a^T (x - a d)` has the covariance `M` of the block. So `s^T (M + I)^-1 s` is as large in the mean as
//! the degrees of freedom that the block has left, `tr (M + I)^-1 (I - M T^-1) M` with `T` the information of all
//! blocks, which `d` was fitted to, and of the tolerance. The ratio of the two sums is the scatter; the evidence is that
//! of a noise whose variance is larger by it.

use super::evidence::{Information, Limits};

/// Length of a block, s: the shortest time in which a manoeuvre says something of several columns. What is coloured over
/// a longer time shows in part only.
const BLOCK_S: f64 = 2.0;
/// A block counts as no more than this many times the scatter so far: a failure lies in few blocks, and must not hide
/// itself by making all that is expected larger.
const LARGEST: f64 = 4.0;
/// A block with fewer degrees of freedom than this says nothing.
const SMALLEST_FREEDOM: f64 = 0.05;

#[derive(Clone)]
pub(super) struct Scatter<const P: usize> {
    block: Information<P>,
    since_s: f64,
    /// Scatter that is assumed at first, and the degrees of freedom that it is worth.
    assumed: f64,
    weight: f64,
    square: f64,
    freedom: f64,
}

impl<const P: usize> Scatter<P> {
    pub(super) fn new(assumed: f64, weight: f64) -> Self {
        Self { block: Information::NONE, since_s: f64::NAN, assumed, weight, square: 0.0, freedom: 0.0 }
    }

    /// Variance of the scores over what the noise levels in use make of them, at least one. It does not depend on the
    /// block that is not yet over.
    pub(super) fn in_use(&self) -> f64 {
        let mean = (self.weight * self.assumed + self.square) / (self.weight + self.freedom);
        if mean.is_finite() { mean.max(1.0) } else { self.assumed.max(1.0) }
    }

    /// As far as it was seen in this flight, without what is assumed (NaN before anything was seen), and the degrees of
    /// freedom behind it.
    pub(super) fn seen(&self) -> [f64; 2] {
        [self.square / self.freedom, self.freedom]
    }

    pub(super) fn add(&mut self, a: &[f64; P], x: f64, len: usize) {
        self.block.add(a, x, len);
    }

    /// Deviations are counted from another point.
    pub(super) fn recentre(&mut self, step: &[f64; P], len: usize) {
        self.block.recentre(step, len);
    }

    /// What was seen of the present block is left out: the sums for the healthy deviation begin anew.
    pub(super) fn begin_block(&mut self) {
        self.block = Information::NONE;
        self.since_s = f64::NAN;
    }

    /// Ends the block if it is long enough. Deviations are counted from the most likely healthy one, and `total` is the
    /// information of the whole flight on it.
    pub(super) fn look(&mut self, time_s: f64, total: &Information<P>, limits: &Limits<P>, len: usize) {
        if self.since_s.is_nan() {
            self.since_s = time_s;
        }
        if time_s - self.since_s < BLOCK_S - 1e-9 {
            return;
        }
        self.since_s = time_s;
        if let Some([square, freedom]) = self.block.scatter(total, limits, len)
            && square.is_finite()
            && freedom >= SMALLEST_FREEDOM
        {
            self.square += square.min(LARGEST * self.in_use() * freedom);
            self.freedom += freedom;
        }
        self.block = Information::NONE;
    }
}
