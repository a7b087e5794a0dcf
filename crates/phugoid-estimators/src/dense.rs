//! Small dense Cholesky factorisation for run-time sizes.

use crate::kernels::{add_scaled, dot};

/// Lower Cholesky factor, in place of a symmetric positive definite matrix of size `len`. In place because clearing or
/// copying a matrix of the whole capacity costs more than factoring the part in use.
pub(crate) struct Cholesky<'a, const P: usize> {
    len: usize,
    lower: &'a [[f64; P]; P],
    inverse_diagonal: [f64; P],
    log_determinant: f64,
}

impl<'a, const P: usize> Cholesky<'a, P> {
    /// Factors the lower triangle of `a`. `None` if it is not positive definite and finite.
    pub(crate) fn new(a: &'a mut [[f64; P]; P], len: usize) -> Option<Self> {
        let n = len.min(P);
        let mut inverse_diagonal = [0.0; P];
        let mut log_determinant = 0.0;
        // Pivots are multiplied in fours before the logarithm: 1e75 each would be needed to overflow.
        let mut product = 1.0;
        for i in 0..n {
            let (above, below) = a.split_at_mut(i);
            let row = &mut below[0];
            for j in 0..i {
                row[j] = (row[j] - dot(&row[..j], &above[j][..j])) * inverse_diagonal[j];
            }
            let pivot = row[i] - dot(&row[..i], &row[..i]);
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            let root = libm::sqrt(pivot);
            row[i] = root;
            inverse_diagonal[i] = 1.0 / root;
            product *= pivot;
            if i % 4 == 3 || i + 1 == n {
                log_determinant += libm::log(product);
                product = 1.0;
            }
        }
        Some(Self { len: n, lower: a, inverse_diagonal, log_determinant })
    }

    /// At most `P`, which the compiler cannot know of a field.
    #[inline(always)]
    fn len(&self) -> usize {
        self.len.min(P)
    }

    pub(crate) fn log_determinant(&self) -> f64 {
        self.log_determinant
    }

    /// Solves `L y = b` and writes `y` over `b`.
    pub(crate) fn solve_lower(&self, b: &mut [f64; P]) {
        for i in 0..self.len() {
            b[i] = (b[i] - dot(&self.lower[i][..i], &b[..i])) * self.inverse_diagonal[i];
        }
    }

    /// Solves `A x = b` and writes `x` over `b`.
    pub(crate) fn solve(&self, b: &mut [f64; P]) {
        self.solve_lower(b);
        for i in (0..self.len()).rev() {
            let x = b[i] * self.inverse_diagonal[i];
            b[i] = x;
            add_scaled(&mut b[..i], -x, &self.lower[i][..i]);
        }
    }

    /// Trace of `A^-1`, from the columns of `L^-1`.
    pub(crate) fn inverse_trace(&self) -> f64 {
        let mut trace = 0.0;
        for j in 0..self.len() {
            // Column j of L^-1; its entries above j are zero.
            let mut column = [0.0; P];
            column[j] = self.inverse_diagonal[j];
            trace += column[j] * column[j];
            for i in j + 1..self.len() {
                column[i] = -dot(&self.lower[i][j..i], &column[j..i]) * self.inverse_diagonal[i];
                trace += column[i] * column[i];
            }
        }
        trace
    }
}

#[cfg(test)]
mod tests {
    use super::Cholesky;

    #[test]
    fn solves_and_measures_a_known_matrix() {
        let a = [[4.0, 2.0, 0.6], [2.0, 5.0, 1.0], [0.6, 1.0, 3.0]];
        let mut factored = a;
        let chol = Cholesky::new(&mut factored, 3).expect("positive definite");
        let mut x = [1.0, -2.0, 0.5];
        chol.solve(&mut x);
        for i in 0..3 {
            let back: f64 = (0..3).map(|j| a[i][j] * x[j]).sum();
            assert!((back - [1.0, -2.0, 0.5][i]).abs() < 1e-14);
        }
        // det by cofactors: 4(15-1) - 2(6-.6) + .6(2-3) = 44.6 ; trace of the inverse from the principal minors.
        assert!((chol.log_determinant() - 44.6_f64.ln()).abs() < 1e-14);
        let trace = ((15.0 - 1.0) + (12.0 - 0.36) + (20.0 - 4.0)) / 44.6;
        assert!((chol.inverse_trace() - trace).abs() < 1e-14);
    }

    #[test]
    fn refuses_an_indefinite_matrix() {
        assert!(Cholesky::new(&mut [[1.0, 2.0], [2.0, 1.0]], 2).is_none());
        assert!(Cholesky::new(&mut [[f64::NAN, 0.0], [0.0, 1.0]], 2).is_none());
    }
}
