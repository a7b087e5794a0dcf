//! Noise levels and scales of the process noise by recursive maximum likelihood.
//!
//! A filter for the state alone runs on the estimator's transition `A`, output Jacobian `H` and residuals `y - h`, with the
//! levels `r_i` and the process noise `q_k Qx` of which the logarithms are the unknowns `eta`. With it run its derivatives by
//! each of them, those of its gains included:
//!
//! ```text
//! P <- A P A^T + q Qx h,   d <- A d                         d: state of this filter less that of the estimator
//! row i:  s = H P H^T + r_i,   S = s + w_i,   eps = y_i - h_i - H d,   d <- d + P H^T eps/S,   P <- P - P H^T H P/s
//!         s' = H P' H^T (+ r_i for its own level),   eps' = -H d'       the same by each unknown, and P', d' likewise
//!         slope += s'/(2 S) (eps^2/S - 1) - eps eps'/S
//!         F     += s' s'^T/(2 S^2) + eps' eps'^T/S
//! frame:  eta <- eta + F^-1 slope,   F <- (1 - mu) F
//! ```
//!
//! (Ljung and Soderstrom, *Theory and Practice of Recursive Identification*, 1983; the slope and `F` are those of Gupta and
//! Mehra, IEEE TAC 19, 1974, that filter error uses.) `w_i` is what the unknown parameters add to the variance; a row that still
//! teaches them (`w_i >= s_i` of the estimator) teaches no level. `mu` forgets within half of the flight, 30 s at most.
//! Innovations are bounded, so that outliers teach nothing and a level that is far too small rises quickly.

use super::frame::Frame;
use crate::bounded::limited;
use crate::dense::Cholesky;
use crate::settings::{LearntLevels, NoiseLearning, SCALES};

/// Bound of a squared innovation in the slope, and its mean under a normal density, `E min(z^2, 9)`.
const BOUND: f64 = 9.0;
const BOUNDED_MEAN: f64 = 0.995;
/// The same bound where the frame before was beyond [`BOUND`] too: a level that is wrong rises by a factor of e per
/// frame in the beginning, and single outliers do not raise it.
const BOUND_IN_SUCCESSION: f64 = 25.0;
/// Information about the logarithm of a level, and of a scale, that a step counts on at least. Little of it for a scale: where
/// the process noise is small beside the noise of the sensors, each frame says little of it.
const LEAST_OF_A_LEVEL: f64 = 10.0;
const LEAST_OF_A_SCALE: f64 = 0.5;
/// Part of that which is added besides, so that the factorisation exists where two unknowns cannot be told apart.
const ADDED: f64 = 0.1;
/// Standard deviations up to which an innovation moves the state.
const OFFSET_LIMIT: f64 = 3.0;
/// Limits of one step of the logarithm of a variance.
const STEP: [f64; 2] = [-0.5, 1.0];
/// Shortest and longest memory, s; between them half of the flight.
const MEMORY_S: [f64; 2] = [0.3, 30.0];
/// Time after which a burst of outliers in one output is told from a level that is too small, s: before it the start
/// value of the level may be anything.
const CALIBRATED_S: f64 = 2.0;
/// Part of the information, and of the time, that counts where levels that were known before are learnt again.
const CARRIED_OVER: f64 = 0.5;
/// A slow scale rises freely until the parameters have been known for so long, s, and then by a factor of e in this time, s.
/// What a model lacks belongs to the model and stays; a sudden change of the aircraft looks like process noise too, and has to be
/// found before it is taken for that.
const FREE_S: f64 = 8.0;
const RISES_IN_S: f64 = 20.0;
/// Smallest and largest variance of a row: nothing overflows in products.
const VARIANCE_LIMITS: [f64; 2] = [1e-24, 1e24];
/// Most levels and scales that are learnt together.
const UNKNOWNS: usize = 20;

