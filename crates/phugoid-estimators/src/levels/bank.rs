//! The shadows: filters for the state alone, each with a fixed scale of the process noise and noise levels of its own.
//!
//! Per frame and shadow `m`, with the estimator's transition `A`, output Jacobian `H` and residuals `y - h`:
//!
//! ```text
//! P <- A P A^T + q_m Qx h,     d <- A d                           d: state of the shadow less that of the estimator
//! row i:  s = H P H^T + r_i,   S = s + w_i,   eps = y_i - h_i - H d,   z2 = eps^2/S
//!         L <- L - 1/2 [(nu + 1) ln(1 + z2/nu) + ln S]            evidence, of a Student density
//!         ln r_i <- ln r_i + rho (zt - E zt)/2 / I_i,   I_i <- (1 - mu) I_i + rho^2/2,   rho = r_i/S
//! ```
//!
//! `w_i` is what the unknown parameters add to the variance; a row that still teaches them (`w_i >= s_i` of the
//! estimator) teaches no level and is no evidence. `mu` forgets within half of the flight, 30 s at most.

use crate::bounded::limited;
use crate::settings::{LearntLevels, NoiseLearning, SHADOWS};

/// Degrees of freedom of the Student density: its loss grows with the logarithm of the innovation, so that outliers do
/// not elect the shadow with the largest variance.
const STUDENT: f64 = 8.0;
/// Bound of a squared innovation in the level, and its mean under a normal density, `E min(z^2, 9)`.
const BOUND: f64 = 9.0;
const BOUNDED_MEAN: f64 = 0.995;
/// The same bound where the frame before was beyond [`BOUND`] too: a level that is wrong rises by a factor of e per
/// frame in the beginning, and single outliers do not raise it.
const BOUND_IN_SUCCESSION: f64 = 25.0;
/// Information about a level that it begins with, and that its steps count on at least.
const LEAST_INFORMATION: f64 = 10.0;
/// Standard deviations up to which an innovation moves the state of a shadow.
const OFFSET_LIMIT: f64 = 3.0;
/// Limits of one step of the logarithm of a variance.
const STEP: [f64; 2] = [-0.5, 1.0];
/// Shortest and longest memory, s; between them half of the flight.
const MEMORY_S: [f64; 2] = [0.3, 30.0];
/// How far behind the best shadow another may be, nats, where the shadows go on after a replay.
const FURTHEST_BEHIND: f64 = 10.0;
/// Information about a level per frame of the flight so far, where the shadows go on after a replay.
const KNOWN_INFORMATION: f64 = 0.35;
/// Time after which a burst of outliers in one output is told from a level that is too small, s: before it the start
/// value of the level may be anything.
const CALIBRATED_S: f64 = 2.0;
/// Smallest and largest variance of a row: nothing overflows in products of a frame's rows.
const VARIANCE_LIMITS: [f64; 2] = [1e-24, 1e24];

/// What the estimator has seen of one frame: its linearisation and residuals before the frame corrected it.
#[derive(Clone, Copy, Debug)]
pub struct Frame<const N: usize, const R: usize> {
    pub(crate) time_s: f64,
    /// `A`, over the interval that the frame ends.
    pub(crate) transition: [[f64; N]; N],
    /// `H`.
    pub(crate) state_jacobian: [[f64; N]; R],
    /// `y - h`, output units. NaN where missing.
    pub(crate) residual: [f64; R],
    /// `w`, what the unknown parameters add to the predicted variance, output units squared.
    pub(crate) taught: [f64; R],
    /// True for a row that still teaches the parameters more than they know.
    pub(crate) teaches: [bool; R],
    /// Normalised surface `xi`. NaN where missing.
    pub(crate) normalised: [f64; R],
    /// `U dtheta - dx`: by which the state of a shadow departs from the corrected one of the estimator.
    pub(crate) step: [f64; N],
}

impl<const N: usize, const R: usize> Frame<N, R> {
    pub(crate) const EMPTY: Self = Self {
        time_s: f64::NAN,
        transition: identity(),
        state_jacobian: [[0.0; N]; R],
        residual: [f64::NAN; R],
        taught: [0.0; R],
        teaches: [false; R],
        normalised: [f64::NAN; R],
        step: [0.0; N],
    };

