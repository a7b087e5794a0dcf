//! The change detector: is a sudden change of the parameters a better explanation of the last second than the usual
//! wander of this model?
//!
//! The rows are whitened exactly: with `a = psi/nn` the innovations `xi = e/nn` are white with variance one for *any*
//! covariance `C`, so `g = sum a^T xi` has covariance `M = sum a^T a` under constant parameters. For a jump
//! `N(0, diag d^2)` against a wander `N(0, w^2 diag d^2)` the log Bayes factor is (columns scaled by `d`)
//!
//! ```text
//! A1 = I + M,  A2 = I + w^2 M,  q = g^T A1^-1 A2^-1 g
//! B  = 1/2 [ (1 - w^2) q - ln det A1 + ln det A2 ]
//! ```
//!
//! `w` (model error) and the leverage `lev` (coloured noise) are learnt in flight from `q` itself; docs/theory.md
//! derives it.

use super::columns::Columns;
use super::settings::ChangeDetection;
use super::slot::ScoredRow;
use crate::dense::Cholesky;
use crate::kernels::{add_scaled, dot};

const BLOCKS: usize = 20;
/// Window lengths tested, in blocks: the time of the change is unknown.
const SUFFIXES: [usize; 4] = [2, 5, 10, BLOCKS];
/// Blocks worth of information after which the wander counts as learnt.
const LEARNT: f64 = 10.0;

/// Information up to which every window is learnt from at once. After that a window is learnt from one window later, and
/// not at all if it has led to a trigger by then: a change that is only beginning to show otherwise raises `w` and hides
/// itself.
const EAGER: f64 = 5.0;

#[derive(Clone, Copy)]
struct Block<const P: usize> {
    g: [f64; P],
    /// Lower triangle.
    m: [[f64; P]; P],
}

impl<const P: usize> Block<P> {
    const EMPTY: Self = Self { g: [0.0; P], m: [[0.0; P]; P] };

    /// Zero where `n` columns are in use.
    fn clear(&mut self, n: usize) {
        self.g[..n].fill(0.0);
        for row in &mut self.m[..n] {
            row[..n].fill(0.0);
        }
    }
}

/// What calibration needs of the longest window.
#[derive(Clone, Copy)]
struct Moments {
    /// `q`.
    score: f64,
    /// `m`, its mean under no change.
    expected: f64,
    /// `sh = p' - tr A2^-1`.
    wander: f64,
}

#[derive(Clone, Copy)]
pub(crate) struct ChangeDetector<const P: usize> {
    settings: ChangeDetection,
    /// Columns that may change, and their number.
    tested: [usize; P],
    count: usize,
    frames_per_block: usize,
    /// Ring; `running` is the block being filled, `filled` complete ones lie before it.
    blocks: [Block<P>; BLOCKS],
    running: usize,
    filled: usize,
    frames: usize,
    since_calibration: usize,
    wander_squared: f64,
    leverage: f64,
    informative: f64,
    bayes_factor: f64,
    /// What the last window had to say, not yet believed.
    pending: Option<Moments>,
    /// Working storage of the test.
    sum: Block<P>,
    work: [[[f64; P]; P]; 2],
}

impl<const P: usize> ChangeDetector<P> {
    pub(crate) fn new<const N: usize, const R: usize>(
        settings: ChangeDetection,
        sample_time_s: f64,
        columns: &Columns<N, R, P>,
    ) -> Self {
        let mut tested = [0; P];
        let mut count = 0;
        for j in 0..columns.count {
            if columns.change[j].sd(columns.initial[j], columns.initial[j]) > 0.0
                || matches!(columns.change[j], super::settings::ChangePrior::Relative { .. })
            {
                tested[count] = j;
                count += 1;
            }
        }
        let frames = libm::round(settings.window_s / (BLOCKS as f64 * sample_time_s));
        Self {
            settings,
            tested,
            count,
            frames_per_block: if frames >= 1.0 { frames as usize } else { 1 },
            blocks: [Block::EMPTY; BLOCKS],
            running: 0,
            filled: 0,
            frames: 0,
            since_calibration: 0,
            wander_squared: settings.initial_wander * settings.initial_wander,
            leverage: 1.0,
            informative: 0.0,
            bayes_factor: 0.0,
            pending: None,
            sum: Block::EMPTY,
            work: [[[0.0; P]; P]; 2],
        }
    }

    /// Indices of the columns that may change.
    pub(crate) fn tested(&self) -> &[usize] {
        &self.tested[..self.count.min(P)]
    }

    /// Adds a row, before it is used.
    #[inline]
    pub(crate) fn observe(&mut self, row: &ScoredRow<'_>, kappa: f64) {
        // A row with v >= 1 is still being learnt from; it is no evidence of a change.
        if row.v >= 1.0 {
            return;
        }
        let n = self.count.min(P);
        let inverse = 1.0 / row.nn;
        let mut a = [0.0; P];
        for (value, column) in a[..n].iter_mut().zip(&self.tested[..n]) {
            *value = row.psi.get(*column).copied().unwrap_or(0.0) * inverse;
        }
        let x = row.xi.clamp(-kappa, kappa);
        let block = &mut self.blocks[self.running];
        for i in 0..n {
            let ai = a[i];
            block.g[i] += ai * x;
            add_scaled(&mut block.m[i][..=i], ai, &a[..=i]);
        }
    }

