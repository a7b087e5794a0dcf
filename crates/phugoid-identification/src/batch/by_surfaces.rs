//! What the part of the motion that the surfaces made says of the parameters: two-stage least squares with the recent motion of
//! the surfaces as instrumental variables.
//!
//! Least squares on the equations of motion, and a filter whose process noise is white, take what an equation leaves over for independent
//! of the motion up to that moment. What lasts is not: a gust that turns the air rolls the aircraft, and goes on while it rolls, so that
//! the roll rate and the rest of the rolling moment go together and the damping comes out too small. Noise of the measured states shrinks
//! derivatives as well. Neither can be seen in the residuals, which are small because the parameters are bent.
//!
//! A surface that a pilot or a computer moves knows nothing of gusts to come and of the noise of the sensors. In the first stage each
//! regressor is replaced by what the positions of the surfaces, and these through lags of several times, explain of it; in the second the
//! parameters are those for which the rest of each equation has nothing in common with that part (T. Söderström & P. Stoica,
//! *Instrumental Variable Methods for System Identification*, 1983; P. Young, *Recursive Estimation and Time-Series Analysis*, 1984). With
//! `W` the surfaces, their lags and a constant, `P_W` the projection on them, and both sides divided by one sigma of each equation,
//!
//! ```text
//! theta = (X^T P_W X)^-1 X^T P_W y      Cov = (X^T P_W X)^-1 [ sum_i sum_j x(i)^T R(i - j) x(j) ] (X^T P_W X)^-1,  x = P_W X
//! ```
//!
//! where `R` is the autocorrelation of what is left over, as in [`colour`](super::colour). It needs no model of gusts and of noise,
//! and pays for that with wider bounds. It is wrong where a controller moves the surfaces after what lasts, as least squares are.

use nalgebra::{DMatrix, DVector};

use super::colour::Colour;
use super::equation_error::{EquationErrorSettings, needed_rows_at};
use super::error::BatchError;
use super::information::covariance;
use super::loss::Loss;
use super::problem::{Manoeuvre, Structure};
use super::response::Rows;
use super::result::{BatchFit, Unknown};

/// Time constants of the lags through which the surfaces go, s: from a few samples to the slow modes, twice as long each. What a linear
/// aircraft makes of its surfaces is nearly a sum of these.
const LAGS_S: [f64; 7] = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2];
/// Part of a variable that has to be left beside those before it, so that it is another one; below it is rounding.
const ANOTHER: f64 = 1e-6;

/// The unknowns of equation error again, from what the surfaces explain of the regressors; standard errors are those for coloured residuals. `surfaces`
/// are the positions (rad, or the unit of a further input) by manoeuvre, then input, then sample; `fit` is what [`equation_error`](super::equation_error())
/// found of the same manoeuvres with the same structure.
///
/// # Errors
/// Those of [`equation_error`](super::equation_error()); [`BatchError::Singular`] where the surfaces do not tell the parameters apart.
pub fn by_surfaces<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    surfaces: &[Vec<&[f64]>],
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
    fit: &BatchFit,
) -> Result<Vec<Unknown>, BatchError> {
    let at: Vec<f64> = fit.unknowns.iter().map(|unknown| unknown.value).collect();
    let (layout, rows) = needed_rows_at(manoeuvres, structure, settings, &at)?;
    let places = &layout.places;
    let sigma = root_mean_square(&rows);
    let rows: Vec<Rows<R>> = rows.into_iter().map(|rows| rows.whitened(&sigma, Loss::GAUSSIAN)).collect();
    let explained: Vec<Rows<R>> = rows
        .iter()
        .zip(manoeuvres)
        .zip(surfaces)
        .map(|((rows, manoeuvre), surfaces)| projected(rows, &variables(manoeuvre.time_s, surfaces)))
        .collect();
    let n = places.len();
    let mut information = DMatrix::<f64>::zeros(n, n);
    let mut gradient = DVector::<f64>::zeros(n);
    for (rows, explained) in rows.iter().zip(&explained) {
        for (k, residuals) in rows.residuals.iter().enumerate() {
            for (i, residual) in residuals.iter().enumerate().filter(|(_, e)| e.is_finite()) {
                let own = explained.sensitivity(k, i);
                for (a, &row) in rows.columns.iter().enumerate().filter(|(a, _)| own[*a] != 0.0) {
                    gradient[row] += own[a] * residual;
                    for (b, &column) in rows.columns.iter().enumerate() {
                        information[(row, column)] += own[a] * own[b];
                    }
                }
            }
        }
    }
    let mut known = DMatrix::<f64>::zeros(n, n);
    for (j, place) in places.iter().enumerate().filter(|(_, place)| place.prior_std.is_finite()) {
        known[(j, j)] = place.prior_std.powi(-2);
        gradient[j] += known[(j, j)] * (place.start - at[j]);
    }
    let claimed = covariance(&(information + &known), |j| places[j].name.clone())?;
    let step = &claimed * gradient;
    let left: Vec<Rows<R>> =
        rows.iter().zip(explained).map(|(rows, explained)| with_residuals_after(rows, explained, &step)).collect();
    let spread = Colour::of(&left).spread(&left, n) + known;
    let corrected = &claimed * spread * &claimed;
    let unknown = |(j, found): (usize, &Unknown)| Unknown {
        value: found.value + step[j],
        std_error: claimed[(j, j)].sqrt(),
        corrected_std_error: claimed[(j, j)].max(corrected[(j, j)]).sqrt(),
        ..found.clone()
    };
    Ok(fit.unknowns.iter().enumerate().map(unknown).collect())
}

