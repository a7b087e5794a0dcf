//! How much better than "all within tolerance" a failure explains what the innovations say.
//!
//! A window of innovations `x_i = a_i d + noise` of variance one enters through `g = sum a^T x` and `M = sum a^T a`
//! alone: the log likelihood of a deviation `d` against none is `d^T g - d^T M d / 2`. Columns are scaled to one sigma
//! of a failure.

use crate::bounded::{at, unit};
use crate::dense::Cholesky;
use crate::kernels::{add_scaled, dot};

/// Sizes of a failure, in its one sigma, that the alternative is a mixture of: a small one is found sooner than by the
/// full size alone.
const SIZES: [f64; 2] = [1.0, 0.25];
/// Sweeps of the ascent over the box: its remaining gap is counted against the failure.
const SWEEPS: usize = 50;
/// Gap, nats, at which the ascent may stop.
const SMALL_GAP: f64 = 0.01;
/// Ridge that keeps a window without information solvable, and the deviation (in one sigma of a failure) up to which
/// what it takes away is given back.
const RIDGE: f64 = 1e-6;
const LARGEST: f64 = 20.0;

/// The information of one window: `g` and the lower triangle of `M`, the leading `len` entries.
#[derive(Clone, Copy)]
pub(super) struct Information<const P: usize> {
    pub(super) g: [f64; P],
    pub(super) m: [[f64; P]; P],
    /// `sum x^2` and the number of innovations.
    pub(super) square: f64,
    pub(super) rows: f64,
}

/// Between what deviations count as healthy, per column.
#[derive(Clone, Copy)]
pub(super) struct Limits<const P: usize> {
    pub(super) low: [f64; P],
    pub(super) high: [f64; P],
}

impl<const P: usize> Limits<P> {
    /// As far to either side.
    pub(super) fn symmetric(width: &[f64; P]) -> Self {
        Self { low: width.map(|w| -w), high: *width }
    }

    /// How far a value of column `j` lies outside.
    fn beyond(&self, j: usize, value: f64) -> f64 {
        (value - self.high[j]).max(self.low[j] - value).max(0.0)
    }
}

impl<const P: usize> Information<P> {
    pub(super) const NONE: Self = Self { g: [0.0; P], m: [[0.0; P]; P], square: 0.0, rows: 0.0 };

    /// Adds one innovation `x = a d + noise`.
    pub(super) fn add(&mut self, a: &[f64; P], x: f64, len: usize) {
        let len = len.min(P);
        self.square += x * x;
        self.rows += 1.0;
        for i in 0..len {
            self.g[i] += a[i] * x;
            add_scaled(&mut self.m[i][..=i], a[i], &a[..=i]);
        }
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        let (row, column) = if i >= j { (i, j) } else { (j, i) };
        self.m.get(row).map_or(0.0, |row| at(row, column))
    }

    /// `ln` of the mean likelihood over failures `d ~ N(0, c^2 I)`, equally over the sizes `c`, against none: nats.
    ///
    /// With the truth at `d = 0` its exponential is a martingale of mean one (a mixture of likelihood ratios).
    pub(super) fn failure(&self, len: usize) -> f64 {
        let len = len.min(P);
        let mut largest = f64::NEG_INFINITY;
        let mut logs = [f64::NEG_INFINITY; SIZES.len()];
        for (log, size) in logs.iter_mut().zip(SIZES) {
            let variance = size * size;
            let mut a = [[0.0; P]; P];
            for i in 0..len {
                for j in 0..=i {
                    a[i][j] = variance * self.m[i][j];
                }
                a[i][i] += 1.0;
            }
            let Some(cholesky) = Cholesky::new(&mut a, len) else { continue };
            let mut left = self.g;
            cholesky.solve_lower(&mut left);
            let value = 0.5 * (variance * dot(&left[..len], &left[..len]) - cholesky.log_determinant());
            if value.is_finite() {
                *log = value;
                largest = largest.max(value);
            }
        }
        if !largest.is_finite() {
            return f64::NEG_INFINITY;
        }
        let sum: f64 = logs.iter().map(|log| libm::exp(log - largest)).sum();
        largest + libm::log(sum / SIZES.len() as f64)
    }