    /// The frame of this time, with no row seen yet.
    pub(crate) fn begin(&mut self, time_s: f64) {
        self.time_s = time_s;
        self.residual = [f64::NAN; R];
        self.normalised = [f64::NAN; R];
        self.step = [0.0; N];
    }

    /// No time passes before the next frame.
    pub(crate) fn stand_still(&mut self) {
        self.transition = identity();
    }

    /// Notes a row before it is used: its Jacobian, `y - h`, the variance `s` that it has given the parameters, `1 + v`
    /// and its normalised surface.
    #[inline]
    pub(crate) fn see(&mut self, output: usize, h: &[f64; N], residual: f64, s: f64, one_plus_v: f64, xi: f64) {
        self.state_jacobian[output] = *h;
        self.residual[output] = residual;
        self.taught[output] = s * (one_plus_v - 1.0);
        self.teaches[output] = one_plus_v >= 2.0;
        self.normalised[output] = xi;
    }
}

const fn identity<const N: usize>() -> [[f64; N]; N] {
    let mut out = [[0.0; N]; N];
    let mut k = 0;
    while k < N {
        out[k][k] = 1.0;
        k += 1;
    }
    out
}

#[derive(Clone, Copy, Debug)]
struct Shadow<const N: usize, const R: usize> {
    /// Process noise, variance per second.
    process: [f64; N],
    covariance: [[f64; N]; N],
    offset: [f64; N],
    variance: [f64; R],
    information: [f64; R],
    evidence: f64,
    /// Squared innovation of each output at its last frame.
    before: [f64; R],
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Bank<const N: usize, const R: usize> {
    shadows: [Shadow<N, R>; SHADOWS],
    /// Shadows in use.
    count: usize,
    log_scale: [f64; SHADOWS],
    /// Lowest variance per output.
    floor: [f64; R],
    used: [bool; R],
    /// Time since the first frame, s.
    elapsed_s: f64,
    /// Until when what is known is used as it is, s.
    known_until_s: Option<f64>,
}

impl<const N: usize, const R: usize> Bank<N, R> {
    /// `fixed_scale` is that of a process noise that does not adapt.
    pub(crate) fn new(
        noise_std: &[f64; R],
        learning: &NoiseLearning<R>,
        fixed_scale: Option<f64>,
        variance_per_s: [f64; N],
    ) -> Self {
        let (count, mut scales) = match fixed_scale {
            Some(scale) => (1, [scale; SHADOWS]),
            None => (SHADOWS, learning.scales),
        };
        if variance_per_s.iter().all(|q| *q == 0.0) {
            // Without any process noise its scale has no meaning.
            scales = [1.0; SHADOWS];
        }
        let floor = learning.white_std.map(|std| if std.is_finite() { (0.25 * std * std).max(0.0) } else { 0.0 });
        let used = noise_std.map(|std| std.is_finite() && std > 0.0);
        let shadow = Shadow {
            process: variance_per_s,
            covariance: [[0.0; N]; N],
            offset: [0.0; N],
            variance: noise_std.map(|std| std * std),
            information: [LEAST_INFORMATION; R],
            evidence: 0.0,
            before: [0.0; R],
        };
        let mut bank = Self {
            shadows: [shadow; SHADOWS],
            count: if scales[0] == scales[SHADOWS - 1] { 1 } else { count },
            log_scale: scales.map(libm::log),
            floor,
            used,
            elapsed_s: 0.0,
            known_until_s: None,
        };
        for (shadow, scale) in bank.shadows.iter_mut().zip(scales) {
            shadow.process = variance_per_s.map(|q| q * scale);
        }
        if let Some((learnt, until_s)) = &learning.known {
            bank.go_back(learnt);
            bank.elapsed_s = learnt.elapsed_s;
            bank.known_until_s = Some(*until_s);
        }
        bank
    }

    fn in_use(&mut self) -> &mut [Shadow<N, R>] {
        let count = self.count.min(SHADOWS);
        &mut self.shadows[..count]
    }

    pub(crate) fn start_state(&mut self, variances: &[f64; N]) {
        for shadow in self.in_use() {
            shadow.offset = [0.0; N];
            shadow.covariance = [[0.0; N]; N];
            for k in 0..N {
                shadow.covariance[k][k] = variances[k];
            }
        }
    }