/// The filter's state and covariance, or their derivatives by one unknown.
#[derive(Clone, Copy, Debug)]
struct State<const N: usize> {
    covariance: [[f64; N]; N],
    offset: [f64; N],
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Likelihood<const N: usize, const R: usize> {
    /// The offset is the state of this filter less that of the estimator.
    state: State<N>,
    variance: [f64; R],
    log_scale: [f64; SCALES],
    /// Scales in use, in the order of the states.
    scales: usize,
    scale_of: [Option<usize>; N],
    slow: [bool; SCALES],
    /// Logarithm of the lowest and highest scale.
    limits: [[f64; 2]; SCALES],
    variance_per_s: [f64; N],
    /// Factor on the process noise of states that have no scale of their own.
    fixed_scale: f64,
    /// Derivatives by the logarithms of the levels and of the scales.
    of_level: [State<N>; R],
    of_scale: [State<N>; SCALES],
    /// Fisher information about the logarithms, levels first, lower triangle.
    information: [[f64; UNKNOWNS]; UNKNOWNS],
    /// Squared innovation of each output at its last frame.
    before: [f64; R],
    /// Lowest variance per output.
    floor: [f64; R],
    used: [bool; R],
    /// Time since the first frame, and since a row taught the parameters more than they knew, s.
    elapsed_s: f64,
    settled_s: f64,
    /// Until when what is known is used as it is, s.
    known_until_s: Option<f64>,
}

/// One row of a frame, as this filter sees it.
struct Row<'a, const N: usize> {
    h: &'a [f64; N],
    p_h: [f64; N],
    /// Of `s` and `S`.
    inverse_own: f64,
    inverse_whole: f64,
    /// Gain over `P H^T`, and whether the innovation was bounded for it.
    gain: f64,
    clipped: bool,
    /// Whether the row moves the state, and makes the covariance smaller.
    moves: bool,
    shrinks: bool,
}

impl<const N: usize, const R: usize> Likelihood<N, R> {
    /// `fixed_scale` is that of a process noise that does not adapt.
    pub(crate) fn new(
        noise_std: &[f64; R],
        learning: &NoiseLearning<N, R>,
        fixed_scale: Option<f64>,
        variance_per_s: [f64; N],
    ) -> Self {
        let most = SCALES.min(UNKNOWNS.saturating_sub(R));
        let mut scale_of = [None; N];
        let mut scales = 0;
        let (mut log_scale, mut limits, mut slow) = ([0.0; SCALES], [[0.0; 2]; SCALES], [false; SCALES]);
        let mut shared = None;
        for i in 0..N {
            let first = learning.first_scale[i];
            let has_noise = variance_per_s[i] > 0.0;
            if fixed_scale.is_some() || !has_noise {
                continue;
            }
            if learning.shared[i] && shared.is_some() {
                scale_of[i] = shared;
            } else if scales < most {
                if learning.shared[i] {
                    shared = Some(scales);
                }
                log_scale[scales] = libm::log(first);
                limits[scales] = learning.limits.map(|limit| libm::log(limit * first));
                slow[scales] = learning.slow[i];
                scale_of[i] = Some(scales);
                scales += 1;
            }
        }
        let mut likelihood = Self {
            state: State::ZERO,
            variance: noise_std.map(|std| std * std),
            log_scale,
            scales,
            scale_of,
            slow,
            limits,
            variance_per_s,
            fixed_scale: fixed_scale.unwrap_or(1.0),
            of_level: [State::ZERO; R],
            of_scale: [State::ZERO; SCALES],
            information: [[0.0; UNKNOWNS]; UNKNOWNS],
            before: [0.0; R],
            floor: learning.white_std.map(|std| if std.is_finite() { (0.25 * std * std).max(0.0) } else { 0.0 }),
            used: noise_std.map(|std| std.is_finite() && std > 0.0),
            elapsed_s: 0.0,
            settled_s: 0.0,
            known_until_s: None,
        };
        likelihood.forget_information();
        if let Some((learnt, until_s)) = &learning.known {
            likelihood.go_back(learnt);
            likelihood.known_until_s = Some(*until_s);
        }
        likelihood
    }

