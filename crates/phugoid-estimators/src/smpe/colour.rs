//! Standard errors that allow for coloured residuals.
//!
//! `C` counts every sample as new evidence. Where the residuals are correlated over a time shorter than a block, the
//! sum `S` of the outer products of the block scores `g_b = sum psi^T xi` shows how much the score really scatters, and
//! `C S C` is the covariance that follows (the "sandwich"). It is reported where it is larger.

use crate::ud::Ud;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Colour<const P: usize> {
    /// Score of the running block, scaled columns.
    block: [f64; P],
    /// `S`, full and symmetric.
    scatter: [[f64; P]; P],
}

impl<const P: usize> Colour<P> {
    pub(crate) const fn new() -> Self {
        Self { block: [0.0; P], scatter: [[0.0; P]; P] }
    }

    #[inline]
    pub(crate) fn add(&mut self, psi: &[f64], xi: f64) {
        for (g, a) in self.block.iter_mut().zip(psi) {
            *g += a * xi;
        }
    }

    /// Ends the running block.
    pub(crate) fn close_block(&mut self, columns: usize) {
        let p = columns.min(P);
        for i in 0..p {
            let gi = self.block[i];
            for (s, g) in self.scatter[i][..p].iter_mut().zip(&self.block[..p]) {
                *s += gi * g;
            }
        }
        self.block = [0.0; P];
    }

    /// The diagonal of `C S C`.
    pub(crate) fn variances(&self, covariance: &[[f64; P]; P], columns: usize) -> [f64; P] {
        let p = columns.min(P);
        let mut out = [0.0; P];
        for j in 0..p {
            // c_j^T S c_j with c_j the j-th row (= column) of C.
            let c = &covariance[j];
            let mut product = [0.0; P];
            for i in 0..p {
                let ci = c[i];
                for (t, s) in product[..p].iter_mut().zip(&self.scatter[i][..p]) {
                    *t += ci * s;
                }
            }
            out[j] = product[..p].iter().zip(&c[..p]).map(|(a, b)| a * b).sum();
        }
        out
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
    }
}