    pub(crate) fn forget_offsets(&mut self) {
        self.in_use().iter_mut().for_each(|shadow| shadow.offset = [0.0; N]);
    }

    pub(crate) fn learnt(&self) -> LearntLevels<R> {
        LearntLevels {
            variance: core::array::from_fn(|m| self.shadows[m].variance),
            evidence: core::array::from_fn(|m| self.shadows[m].evidence),
            information: core::array::from_fn(|m| self.shadows[m].information),
            elapsed_s: self.elapsed_s,
        }
    }

    /// The time since the first frame goes on.
    pub(crate) fn go_back(&mut self, learnt: &LearntLevels<R>) {
        for (m, shadow) in self.shadows.iter_mut().enumerate() {
            shadow.variance = learnt.variance[m];
            shadow.evidence = learnt.evidence[m];
            shadow.information = learnt.information[m];
        }
    }

    /// True once a burst of outliers can be told from a level that is too small.
    pub(crate) fn is_calibrated(&self) -> bool {
        self.elapsed_s > CALIBRATED_S
    }

    /// One sigma per output and the scale of the process noise, weighted by the likelihoods of the shadows.
    pub(crate) fn weighted(&self) -> ([f64; R], f64) {
        let shadows = &self.shadows[..self.count.min(SHADOWS)];
        let best = shadows.iter().map(|shadow| shadow.evidence).fold(f64::NEG_INFINITY, f64::max);
        let mut total = 0.0;
        let mut variance = [0.0; R];
        let mut log_scale = 0.0;
        for (shadow, log) in shadows.iter().zip(&self.log_scale) {
            let behind = shadow.evidence - best;
            if behind < -30.0 {
                continue;
            }
            let weight = libm::exp(behind);
            total += weight;
            log_scale += weight * log;
            for (to, from) in variance.iter_mut().zip(&shadow.variance) {
                *to += weight * from;
            }
        }
        (variance.map(|v| libm::sqrt(v / total)), libm::exp(log_scale / total))
    }

    /// Takes a frame. With `hold` only the states of the shadows go on. False if nothing was learnt.
    pub(crate) fn take(
        &mut self,
        frame: &Frame<N, R>,
        interval_s: f64,
        hold: bool,
        rejection_limit: f64,
        bursts: &[bool; R],
        state_covariance: impl FnOnce() -> [[f64; N]; N],
    ) -> bool {
        if let Some(until_s) = self.known_until_s {
            if frame.time_s <= until_s {
                return false;
            }
            self.go_on(interval_s, &state_covariance());
        }
        self.elapsed_s += interval_s;
        let memory_s = (0.5 * self.elapsed_s).clamp(MEMORY_S[0], MEMORY_S[1]);
        let forgotten = (interval_s / memory_s).min(1.0);
        let (floor, used) = (self.floor, self.used);
        for shadow in self.in_use() {
            shadow.predict(&frame.transition, interval_s);
            shadow.correct(frame, forgotten, hold, rejection_limit, &floor, &used, bursts);
        }
        true
    }