    pub(crate) fn start_state(&mut self, variances: &[f64; N]) {
        self.state = State::ZERO;
        for (k, variance) in variances.iter().enumerate() {
            self.state.covariance[k][k] = *variance;
        }
        self.of_level = [State::ZERO; R];
        self.of_scale = [State::ZERO; SCALES];
    }

    /// The estimator's state is another one now: this filter goes on from it.
    pub(crate) fn forget_offsets(&mut self) {
        let derivatives = self.of_level.iter_mut().chain(&mut self.of_scale);
        derivatives.chain([&mut self.state]).for_each(|state| state.offset = [0.0; N]);
    }

    /// Nothing is known of the levels but their values.
    fn forget_information(&mut self) {
        self.information = [[0.0; UNKNOWNS]; UNKNOWNS];
        for (k, row) in self.information.iter_mut().enumerate() {
            row[k] = least(k, R);
        }
    }

    pub(crate) fn learnt(&self) -> LearntLevels<R> {
        LearntLevels { variance: self.variance, log_scale: self.log_scale }
    }

    /// The time since the first frame goes on.
    pub(crate) fn go_back(&mut self, learnt: &LearntLevels<R>) {
        self.variance = learnt.variance;
        self.log_scale = learnt.log_scale;
    }

    /// True once a burst of outliers can be told from a level that is too small.
    pub(crate) fn is_calibrated(&self) -> bool {
        self.elapsed_s > CALIBRATED_S || self.known_until_s.is_some()
    }

    /// One sigma per output, and the scale of each state's process noise.
    pub(crate) fn levels(&self) -> ([f64; R], [f64; N]) {
        (self.variance.map(libm::sqrt), self.state_scales())
    }

    fn state_scales(&self) -> [f64; N] {
        let mut scale = [0.0; SCALES];
        for (to, log) in scale.iter_mut().zip(&self.log_scale).take(self.scales) {
            *to = libm::exp(*log);
        }
        let of_state = |k: Option<usize>| k.and_then(|k| scale.get(k).copied()).unwrap_or(self.fixed_scale);
        self.scale_of.map(of_state)
    }

    /// Takes a frame. With `hold` only the state goes on. False if nothing was learnt.
    pub(crate) fn take(
        &mut self,
        frame: &Frame<N, R>,
        interval_s: f64,
        hold: bool,
        rejection_limit: f64,
        bursts: &[bool; R],
    ) -> bool {
        self.elapsed_s += interval_s;
        // What was opened again says nothing new of what the model lacks; and an opened parameter must not seem to explain what
        // freer process noise does.
        let is_learning = frame.teaches.contains(&true) && !frame.reopened;
        self.settled_s = if is_learning { 0.0 } else { self.settled_s + interval_s };
        let known = self.known_until_s.is_some_and(|until_s| frame.time_s <= until_s);
        if !known && self.known_until_s.take().is_some() {
            self.elapsed_s *= CARRIED_OVER;
            self.information.iter_mut().flatten().for_each(|value| *value *= CARRIED_OVER);
        }
        self.predict(&frame.transition, interval_s);
        if !hold {
            let memory_s = (0.5 * self.elapsed_s).clamp(MEMORY_S[0], MEMORY_S[1]);
            let kept = 1.0 - (interval_s / memory_s).min(1.0);
            self.information.iter_mut().flatten().for_each(|value| *value *= kept);
        }
        let mut slope = [0.0; UNKNOWNS];
        for output in 0..R {
            self.row(frame, output, hold, rejection_limit, bursts[output], &mut slope);
        }
        for (offset, step) in self.state.offset.iter_mut().zip(&frame.step) {
            *offset += step;
        }
        if !self.state.offset.iter().sum::<f64>().is_finite() {
            self.state.offset = [0.0; N];
        }
        for state in self.of_level.iter_mut().chain(&mut self.of_scale) {
            if !state.offset.iter().chain(state.covariance.iter().flatten()).sum::<f64>().is_finite() {
                *state = State::ZERO;
            }
        }
        if !hold && !known {
            self.step(slope, interval_s);
        }
        !hold && !known
    }