    /// An upper bound (too large by at most [`SMALL_GAP`], or by what the sweeps leave) of `d^T g - d^T M d / 2` over
    /// all `d` within the half widths, the log likelihood of the best healthy deviation, and that deviation.
    ///
    /// The function is concave: at any `d` with slope `r = g - M d` nothing in the box is better by more than
    /// `sum max(r_j low_j, r_j high_j) - r_j d_j`.
    pub(super) fn best_within(&self, limits: &Limits<P>, len: usize) -> (f64, [f64; P]) {
        let len = len.min(P);
        // From the best without limits: mostly it is healthy, and this is all.
        let mut d = self.free(len).unwrap_or([0.0; P]);
        let within = |j: usize, value: f64| value.max(limits.low[j]).min(limits.high[j]);
        for j in 0..len {
            d[j] = within(j, d[j]);
        }
        let mut slope = self.g;
        for i in 0..len {
            slope[i] -= (0..len).map(|j| self.entry(i, j) * d[j]).sum::<f64>();
        }
        for _ in 0..SWEEPS {
            if gap(&slope, &d, limits, len) < SMALL_GAP {
                break;
            }
            for j in 0..len {
                let curvature = self.m[j][j];
                let free = if curvature > 0.0 { d[j] + slope[j] / curvature } else { d[j] };
                let step = within(j, free) - d[j];
                if step != 0.0 {
                    d[j] += step;
                    for i in 0..len {
                        slope[i] -= self.entry(i, j) * step;
                    }
                }
            }
        }
        let value: f64 = (0..len).map(|j| 0.5 * d[j] * (self.g[j] + slope[j])).sum();
        (value + gap(&slope, &d, limits, len), d)
    }

    /// The most likely `d`, without limits.
    fn free(&self, len: usize) -> Option<[f64; P]> {
        let len = len.min(P);
        let mut a = self.m;
        for i in 0..len {
            a[i][i] += RIDGE;
        }
        let cholesky = Cholesky::new(&mut a, len)?;
        let mut d = self.g;
        cholesky.solve(&mut d);
        d[..len].iter().sum::<f64>().is_finite().then_some(d)
    }

    /// `d^T g - d^T M d / 2`.
    pub(super) fn log_likelihood(&self, d: &[f64; P], len: usize) -> f64 {
        let len = len.min(P);
        let product = |i: usize| (0..len).map(|j| self.entry(i, j) * at(d, j)).sum::<f64>();
        (0..len).map(|i| at(d, i) * (at(&self.g, i) - 0.5 * product(i))).sum()
    }

    /// The same about `d = step`.
    pub(super) fn recentre(&mut self, step: &[f64; P], len: usize) {
        let len = len.min(P);
        let explained = 2.0 * self.log_likelihood(step, len);
        let g = self.g;
        for i in 0..len {
            self.g[i] = g[i] - (0..len).map(|j| self.entry(i, j) * step[j]).sum::<f64>();
        }
        self.square -= explained;
    }

    /// The information of the innovations after those in `earlier`: the difference of the two sums.
    pub(super) fn since(&self, earlier: &Self, len: usize) -> Self {
        let len = len.min(P);
        let mut later = *self;
        for i in 0..len {
            later.g[i] -= earlier.g[i];
            for j in 0..=i {
                later.m[i][j] -= earlier.m[i][j];
            }
        }
        later.square -= earlier.square;
        later.rows -= earlier.rows;
        later
    }

    /// The same of a noise whose variance is larger by one over this factor.
    pub(super) fn scaled(&self, factor: f64, len: usize) -> Self {
        let len = len.min(P);
        let mut s = *self;
        for i in 0..len {
            s.g[i] *= factor;
            for j in 0..=i {
                s.m[i][j] *= factor;
            }
        }
        s.square *= factor;
        s
    }

