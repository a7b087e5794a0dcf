//! One coefficient's equation over a segment: least squares with errors that allow for coloured residuals, and the
//! reason why a term is not determined.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::record::Window;
use crate::batch::colour::Colour;
use crate::batch::differentiate::LocalCubics;
use crate::batch::loss::Loss;
use crate::batch::response::Rows;

/// How far a regressor moves together with the other regressors of its equation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inflation {
    /// By how much the others multiply the variance of its derivative: `1 / (1 - R^2)`, `R^2` of its regression on
    /// them.
    pub variance_inflation: f64,
    /// The regressor with which it is most correlated, in words, and the correlation; `None` where there is no other.
    pub with: Option<(String, f64)>,
}

/// A term of an equation: its regressor is `values`, measured at the times of the window.
pub(crate) struct Regressor {
    /// Name in words: `angle of attack`.
    pub(crate) words: &'static str,
    /// Name in the parameter: `alpha`.
    pub(crate) name: &'static str,
    /// Values at the times of the window; NaN where missing.
    pub(crate) values: Vec<f64>,
    /// One sigma of the noise of a value.
    pub(crate) noise: f64,
}

/// A regressor has moved where its spread is this many sigmas of its noise.
const MOVED: f64 = 3.0;

/// What a regression says of one term.
#[derive(Clone, Debug)]
pub(crate) struct TermFit {
    pub(crate) name: &'static str,
    pub(crate) words: &'static str,
    pub(crate) value: f64,
    /// One sigma, corrected for the colour of the residuals.
    pub(crate) std_error: f64,
    /// Root mean square of the smoothed regressor about its mean.
    pub(crate) spread: f64,
    /// True if the spread is visibly larger than the noise; otherwise the term was left out.
    pub(crate) moved: bool,
    pub(crate) inflation: Inflation,
}

/// The fit of one equation: its terms, and how much the left side moved.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) terms: Vec<TermFit>,
    /// Root mean square of the left side about its mean.
    pub(crate) spread: f64,
}

/// What the left side is given as.
pub(crate) enum Left {
    /// Its integral was measured: an angular rate for an angular acceleration.
    Integral(Vec<f64>),
    /// The left side itself was measured, such as a specific force.
    Value(Vec<f64>),
}

/// Samples this far to each side make one smoothed value, s: as equation error takes them.
fn half_window(time: &[f64]) -> f64 {
    let step = (time.last().copied().unwrap_or(0.0) - time.first().copied().unwrap_or(0.0)) / time.len().max(2) as f64;
    f64::max(0.2, 3.0 * step)
}