    /// The shadows begin with what is known.
    fn go_on(&mut self, interval_s: f64, state_covariance: &[[f64; N]; N]) {
        self.known_until_s = None;
        let information = (KNOWN_INFORMATION * self.elapsed_s / (2.0 * interval_s)).max(LEAST_INFORMATION);
        self.elapsed_s *= 0.5;
        let best = self.in_use().iter().map(|shadow| shadow.evidence).fold(f64::NEG_INFINITY, f64::max);
        for shadow in self.in_use() {
            shadow.covariance = *state_covariance;
            shadow.offset = [0.0; N];
            shadow.evidence = (0.5 * (shadow.evidence - best)).max(-FURTHEST_BEHIND);
            shadow.information = [information; R];
            shadow.before = [0.0; R];
        }
    }
}

impl<const N: usize, const R: usize> Shadow<N, R> {
    /// `P <- A P A^T + q Qx h`, `d <- A d`.
    fn predict(&mut self, transition: &[[f64; N]; N], interval_s: f64) {
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
                let mut sum = 0.0;
                for (from, a) in left[k].iter().zip(&transition[l]) {
                    sum += from * a;
                }
                self.covariance[k][l] = sum;
                self.covariance[l][k] = sum;
            }
            self.covariance[k][k] += self.process[k] * interval_s;
        }
        self.offset = offset;
    }

    #[allow(clippy::too_many_arguments)]
    fn correct(
        &mut self,
        frame: &Frame<N, R>,
        forgotten: f64,
        hold: bool,
        rejection_limit: f64,
        floor: &[f64; R],
        used: &[bool; R],
        bursts: &[bool; R],
    ) {
        let limit2 = rejection_limit * rejection_limit;
        // Products over the rows: one logarithm per frame in place of one per row.
        let (mut student, mut size) = (1.0, 1.0);
        for i in 0..R {
            if !(used[i] && frame.residual[i].is_finite()) {
                continue;
            }
            let h = &frame.state_jacobian[i];
            let mut p_h = [0.0; N];
            let mut state = 0.0;
            let mut eps = frame.residual[i];
            for k in 0..N {
                if h[k] != 0.0 {
                    eps -= h[k] * self.offset[k];
                    for (to, from) in p_h.iter_mut().zip(&self.covariance[k]) {
                        *to += h[k] * from;
                    }
                }
            }
            for (h, p) in h.iter().zip(&p_h) {
                state += h * p;
            }
            let r = self.variance[i];
            let s = state.max(0.0) + r;
            let whole = s + frame.taught[i];
            if !((VARIANCE_LIMITS[0]..=VARIANCE_LIMITS[1]).contains(&whole) && s > 0.0) {
                continue;
            }
            let z2 = (eps * eps / whole).min(1e12);
            let before = self.before[i];
            self.before[i] = z2;
            let single = z2 > limit2 && (before <= limit2 || bursts[i]);
            if !hold && !frame.teaches[i] {
                if !bursts[i] || z2 <= limit2 {
                    student *= 1.0 + z2.min(1e6) / STUDENT;
                    size *= whole;
                }
                let excess = if z2 <= BOUND {
                    z2
                } else if single {
                    BOUNDED_MEAN
                } else if before > BOUND {
                    z2.min(BOUND_IN_SUCCESSION)
                } else {
                    BOUND
                } - BOUNDED_MEAN;
                let rho = r / whole;
                let information = &mut self.information[i];
                *information += 0.5 * rho * rho - forgotten * *information;
                let step = 0.5 * rho * excess / information.max(LEAST_INFORMATION);
                self.variance[i] = limited(
                    r * exponential(step.clamp(STEP[0], STEP[1])),
                    floor[i].max(VARIANCE_LIMITS[0]),
                    VARIANCE_LIMITS[1],
                );
            }
            if single {
                continue;
            }
            let root = OFFSET_LIMIT * libm::sqrt(whole);
            let gain = limited(eps, -root, root) / whole;
            for (to, p) in self.offset.iter_mut().zip(&p_h) {
                *to += gain * p;
            }
            if z2 <= OFFSET_LIMIT * OFFSET_LIMIT {
                let inverse = 1.0 / s;
                for k in 0..N {
                    let factor = p_h[k] * inverse;
                    for (to, p) in self.covariance[k].iter_mut().zip(&p_h) {
                        *to -= factor * p;
                    }
                }
            }
        }
        if !hold {
            self.evidence *= 1.0 - forgotten;
            self.evidence -= 0.5 * ((STUDENT + 1.0) * libm::log(student) + libm::log(size));
        }
        for (offset, step) in self.offset.iter_mut().zip(&frame.step) {
            *offset += step;
        }
        if !self.offset.iter().sum::<f64>().is_finite() {
            self.offset = [0.0; N];
        }
    }
}

/// `exp(x)` for the steps of a level, `|x| <= 1`, to 1e-3 of it: (2, 2) Pade approximation.
fn exponential(x: f64) -> f64 {
    let (even, odd) = (1.0 + x * x / 12.0, 0.5 * x);
    (even + odd) / (even - odd)
}

#[cfg(test)]
mod tests {
    use super::{Bank, Frame};
    use crate::settings::{NoiseLearning, SHADOWS};

    /// Two states and three outputs: the first and the last see a state each, the second sees both.
    fn frame(residual: [f64; 3]) -> Frame<2, 3> {
        let mut frame = Frame::EMPTY;
        frame.begin(0.0);
        for (output, h) in [[1.0, 0.0], [0.5, -2.0], [0.0, 1.0]].iter().enumerate() {
            frame.see(output, h, residual[output], 1.0, 1.0, 0.0);
        }
        frame
    }