    fn predict(&mut self, transition: &[[f64; N]; N], interval_s: f64) {
        self.state.propagate(transition);
        for (state, _) in self.of_level.iter_mut().zip(&self.used).filter(|(_, used)| **used) {
            state.propagate(transition);
        }
        self.of_scale.iter_mut().take(self.scales).for_each(|state| state.propagate(transition));
        let scale = self.state_scales();
        for i in 0..N {
            let added = self.variance_per_s[i] * scale[i] * interval_s;
            self.state.covariance[i][i] += added;
            if let Some(state) = self.scale_of[i].and_then(|k| self.of_scale.get_mut(k)) {
                state.covariance[i][i] += added;
            }
        }
    }

    /// Takes a row: its slope and information, and what it does to the state and the derivatives.
    fn row(
        &mut self,
        frame: &Frame<N, R>,
        output: usize,
        hold: bool,
        rejection_limit: f64,
        burst: bool,
        slope: &mut [f64; UNKNOWNS],
    ) {
        if output >= R || !(self.used[output] && frame.residual[output].is_finite()) {
            return;
        }
        let h = &frame.state_jacobian[output];
        let (p_h, of_state) = self.state.seen(h);
        let eps = frame.residual[output] - dot(h, &self.state.offset);
        let own = of_state.max(0.0) + self.variance[output];
        let whole = own + frame.taught[output];
        if !((VARIANCE_LIMITS[0]..=VARIANCE_LIMITS[1]).contains(&whole) && own > 0.0) {
            return;
        }
        let z2 = (eps * eps / whole).min(1e12);
        let before = self.before[output];
        self.before[output] = z2;
        let limit2 = rejection_limit * rejection_limit;
        let single = z2 > limit2 && (before <= limit2 || burst);
        let bounded = match z2 {
            _ if z2 <= BOUND => z2,
            _ if single => BOUNDED_MEAN,
            _ if before > BOUND => z2.min(BOUND_IN_SUCCESSION),
            _ => BOUND,
        };
        let root = OFFSET_LIMIT * libm::sqrt(whole);
        let row = Row {
            h,
            p_h,
            inverse_own: 1.0 / own,
            inverse_whole: 1.0 / whole,
            gain: limited(eps, -root, root) / whole,
            clipped: eps.abs() > root,
            moves: !single,
            shrinks: z2 <= OFFSET_LIMIT * OFFSET_LIMIT,
        };
        // By each unknown, what the row's variance and innovation change by.
        let (mut of_variance, mut of_eps) = ([0.0; UNKNOWNS], [0.0; UNKNOWNS]);
        let variance = self.variance[output];
        let levels = self.of_level.iter_mut().zip(&self.used).enumerate();
        let levels = levels.map(|(k, (state, used))| (k, state, *used, if k == output { variance } else { 0.0 }));
        let scales = self.of_scale.iter_mut().enumerate();
        let scales = scales.map(|(k, state)| (R + k, state, k < self.scales, 0.0));
        for (k, state, _, level) in levels.chain(scales).filter(|(_, _, used, _)| *used) {
            let [variance, eps] = state.take(&row, level);
            if k < UNKNOWNS {
                (of_variance[k], of_eps[k]) = (variance * row.inverse_whole, eps);
            }
        }
        if !hold && !frame.teaches[output] {
            let trust = match z2 {
                _ if single => 0.0,
                _ if z2 > BOUND => bounded / z2,
                _ => 1.0,
            };
            let count = self.count();
            for k in 0..count {
                let (variance, shift) = (0.5 * of_variance[k], trust * of_eps[k] * row.inverse_whole);
                slope[k] += variance * (bounded - BOUNDED_MEAN) - shift * eps;
                for l in 0..=k {
                    self.information[k][l] += variance * of_variance[l] + shift * of_eps[l];
                }
            }
        }
        self.state.correct(&row);
    }

    /// Levels and scales, all of them.
    fn count(&self) -> usize {
        (R + self.scales).min(UNKNOWNS)
    }