/// Fits `left = sum of terms + constant`, weighted by `weight` on both sides (`weight` multiplies the regressors), both
/// sides smoothed alike: what is measured is integrated, and the slope of local cubics is taken of the integral.
///
/// # Errors
/// A sentence: too few samples, terms that cannot be told apart.
pub(crate) fn fit(window: &Window, left: &Left, regressors: &[Regressor]) -> Result<Fit, String> {
    let time = &window.time;
    let side = match left {
        Left::Integral(values) | Left::Value(values) => values,
    };
    let complete: Vec<bool> =
        (0..time.len()).map(|k| side[k].is_finite() && regressors.iter().all(|r| r.values[k].is_finite())).collect();
    let pick =
        |values: &[f64]| -> Vec<f64> { values.iter().zip(&complete).filter(|(_, c)| **c).map(|(v, _)| *v).collect() };
    let time = pick(time);
    if time.len() < 20 {
        return Err(format!("only {} samples have every channel that it needs", time.len()));
    }
    let cubics = LocalCubics::new(&time, &time, half_window(&time));
    let through = |values: Vec<f64>| cubics.slopes(&integral(&time, &values));
    let y = match left {
        Left::Integral(values) => cubics.slopes(&pick(values)),
        Left::Value(values) => through(pick(values)),
    };
    let columns: Vec<Vec<f64>> = regressors.iter().map(|r| through(pick(&r.values))).collect();
    let rows: Vec<usize> = (0..time.len()).filter(|k| y[*k].is_finite()).collect();
    if rows.len() < 4 * (columns.len() + 1) {
        return Err(format!("only {} samples for {} terms", rows.len(), columns.len() + 1));
    }
    // About their means, and in units of their spread: the constant is gone, and the conditions are those of shapes.
    let centred = |values: &[f64]| {
        let mean = rows.iter().map(|k| values[*k]).sum::<f64>() / rows.len() as f64;
        let about: Vec<f64> = rows.iter().map(|k| values[*k] - mean).collect();
        let spread = (about.iter().map(|v| v * v).sum::<f64>() / rows.len() as f64).sqrt();
        (about, spread)
    };
    let (y, y_spread) = centred(&y);
    let columns: Vec<(Vec<f64>, f64)> = columns.iter().map(|c| centred(c)).collect();
    // Averages over the window: noise falls as the root of the samples in it, by 4/9 for the cubic's value.
    let in_window = (2.0 * half_window(&time) * time.len() as f64 / (time[time.len() - 1] - time[0])).max(1.0);
    let noise: Vec<f64> = regressors.iter().map(|r| r.noise * (2.25 / in_window).sqrt().min(1.0)).collect();
    // What does not move is left out: its noise would only dilute the others.
    let moved: Vec<usize> = (0..columns.len()).filter(|j| columns[*j].1 >= MOVED * noise[*j]).collect();
    let design = DMatrix::from_fn(rows.len(), moved.len(), |k, j| columns[moved[j]].0[k] / columns[moved[j]].1);
    let normal = design.transpose() * &design;
    let Some(inverse) = normal.clone().cholesky().map(|c| c.inverse()) else {
        return Err("its terms move exactly together and cannot be told apart".to_owned());
    };
    let scaled = &inverse * (design.transpose() * DVector::from_vec(y.clone()));
    let residuals: Vec<f64> = (DVector::from_vec(y.clone()) - &design * &scaled).iter().copied().collect();
    let freedom = rows.len().saturating_sub(moved.len() + 1).max(1) as f64;
    let sigma = (residuals.iter().map(|r| r * r).sum::<f64>() / freedom).sqrt();
    let variances = coloured(&design, &inverse, &residuals, sigma);
    let terms = regressors.iter().enumerate().map(|(index, r)| {
        let (spread, place) = (columns[index].1, moved.iter().position(|j| *j == index));
        let (value, std_error, inflation) = match place {
            None => (f64::NAN, f64::INFINITY, Inflation { variance_inflation: 1.0, with: None }),
            Some(j) => {
                let variance_inflation = inverse[(j, j)] * rows.len() as f64;
                let with = (0..moved.len())
                    .filter(|i| *i != j)
                    .map(|i| (regressors[moved[i]].words.to_owned(), normal[(i, j)] / rows.len() as f64))
                    .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
                (scaled[j] / spread, variances[j].sqrt() / spread, Inflation { variance_inflation, with })
            }
        };
        TermFit { name: r.name, words: r.words, value, std_error, spread, moved: place.is_some(), inflation }
    });
    Ok(Fit { terms: terms.collect(), spread: y_spread })
}

/// Variances of the scaled values, by the residuals' own autocorrelation; not below those of white residuals.
fn coloured(design: &DMatrix<f64>, inverse: &DMatrix<f64>, residuals: &[f64], sigma: f64) -> Vec<f64> {
    let width = design.ncols();
    if sigma <= 0.0 || sigma.is_nan() {
        return vec![0.0; width];
    }
    let rows = [Rows::<1> {
        columns: (0..width).collect(),
        outputs: Vec::new(),
        residuals: residuals.iter().map(|r| [r / sigma]).collect(),
        sensitivities: (0..design.nrows()).flat_map(|k| (0..width).map(move |j| design[(k, j)])).collect(),
        loss: Loss::GAUSSIAN,
        growth: 1.0,
    }];
    let spread = Colour::of(&rows).spread(&rows, width);
    let covariance = inverse * spread * inverse;
    (0..width).map(|j| sigma * sigma * covariance[(j, j)].max(inverse[(j, j)])).collect()
}

/// Running integral by trapezia, zero at the first sample.
fn integral(time: &[f64], values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut total = vec![0.0; values.len()];
    for k in 1..values.len() {
        sum += 0.5 * (time[k] - time[k - 1]) * (values[k] + values[k - 1]);
        total[k] = sum;
    }
    total
}