    fn bank(noise_std: [f64; 3]) -> Bank<2, 3> {
        let mut bank = Bank::new(&noise_std, &NoiseLearning::from_white([0.0; 3]), None, [1.0, 4.0]);
        bank.start_state(&[0.3, 0.2]);
        bank
    }

    /// Every shadow is a Kalman filter for the state: after a frame its covariance is the inverse of the sum of what the
    /// rows tell, computed here from the matrix that has them all at once. The levels of a frame whose innovations are
    /// as large as they should be stay what they are, nearly.
    #[test]
    fn every_shadow_is_a_kalman_filter_of_its_own_noise() {
        let std = [0.2, 0.3, 0.5];
        let mut bank = bank(std);
        assert!(bank.take(&frame([0.01, -0.02, 0.03]), 0.1, true, 5.0, &[false; 3], || unreachable!()));
        for (m, shadow) in bank.shadows.iter().enumerate() {
            let scale = NoiseLearning::<3>::from_white([0.0; 3]).scales[m];
            let before = [0.3 + 0.1 * scale, 0.2 + 0.4 * scale];
            let mut information = [[1.0 / before[0], 0.0], [0.0, 1.0 / before[1]]];
            for (h, std) in [[1.0, 0.0], [0.5, -2.0], [0.0, 1.0]].iter().zip(std) {
                for k in 0..2 {
                    for l in 0..2 {
                        information[k][l] += h[k] * h[l] / (std * std);
                    }
                }
            }
            let [[a, b], [_, d]] = information;
            let determinant = a * d - b * b;
            for (found, expected) in
                [(shadow.covariance[0][0], d), (shadow.covariance[0][1], -b), (shadow.covariance[1][1], a)]
            {
                assert!((found * determinant / expected - 1.0).abs() < 1e-12, "{m}: {found}");
            }
            // The levels are held.
            assert_eq!(shadow.variance, std.map(|std| std * std));
        }
    }

    /// An output that is missing or not used is as if it were not there, wherever it stands among the others.
    #[test]
    fn a_missing_output_is_as_if_it_were_not_there() {
        for missing in 0..3 {
            let mut residual = [0.3, -0.2, 0.6];
            let mut std = [0.2, 0.3, 0.5];
            let mut unused = std;
            unused[missing] = f64::NAN;
            let mut not_used = bank(unused);
            not_used.take(&frame(residual), 0.1, false, 5.0, &[false; 3], || unreachable!());
            residual[missing] = f64::NAN;
            let mut not_measured = bank(std);
            not_measured.take(&frame(residual), 0.1, false, 5.0, &[false; 3], || unreachable!());
            std[missing] = 0.0;
            for (one, other) in not_used.shadows.iter().zip(&not_measured.shadows) {
                assert_eq!(
                    (one.covariance, one.offset, one.evidence),
                    (other.covariance, other.offset, other.evidence)
                );
                for output in (0..3).filter(|output| *output != missing) {
                    assert_eq!(one.variance[output], other.variance[output]);
                    assert!(one.variance[output] != std[output] * std[output]);
                }
            }
            // It is forgotten what was known of it, and nothing is learnt.
            assert!(not_measured.shadows.iter().all(|shadow| shadow.information[missing] == super::LEAST_INFORMATION));
        }
    }

    /// What was learnt comes back where it was: each shadow its own.
    #[test]
    fn what_was_learnt_goes_back_to_its_shadow() {
        let mut taught = bank([0.2, 0.3, 0.5]);
        for k in 0..5 {
            taught.take(&frame([0.3, -0.2, 0.1 * f64::from(k)]), 0.1, false, 5.0, &[false; 3], || unreachable!());
        }
        let learnt = taught.learnt();
        let mut fresh = bank([0.2, 0.3, 0.5]);
        fresh.go_back(&learnt);
        for m in 0..SHADOWS {
            assert_eq!(fresh.shadows[m].variance, taught.shadows[m].variance);
            assert_eq!(fresh.shadows[m].evidence, taught.shadows[m].evidence);
        }
        assert!((1..SHADOWS).all(|m| taught.shadows[m].variance != taught.shadows[0].variance));
        assert_eq!(fresh.weighted(), taught.weighted());
    }
}
