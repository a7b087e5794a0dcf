//! How well a model's outputs follow the measured ones.

use serde::{Deserialize, Serialize};

/// Fit of one output over one manoeuvre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputFit {
    /// Canonical name of the output's channel, e.g. `alpha`.
    pub name: String,
    /// Number of samples in which both signals have a value.
    pub samples: usize,
    /// Root mean square of measured minus modelled, output units.
    pub rms: f64,
    /// Coefficient of determination, `1 - sum of squared errors / sum of squares about the mean`: 1 is perfect, 0 is
    /// what the mean alone explains, negative is worse than that.
    pub r_squared: f64,
    /// Theil's inequality coefficient, 0 (perfect) to 1: rms error over the sum of the rms of both signals
    /// (Jategaonkar, Flight Vehicle System Identification, chapter 11; below 0.3 counts as a good agreement there).
    pub theil: f64,
    /// Share of the squared error that a constant difference between the two signals makes, 0 to 1.
    pub theil_bias: f64,
    /// Share of the squared error that different amplitudes of the two signals make, 0 to 1.
    pub theil_variance: f64,
    /// The remaining share, which neither a constant nor a factor can remove; near 1 for a good model. The three shares
    /// add up to 1.
    pub theil_covariance: f64,
    /// Correlation of each error with the next one: about 0 if the errors are white.
    pub lag_one: f64,
    /// True if the errors cannot be distinguished from white noise: Ljung & Box's sum over the first lags is below its
    /// 99 % point.
    pub white: bool,
}

/// Number of lags in the sum of Ljung & Box.
const LAGS: usize = 20;

impl OutputFit {
    /// Compares two signals where both have values; none if they have fewer than two in common.
    ///
    /// ```
    /// use phugoid_identification::batch::OutputFit;
    /// let measured: Vec<f64> = (0..100).map(|k| (0.1 * f64::from(k)).sin()).collect();
    /// let shifted: Vec<f64> = measured.iter().map(|value| value + 0.1).collect();
    /// let fit = OutputFit::of("q", &measured, &shifted).ok_or("fewer than two values")?;
    /// assert!((fit.rms - 0.1).abs() < 1e-12);
    /// assert!(fit.theil_bias > 0.999, "the whole error is a constant");
    /// # Ok::<(), &str>(())
    /// ```
    pub fn of(name: &str, measured: &[f64], modelled: &[f64]) -> Option<Self> {
        let both: Vec<(f64, f64)> =
            measured.iter().copied().zip(modelled.iter().copied()).filter(|(y, z)| (y - z).is_finite()).collect();
        let n = both.len();
        if n < 2 {
            return None;
        }
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| both.iter().map(f).sum::<f64>() / n as f64;
        let squared = mean(&|(y, z)| (y - z).powi(2));
        let (mean_y, mean_z) = (mean(&|p| p.0), mean(&|p| p.1));
        let std_y = mean(&|p| (p.0 - mean_y).powi(2)).sqrt();
        let std_z = mean(&|p| (p.1 - mean_z).powi(2)).sqrt();
        let size = mean(&|p| p.0 * p.0).sqrt() + mean(&|p| p.1 * p.1).sqrt();
        let share = |part: f64| if squared > 0.0 { part / squared } else { 0.0 };
        let (bias, variance) = (share((mean_y - mean_z).powi(2)), share((std_y - std_z).powi(2)));
        let (lag_one, white) = whiteness(measured, modelled);
        Some(Self {
            name: name.to_owned(),
            samples: n,
            rms: squared.sqrt(),
            r_squared: if std_y > 0.0 { 1.0 - squared / (std_y * std_y) } else { f64::NAN },
            theil: if size > 0.0 { squared.sqrt() / size } else { 0.0 },
            theil_bias: bias,
            theil_variance: variance,
            theil_covariance: if squared > 0.0 { 1.0 - bias - variance } else { 0.0 },
            lag_one,
            white,
        })
    }
}