    /// Ends a frame that had measurements. At the end of a block gives the new log Bayes factor.
    /// `change_over_prior` is `d_j` over the prior standard deviation, per column.
    pub(crate) fn end_frame(&mut self, change_over_prior: &[f64; P]) -> Option<f64> {
        self.frames += 1;
        if self.frames < self.frames_per_block || self.count == 0 {
            return None;
        }
        self.frames = 0;
        self.filled = (self.filled + 1).min(BLOCKS);
        self.since_calibration += 1;

        let calibration_is_due = self.since_calibration >= BLOCKS && self.filled == BLOCKS;
        let (best, moments) = self.test(change_over_prior, calibration_is_due);
        self.bayes_factor = best;
        if let Some(moments) = moments {
            self.since_calibration = 0;
            if self.informative < EAGER {
                self.calibrate(&moments);
            } else {
                let pending = self.pending.replace(moments);
                if let (Some(pending), true) = (pending, best < 0.7 * self.settings.trigger) {
                    self.calibrate(&pending);
                }
            }
        }

        self.running = (self.running + 1) % BLOCKS;
        self.blocks[self.running].clear(self.count.min(P));
        Some(best)
    }

    /// Largest log Bayes factor over the windows, and the moments of the longest one if they are wanted. The running
    /// block is the newest complete one.
    fn test(&mut self, change_over_prior: &[f64; P], with_moments: bool) -> (f64, Option<Moments>) {
        let n = self.count.min(P);
        let mut scale = [0.0; P];
        for (s, column) in scale[..n].iter_mut().zip(&self.tested[..n]) {
            *s = change_over_prior[*column];
        }
        self.sum.clear(n);
        let mut taken = 0;
        let mut best = f64::NEG_INFINITY;
        let mut moments = None;
        for length in SUFFIXES {
            if length > self.filled {
                break;
            }
            while taken < length {
                let block = &self.blocks[(self.running + BLOCKS - taken) % BLOCKS];
                add_scaled(&mut self.sum.g[..n], 1.0, &block.g[..n]);
                for i in 0..n {
                    add_scaled(&mut self.sum.m[i][..=i], 1.0, &block.m[i][..=i]);
                }
                taken += 1;
            }
            if let Some((factor, window)) = self.window(&scale, with_moments && length == BLOCKS) {
                best = best.max(factor);
                moments = window;
            }
        }
        (if best.is_finite() { best } else { 0.0 }, moments)
    }

    /// Log Bayes factor of the summed window.
    fn window(&mut self, scale: &[f64; P], with_moments: bool) -> Option<(f64, Option<Moments>)> {
        let n = self.count.min(P);
        let w2 = self.wander_squared;
        let inverse_leverage = 1.0 / self.leverage;
        let [a1, a2] = &mut self.work;
        let mut left = [0.0; P];
        for i in 0..n {
            let scale_i = scale[i] * inverse_leverage;
            left[i] = self.sum.g[i] * scale_i;
            for j in 0..=i {
                let m = self.sum.m[i][j] * scale_i * scale[j];
                a1[i][j] = m;
                a2[i][j] = w2 * m;
            }
            a1[i][i] += 1.0;
            a2[i][i] += 1.0;
        }
        let jump = Cholesky::new(a1, n)?;
        let wander = Cholesky::new(a2, n)?;
        let mut right = left;
        jump.solve(&mut left);
        wander.solve(&mut right);
        // A1 and A2 commute, so g^T A1^-1 A2^-1 g is this product.
        let score = dot(&left[..n], &right[..n]);
        let factor = 0.5 * ((1.0 - w2) * score - jump.log_determinant() + wander.log_determinant());
        let moments = with_moments.then(|| Moments {
            score,
            expected: n as f64 - jump.inverse_trace(),
            wander: n as f64 - wander.inverse_trace(),
        });
        Some((factor, moments))
    }

    /// Learns the wander and the leverage: under no change `E[q] = m = p' - tr A1^-1`, of which `sh` grows with `w`.
    fn calibrate(&mut self, moments: &Moments) {
        let m = moments.expected;
        if m <= 0.3 {
            return;
        }
        let share = (moments.wander / m).clamp(0.0, 1.0);
        let excess = (moments.score / m).min(4.0) - 1.0;
        let early = self.informative < LEARNT;
        let gain = match (excess > 0.0, early) {
            (true, true) => 1.0,
            (true, false) | (false, true) => 0.5,
            (false, false) => 0.3,
        };
        let [low, high] = self.settings.wander_limits;
        self.leverage = (self.leverage * libm::exp(0.1 * (1.0 - share) * excess)).clamp(1.0, 20.0);
        self.wander_squared = (self.wander_squared * libm::exp(gain * share * excess)).clamp(low * low, high * high);
        self.informative += share;
    }

    /// Forgets the window, not what was learnt about the model.
    pub(crate) fn clear(&mut self) {
        self.blocks[self.running].clear(self.count.min(P));
        self.filled = 0;
        self.frames = 0;
        self.since_calibration = 0;
        self.bayes_factor = 0.0;
        self.pending = None;
    }

    /// Takes more wander for granted (chain breaker).
    pub(crate) fn widen_wander(&mut self, factor: f64) {
        let high = self.settings.wander_limits[1];
        self.wander_squared = (self.wander_squared * factor).min(high * high);
    }

    pub(crate) fn wander(&self) -> f64 {
        libm::sqrt(self.wander_squared)
    }

    pub(crate) fn wander_squared(&self) -> f64 {
        self.wander_squared
    }

    pub(crate) fn leverage(&self) -> f64 {
        self.leverage
    }

    pub(crate) fn bayes_factor(&self) -> f64 {
        self.bayes_factor
    }

    pub(crate) fn has_learnt(&self) -> bool {
        self.informative >= LEARNT
    }

    pub(crate) fn informative(&self) -> f64 {
        self.informative
    }
}
