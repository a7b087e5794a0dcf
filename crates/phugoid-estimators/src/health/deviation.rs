//! Comparison of the estimate with the expectation.

use super::evidence::{Information, Limits};
use super::settings::Expected;
use crate::bounded::{Places, unit};
use crate::dense::Cholesky;
use crate::estimate::Estimate;
use crate::kernels::dot;

/// The estimate as far as it lies outside of the tolerances.
pub(super) struct Deviation<const P: usize> {
    /// Beyond the tolerance, in corrected standard errors, with sign.
    pub(super) outside: [f64; P],
    /// Two corrected standard errors are more than the tolerance.
    pub(super) unknown: [bool; P],
    /// Squared distance from the nearest healthy parameters; NaN if it cannot be computed.
    pub(super) joint: f64,
}

/// Compares; the covariance is stretched to the corrected standard errors, its correlations kept.
pub(super) fn deviation<const P: usize>(
    expected: &[Option<Expected>; P],
    estimate: &Estimate<P>,
    covariance: &[[f64; P]; P],
) -> Deviation<P> {
    let mut result = Deviation { outside: [0.0; P], unknown: [false; P], joint: f64::NAN };
    // Columns scaled to the corrected standard error.
    let mut columns = Places::<P>::NONE;
    let mut difference = [0.0; P];
    let mut width = [0.0; P];
    for j in 0..P {
        let Some(expected) = &expected[j] else { continue };
        let sigma = estimate.corrected_std_error[j];
        let away = estimate.parameters[j] - expected.value;
        let beyond = (away.abs() - expected.tolerance).max(0.0);
        // A standard error of zero, or one that is not finite, says nothing about the parameter.
        result.unknown[j] = !(sigma > 0.0 && 2.0 * sigma <= expected.tolerance);
        if sigma > 0.0 && sigma.is_finite() {
            result.outside[j] = if away < 0.0 { -beyond / sigma } else { beyond / sigma };
            let place = columns.len();
            if place < P {
                difference[place] = away / sigma;
                width[place] = expected.tolerance / sigma;
            }
            columns.push(j);
        }
    }
    let n = columns.len();
    let mut correlation = [[0.0; P]; P];
    for a in 0..n {
        let i = columns.column(a);
        for b in 0..a {
            let j = columns.column(b);
            correlation[a][b] = covariance[i][j] / libm::sqrt(covariance[i][i] * covariance[j][j]);
        }
        correlation[a][a] = 1.0;
    }
    let Some(cholesky) = Cholesky::new(&mut correlation, n) else { return result };
    // |difference - d|^2 in the inverse correlation = |difference|^2 - 2 (d g - d M d / 2), M its inverse, g = M difference.
    let mut information = Information::<P>::NONE;
    for j in 0..n {
        let mut row = unit(j);
        cholesky.solve(&mut row);
        information.m[j] = row;
    }
    information.g = difference;
    cholesky.solve(&mut information.g);
    let whole = dot(&difference[..n], &information.g[..n]);
    let joint = (whole - 2.0 * information.best_within(&Limits::symmetric(&width), n).0).max(0.0);
    if whole.is_finite() && n > 0 {
        result.joint = joint;
    }
    result
}
