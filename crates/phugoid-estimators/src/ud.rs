//! Covariance as `U D U^T`: positive definite by construction, whatever the rounding does.
//!
//! Measurement update and rank-one increase after G. J. Bierman, *Factorization Methods for Discrete Sequential
//! Estimation*, Academic Press 1977 (chapters III and V); time update by modified weighted Gram-Schmidt after
//! C. L. Thornton, *Triangular Covariance Factorizations for Kalman Filtering*, JPL TM 33-798, 1976.
//!
//! ```
//! use phugoid_estimators::ud::Ud;
//!
//! // Two parameters with variances 4 and 1; their sum is measured with noise of variance 1.
//! let mut covariance = Ud::<2>::from_variances(&[4.0, 1.0]);
//! let projection = covariance.project(&[1.0, 1.0], 1.0);
//! assert_eq!(projection.variance, 6.0);
//! covariance.update(&projection, 1.0);
//! // C - (C a^T)(a C)/6 with a = [1, 1]
//! let variances = covariance.variances();
//! assert!((variances[0] - (4.0 - 16.0 / 6.0)).abs() < 1e-12 && (variances[1] - (1.0 - 1.0 / 6.0)).abs() < 1e-12);
//! ```

use crate::kernels::{add_scaled, dot, rotate};

/// `C = U diag(D) U^T` with `U` unit upper triangular, of run-time size `len <= CAPACITY`.
///
/// A variance may be zero (a parameter known exactly); none can become negative.
#[derive(Clone, Copy, Debug)]
pub struct Ud<const CAPACITY: usize> {
    len: usize,
    /// `columns[j][i] = U_ij` for `i < j`. The diagonal of ones is implied, the rest is never read.
    columns: [[f64; CAPACITY]; CAPACITY],
    diagonal: [f64; CAPACITY],
}

/// Part of a variance below which what is left of it is rounding.
const LEAST_VARIANCE: f64 = 1e-13;

/// A scalar measurement `y = a x + noise` seen through the factors: everything needed to judge it before it is used.
#[derive(Clone, Copy, Debug)]
pub struct Projection<const CAPACITY: usize> {
    /// `f = U^T a`.
    f: [f64; CAPACITY],
    /// `g = D U^T a`.
    g: [f64; CAPACITY],
    /// `a C a^T + r`, the innovation variance.
    pub variance: f64,
}

impl<const CAPACITY: usize> Ud<CAPACITY> {
    /// A diagonal covariance of size `variances.len()`, cut at the capacity. Negative or non-finite variances count
    /// as zero.
    pub fn from_variances(variances: &[f64]) -> Self {
        let len = variances.len().min(CAPACITY);
        let mut diagonal = [0.0; CAPACITY];
        for (d, v) in diagonal.iter_mut().zip(variances) {
            *d = if v.is_finite() && *v > 0.0 { *v } else { 0.0 };
        }
        Self { len, columns: [[0.0; CAPACITY]; CAPACITY], diagonal }
    }

    /// Factors a covariance given by its lower triangle, of size `len`, cut at the capacity. A direction whose variance
    /// given the later columns is zero but for rounding (below 1e-13 of its variance) gets none: [`Self::solve`] then
    /// leaves it out.
    pub fn from_lower_triangle(lower: &[[f64; CAPACITY]; CAPACITY], len: usize) -> Self {
        if len >= CAPACITY { Self::factors_of(lower, CAPACITY) } else { Self::factors_of(lower, len.min(CAPACITY)) }
    }

    #[inline(always)]
    fn factors_of(lower: &[[f64; CAPACITY]; CAPACITY], n: usize) -> Self {
        let mut columns = *lower;
        let mut diagonal = [0.0; CAPACITY];
        for j in 0..n {
            diagonal[j] = lower[j][j];
        }
        for j in (0..n).rev() {
            let d = diagonal[j];
            if d.is_nan() || d <= LEAST_VARIANCE * lower[j][j] {
                diagonal[j] = 0.0;
                columns[j][..j].fill(0.0);
                continue;
            }
            let inverse = 1.0 / d;
            let (before, rest) = columns.split_at_mut(j);
            // Still C_ij; taken out of the leading block, then divided.
            let column = &mut rest[0][..j];
            for k in 0..j {
                let u = column[k] * inverse;
                add_scaled(&mut before[k][..k], -u, &column[..k]);
                diagonal[k] -= u * column[k];
            }
            for value in column {
                *value *= inverse;
            }
        }
        Self { len: n, columns, diagonal }
    }

