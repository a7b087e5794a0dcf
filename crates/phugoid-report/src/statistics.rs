//! Descriptions of residuals: the fit of each output, the spread of the residuals and their correlation from sample to
//! sample.

use phugoid_identification::estimation::{Estimation, Signal};

/// Autocorrelation of a signal at lags 0 to `max_lag` (in samples), its mean removed (Box and Jenkins, Time Series
/// Analysis, equation 2.1.10, with sums over the pairs in which neither value is missing, per pair):
///
/// ```text
/// r(k) = mean over pairs of (x_i - m)(x_{i+k} - m)  /  mean of (x_i - m)^2
/// ```
///
/// White noise of n samples stays within +-1.96/sqrt(n) at 95 % of the lags. Values that are not finite are left out.
/// The result is empty if fewer than three values are finite or if they are all equal; a lag without a pair is NaN.
///
/// ```
/// use phugoid_report::statistics::autocorrelation;
///
/// // A value that changes its sign from sample to sample.
/// let alternating: Vec<f64> = (0..100).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// let r = autocorrelation(&alternating, 2);
/// assert!((r[0] - 1.0).abs() < 1e-12 && (r[1] + 1.0).abs() < 1e-12 && (r[2] - 1.0).abs() < 1e-12);
/// assert!(autocorrelation(&[2.0; 50], 2).is_empty());
/// ```
pub fn autocorrelation(values: &[f64], max_lag: usize) -> Vec<f64> {
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let count = finite.len() as f64;
    let mean = finite.iter().sum::<f64>() / count;
    let variance = finite.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
    if finite.len() < 3 || variance <= f64::EPSILON * mean * mean || !variance.is_finite() {
        return Vec::new();
    }
    (0..=max_lag.min(values.len() - 1))
        .map(|lag| {
            let (sum, pairs) = values
                .iter()
                .zip(&values[lag..])
                .filter(|(a, b)| a.is_finite() && b.is_finite())
                .fold((0.0, 0.0), |(sum, pairs), (a, b)| (sum + (a - mean) * (b - mean), pairs + 1.0));
            sum / pairs / variance
        })
        .collect()
}

/// How well the model explains one measured output.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputFit {
    /// Canonical name of the output.
    pub name: String,
    /// SI unit of `noise` and `rms_error`.
    pub unit: String,
    /// Standard deviation of the measurement noise that the estimation used, SI; `None` if it does not say.
    pub noise: Option<f64>,
    /// Root mean square of measured minus predicted (one sample ahead; of a batch method the fitted output), SI; NaN without common samples.
    pub rms_error: f64,
    /// Root mean square of the whitened residual; 1 if model and noise are right; NaN without residuals.
    pub residual_rms: f64,
    /// Share of the whitened residuals within +-2; 0.954 if model and noise are right; NaN without residuals.
    pub within_two_sigma: f64,
    /// Autocorrelation of the whitened residual at a lag of one sample; near 0 if it is white; NaN without residuals.
    pub lag_one: f64,
    /// Number of samples with a residual.
    pub samples: usize,
}

/// The fit of every measured output, in the order of the history.
pub fn output_fits(estimation: &Estimation) -> Vec<OutputFit> {
    let history = &estimation.history;
    let named = |signals: &[Signal], name: &str| signals.iter().position(|s| s.name == name);
    history
        .measured
        .iter()
        .map(|measured| {
            let errors: Vec<f64> = named(&history.predicted, &measured.name).map_or_else(Vec::new, |k| {
                measured.values.iter().zip(&history.predicted[k].values).map(|(m, p)| m - p).collect()
            });
            let residual: &[f64] =
                named(&history.residuals, &measured.name).map_or(&[], |k| history.residuals[k].values.as_slice());
            let finite: Vec<f64> = residual.iter().copied().filter(|v| v.is_finite()).collect();
            let noise = named(&estimation.noise, &measured.name)
                .and_then(|k| estimation.noise[k].values.first().copied())
                .filter(|sigma| sigma.is_finite());
            OutputFit {
                name: measured.name.clone(),
                unit: measured.unit.clone(),
                noise,
                rms_error: rms(errors.into_iter().filter(|v| v.is_finite())),
                residual_rms: rms(finite.iter().copied()),
                within_two_sigma: finite.iter().filter(|v| v.abs() <= 2.0).count() as f64 / finite.len() as f64,
                lag_one: autocorrelation(residual, 1).get(1).copied().unwrap_or(f64::NAN),
                samples: finite.len(),
            }
        })
        .collect()
}

/// Median of the steps between finite times, in their unit; the upper one of two middle steps. NaN if there is no step.
pub(crate) fn median_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).filter(|d| d.is_finite()).collect();
    if steps.is_empty() {
        return f64::NAN;
    }
    steps.sort_unstable_by(f64::total_cmp);
    steps[steps.len() / 2]
}

/// Root mean square; NaN without values.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    (sum / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_first_order_process_decays_geometrically() {
        // x_k = .8 x_{k-1} + e_k has r(k) = .8^k; with 200,000 samples the estimate is good to about .01.
        let mut state = 1_u64;
        let mut noise = || {
            // Sum of twelve uniform numbers from a 64-bit linear congruential generator (Knuth's constants).
            (0..12)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (state >> 11) as f64 / (1_u64 << 53) as f64
                })
                .sum::<f64>()
                - 6.0
        };
        let mut x = 0.0;
        let mut values: Vec<f64> = (0..200_000)
            .map(|_| {
                x = 0.8 * x + noise();
                x
            })
            .collect();
        values[77] = f64::NAN;
        let r = autocorrelation(&values, 5);
        assert_eq!(r.len(), 6);
        for (k, r) in r.iter().enumerate() {
            assert!((r - 0.8_f64.powi(k as i32)).abs() < 0.015, "lag {k}: {r}");
        }
    }

    #[test]
    fn nothing_comes_of_nothing() {
        assert!(autocorrelation(&[], 10).is_empty());
        assert!(autocorrelation(&[f64::NAN; 5], 10).is_empty());
        assert!(autocorrelation(&[2.0; 50], 10).is_empty());
        assert_eq!(autocorrelation(&[1.0, -1.0, 1.0, -1.0], 100).len(), 4);
        assert!(median_step(&[1.0]).is_nan());
    }
}
