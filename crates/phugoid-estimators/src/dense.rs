//! Small dense Cholesky factorisation for run-time sizes.

/// Lower Cholesky factor of a symmetric positive definite matrix of size `len`.
#[derive(Clone, Copy)]
pub(crate) struct Cholesky<const P: usize> {
    len: usize,
    lower: [[f64; P]; P],
    inverse_diagonal: [f64; P],
    log_determinant: f64,
}

impl<const P: usize> Cholesky<P> {
    /// Factors the lower triangle of `a`. `None` if it is not positive definite and finite.
    pub(crate) fn new(a: &[[f64; P]; P], len: usize) -> Option<Self> {
        let n = len.min(P);
        let mut out = Self { len: n, lower: [[0.0; P]; P], inverse_diagonal: [0.0; P], log_determinant: 0.0 };
        // Pivots are multiplied in fours before the logarithm: 1e75 each would be needed to overflow.
        let mut product = 1.0;
        for i in 0..n {
            let mut row = a[i];
            for j in 0..i {
                let mut sum = row[j];
                for (x, y) in row[..j].iter().zip(&out.lower[j][..j]) {
                    sum -= x * y;
                }
                row[j] = sum * out.inverse_diagonal[j];
            }
            let pivot = row[i] - row[..i].iter().map(|x| x * x).sum::<f64>();
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            let root = libm::sqrt(pivot);
            row[i] = root;
            out.inverse_diagonal[i] = 1.0 / root;
            out.lower[i] = row;
            product *= pivot;
            if i % 4 == 3 || i + 1 == n {
                out.log_determinant += libm::log(product);
                product = 1.0;
            }
        }
        Some(out)
    }

    pub(crate) fn log_determinant(&self) -> f64 {
        self.log_determinant
    }

    /// `L^-1 b` over `b`.
    pub(crate) fn solve_lower(&self, b: &mut [f64; P]) {
        for i in 0..self.len {
            let mut sum = b[i];
            for (l, x) in self.lower[i][..i].iter().zip(&b[..i]) {
                sum -= l * x;
            }
            b[i] = sum * self.inverse_diagonal[i];
        }
    }

    /// `A^-1 b` over `b`.
    pub(crate) fn solve(&self, b: &mut [f64; P]) {
        self.solve_lower(b);
        for i in (0..self.len).rev() {
            let x = b[i] * self.inverse_diagonal[i];
            b[i] = x;
            for (y, l) in b[..i].iter_mut().zip(&self.lower[i][..i]) {
                *y -= l * x;
            }
        }
    }

    /// Trace of `A^-1`.
    pub(crate) fn inverse_trace(&self) -> f64 {
        let mut trace = 0.0;
        for j in 0..self.len {
            // Column j of L^-1; its entries above j are zero.
            let mut column = [0.0; P];
            column[j] = self.inverse_diagonal[j];
            trace += column[j] * column[j];
            for i in j + 1..self.len {
                let sum: f64 = self.lower[i][j..i].iter().zip(&column[j..i]).map(|(l, x)| l * x).sum();
                column[i] = -sum * self.inverse_diagonal[i];
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
        let chol = Cholesky::new(&a, 3).expect("positive definite");
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
        assert!(Cholesky::new(&[[1.0, 2.0], [2.0, 1.0]], 2).is_none());
        assert!(Cholesky::new(&[[f64::NAN, 0.0], [0.0, 1.0]], 2).is_none());
    }
}
