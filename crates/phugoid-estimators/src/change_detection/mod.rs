//! The change detector. It compares two explanations of the last second: a sudden change of the parameters, and the
//! usual slow wander that errors of this model cause.
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

pub(crate) mod challenge;

use crate::bounded::{Places, at, limited};
use crate::columns::Columns;
use crate::dense::Cholesky;
use crate::innovation::ScoredRow;
use crate::kernels::{add_scaled, dot};
use crate::settings::ChangeDetection;

const BLOCKS: usize = 20;
/// Window lengths tested, in blocks: the time of the change is unknown.
const SUFFIXES: [usize; 4] = [2, 5, 10, BLOCKS];
/// Blocks worth of information after which the wander counts as learnt.
const LEARNT: f64 = 10.0;

/// Information up to which every window is learnt from at once. After that a window is learnt from one window later,
/// and not at all if it has led to a trigger by then: a change that is only beginning to show otherwise raises `w` and
/// hides itself. A single 3-2-1-1 gives about 4.5 of it: with 5 in place of 2, 9 in 100 damages between the first and
/// the second one were missed, and 1 with 2.
const EAGER: f64 = 2.0;

/// Log Bayes factor within which a beginning of the change counts as possible, nats.
const ONSET: f64 = 3.0;

#[derive(Clone, Copy)]
struct Block<const P: usize> {
    g: [f64; P],
    /// `M = sum a^T a`, lower triangle; the entries above the diagonal are not used.
    m: [[f64; P]; P],
}

impl<const P: usize> Block<P> {
    const EMPTY: Self = Self { g: [0.0; P], m: [[0.0; P]; P] };

    /// Adds `factor` times another block where `n` columns are in use.
    fn add(&mut self, other: &Self, factor: f64, n: usize) {
        add_scaled(&mut self.g[..n], factor, &other.g[..n]);
        for i in 0..n {
            add_scaled(&mut self.m[i][..=i], factor, &other.m[i][..=i]);
        }
    }

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
    /// The statistic `q = g^T A1^-1 A2^-1 g` of the window.
    score: f64,
    /// `m`, its mean under no change.
    expected: f64,
    /// `sh = p' - tr A2^-1`.
    wander: f64,
}

#[derive(Clone, Copy)]
pub(crate) struct ChangeDetector<const P: usize> {
    settings: ChangeDetection,
    /// Columns that may change.
    tested: Places<P>,
    frames_per_block: usize,
    /// Ring; `running` is the block being filled, `filled` complete ones lie before it.
    blocks: [Block<P>; BLOCKS],
    running: usize,
    filled: usize,
    frames: usize,
    /// Number of the first frame of each block.
    begins: [u64; BLOCKS],
    since_calibration: usize,
    wander_squared: f64,
    leverage: f64,
    informative: f64,
    bayes_factor: f64,
    /// Moments of the last window. They are used one window later, and not at all if that window leads to a trigger.
    pending: Option<Moments>,
    /// Working storage of the test.
    sum: Block<P>,
    work: [[[f64; P]; P]; 2],
}

