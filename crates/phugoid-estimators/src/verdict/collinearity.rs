//! Collinearity: which parameters can only be estimated in combination, from their covariance.

use super::Partner;
use crate::bounded::unit;
use crate::dense::Cholesky;

/// Variance inflation and condition of a covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collinearity<const P: usize> {
    /// `C_jj (C^-1)_jj`: variance with the others unknown over that with the others known, at least 1. Infinite for all
    /// if the covariance is singular to rounding.
    pub variance_inflation: [f64; P],
    /// Condition number of the correlation matrix in the 1-norm.
    pub condition: f64,
    /// Correlation matrix; rows and columns of fixed parameters (variance zero) are those of the identity.
    pub correlation: [[f64; P]; P],
    count: usize,
}

impl<const P: usize> Collinearity<P> {
    /// Of the first `count` rows and columns of a covariance.
    ///
    /// ```
    /// use phugoid_estimators::verdict::Collinearity;
    ///
    /// // Two errors with a correlation of 0.98: the variances are 1/(1 - 0.98^2) times what they were with the other one known.
    /// let found = Collinearity::of(&[[1.0, 0.98], [0.98, 1.0]], 2);
    /// assert!((found.variance_inflation[0] - 25.25).abs() < 0.01);
    /// assert_eq!(found.partners(0, 0.7)[0].unwrap().column, 1);
    /// ```
    pub fn of(covariance: &[[f64; P]; P], count: usize) -> Self {
        let n = count.min(P);
        let mut correlation = [[0.0; P]; P];
        for i in 0..n {
            for j in 0..n {
                let scale = libm::sqrt(covariance[i][i]) * libm::sqrt(covariance[j][j]);
                // A fixed parameter has no error that could go with another's.
                correlation[i][j] = if i == j {
                    1.0
                } else if scale > 0.0 {
                    covariance[i][j] / scale
                } else {
                    0.0
                };
            }
        }
        let mut variance_inflation = [f64::INFINITY; P];
        let mut condition = f64::INFINITY;
        let mut factored = correlation;
        if let Some(cholesky) = Cholesky::new(&mut factored, n) {
            let (mut norm, mut inverse_norm) = (0.0_f64, 0.0_f64);
            for j in 0..n {
                let mut column = unit(j);
                cholesky.solve(&mut column);
                // Rounding can leave it a little below the one that it cannot be below.
                variance_inflation[j] = column[j].max(1.0);
                inverse_norm = inverse_norm.max(column[..n].iter().map(|v| v.abs()).sum());
                norm = norm.max(correlation[j][..n].iter().map(|v| v.abs()).sum());
            }
            condition = norm * inverse_norm;
        }
        Self { variance_inflation, condition, correlation, count: n }
    }

    /// The two columns most correlated with column `j`, of those beyond `threshold`, the strongest first. None of a
    /// column that there is no room for.
    pub fn partners(&self, j: usize, threshold: f64) -> [Option<Partner>; 2] {
        let mut found: [Option<Partner>; 2] = [None; 2];
        let Some(row) = self.correlation.get(j) else { return found };
        for (k, &correlation) in row.iter().enumerate().take(self.count).filter(|(k, _)| *k != j) {
            let stronger = |than: Option<Partner>| than.is_none_or(|p| correlation.abs() > p.correlation.abs());
            if correlation.abs() < threshold {
                continue;
            }
            let partner = Some(Partner { column: k, correlation });
            if stronger(found[0]) {
                found = [partner, found[0]];
            } else if stronger(found[1]) {
                found[1] = partner;
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two regressors with correlation r: the inflation is 1/(1 - r^2), the condition in the 1-norm (1 + r)/(1 - r).
    #[test]
    fn two_columns_have_the_textbook_inflation() {
        let (a, b, r) = (0.2, 30.0, -0.98);
        let covariance = [[a * a, r * a * b, 0.0], [r * a * b, b * b, 0.0], [0.0, 0.0, 4.0]];
        let found = Collinearity::of(&covariance, 3);
        let expected = 1.0 / (1.0 - r * r);
        assert!((found.variance_inflation[0] / expected - 1.0).abs() < 1e-12);
        assert!((found.variance_inflation[1] / expected - 1.0).abs() < 1e-12);
        assert!((found.variance_inflation[2] - 1.0).abs() < 1e-15);
        assert!((found.condition / ((1.0 - r) / (1.0 + r)) - 1.0).abs() < 1e-12);
        let partner = found.partners(0, 0.7)[0].unwrap();
        assert_eq!(partner.column, 1);
        assert!((partner.correlation - r).abs() < 1e-15);
        assert_eq!(found.partners(2, 0.7), [None; 2]);
    }

    /// Three-way collinearity that no single pair shows: x3 = (x1 + x2)/sqrt 2 but for a little noise.
    #[test]
    fn a_combination_of_three_is_seen_where_no_pair_is() {
        // Information of regressors with unit power: correlations 0 and 1/sqrt 2.
        let s = core::f64::consts::FRAC_1_SQRT_2 * 0.999;
        let information = [[1.0, 0.0, s], [0.0, 1.0, s], [s, s, 1.0]];
        let mut factored = information;
        let cholesky = Cholesky::new(&mut factored, 3).unwrap();
        let mut covariance = [[0.0; 3]; 3];
        for j in 0..3 {
            covariance[j][j] = 1.0;
            cholesky.solve(&mut covariance[j]);
        }
        let found = Collinearity::of(&covariance, 3);
        assert!(found.variance_inflation.iter().all(|v| *v > 100.0), "{:?}", found.variance_inflation);
    }

    #[test]
    fn a_singular_covariance_and_a_fixed_parameter_are_no_trouble() {
        let singular = Collinearity::of(&[[1.0, 1.0], [1.0, 1.0]], 2);
        assert_eq!((singular.variance_inflation, singular.condition), ([f64::INFINITY; 2], f64::INFINITY));
        let fixed = Collinearity::of(&[[0.0, 0.0], [0.0, 2.0]], 2);
        assert_eq!((fixed.variance_inflation, fixed.condition), ([1.0; 2], 1.0));
    }
}
