//! Standard errors that allow for coloured residuals.
//!
//! The covariance `C` is right for white residuals: it counts every sample as independent evidence. The error of the
//! estimate is a sum of scores,
//!
//! ```text
//! C^-1 (theta - truth) = C0^-1 (theta0 - truth) + sum g,     g = psi^T xi (sliding row),  g = psi^T phi (reaching row)
//! ```
//!
//! in which the innovation `xi` stands for the unknown noise. A reaching row counts only while `v < 1`, and leaves `C`
//! as it is. If residuals are correlated over a time shorter than a block, the scatter of `g` is measured by `S`, the
//! sum of the outer products of the block sums of `g`, and the covariance of the estimate is `C S C` (the "sandwich"
//! estimate). The larger of `C` and `C S C` is reported.

use crate::bounded::at;
use crate::kernels::{add_scaled, dot};
use crate::ud::Ud;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Colour<const P: usize> {
    /// Score of the running block, scaled columns.
    block: [f64; P],
    /// Scatter `S` of the scores of the blocks, scaled columns, full and symmetric.
    scatter: [[f64; P]; P],
    /// `(C S C)_jj / C_jj`, at least one.
    inflation: [f64; P],
    /// Next column whose inflation is renewed.
    next: usize,
}

/// Between the ends of blocks all inflations are renewed once in this many samples. `S` is constant then and `C` only
/// shrinks, but their ratio may go either way while `C` turns: a corrected standard error up to four samples old is
/// mostly within 5 % of the present one, and was up to 40 % below it in the middle of a first manoeuvre.
const SAMPLES_PER_ROUND: usize = 4;

impl<const P: usize> Colour<P> {
    pub(crate) const fn new() -> Self {
        Self { block: [0.0; P], scatter: [[0.0; P]; P], inflation: [1.0; P], next: 0 }
    }

    #[inline]
    pub(crate) fn add(&mut self, psi: &[f64], xi: f64) {
        add_scaled(&mut self.block, xi, psi);
    }

    /// Lets what was collected fade by `factor`, as a forgetting estimator's scores do.
    pub(crate) fn fade(&mut self, factor: f64) {
        if factor < 1.0 {
            self.scatter.iter_mut().flatten().for_each(|s| *s *= factor);
        }
    }

    /// Ends the running block. `column` gives a column of the `columns` by `columns` covariance.
    #[inline(always)]
    pub(crate) fn close_block(&mut self, columns: usize, column: impl Fn(usize) -> [f64; P]) {
        let p = columns.min(P);
        for i in 0..p {
            let gi = self.block[i];
            add_scaled(&mut self.scatter[i][..p], gi, &self.block[..p]);
        }
        self.block = [0.0; P];
        for j in 0..p {
            self.renew_column(j, p, &column(j));
        }
    }

    /// Renews a few inflations by the present covariance.
    #[inline(always)]
    pub(crate) fn renew(&mut self, columns: usize, column: impl Fn(usize) -> [f64; P]) {
        let p = columns.min(P);
        for _ in 0..p.div_ceil(SAMPLES_PER_ROUND) {
            self.next = if self.next + 1 < p { self.next + 1 } else { 0 };
            self.renew_column(self.next, p, &column(self.next));
        }
    }

    #[inline]
    fn renew_column(&mut self, j: usize, p: usize, column: &[f64; P]) {
        // c_j^T S c_j with c_j the j-th column of C.
        let p = p.min(P);
        let mut variance = 0.0;
        for i in 0..p {
            variance += column[i] * dot(&self.scatter[i][..p], &column[..p]);
        }
        let own = at(column, j);
        if let Some(inflation) = self.inflation.get_mut(j) {
            *inflation = if variance > own { variance / own } else { 1.0 };
        }
    }

    /// The larger of `C S C` and `C` over `C`, per column.
    pub(crate) fn inflation(&self) -> &[f64; P] {
        &self.inflation
    }

    /// True if no inflation has overflowed.
    pub(crate) fn is_sound(&self, columns: usize) -> bool {
        self.inflation[..columns.min(P)].iter().sum::<f64>().is_finite()
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
            self.renew_column(j, p, &after.column(j));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Colour;
    use crate::ud::Ud;

    const P: usize = 9;
    const COLUMNS: usize = 7;

    fn dense(c: &Ud<P>) -> [[f64; P]; P] {
        let mut out = [[0.0; P]; P];
        c.write_dense(&mut out);
        out
    }

    /// `C S C` from the definition.
    fn sandwich(c: &[[f64; P]; P], s: &[[f64; P]; P]) -> [[f64; P]; P] {
        let product = |a: &[[f64; P]; P], b: &[[f64; P]; P]| -> [[f64; P]; P] {
            core::array::from_fn(|i| core::array::from_fn(|j| (0..P).map(|k| a[i][k] * b[k][j]).sum()))
        };
        product(&product(c, s), c)
    }

    #[test]
    fn the_inflation_is_the_sandwich_and_survives_a_re_opening() {
        let mut c = Ud::<P>::from_variances(&[1.0; COLUMNS]);
        let mut colour = Colour::<P>::new();
        let mut scatter = [[0.0; P]; P];
        for block in 0..12 {
            let mut sum = [0.0; P];
            for k in 0..3 {
                let psi: [f64; P] = core::array::from_fn(|j| {
                    if j < COLUMNS {
                        (1.3 * (j + 1) as f64 * f64::from(block + 1) + 0.1 * f64::from(k)).sin()
                    } else {
                        0.0
                    }
                });
                // Coloured: the same sign all over a block.
                let xi = if block % 3 == 0 { 2.5 } else { -3.0 };
                let projection = c.project(&psi, 1.0);
                c.update(&projection, 1.0);
                colour.add(&psi[..COLUMNS], xi);
                for j in 0..P {
                    sum[j] += xi * psi[j];
                }
            }
            for i in 0..P {
                for j in 0..P {
                    scatter[i][j] += sum[i] * sum[j];
                }
            }
            colour.close_block(c.len(), |j| c.column(j));
        }
        let before = sandwich(&dense(&c), &scatter);
        let variances = c.variances();
        for j in 0..COLUMNS {
            let expected = (before[j][j] / variances[j]).max(1.0);
            assert!((colour.inflation()[j] / expected - 1.0).abs() < 1e-12, "{j}");
            assert!(expected > 1.0, "{j}: no colour in this test");
        }
        assert!(colour.inflation()[COLUMNS..].iter().all(|inflation| *inflation == 1.0));

        let mut opened = c;
        for j in [0, 3] {
            let mut unit = [0.0; P];
            unit[j] = 1.0;
            opened.add_rank_one(0.5, &unit);
        }
        colour.reopen(&dense(&c), &opened);
        let after = sandwich(&dense(&opened), &colour.scatter);
        for i in 0..P {
            for j in 0..P {
                assert!((after[i][j] - before[i][j]).abs() < 1e-11 * (before[i][i] * before[j][j]).sqrt().max(1e-3));
            }
        }
    }
}
