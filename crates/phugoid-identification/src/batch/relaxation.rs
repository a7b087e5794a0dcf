//! Least squares with noise levels that are known or at their own optimum: what output error and equation error share.

use super::error::BatchError;
use super::layout::Place;
use super::likelihood::Evaluation;
use super::optimise::{Minimum, OptimiserSettings, minimise};
use super::problem::{Manoeuvre, Noise};
use super::response::Rows;

/// The residuals at one point, and the noise that they were divided by.
pub(crate) struct Fitted<const R: usize> {
    /// Residuals and sensitivities of each manoeuvre, divided by the standard deviation of the noise of their output.
    pub(crate) rows: Vec<Rows<R>>,
    pub(crate) noise_std: [f64; R],
}

/// Minimises `sum_i [ N_i ln std_i + 1/2 sum_k e_i(k)^2 / std_i^2 ]` and the priors. An unknown `std_i` is at its
/// optimum for the residuals of the moment, `std_i^2 = sum e_i^2 / N_i`, at every evaluation: the gradient is then that
/// of the likelihood with the noise eliminated, and one cost serves the whole search.
pub(crate) fn fit<const R: usize>(
    places: &[Place],
    start: Vec<f64>,
    noise: &[Noise; R],
    floor: &[f64; R],
    settings: &OptimiserSettings,
    residuals: impl Fn(&[f64]) -> Result<Vec<Rows<R>>, BatchError>,
) -> Result<Minimum<Fitted<R>>, BatchError> {
    let evaluate = |unknowns: &[f64]| -> Result<Evaluation<Fitted<R>>, BatchError> {
        let rows = residuals(unknowns)?;
        let (noise_std, cost) = levels(noise, &rows, floor);
        let rows: Vec<Rows<R>> = rows.into_iter().map(|r| r.whitened(&noise_std)).collect();
        let mut evaluation = Evaluation::of_priors(places, unknowns);
        rows.iter().for_each(|r| evaluation.add(r));
        Ok(evaluation.with(cost, Fitted { rows, noise_std }))
    };
    let first = evaluate(&start)?;
    minimise(places, start, first, settings, |unknowns, _| evaluate(unknowns).ok())
}

/// Smallest standard deviation of the noise that is accepted for each output: without it, exact data of an exact model
/// would have infinite information.
pub(crate) fn noise_floor<M, I, const N: usize, const R: usize>(manoeuvres: &[Manoeuvre<'_, M, I, N, R>]) -> [f64; R] {
    std::array::from_fn(|i| {
        let values = manoeuvres.iter().flat_map(|m| m.outputs.iter().map(move |y| y[i])).filter(|v| v.is_finite());
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let size = (high - low).max(1e-9 * high.abs().max(low.abs()));
        if size > 0.0 && size.is_finite() { 1e-7 * size } else { f64::MIN_POSITIVE.sqrt() }
    })
}

/// One sigma of each output, NaN where it has no values, and the cost of the residuals.
pub(crate) fn levels<const R: usize>(noise: &[Noise; R], rows: &[Rows<R>], floor: &[f64; R]) -> ([f64; R], f64) {
    let mut cost = 0.0;
    let noise_std = std::array::from_fn(|i| {
        let errors = rows.iter().flat_map(|r| r.residuals.iter().map(move |e| e[i])).filter(|e| e.is_finite());
        let (count, sum) = errors.fold((0.0_f64, 0.0), |(n, s), e| (n + 1.0, s + e * e));
        if count == 0.0 {
            return f64::NAN;
        }
        let std = match noise[i] {
            Noise::Known(std) => std,
            Noise::Estimated => (sum / count).sqrt().max(floor[i]),
        };
        cost += count * std.ln() + 0.5 * sum / (std * std);
        std
    });
    (noise_std, cost)
}