impl<const P: usize> ChangeDetector<P> {
    pub(crate) fn new<const R: usize>(settings: ChangeDetection, sample_time_s: f64, columns: &Columns<R, P>) -> Self {
        let mut tested = Places::NONE;
        for j in 0..columns.count() {
            if columns.change[j].std(columns.initial[j], columns.initial[j]) > 0.0
                || matches!(columns.change[j], super::settings::ChangePrior::Relative { .. })
            {
                tested.push(j);
            }
        }
        let frames = libm::round(settings.window_s / (BLOCKS as f64 * sample_time_s));
        Self {
            settings,
            tested,
            frames_per_block: if frames >= 1.0 { frames as usize } else { 1 },
            blocks: [Block::EMPTY; BLOCKS],
            running: 0,
            filled: 0,
            frames: 0,
            begins: [0; BLOCKS],
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
        self.tested.as_slice()
    }

    /// Adds a row, before it is used, as so much of a row as `weight` says.
    #[inline]
    pub(crate) fn observe(&mut self, row: &ScoredRow<'_>, kappa: f64, weight: f64) {
        // A row with v >= 1 still teaches the parameters more than they know; it cannot show a change.
        if row.v >= 1.0 {
            return;
        }
        let n = self.tested.len();
        let inverse = 1.0 / row.nn;
        let mut a = [0.0; P];
        for (value, column) in a[..n].iter_mut().zip(self.tested.as_slice()) {
            *value = row.psi.get(*column).copied().unwrap_or(0.0) * inverse;
        }
        let x = limited(row.xi, -kappa, kappa);
        let block = &mut self.blocks[self.running.min(BLOCKS - 1)];
        for i in 0..n {
            let ai = weight * a[i];
            block.g[i] += ai * x;
            add_scaled(&mut block.m[i][..=i], ai, &a[..=i]);
        }
    }

    /// Ends a frame that had measurements. At the end of a block gives the new log Bayes factor.
    /// `change_over_prior` is `d_j` over the prior standard deviation, per column; `number` that of the frame.
    pub(crate) fn end_frame(&mut self, change_over_prior: &[f64; P], number: u64) -> Option<f64> {
        if self.frames == 0 {
            self.begins[self.running.min(BLOCKS - 1)] = number;
        }
        self.frames += 1;
        if self.frames < self.frames_per_block || self.tested.len() == 0 {
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
        self.blocks[self.running].clear(self.tested.len());
        Some(best)
    }

    /// Numbers of the frames between which the change has begun, from the complete blocks: the first frame that it may
    /// have touched, and one before which it has begun, both up to a Bayes factor of `exp(ONSET)`. Each beginning is
    /// judged by all blocks: wander before it, a jump after it. (The Bayes factors of the windows have each its own
    /// alternative and prefer long windows.) To be asked for directly after a test.
    pub(crate) fn onset(&mut self, change_over_prior: &[f64; P]) -> [u64; 2] {
        let n = self.tested.len();
        let scale = self.scale(change_over_prior);
        // The running block has just been emptied: the newest complete one lies before it, and it has one place less.
        let complete = self.filled.min(BLOCKS - 1);
        let place = |back: usize| (self.running + BLOCKS - back.min(BLOCKS)) % BLOCKS;
        let mut likelihood = [f64::NEG_INFINITY; BLOCKS];
        let mut before = Block::EMPTY;
        for length in 1..=complete {
            before.add(&self.blocks[place(length)], 1.0, n);
        }
        self.sum.clear(n);
        for length in 1..=complete {
            let block = self.blocks[place(length)];
            self.sum.add(&block, 1.0, n);
            before.add(&block, -1.0, n);
            let after = self.evidence(&self.sum, &scale, 1.0);
            let wander = self.evidence(&before, &scale, self.wander_squared);
            if let (Some(after), Some(wander)) = (after, wander) {
                likelihood[length] = after + wander;
            }
        }
        let best = likelihood.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut possible = (1..=complete).filter(|length| likelihood[*length] > best - ONSET);
        let shortest = possible.next().unwrap_or(1);
        let longest = possible.next_back().unwrap_or(shortest);
        // The change may lie within the block before the longest window, and before that which begins the shortest.
        [self.begins[place((longest + 1).min(complete.max(1)))], self.begins[place(shortest)]]
    }

    /// Log evidence of some blocks for a deviation `N(0, size diag d^2)` of the parameters against none, nats:
    /// `1/2 [size g^T A^-1 g - ln det A]`, `A = I + size M`.
    fn evidence(&self, blocks: &Block<P>, scale: &[f64; P], size: f64) -> Option<f64> {
        let n = self.tested.len();
        let inverse_leverage = 1.0 / self.leverage;
        let mut a = [[0.0; P]; P];
        let mut g = [0.0; P];
        for i in 0..n {
            let scale_i = scale[i] * inverse_leverage;
            g[i] = blocks.g[i] * scale_i;
            for j in 0..=i {
                a[i][j] = size * blocks.m[i][j] * scale_i * scale[j];
            }
            a[i][i] += 1.0;
        }
        let cholesky = Cholesky::new(&mut a, n)?;
        cholesky.solve_lower(&mut g);
        Some(0.5 * (size * dot(&g[..n], &g[..n]) - cholesky.log_determinant()))
    }

    /// Length of the window, frames.
    pub(crate) fn window_frames(&self) -> usize {
        BLOCKS * self.frames_per_block
    }

    fn scale(&self, change_over_prior: &[f64; P]) -> [f64; P] {
        let n = self.tested.len();
        let mut scale = [0.0; P];
        for (s, column) in scale[..n].iter_mut().zip(self.tested.as_slice()) {
            *s = at(change_over_prior, *column);
        }
        scale
    }

    /// Largest log Bayes factor over the windows, and the moments of the longest one if they are wanted. The running
    /// block is the newest complete one.
    fn test(&mut self, change_over_prior: &[f64; P], with_moments: bool) -> (f64, Option<Moments>) {
        let n = self.tested.len();
        let scale = self.scale(change_over_prior);
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
                self.sum.add(block, 1.0, n);
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
        let n = self.tested.len();
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
        let gain = if excess > 0.0 || early { 0.5 } else { 0.3 };
        let [low, high] = self.settings.wander_limits;
        self.leverage = (self.leverage * libm::exp(0.1 * (1.0 - share) * excess)).clamp(1.0, 20.0);
        self.wander_squared = limited(self.wander_squared * libm::exp(gain * share * excess), low * low, high * high);
        self.informative += share;
    }

    /// Forgets the window, not what was learnt about the model.
    pub(crate) fn clear(&mut self) {
        self.blocks[self.running.min(BLOCKS - 1)].clear(self.tested.len());
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

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::{BLOCKS, ChangeDetector, SUFFIXES};
    use crate::columns::Columns;
    use crate::innovation::ScoredRow;
    use crate::settings::{ChangeDetection, ChangePrior};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    const P: usize = 11;
    const COLUMNS: usize = 9;
    /// No multiple of a block of the inner loops, and not the leading columns.
    const TESTED: [usize; 5] = [0, 2, 3, 6, 8];
    const T: usize = TESTED.len();

    /// Inverse and logarithm of the determinant by Gauss and Jordan.
    fn invert(mut a: [[f64; T]; T]) -> ([[f64; T]; T], f64) {
        let mut inverse: [[f64; T]; T] = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(i == j)));
        let mut log_determinant = 0.0;
        for k in 0..T {
            let pivot = a[k][k];
            log_determinant += pivot.ln();
            for j in 0..T {
                a[k][j] /= pivot;
                inverse[k][j] /= pivot;
            }
            for i in (0..T).filter(|i| *i != k) {
                let factor = a[i][k];
                for j in 0..T {
                    a[i][j] -= factor * a[k][j];
                    inverse[i][j] -= factor * inverse[k][j];
                }
            }
        }
        (inverse, log_determinant)
    }

    struct Window {
        g: [f64; T],
        m: [[f64; T]; T],
    }

    /// `(B, q, m, sh)` of a window of whole blocks, from the equations.
    fn window(blocks: &[Window], change: &[f64; P], w2: f64, leverage: f64) -> (f64, f64, f64, f64) {
        let sum = |part: &dyn Fn(&Window) -> f64| blocks.iter().map(part).sum::<f64>() / leverage;
        let g: [f64; T] = core::array::from_fn(|i| change[TESTED[i]] * sum(&|b| b.g[i]));
        let scaled = |i: usize, j: usize| change[TESTED[i]] * change[TESTED[j]] * sum(&|b| b.m[i][j]);
        let plus = |factor: f64| -> [[f64; T]; T] {
            core::array::from_fn(|i| core::array::from_fn(|j| f64::from(i == j) + factor * scaled(i, j)))
        };
        let (a1, log_a1) = invert(plus(1.0));
        let (a2, log_a2) = invert(plus(w2));
        let mut q = 0.0;
        for i in 0..T {
            for j in 0..T {
                for k in 0..T {
                    q += g[i] * a1[i][j] * a2[j][k] * g[k];
                }
            }
        }
        let trace = |a: &[[f64; T]; T]| (0..T).map(|i| a[i][i]).sum::<f64>();
        (0.5 * ((1.0 - w2) * q - log_a1 + log_a2), q, T as f64 - trace(&a1), T as f64 - trace(&a2))
    }

    /// Columns of unit prior, of which some may change by `d = 1`.
    fn columns(count: usize, tested: &[usize]) -> Columns<1, P> {
        let change =
            core::array::from_fn(|j| if tested.contains(&j) { ChangePrior::Fixed(1.0) } else { ChangePrior::None });
        Columns {
            count,
            own: count,
            initial: [0.0; P],
            std: [1.0; P],
            clip_low: [f64::NEG_INFINITY; P],
            clip_high: [f64::INFINITY; P],
            change,
            bias_of_output: [None],
        }
    }

    #[test]
    fn the_bayes_factor_and_the_calibration_are_those_of_the_equations() {
        let columns = columns(COLUMNS, &TESTED);
        // Three frames to a block: 1 s / (20 * 1/60 s).
        let settings = ChangeDetection { window_s: 1.0, ..ChangeDetection::default() };
        let mut detector = ChangeDetector::new(settings, 1.0 / 60.0, &columns);
        assert_eq!(detector.tested(), &TESTED);
        let mut rng = Pcg64Mcg::seed_from_u64(8);
        let mut uniform = || 2.0 * rng.random::<f64>() - 1.0;
        let mut blocks: Vec<Window> = Vec::new();
        let (mut tests, mut calibrations) = (0, 0);
        for frame in 0..400 {
            if frame == 250 {
                // In the middle of a block and of the ring.
                detector.clear();
                blocks.clear();
            }
            let since_clear = if frame >= 250 { frame - 250 } else { frame };
            if since_clear % 3 == 0 {
                blocks.push(Window { g: [0.0; T], m: [[0.0; T]; T] });
            }
            for row in 0..4 {
                let psi: [f64; COLUMNS] = core::array::from_fn(|_| 0.6 * uniform());
                let xi = 4.0 * uniform();
                // The last row still learns: no evidence.
                let v = if row == 3 { 1.0 } else { 0.5 * (1.0 + uniform()) * 0.99 };
                let nn = (1.0 + v).sqrt();
                detector.observe(&ScoredRow { output: 0, psi: &psi, xi, v, nn }, 3.0, 1.0);
                if row < 3 {
                    let block = blocks.last_mut().unwrap();
                    for i in 0..T {
                        block.g[i] += psi[TESTED[i]] / nn * xi.clamp(-3.0, 3.0);
                        for j in 0..T {
                            block.m[i][j] += psi[TESTED[i]] * psi[TESTED[j]] / (nn * nn);
                        }
                    }
                }
            }
            let change: [f64; P] = core::array::from_fn(|j| 0.3 + 0.05 * j as f64 + 0.001 * f64::from(frame));
            let (w2, leverage) = (detector.wander_squared(), detector.leverage());
            let answer = detector.end_frame(&change, frame as u64);
            assert_eq!(answer.is_some(), since_clear % 3 == 2, "frame {frame}");
            let Some(factor) = answer else { continue };
            let of = |length: usize| window(&blocks[blocks.len() - length..], &change, w2, leverage);
            let expected = SUFFIXES.into_iter().filter(|l| *l <= blocks.len()).map(|l| of(l).0).reduce(f64::max);
            assert!((factor - expected.unwrap_or(0.0)).abs() < 1e-10, "frame {frame}: {factor} {expected:?}");
            tests += 1;
            if blocks.len().is_multiple_of(BLOCKS) && detector.informative() < 2.0 {
                let (_, q, m, sh) = of(BLOCKS);
                let share = sh / m;
                let excess = (q / m).min(4.0) - 1.0;
                let gain = 0.5;
                let [low, high] = settings.wander_limits;
                let wander = (w2 * (gain * share * excess).exp()).clamp(low * low, high * high);
                let level = (leverage * (0.1 * (1.0 - share) * excess).exp()).clamp(1.0, 20.0);
                assert!((detector.wander_squared() / wander - 1.0).abs() < 1e-9);
                assert!((detector.leverage() / level - 1.0).abs() < 1e-9);
                calibrations += 1;
            } else {
                assert_eq!((detector.wander_squared(), detector.leverage()), (w2, leverage), "frame {frame}");
            }
        }
        assert!(tests > 100 && calibrations >= 2, "{tests} {calibrations}");
    }

    /// One column, rows of equal weight, three frames to a block; from frame 91 on the innovations have a mean.
    #[test]
    fn the_onset_lies_within_what_the_blocks_tell() {
        let columns = columns(1, &[0]);
        let mut rng = Pcg64Mcg::seed_from_u64(21);
        let (mut inside, mut width) = (0, 0);
        for _ in 0..200 {
            let mut detector = ChangeDetector::new(ChangeDetection::default(), 1.0 / 60.0, &columns);
            assert_eq!(detector.window_frames(), 60);
            for number in 1..=400_u64 {
                // Uniform noise of variance one.
                let noise = 3.0_f64.sqrt() * (2.0 * rng.random::<f64>() - 1.0);
                let xi = noise + if number >= 91 { 1.5 } else { 0.0 };
                detector.observe(&ScoredRow { output: 0, psi: &[1.0], xi, v: 0.0, nn: 1.0 }, 3.0, 1.0);
                let Some(factor) = detector.end_frame(&[1.0; P], number) else { continue };
                if factor > 15.0 {
                    let [first, last] = detector.onset(&[1.0; P]);
                    assert!(first <= last && last <= number && number >= 91, "{first} {last} {number}");
                    inside += usize::from(first <= 91 && 91 <= last + 3);
                    width += last - first;
                    break;
                }
            }
        }
        // Measured: 142, within a block. The trigger chooses moments at which chance has helped; wider is not better
        // (a margin of 6 nats gives away data after the change, docs/theory.md).
        std::println!("{inside} of 200, mean width {} frames", width / 200);
        assert!(inside >= 130, "{inside} of 200");
        assert!(width < 200 * 24, "{width}");
    }
}