    /// Number of rows and columns in use, at most the capacity.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if the size is zero.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// `f = U^T a`, `g = D f` and the innovation variance `r + f^T g` of a scalar measurement with row `a` (its first
    /// `len` entries) and noise variance `r`. Changes nothing.
    #[inline]
    pub fn project(&self, a: &[f64; CAPACITY], r: f64) -> Projection<CAPACITY> {
        if self.len >= CAPACITY {
            self.project_of(CAPACITY, a, r)
        } else {
            self.project_of(self.len.min(CAPACITY), a, r)
        }
    }

    #[inline(always)]
    fn project_of(&self, n: usize, a: &[f64; CAPACITY], r: f64) -> Projection<CAPACITY> {
        let mut f = [0.0; CAPACITY];
        let mut g = [0.0; CAPACITY];
        let mut variance = r;
        for j in 0..n {
            let sum = a[j] + dot(&self.columns[j][..j], &a[..j]);
            f[j] = sum;
            g[j] = self.diagonal[j] * sum;
            variance += sum * g[j];
        }
        Projection { f, g, variance }
    }

    /// `C a^T` of a projected measurement, without using the measurement.
    #[inline]
    pub fn cross_covariance(&self, projection: &Projection<CAPACITY>) -> [f64; CAPACITY] {
        let n = self.len.min(CAPACITY);
        let mut b = [0.0; CAPACITY];
        for j in 0..n {
            let g = projection.g[j];
            add_scaled(&mut b[..j], g, &self.columns[j][..j]);
            b[j] = g;
        }
        b
    }

    /// Bierman's update by a projected measurement with noise variance `r > 0`:
    /// `C <- C - (C a^T)(a C)/(a C a^T + r)`. Gives `C a^T` of before, so that the gain is that over the innovation
    /// variance.
    #[inline]
    pub fn update(&mut self, projection: &Projection<CAPACITY>, r: f64) -> [f64; CAPACITY] {
        if self.len >= CAPACITY {
            self.update_of(CAPACITY, projection, r)
        } else {
            self.update_of(self.len.min(CAPACITY), projection, r)
        }
    }

    #[inline(always)]
    fn update_of(&mut self, n: usize, projection: &Projection<CAPACITY>, r: f64) -> [f64; CAPACITY] {
        let Projection { f, g, .. } = projection;
        let mut b = [0.0; CAPACITY];
        let mut alpha = r;
        let mut inverse = 1.0 / r;
        for j in 0..n {
            let beta = alpha;
            let inverse_beta = inverse;
            alpha += f[j] * g[j];
            inverse = 1.0 / alpha;
            self.diagonal[j] *= beta * inverse;
            let lambda = -f[j] * inverse_beta;
            rotate(&mut self.columns[j][..j], &mut b[..j], lambda, g[j]);
            b[j] = g[j];
        }
        b
    }

    /// `C <- c C`, `c > 0`. Any other factor is ignored.
    pub fn scale(&mut self, c: f64) {
        if c > 0.0 && c.is_finite() {
            self.diagonal.iter_mut().for_each(|d| *d *= c);
        }
    }

    /// Agee and Turner's rank-one increase `C <- C + c a a^T`, `c >= 0`. A negative or non-finite `c` is ignored.
    pub fn add_rank_one(&mut self, c: f64, a: &[f64; CAPACITY]) {
        if !(c > 0.0 && c.is_finite()) {
            return;
        }
        let n = self.len.min(CAPACITY);
        let mut a = *a;
        let mut c = c;
        for j in (0..n).rev() {
            let aj = a[j];
            let before = self.diagonal[j];
            let after = before + c * aj * aj;
            if after <= 0.0 {
                // Both the variance and the increase along this direction are zero: nothing to rotate.
                continue;
            }
            let beta = c * aj / after;
            c *= before / after;
            self.diagonal[j] = after;
            for (u, ai) in self.columns[j][..j].iter_mut().zip(&mut a[..j]) {
                *ai -= aj * *u;
                *u += beta * *ai;
            }
        }
    }

    /// Thornton's time update `C <- A C A^T + diag(q)`, `q >= 0`.
    #[inline]
    pub fn predict(&mut self, a: &[[f64; CAPACITY]; CAPACITY], q: &[f64; CAPACITY]) {
        if self.len >= CAPACITY {
            self.predict_of(CAPACITY, a, q)
        } else {
            self.predict_of(self.len.min(CAPACITY), a, q)
        }
    }