    /// `s^T (M + I)^-1 s` of what this block says beside no deviation, and how large that is in the mean with white
    /// noise, where the healthy deviation was fitted to `total` within the limits. None where the arithmetic fails.
    pub(super) fn scatter(&self, total: &Self, limits: &Limits<P>, len: usize) -> Option<[f64; 2]> {
        let len = len.min(P);
        let mut with_unit = self.m;
        let mut all = total.m;
        for i in 0..len {
            with_unit[i][i] += 1.0;
            let half = 0.5 * (limits.high[i] - limits.low[i]);
            all[i][i] += 1.0 / (half * half);
        }
        let with_unit = Cholesky::new(&mut with_unit, len)?;
        let all = Cholesky::new(&mut all, len)?;
        let mut solved = self.g;
        with_unit.solve(&mut solved);
        let square = dot(&solved[..len], &self.g[..len]);
        let mut freedom = 0.0;
        for j in 0..len {
            let mut left: [f64; P] = [0.0; P];
            for i in 0..len {
                left[i] = self.entry(i, j);
            }
            let mut fitted = left;
            all.solve(&mut fitted);
            for i in 0..len {
                left[i] -= (0..len).map(|k| self.entry(i, k) * fitted[k]).sum::<f64>();
            }
            with_unit.solve(&mut left);
            freedom += left[j];
        }
        Some([square, freedom])
    }

    /// The best log likelihood of a change from `from` after which one column is within its half width and the others
    /// anything (up to [`LARGEST`]), for all columns. Infinite where it cannot be computed: no evidence against that
    /// column.
    pub(super) fn best_with_one_within(&self, from: &[f64; P], limits: &Limits<P>, len: usize) -> [f64; P] {
        let len = len.min(P);
        let mut best = [f64::INFINITY; P];
        let mut a = self.m;
        for i in 0..len {
            a[i][i] += RIDGE;
        }
        let Some(cholesky) = Cholesky::new(&mut a, len) else { return best };
        let mut d = self.g;
        cholesky.solve(&mut d);
        let free = 0.5 * dot(&d[..len], &self.g[..len]) + 0.5 * RIDGE * len as f64 * LARGEST * LARGEST;
        for j in 0..len {
            let mut column = unit(j);
            cholesky.solve(&mut column);
            let beyond = limits.beyond(j, from[j] + d[j]);
            let bound = free - 0.5 * beyond * beyond / column[j];
            if bound.is_finite() {
                best[j] = bound;
            }
        }
        best
    }

    /// The same if only these columns can have changed.
    pub(super) fn restricted(&self, columns: &[bool; P], len: usize) -> Self {
        let len = len.min(P);
        let mut own = *self;
        for i in 0..len {
            let changes = columns[i];
            if !changes {
                own.g[i] = 0.0;
            }
            for (value, other_changes) in own.m[i].iter_mut().zip(columns).take(i + 1) {
                if !(changes && *other_changes) {
                    *value = 0.0;
                }
            }
        }
        own
    }

    /// The log likelihood of the best change; minus infinity where it cannot be computed.
    pub(super) fn best(&self, len: usize) -> f64 {
        let Some(d) = self.free(len) else { return f64::NEG_INFINITY };
        let value = self.log_likelihood(&d, len);
        if value.is_finite() { value } else { f64::NEG_INFINITY }
    }

    /// Mean square of what the best failure leaves of the innovations: one where the failure is linear and the noise as
    /// promised.
    pub(super) fn misfit(&self, len: usize) -> f64 {
        let len = len.min(P);
        let (d, _) = self.deviation(len);
        let product = |i: usize| (0..len).map(|j| self.entry(i, j) * at(&d, j)).sum::<f64>();
        let explained: f64 = (0..len).map(|i| at(&d, i) * (2.0 * at(&self.g, i) - product(i))).sum();
        (self.square - explained) / self.rows
    }

    /// The deviation itself: mean and variance of `d` given the window and `d ~ N(0, I)`. Zero and one where the
    /// arithmetic fails.
    pub(super) fn deviation(&self, len: usize) -> ([f64; P], [f64; P]) {
        let len = len.min(P);
        let (mut mean, mut variance) = ([0.0; P], [1.0; P]);
        let mut a = self.m;
        for i in 0..len {
            a[i][i] += 1.0;
        }
        let Some(cholesky) = Cholesky::new(&mut a, len) else { return (mean, variance) };
        mean = self.g;
        cholesky.solve(&mut mean);
        for j in 0..len {
            let mut column = unit(j);
            cholesky.solve_lower(&mut column);
            variance[j] = dot(&column[..len], &column[..len]);
        }
        (mean, variance)
    }
}

/// How much better than `d` anything within the limits can be.
fn gap<const P: usize>(slope: &[f64; P], d: &[f64; P], limits: &Limits<P>, len: usize) -> f64 {
    let len = len.min(P);
    (0..len).map(|j| (slope[j] * limits.low[j]).max(slope[j] * limits.high[j]) - slope[j] * d[j]).sum()
}