    /// A step of Newton's method.
    fn step(&mut self, mut slope: [f64; UNKNOWNS], interval_s: f64) {
        let mut matrix = self.information;
        for (k, row) in matrix.iter_mut().enumerate() {
            row[k] = (row[k] + ADDED * least(k, R)).max(least(k, R));
        }
        let Some(factor) = Cholesky::new(&mut matrix, self.count()) else {
            // An overflow would stay for ever, and no level would be learnt again.
            if !self.information.iter().flatten().sum::<f64>().is_finite() {
                self.forget_information();
            }
            return;
        };
        factor.solve(&mut slope);
        let wanted = |k: usize| slope.get(k).copied().filter(|step| step.is_finite()).unwrap_or(0.0);
        for output in 0..R {
            if self.used[output] {
                let step = wanted(output).clamp(STEP[0], STEP[1]);
                let floor = self.floor[output].max(VARIANCE_LIMITS[0]);
                self.variance[output] = limited(self.variance[output] * exponential(step), floor, VARIANCE_LIMITS[1]);
            }
        }
        for k in 0..self.scales.min(SCALES) {
            let is_slow = self.slow[k] && self.settled_s > FREE_S;
            let most = if is_slow { (interval_s / RISES_IN_S).min(STEP[1]) } else { STEP[1] };
            let [lowest, highest] = self.limits[k];
            self.log_scale[k] = limited(self.log_scale[k] + limited(wanted(R + k), STEP[0], most), lowest, highest);
        }
    }
}

impl<const N: usize> State<N> {
    const ZERO: Self = Self { covariance: [[0.0; N]; N], offset: [0.0; N] };

    /// `P <- A P A^T`, `d <- A d`.
    fn propagate(&mut self, transition: &[[f64; N]; N]) {
        let mut left = [[0.0; N]; N];
        let mut offset = [0.0; N];
        for k in 0..N {
            for (l, a) in transition[k].iter().enumerate() {
                if *a != 0.0 {
                    offset[k] += a * self.offset[l];
                    for (to, from) in left[k].iter_mut().zip(&self.covariance[l]) {
                        *to += a * from;
                    }
                }
            }
        }
        for k in 0..N {
            for l in 0..=k {
                let sum = dot(&left[k], &transition[l]);
                self.covariance[k][l] = sum;
                self.covariance[l][k] = sum;
            }
        }
        self.offset = offset;
    }

    /// `P H^T` and `H P H^T`.
    fn seen(&self, h: &[f64; N]) -> ([f64; N], f64) {
        let mut p_h = [0.0; N];
        for (h, row) in h.iter().zip(&self.covariance) {
            if *h != 0.0 {
                for (to, from) in p_h.iter_mut().zip(row) {
                    *to += h * from;
                }
            }
        }
        (p_h, dot(h, &p_h))
    }

    /// The correction by a row.
    fn correct(&mut self, row: &Row<'_, N>) {
        if !row.moves {
            return;
        }
        for (to, p) in self.offset.iter_mut().zip(&row.p_h) {
            *to += row.gain * p;
        }
        if row.shrinks {
            for (to, p) in self.covariance.iter_mut().zip(&row.p_h) {
                let factor = p * row.inverse_own;
                for (to, p) in to.iter_mut().zip(&row.p_h) {
                    *to -= factor * p;
                }
            }
        }
    }

    /// The derivative of [`State::correct`], where this is that of the state: `level` is what the row's own noise adds to the
    /// derivative of its variance. Gives the derivatives of variance and innovation before it.
    fn take(&mut self, row: &Row<'_, N>, level: f64) -> [f64; 2] {
        let (p_h, of_state) = self.seen(row.h);
        let variance = of_state + level;
        let eps = -dot(row.h, &self.offset);
        if row.moves {
            let of_gain = if row.clipped {
                -0.5 * row.gain * variance * row.inverse_whole
            } else {
                (eps - row.gain * variance) * row.inverse_whole
            };
            for (to, (was, is)) in self.offset.iter_mut().zip(row.p_h.iter().zip(&p_h)) {
                *to += of_gain * was + row.gain * is;
            }
            if row.shrinks {
                // Of `P H^T H P/s`: `u P H^T` and its transpose, with half of what `s` changes by in each.
                let half = 0.5 * variance * row.inverse_own;
                let u: [f64; N] = core::array::from_fn(|k| (p_h[k] - half * row.p_h[k]) * row.inverse_own);
                for (to, (u_k, was_k)) in self.covariance.iter_mut().zip(u.iter().zip(&row.p_h)) {
                    for (to, (u, was)) in to.iter_mut().zip(u.iter().zip(&row.p_h)) {
                        *to -= u_k * was + was_k * u;
                    }
                }
            }
        }
        [variance, eps]
    }
}

