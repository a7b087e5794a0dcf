//! From covariances to correlations.

/// Correlation of errors, from their covariance: one on the diagonal, between -1 and 1 beside it, zero with what has no error.
pub(crate) fn correlation(covariance: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let entry = |j: usize, k: usize| {
        let scale = (covariance[j][j] * covariance[k][k]).sqrt();
        if j == k {
            1.0
        } else if scale > 0.0 {
            (covariance[j][k] / scale).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    };
    (0..covariance.len()).map(|j| (0..covariance.len()).map(|k| entry(j, k)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::correlation;

    #[test]
    fn what_has_no_error_goes_with_nothing() {
        let covariance = [vec![4.0, -3.0, 0.0], vec![-3.0, 9.0, 0.0], vec![0.0, 0.0, 0.0]];
        let found = correlation(&covariance);
        assert_eq!(found, [vec![1.0, -0.5, 0.0], vec![-0.5, 1.0, 0.0], vec![0.0, 0.0, 1.0]]);
    }
}
