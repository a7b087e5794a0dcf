//! Standard errors when the residuals are coloured.
//!
//! The inverse of the information is the covariance of the estimates only if the residuals are white. In flight they
//! are not: turbulence and model error last for many samples. With the sensitivities `S(k)` and residuals `nu(k)`, both
//! divided by one sigma of each output,
//!
//! ```text
//! Cov = M^-1 [ sum_i sum_j S(i)^T R(i - j) S(j) ] M^-1        R(k): autocorrelation matrix of nu at lag k
//! ```
//!
//! (Morelli & Klein, Determining the accuracy of maximum likelihood parameter estimates with colored residuals, NASA
//! CR-194893, 1994; Klein & Morelli, Aircraft System Identification, section 6.3). All lags together would give exactly
//! zero, because residuals and sensitivities are orthogonal at the optimum; lags are therefore summed as far as the
//! residuals are correlated at all, with a flat-top window whose width is found by the rule of D. N. Politis (Adaptive
//! bandwidth choice, Journal of Nonparametric Statistics 15, 2003).

use nalgebra::DMatrix;

use super::response::Rows;

/// Autocorrelation matrices of the residuals, by lag.
pub(crate) struct Colour<const R: usize> {
    /// `E nu_a(i) nu_b(i + k)` times the window, entry `k`.
    windowed: Vec<[[f64; R]; R]>,
}

impl<const R: usize> Colour<R> {
    /// Measures the colour of residuals in units of one sigma, pooled over the manoeuvres.
    pub(crate) fn of(rows: &[Rows<R>]) -> Self {
        let samples = rows.iter().map(|r| r.residuals.len()).sum::<usize>();
        let shortest = rows.iter().map(|r| r.residuals.len()).min().unwrap_or(0);
        let most = shortest / 4;
        // Politis: the first lag after which `quiet` lags in a row are below the threshold.
        let decades = (samples.max(2) as f64).log10();
        let threshold = 2.0 * (decades / samples.max(1) as f64).sqrt();
        let quiet = 5.max(decades.sqrt().ceil() as usize);
        let variance = pooled(rows, 0);
        let mut last_loud = 0;
        for lag in 1..=most {
            let at = pooled(rows, lag);
            let loud = (0..R).any(|i| variance[i][i] > 0.0 && (at[i][i] / variance[i][i]).abs() > threshold);
            if loud {
                last_loud = lag;
            } else if lag - last_loud >= quiet {
                break;
            }
        }
        let width = (2 * last_loud).min(most);
        let windowed = (0..=width)
            .map(|lag| {
                let window = if lag <= last_loud { 1.0 } else { 2.0 - lag as f64 / last_loud as f64 };
                pooled(rows, lag).map(|row| row.map(|value| window * value))
            })
            .collect();
        Self { windowed }
    }

    /// `sum_i sum_j S(i)^T R(i - j) S(j)` over all manoeuvres.
    pub(crate) fn spread(&self, rows: &[Rows<R>], unknowns: usize) -> DMatrix<f64> {
        let mut total = DMatrix::<f64>::zeros(unknowns, unknowns);
        for manoeuvre in rows {
            let width = manoeuvre.columns.len();
            let mut half = DMatrix::<f64>::zeros(width, width);
            let samples = manoeuvre.residuals.len();
            let mut ahead = vec![0.0; width];
            for k in 0..samples {
                for a in (0..R).filter(|&a| manoeuvre.residuals[k][a].is_finite()) {
                    ahead.fill(0.0);
                    for (lag, correlation) in self.windowed.iter().enumerate().take(samples - k) {
                        for b in (0..R).filter(|&b| manoeuvre.residuals[k + lag][b].is_finite()) {
                            // Both signs of the lag come by adding the transpose: lag zero counts half.
                            let weight = correlation[a][b] * if lag == 0 { 0.5 } else { 1.0 };
                            for (sum, s) in ahead.iter_mut().zip(manoeuvre.sensitivity(k + lag, b)) {
                                *sum += weight * s;
                            }
                        }
                    }
                    for (i, s) in manoeuvre.sensitivity(k, a).iter().enumerate().filter(|(_, s)| **s != 0.0) {
                        for (j, sum) in ahead.iter().enumerate() {
                            half[(i, j)] += s * sum;
                        }
                    }
                }
            }
            for (i, &row) in manoeuvre.columns.iter().enumerate() {
                for (j, &column) in manoeuvre.columns.iter().enumerate() {
                    total[(row, column)] += half[(i, j)] + half[(j, i)];
                }
            }
        }
        total
    }
}

/// `sum nu_a(i) nu_b(i + lag)` over the number of samples: the biased estimate, smaller in variance.
fn pooled<const R: usize>(rows: &[Rows<R>], lag: usize) -> [[f64; R]; R] {
    let mut sum = [[0.0; R]; R];
    let mut present = [[0.0_f64; R]; R];
    for manoeuvre in rows {
        let residuals = &manoeuvre.residuals;
        for (now, later) in residuals.iter().zip(residuals.iter().skip(lag)) {
            for a in 0..R {
                for b in 0..R {
                    let product = now[a] * later[b];
                    if product.is_finite() {
                        sum[a][b] += product;
                        present[a][b] += 1.0;
                    }
                }
            }
        }
    }
    let share = |n: usize| (n.saturating_sub(lag)) as f64 / n.max(1) as f64;
    let taper = rows.iter().map(|r| share(r.residuals.len())).sum::<f64>() / rows.len().max(1) as f64;
    for a in 0..R {
        for b in 0..R {
            sum[a][b] *= if present[a][b] > 0.0 { taper / present[a][b] } else { 0.0 };
        }
    }
    sum
}
