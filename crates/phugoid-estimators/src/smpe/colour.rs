//! Standard errors that allow for coloured residuals.
//!
//! `C` counts every sample as new evidence. Its error obeys `C^-1 (theta - truth) = C0^-1 (theta0 - truth) + sum g`, with
//! the score `g = psi^T xi` of a sliding row (the innovation stands for the unknown noise) and `g = psi^T phi` of a
//! reaching row that knows better than it learns (`C` stays as it is). Where residuals are correlated over a time shorter than a block, the sum `S`
//! of the outer products of the block sums of `g` shows how much the score really scatters, and `C S C` is the
//! covariance that follows (the "sandwich"). It is reported where it is larger.

use crate::kernels::{add_scaled, dot};
use crate::ud::Ud;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Colour<const P: usize> {
    /// Score of the running block, scaled columns.
    block: [f64; P],
    /// `S`, full and symmetric.
    scatter: [[f64; P]; P],
    /// `(C S C)_jj / C_jj`, at least one.
    inflation: [f64; P],
    /// Next column whose inflation is renewed.
    next: usize,
}

/// Between the ends of blocks all inflations are renewed once in this many samples. `S` is constant then and `C` only
/// shrinks, so an old inflation is too large, never too small.
const SAMPLES_PER_ROUND: usize = 4;

impl<const P: usize> Colour<P> {
    pub(crate) const fn new() -> Self {
        Self { block: [0.0; P], scatter: [[0.0; P]; P], inflation: [1.0; P], next: 0 }
    }

    #[inline]
    pub(crate) fn add(&mut self, psi: &[f64], xi: f64) {
        add_scaled(&mut self.block, xi, psi);
    }

    /// Ends the running block.
    pub(crate) fn close_block(&mut self, covariance: &Ud<P>) {
        let p = covariance.len().min(P);
        for i in 0..p {
            let gi = self.block[i];
            add_scaled(&mut self.scatter[i][..p], gi, &self.block[..p]);
        }
        self.block = [0.0; P];
        for j in 0..p {
            self.renew_column(j, covariance);
        }
    }

    /// Renews a few inflations by the present covariance.
    pub(crate) fn renew(&mut self, covariance: &Ud<P>) {
        let p = covariance.len().min(P);
        for _ in 0..p.div_ceil(SAMPLES_PER_ROUND) {
            self.next = if self.next + 1 < p { self.next + 1 } else { 0 };
            self.renew_column(self.next, covariance);
        }
    }

    fn renew_column(&mut self, j: usize, covariance: &Ud<P>) {
        // c_j^T S c_j with c_j the j-th column of C.
        let p = covariance.len().min(P);
        let column = covariance.column(j);
        let mut variance = 0.0;
        for i in 0..p {
            variance += column[i] * dot(&self.scatter[i][..p], &column[..p]);
        }
        self.inflation[j] = if variance > column[j] { variance / column[j] } else { 1.0 };
    }

    /// The larger of `C S C` and `C` over `C`, per column.
    pub(crate) fn inflation(&self) -> &[f64; P] {
        &self.inflation
    }

    /// Keeps `C S C` what it was when the covariance becomes `C'`: `S <- (C'^-1 C) S (C'^-1 C)^T`.
    /// `before` is the dense `C`, `after` the factors of `C'`.
    pub(crate) fn reopen(&mut self, before: &[[f64; P]; P], after: &Ud<P>) {
        let p = after.len().min(P);
        // Twice: apply C'^-1 C to the columns of a symmetric matrix, and transpose.
        for _ in 0..2 {
            let mut next = [[0.0; P]; P];
            for j in 0..p {
                let mut column = [0.0; P];
                for i in 0..p {
                    column[i] = (0..p).map(|k| before[i][k] * self.scatter[k][j]).sum();
                }
                after.solve(&mut column);
                next[j][..p].copy_from_slice(&column[..p]);
            }
            self.scatter = next;
        }
        self.block = [0.0; P];
        for j in 0..p {
            self.renew_column(j, after);
        }
    }
}