/// One sigma of what is left over of each equation.
fn root_mean_square<const R: usize>(rows: &[Rows<R>]) -> [f64; R] {
    std::array::from_fn(|i| {
        let values = rows.iter().flat_map(|rows| rows.residuals.iter().map(|e| e[i])).filter(|e| e.is_finite());
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), e| (sum + e * e, count + 1.0));
        // Without a rest, as of data without noise, every equation counts alike.
        if sum > 0.0 { f64::sqrt(sum / count) } else { 1.0 }
    })
}

/// The constant, the inputs, and the inputs through each lag, which start at rest; by variable, then sample.
fn variables(time_s: &[f64], inputs: &[&[f64]]) -> Vec<Vec<f64>> {
    let mut all = vec![vec![1.0; time_s.len()]];
    for input in inputs {
        all.push(input.to_vec());
        for lag_s in LAGS_S {
            let mut value = input.first().copied().unwrap_or(0.0);
            let mut last_s = time_s.first().copied().unwrap_or(0.0);
            let follow = |(time_s, input): (&f64, &f64)| {
                value += (1.0 - (-(time_s - last_s) / lag_s).exp()) * (input - value);
                last_s = *time_s;
                value
            };
            all.push(time_s.iter().zip(*input).map(follow).collect());
        }
    }
    all
}

/// The rows with what the variables explain of each regressor, over the samples at which its equation has a value.
fn projected<const R: usize>(rows: &Rows<R>, variables: &[Vec<f64>]) -> Rows<R> {
    let width = rows.columns.len();
    let mut found = rows.clone();
    found.sensitivities.fill(0.0);
    for i in 0..R {
        let samples: Vec<usize> = (0..rows.residuals.len()).filter(|&k| rows.residuals[k][i].is_finite()).collect();
        let basis = orthonormal(variables.iter().map(|of| samples.iter().map(|&k| of[k]).collect()));
        for column in 0..width {
            let own: Vec<f64> = samples.iter().map(|&k| rows.sensitivity(k, i)[column]).collect();
            if own.iter().all(|v| *v == 0.0) {
                continue;
            }
            for direction in &basis {
                let part = dot(direction, &own);
                for (&k, v) in samples.iter().zip(direction) {
                    found.sensitivities[(k * R + i) * width + column] += part * v;
                }
            }
        }
    }
    found
}

/// Orthonormal vectors that span the given ones (Gram and Schmidt, twice, so that rounding leaves nothing of the first pass); what is no number
/// is left out.
fn orthonormal(vectors: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut vector in vectors {
        let before = dot(&vector, &vector).sqrt();
        for _ in 0..2 {
            for direction in &basis {
                let part = dot(direction, &vector);
                vector.iter_mut().zip(direction).for_each(|(v, d)| *v -= part * d);
            }
        }
        let length = dot(&vector, &vector).sqrt();
        if length > ANOTHER * before {
            vector.iter_mut().for_each(|v| *v /= length);
            basis.push(vector);
        }
    }
    basis
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What is left over after a step of the unknowns, beside what the surfaces explain of the regressors.
fn with_residuals_after<const R: usize>(rows: &Rows<R>, explained: Rows<R>, step: &DVector<f64>) -> Rows<R> {
    let mut left = explained;
    for (k, residuals) in left.residuals.iter_mut().enumerate() {
        for (i, residual) in residuals.iter_mut().enumerate() {
            let moved = rows.sensitivity(k, i).iter().zip(&rows.columns).map(|(s, &column)| s * step[column]);
            *residual -= moved.sum::<f64>();
        }
    }
    left
}