/// Information about unknown `k` that a step counts on at least; the first `levels` are levels.
fn least(k: usize, levels: usize) -> f64 {
    if k < levels { LEAST_OF_A_LEVEL } else { LEAST_OF_A_SCALE }
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `exp(x)` for the steps of a level, `|x| <= 1`, to 1e-3 of it: (2, 2) Pade approximation.
fn exponential(x: f64) -> f64 {
    let (even, odd) = (1.0 + x * x / 12.0, 0.5 * x);
    (even + odd) / (even - odd)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    use super::{FREE_S, Frame, Likelihood, RISES_IN_S};
    use crate::settings::{NoiseLearning, SCALES};

    const INTERVAL_S: f64 = 0.1;

    /// Two states and three outputs: the first and the last see a state each, the second sees both. The first state is the
    /// integral of the second.
    fn frame(residual: [f64; 3]) -> Frame<2, 3> {
        let mut frame = Frame::EMPTY;
        frame.begin(0.0);
        frame.transition = [[1.0, INTERVAL_S], [-0.2, 0.9]];
        for (output, h) in [[1.0, 0.0], [0.5, -2.0], [0.0, 1.0]].iter().enumerate() {
            frame.see(output, h, residual[output], 1.0, 1.0, 0.0);
        }
        frame
    }

    fn likelihood(noise_std: [f64; 3], learning: &NoiseLearning<2, 3>) -> Likelihood<2, 3> {
        let mut likelihood = Likelihood::new(&noise_std, learning, None, [1.0, 4.0]);
        likelihood.start_state(&[0.3, 0.2]);
        likelihood
    }

    fn take(likelihood: &mut Likelihood<2, 3>, frame: &Frame<2, 3>, hold: bool) {
        likelihood.take(frame, INTERVAL_S, hold, 5.0, &[false; 3]);
    }

    fn normal(rng: &mut Pcg64Mcg) -> f64 {
        StandardNormal.sample(rng)
    }

    /// The derivatives that run along are those of the filter: central differences over a few frames, one of them with a bounded
    /// innovation. A step of 1e-5 leaves 1e-10 of curvature and 1e-11 of rounding.
    #[test]
    fn the_derivatives_are_those_of_the_filter() {
        let std = [0.2, 0.3, 0.5];
        let learning = NoiseLearning::from_white([0.0; 3]);
        let residuals = [[0.1, -0.2, 0.3], [-0.4, 0.1, 2.9], [0.2, 0.5, -0.3], [0.0, -0.1, 0.2]];
        let run = |change: &dyn Fn(&mut Likelihood<2, 3>)| {
            let mut own = likelihood(std, &learning);
            change(&mut own);
            residuals.iter().for_each(|residual| take(&mut own, &frame(*residual), true));
            own
        };
        let own = run(&|_| {});
        let h = 1e-5;
        for unknown in 0..5 {
            let changed = |step: f64| {
                run(&|own: &mut Likelihood<2, 3>| match unknown {
                    0..3 => own.variance[unknown] *= libm::exp(step),
                    _ => own.log_scale[unknown - 3] += step,
                })
                .state
            };
            let (above, below) = (changed(h), changed(-h));
            let found = if unknown < 3 { own.of_level[unknown] } else { own.of_scale[unknown - 3] };
            for i in 0..2 {
                let expected = (above.offset[i] - below.offset[i]) / (2.0 * h);
                assert!((found.offset[i] - expected).abs() < 1e-8, "{unknown} {i}: {} {expected}", found.offset[i]);
                for j in 0..2 {
                    let expected = (above.covariance[i][j] - below.covariance[i][j]) / (2.0 * h);
                    let found = found.covariance[i][j];
                    assert!((found - expected).abs() < 1e-8, "{unknown} {i} {j}: {found} {expected}");
                }
            }
        }
    }

    /// Data of the filter's own model, 400 s: levels and scales are found where the scales begin a hundred times too large, and the levels
    /// ten times too large or half of what they are. (Levels that are far too small beside such scales are not: both leave the same
    /// trace.) The Fisher information of half a minute, which is the memory, leaves about 8 % of a variance of an output and 35 % of
    /// one of the process noise, one sigma.
    #[test]
    fn levels_and_scales_are_found_from_far_away() {
        let (std, scales) = ([0.2, 0.3, 0.5], [0.5, 0.1]);
        for start in [0.5, 1.0, 10.0] {
            let learning =
                NoiseLearning { first_scale: [50.0, 10.0], ..NoiseLearning::from_white(std.map(|std| 0.01 * std)) };
            let mut own = likelihood(std.map(|std| std * start), &learning);
            let mut rng = Pcg64Mcg::seed_from_u64(7);
            let mut x = [0.0, 0.0];
            for k in 0..4000 {
                let noise: [f64; 2] = [1.0, 4.0].map(|q: f64| libm::sqrt(q * INTERVAL_S) * normal(&mut rng));
                let moved = [x[0] + INTERVAL_S * x[1], -0.2 * x[0] + 0.9 * x[1]];
                x = [0, 1].map(|i| moved[i] + libm::sqrt(scales[i]) * noise[i]);
                let y = [x[0], 0.5 * x[0] - 2.0 * x[1], x[1]];
                let mut frame = frame([0, 1, 2].map(|i| y[i] + std[i] * normal(&mut rng)));
                frame.time_s = f64::from(k) * INTERVAL_S;
                take(&mut own, &frame, false);
            }
            let (found, of_state) = own.levels();
            for (found, std) in found.iter().zip(std) {
                assert!((found / std - 1.0).abs() < 0.25, "from {start}: {found} for {std}");
            }
            for (found, scale) in of_state.iter().zip(scales) {
                assert!((libm::log(found / scale)).abs() < 1.0, "from {start}: {found} for {scale}");
            }
        }
    }

    /// An output that is missing or not used is as if it were not there, wherever it stands among the others.
    #[test]
    fn a_missing_output_is_as_if_it_were_not_there() {
        let learning = NoiseLearning::from_white([0.0; 3]);
        for missing in 0..3 {
            let mut residual = [0.3, -0.2, 0.6];
            let mut unused = [0.2, 0.3, 0.5];
            unused[missing] = f64::NAN;
            let mut not_used = likelihood(unused, &learning);
            take(&mut not_used, &frame(residual), false);
            residual[missing] = f64::NAN;
            let mut not_measured = likelihood([0.2, 0.3, 0.5], &learning);
            take(&mut not_measured, &frame(residual), false);
            assert_eq!(not_used.state.covariance, not_measured.state.covariance);
            assert_eq!(not_used.state.offset, not_measured.state.offset);
            for output in (0..3).filter(|output| *output != missing) {
                let (one, other) = (not_used.variance[output], not_measured.variance[output]);
                assert!((one / other - 1.0).abs() < 1e-12, "{one} {other}");
            }
            assert!((not_measured.variance[missing] - [0.04, 0.09, 0.25][missing]).abs() < 1e-12);
        }
    }

    /// What stands for model error rises slowly once the parameters are known, and as it likes before; what stands for gusts
    /// always does.
    #[test]
    fn what_stands_for_model_error_rises_slowly_once_the_parameters_are_known() {
        let settled = |slow: [bool; 2], teaches: bool| {
            let learning = NoiseLearning { slow, first_scale: [1e-2; 2], ..NoiseLearning::from_white([0.0; 3]) };
            let mut own = likelihood([0.05; 3], &learning);
            let mut rng = Pcg64Mcg::seed_from_u64(3);
            let (mut x, mut before) = ([0.0; 2], 0.0);
            for k in 0..(3.0 * FREE_S / INTERVAL_S) as usize {
                // From two thirds on the second state is pushed about a hundred times as much.
                let pushed = k >= (2.0 * FREE_S / INTERVAL_S) as usize;
                if !pushed {
                    before = own.log_scale[1];
                }
                let push = libm::sqrt(4.0 * INTERVAL_S * if pushed { 1.0 } else { 1e-2 }) * normal(&mut rng);
                x = [x[0] + INTERVAL_S * x[1], -0.2 * x[0] + 0.9 * x[1] + push];
                let y = [x[0], 0.5 * x[0] - 2.0 * x[1], x[1]];
                let mut frame = frame(y.map(|y| y + 0.05 * normal(&mut rng)));
                frame.teaches[0] = teaches;
                take(&mut own, &frame, false);
            }
            own.log_scale[1] - before
        };
        let slow = settled([false, true], false);
        assert!(slow <= FREE_S / RISES_IN_S + 1e-9, "{slow}");
        for free in [settled([false; 2], false), settled([false, true], true)] {
            assert!(free > 2.0 * slow, "{free}");
        }
    }

    /// Gusts are one: states that share a scale have that of the first of them, and what is learnt of it is the same whether one or
    /// the other says it.
    #[test]
    fn states_that_share_a_scale_have_the_same() {
        let learning =
            NoiseLearning { shared: [true; 2], first_scale: [2.0, 0.5], ..NoiseLearning::from_white([0.0; 3]) };
        let mut own = likelihood([0.2, 0.3, 0.5], &learning);
        assert_eq!(own.levels().1, [2.0; 2]);
        let derivative = own.of_scale[0].covariance;
        own.predict(&frame([0.0; 3]).transition, INTERVAL_S);
        assert_eq!(derivative, [[0.0; 2]; 2]);
        // Both states gain by it, each by its own variance.
        let gained = own.of_scale[0].covariance;
        assert!((gained[0][0] - 2.0 * 1.0 * INTERVAL_S).abs() < 1e-12, "{gained:?}");
        assert!((gained[1][1] - 2.0 * 4.0 * INTERVAL_S).abs() < 1e-12, "{gained:?}");
        take(&mut own, &frame([0.9, -0.2, 0.3]), false);
        let [one, other] = own.levels().1;
        assert!(one == other && one != 2.0, "{one} {other}");
    }

    /// Information that overflowed does not end the learning.
    #[test]
    fn learning_goes_on_after_an_overflow() {
        for wrong in [f64::NAN, f64::INFINITY] {
            let mut own = likelihood([0.2, 0.3, 0.5], &NoiseLearning::from_white([0.0; 3]));
            own.information[1][0] = wrong;
            take(&mut own, &frame([0.3, -0.2, 0.9]), false);
            let before = own.levels();
            take(&mut own, &frame([0.3, -0.2, 0.9]), false);
            assert_ne!(own.levels(), before);
        }
    }

    /// What was learnt goes back to where it was, and what is known is used as it is until its time.
    #[test]
    fn what_was_learnt_is_used_as_it_is_until_its_time() {
        let learning = NoiseLearning::from_white([0.0; 3]);
        let mut taught = likelihood([0.2, 0.3, 0.5], &learning);
        for k in 0..5 {
            take(&mut taught, &frame([0.3, -0.2, 0.1 * f64::from(k)]), false);
        }
        let learnt = taught.learnt();
        assert_eq!(learnt.log_scale.len(), SCALES);
        let mut again = likelihood([0.2, 0.3, 0.5], &NoiseLearning { known: Some((learnt, 1.0)), ..learning });
        assert_eq!(again.levels(), taught.levels());
        let mut frame = frame([0.3, -0.2, 0.9]);
        frame.time_s = 1.0;
        take(&mut again, &frame, false);
        assert_eq!(again.levels(), taught.levels());
        frame.time_s = 1.1;
        take(&mut again, &frame, false);
        assert_ne!(again.levels(), taught.levels());
    }
}