    #[inline(always)]
    fn predict_of(&mut self, n: usize, a: &[[f64; CAPACITY]; CAPACITY], q: &[f64; CAPACITY]) {
        // Rows of W = [A U, I], weights [D, q].
        let mut left = [[0.0; CAPACITY]; CAPACITY];
        let mut right = [[0.0; CAPACITY]; CAPACITY];
        for i in 0..n {
            for j in 0..n {
                left[i][j] = a[i][j] + dot(&self.columns[j][..j], &a[i][..j]);
            }
            right[i][i] = 1.0;
        }
        let d = self.diagonal;
        for j in (0..n).rev() {
            let row_left = left[j];
            let row_right = right[j];
            let mut weighted_left = [0.0; CAPACITY];
            let mut weighted_right = [0.0; CAPACITY];
            let mut variance = 0.0;
            for k in 0..n {
                weighted_left[k] = row_left[k] * d[k];
                weighted_right[k] = row_right[k] * q[k];
                variance += row_left[k] * weighted_left[k] + row_right[k] * weighted_right[k];
            }
            self.diagonal[j] = variance;
            let inverse = if variance > 0.0 { 1.0 / variance } else { 0.0 };
            for i in 0..j {
                let mut sum = 0.0;
                for k in 0..n {
                    sum += left[i][k] * weighted_left[k] + right[i][k] * weighted_right[k];
                }
                let u = sum * inverse;
                self.columns[j][i] = u;
                for k in 0..n {
                    left[i][k] -= u * row_left[k];
                    right[i][k] -= u * row_right[k];
                }
            }
        }
    }

    /// Writes `C^-1 y` over the first `len` entries of `y`. Directions of zero variance give zero.
    pub fn solve(&self, y: &mut [f64; CAPACITY]) {
        let n = self.len.min(CAPACITY);
        // U z = y, from the bottom.
        for j in (0..n).rev() {
            let yj = y[j];
            add_scaled(&mut y[..j], -yj, &self.columns[j][..j]);
        }
        for j in 0..n {
            y[j] = if self.diagonal[j] > 0.0 { y[j] / self.diagonal[j] } else { 0.0 };
        }
        // U^T w = z, from the top.
        for j in 0..n {
            y[j] -= dot(&self.columns[j][..j], &y[..j]);
        }
    }

    /// The diagonal of `C`: the variances.
    #[inline]
    pub fn variances(&self) -> [f64; CAPACITY] {
        if self.len >= CAPACITY { self.variances_of(CAPACITY) } else { self.variances_of(self.len.min(CAPACITY)) }
    }

    #[inline(always)]
    fn variances_of(&self, n: usize) -> [f64; CAPACITY] {
        let mut out = [0.0; CAPACITY];
        for j in 0..n {
            let d = self.diagonal[j];
            for (v, u) in out[..j].iter_mut().zip(&self.columns[j][..j]) {
                *v += u * u * d;
            }
            out[j] = d;
        }
        out
    }

    /// Writes `C` into the leading `len` by `len` part of `out`.
    #[inline]
    pub fn write_dense(&self, out: &mut [[f64; CAPACITY]; CAPACITY]) {
        let n = self.len.min(CAPACITY);
        for j in 0..n {
            // Rank one: D_j times the outer product of column j, whose entry j is one.
            let d = self.diagonal[j];
            for i in 0..j {
                let ud = self.columns[j][i] * d;
                add_scaled(&mut out[i][..j], ud, &self.columns[j][..j]);
                out[i][j] = ud;
                out[j][i] = ud;
            }
            out[j][j] = d;
        }
    }

    /// Column `j` of `C`; zero beyond the size.
    #[inline]
    pub fn column(&self, j: usize) -> [f64; CAPACITY] {
        if self.len >= CAPACITY { self.column_of(CAPACITY, j) } else { self.column_of(self.len.min(CAPACITY), j) }
    }

    #[inline(always)]
    fn column_of(&self, n: usize, j: usize) -> [f64; CAPACITY] {
        let mut out = [0.0; CAPACITY];
        if j >= n {
            return out;
        }
        out[j] = self.diagonal[j];
        add_scaled(&mut out[..j], self.diagonal[j], &self.columns[j][..j]);
        for k in j + 1..n {
            // D_k U_jk times column k of U, whose entry k is one.
            let weight = self.diagonal[k] * self.columns[k][j];
            add_scaled(&mut out[..k], weight, &self.columns[k][..k]);
            out[k] += weight;
        }
        out
    }

    /// True if every factor is finite and no variance is negative.
    #[inline]
    pub fn is_sound(&self) -> bool {
        let n = self.len.min(CAPACITY);
        // Zero times a factor is zero only if the factor is finite.
        let mut check = 0.0;
        let mut least = 0.0_f64;
        for j in 0..n {
            check += 0.0 * self.diagonal[j];
            least = least.min(self.diagonal[j]);
            for u in &self.columns[j][..j] {
                check += 0.0 * u;
            }
        }
        check == 0.0 && least >= 0.0
    }
}
