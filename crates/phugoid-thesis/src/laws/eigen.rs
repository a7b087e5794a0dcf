//! Eigenvalues and eigenvectors of a small symmetric matrix by cyclic Jacobi rotations.

/// Most sweeps; quadratic convergence needs about six for any size used here.
const MAXIMUM_SWEEPS: usize = 20;

/// Eigenvalues of the leading `len` rows and columns of a symmetric matrix, and the eigenvectors as columns. In no order.
pub(super) fn symmetric<const P: usize>(matrix: &[[f64; P]; P], len: usize) -> ([f64; P], [[f64; P]; P]) {
    let n = len.min(P);
    let mut a = *matrix;
    let mut vectors = [[0.0; P]; P];
    for (i, row) in vectors.iter_mut().enumerate().take(n) {
        row[i] = 1.0;
    }
    for _ in 0..MAXIMUM_SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                // Small against both diagonal entries: done to rounding, also for the smaller eigenvalue.
                if a[p][q] * a[p][q] <= 1e-32 * (a[p][p] * a[q][q]).abs() {
                    continue;
                }
                rotated = true;
                let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = libm::copysign(1.0, tau) / (tau.abs() + libm::sqrt(1.0 + tau * tau));
                let c = 1.0 / libm::sqrt(1.0 + t * t);
                let s = t * c;
                for row in a.iter_mut().take(n) {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for k in 0..n {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                }
                for row in vectors.iter_mut().take(n) {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    (core::array::from_fn(|i| if i < n { a[i][i] } else { 0.0 }), vectors)
}

#[cfg(test)]
mod tests {
    use super::symmetric;

    #[test]
    fn takes_a_matrix_apart() {
        let a = [[4.0, 1.0, -2.0, 9.0], [1.0, 2.0, 0.0, 9.0], [-2.0, 0.0, 3.0, 9.0], [9.0; 4]];
        let (values, vectors) = symmetric(&a, 3);
        for i in 0..3 {
            for j in 0..3 {
                let back: f64 = (0..3).map(|k| vectors[i][k] * values[k] * vectors[j][k]).sum();
                assert!((back - a[i][j]).abs() < 1e-14);
                let unit: f64 = (0..3).map(|k| vectors[k][i] * vectors[k][j]).sum();
                assert!((unit - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        // Rank one of size 1e-8 beside 1: [e, 1e-4][e, 1e-4]^T.
        let (values, _) = symmetric(&[[1.0, 1e-4], [1e-4, 1e-8]], 2);
        assert!(values.iter().any(|v| v.abs() < 1e-20) && values.iter().any(|v| (v - 1.0).abs() < 1e-7));
        assert_eq!(symmetric(&[[0.0; 2]; 2], 2).0, [0.0; 2]);
    }
}
