//! How the residuals of an equation on a grid of times go together, and what that does to sums with regressors.

use super::table::APART;

/// Correlation of a residual with itself some rows on, weighted by the window of the sum.
pub(crate) struct RowCorrelation {
    by_lag: Vec<f64>,
}

impl RowCorrelation {
    /// From the products by lag, already weighted.
    pub(crate) fn of_lags(by_lag: Vec<f64>) -> Self {
        Self { by_lag }
    }

    /// The product at a lag; zero beyond the last.
    pub(crate) fn at(&self, lag: usize) -> f64 {
        self.by_lag.get(lag).copied().unwrap_or(0.0)
    }

    /// As far as the residual is correlated at all, with a flat-top window (D. N. Politis, Journal of Nonparametric
    /// Statistics 15, 2003). Rows that are not used are zero; `count` are.
    pub(crate) fn of_residual(residuals: &[f64], count: f64) -> Self {
        let count = count.max(2.0);
        let most = (APART - 1).min((count / 4.0) as usize);
        let threshold = 2.0 * (count.log10() / count).sqrt();
        let lagged = |lag: usize| {
            residuals.iter().zip(&residuals[lag.min(residuals.len())..]).map(|(a, b)| a * b).sum::<f64>() / count
        };
        let mut by_lag = vec![lagged(0)];
        let (mut last_loud, mut quiet) = (0, 0);
        for lag in 1..=most {
            by_lag.push(lagged(lag));
            if (by_lag[lag] / by_lag[0]).abs() > threshold {
                (last_loud, quiet) = (lag, 0);
            } else {
                quiet += 1;
                if quiet >= 5 {
                    break;
                }
            }
        }
        let width = (2 * last_loud).min(most);
        while by_lag.len() <= width {
            by_lag.push(lagged(by_lag.len()));
        }
        by_lag.truncate(width + 1);
        for (lag, value) in by_lag.iter_mut().enumerate().skip(last_loud + 1) {
            *value *= 2.0 - lag as f64 / last_loud as f64;
        }
        Self { by_lag }
    }

    /// Variance of the sum of a regressor times the residual.
    pub(crate) fn spread(&self, own: &[f64]) -> f64 {
        let product = |lag: usize| own.iter().zip(&own[lag.min(own.len())..]).map(|(a, b)| a * b).sum::<f64>();
        let sum = self.by_lag.iter().enumerate().map(|(lag, r)| if lag == 0 { 1.0 } else { 2.0 } * r * product(lag));
        sum.sum::<f64>().max(0.0)
    }
}