/// `ln(exp a + exp b)`.
pub(super) fn log_add(a: f64, b: f64) -> f64 {
    let (high, low) = if a >= b { (a, b) } else { (b, a) };
    if high == f64::NEG_INFINITY { high } else { high + libm::log1p(libm::exp(low - high)) }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{Information, Limits, log_add};

    /// Two columns, coupled.
    fn window() -> Information<3> {
        Information { g: [3.0, -2.0, 0.0], m: [[4.0, 0.0, 0.0], [1.5, 2.0, 0.0], [0.0; 3]], square: 30.0, rows: 20.0 }
    }

    fn log_likelihood(i: &Information<3>, d: [f64; 2]) -> f64 {
        let quadratic = i.m[0][0] * d[0] * d[0] + 2.0 * i.m[1][0] * d[0] * d[1] + i.m[1][1] * d[1] * d[1];
        d[0] * i.g[0] + d[1] * i.g[1] - 0.5 * quadratic
    }

    #[test]
    fn the_mixture_is_the_integral_of_the_likelihood() {
        let information = window();
        let mut mean = 0.0;
        for size in [1.0, 0.25_f64] {
            // Midpoint rule over eight sigmas.
            let n = 400;
            let step = 16.0 * size / f64::from(n);
            for i in 0..n {
                for j in 0..n {
                    let d = [i, j].map(|k| (f64::from(k) + 0.5) * step - 8.0 * size);
                    let prior = (-0.5 * (d[0] * d[0] + d[1] * d[1]) / (size * size)).exp()
                        / (std::f64::consts::TAU * size * size);
                    mean += 0.5 * prior * log_likelihood(&information, d).exp() * step * step;
                }
            }
        }
        assert!((information.failure(2) - mean.ln()).abs() < 1e-6, "{} {}", information.failure(2), mean.ln());
        assert_eq!(Information::<3>::NONE.failure(2), 0.0);
    }

    #[test]
    fn the_best_in_the_box_is_never_underrated() {
        let information = window();
        for width in [[0.0, 0.0], [0.1, 0.3], [0.5, 0.2], [3.0, 3.0], [0.0, 5.0]] {
            let mut best = f64::NEG_INFINITY;
            for i in -200..=200 {
                for j in -200..=200 {
                    let d = [width[0] * f64::from(i) / 200.0, width[1] * f64::from(j) / 200.0];
                    best = best.max(log_likelihood(&information, d));
                }
            }
            let bound = information.best_within(&Limits::symmetric(&[width[0], width[1], 0.0]), 2).0;
            assert!(bound >= best - 1e-12 && bound < best + 0.02, "{width:?}: {bound} {best}");
        }
    }

    #[test]
    fn one_column_within_lets_the_other_go_anywhere() {
        let information = window();
        let bound = information.best_with_one_within(&[0.0; 3], &Limits::symmetric(&[0.1, 0.2, 0.0]), 2);
        for (column, width) in [(0, 0.1), (1, 0.2)] {
            let mut best = f64::NEG_INFINITY;
            for i in -100..=100 {
                for j in -40_000..=40_000 {
                    let (own, other) = (width * f64::from(i) / 100.0, f64::from(j) / 4000.0);
                    best =
                        best.max(log_likelihood(&information, if column == 0 { [own, other] } else { [other, own] }));
                }
            }
            let found = bound[column];
            assert!(found >= best - 1e-9 && found < best + 1e-3, "{column}: {found} {best}");
        }
    }

    #[test]
    fn numbers_that_are_none_are_no_evidence() {
        let mut broken = window();
        broken.m[1][1] = f64::NAN;
        assert_eq!(broken.failure(2), f64::NEG_INFINITY);
        assert!(
            broken
                .best_with_one_within(&[0.0; 3], &Limits::symmetric(&[0.1; 3]), 2)
                .iter()
                .all(|b| *b == f64::INFINITY)
        );
        assert_eq!(log_add(f64::NEG_INFINITY, f64::NEG_INFINITY), f64::NEG_INFINITY);
        assert!((log_add(1.0, 2.0) - (1.0_f64.exp() + 2.0_f64.exp()).ln()).abs() < 1e-12);
    }
}