/// Lag-one correlation of the errors, and whether Ljung & Box's `Q = n (n + 2) sum r_k^2 / (n - k)` is below the 99 %
/// point of chi-squared with as many degrees of freedom as lags.
fn whiteness(measured: &[f64], modelled: &[f64]) -> (f64, bool) {
    let errors: Vec<f64> = measured.iter().zip(modelled).map(|(y, z)| y - z).collect();
    let present = errors.iter().filter(|e| e.is_finite()).count() as f64;
    let mean = errors.iter().filter(|e| e.is_finite()).sum::<f64>() / present.max(1.0);
    let lagged = |lag: usize| -> f64 {
        let products = errors.iter().zip(errors.iter().skip(lag)).map(|(a, b)| (a - mean) * (b - mean));
        products.filter(|p| p.is_finite()).sum()
    };
    let power = lagged(0);
    if power.is_nan() || power <= 0.0 {
        return (0.0, true);
    }
    let lags = LAGS.min(errors.len() / 5).max(1);
    let sum: f64 = (1..=lags).map(|k| (lagged(k) / power).powi(2) / (present - k as f64).max(1.0)).sum();
    (lagged(1) / power, present * (present + 2.0) * sum <= chi_squared_99(lags as f64))
}

/// 99 % point of chi-squared (Wilson & Hilferty 1931; within 1 % from 3 degrees of freedom on).
fn chi_squared_99(degrees: f64) -> f64 {
    let variance = 2.0 / (9.0 * degrees);
    degrees * (1.0 - variance + 2.326_348 * variance.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_theils_coefficient_tell_what_is_wrong() {
        let wave: Vec<f64> = (0..400).map(|k| (0.1 * f64::from(k)).sin()).collect();
        let fit = |f: &dyn Fn(f64) -> f64| {
            let other: Vec<f64> = wave.iter().map(|v| f(*v)).collect();
            OutputFit::of("x", &wave, &other).unwrap()
        };
        let same = fit(&|v| v);
        assert_eq!((same.rms, same.r_squared, same.theil), (0.0, 1.0, 0.0));
        let shifted = fit(&|v| v + 0.1);
        assert!((shifted.theil_bias - 1.0).abs() < 1e-9 && (shifted.rms - 0.1).abs() < 1e-12, "{shifted:?}");
        let flattened = fit(&|v| 0.5 * v);
        assert!(flattened.theil_variance > 0.99, "{flattened:?}");
        assert!((flattened.r_squared - 0.75).abs() < 1e-3, "{flattened:?}");
        let opposite = fit(&|v| -v);
        assert!((opposite.theil - 1.0).abs() < 1e-12 && opposite.theil_covariance > 0.99, "{opposite:?}");
        for f in [shifted, flattened, opposite] {
            assert!((f.theil_bias + f.theil_variance + f.theil_covariance - 1.0).abs() < 1e-12);
            assert!(!f.white, "a wave is not white: {f:?}");
        }
    }

    #[test]
    fn alternating_errors_are_not_white_and_missing_values_are_left_out() {
        let zeros = vec![0.0; 100];
        let mut errors: Vec<f64> = (0..100).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let fit = OutputFit::of("x", &errors, &zeros).unwrap();
        assert!(fit.lag_one < -0.95 && !fit.white);
        errors[3] = f64::NAN;
        assert_eq!(OutputFit::of("x", &errors, &zeros).unwrap().samples, 99);
        assert_eq!(OutputFit::of("x", &[f64::NAN; 4], &[0.0; 4]), None);
    }

    /// Abramowitz & Stegun, table 26.8.
    #[test]
    fn chi_squared_points_are_the_tabulated_ones() {
        for (degrees, tabulated) in [(5.0, 15.0863), (10.0, 23.2093), (20.0, 37.5662)] {
            assert!((chi_squared_99(degrees) / tabulated - 1.0).abs() < 0.01);
        }
    }
}
