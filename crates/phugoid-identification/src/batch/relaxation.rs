//! Least squares with noise levels that are known or at their own optimum: what output error and equation error share.

use super::error::BatchError;
use super::layout::Place;
use super::likelihood::Evaluation;
use super::loss::Loss;
use super::optimise::{Minimum, OptimiserSettings, minimise};
use super::problem::{Manoeuvre, Noise};
use super::response::Rows;

/// The residuals at one point, and the noise that they were divided by.
pub(crate) struct Fitted<const R: usize> {
    /// Residuals and sensitivities of each manoeuvre, divided by the standard deviation of the noise of their output.
    pub(crate) rows: Vec<Rows<R>>,
    pub(crate) noise_std: [f64; R],
}

/// Minimises `sum_i [ beta N_i ln std_i + sum_k rho(e_i(k) / std_i) ]` and the priors. An unknown `std_i` is at its
/// optimum for the residuals of the moment (`std_i^2 = sum e_i^2 / N_i` for Gaussian noise) at every evaluation: the
/// gradient is then that of the likelihood with the noise eliminated, and one cost serves the whole search.
pub(crate) fn fit<const R: usize>(
    places: &[Place],
    start: Vec<f64>,
    noise: &[Noise; R],
    floor: &[f64; R],
    loss: Loss,
    settings: &OptimiserSettings,
    residuals: impl Fn(&[f64]) -> Result<Vec<Rows<R>>, BatchError>,
) -> Result<Minimum<Fitted<R>>, BatchError> {
    let evaluate = |unknowns: &[f64]| -> Result<Evaluation<Fitted<R>>, BatchError> {
        let rows = residuals(unknowns)?;
        let (noise_std, cost) = levels(noise, &rows, floor, loss);
        let rows: Vec<Rows<R>> = rows.into_iter().map(|r| r.whitened(&noise_std, loss)).collect();
        let mut evaluation = Evaluation::of_priors(places, unknowns);
        rows.iter().for_each(|r| evaluation.add(r));
        Ok(evaluation.with(cost, Fitted { rows, noise_std }))
    };
    let first = evaluate(&start)?;
    // Gauss-Newton with exact sensitivities needs no help here, and what a free simulation of an unstable model shows of
    // the curvature leads the search into minima where one output alone is followed.
    minimise(places, start, first, settings, 0, |unknowns, _| evaluate(unknowns).ok())
}

/// Smallest standard deviation of the noise that is accepted for each output: without it, exact data of an exact model
/// would have infinite information.
pub(crate) fn noise_floor<const N: usize, const R: usize>(manoeuvres: &[Manoeuvre<'_, N, R>]) -> [f64; R] {
    std::array::from_fn(|i| {
        let values = manoeuvres.iter().flat_map(|m| m.outputs.iter().map(move |y| y[i])).filter(|v| v.is_finite());
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let size = (high - low).max(1e-9 * high.abs().max(low.abs()));
        if size > 0.0 && size.is_finite() { 1e-7 * size } else { f64::MIN_POSITIVE.sqrt() }
    })
}

/// Steps of the search for a noise level: each brings it nearer by the share of the squares that outliers make, or more.
const LEVEL_STEPS: usize = 60;
/// Relative change of a noise level at which it counts as found. The cost is at its minimum there, so that its own error
/// is of second order.
const LEVEL_TOLERANCE: f64 = 1e-9;

/// One sigma of each output, NaN where it has no values, and the cost of the residuals.
pub(crate) fn levels<const R: usize>(
    noise: &[Noise; R],
    rows: &[Rows<R>],
    floor: &[f64; R],
    loss: Loss,
) -> ([f64; R], f64) {
    let mut cost = 0.0;
    let noise_std = std::array::from_fn(|i| {
        let errors: Vec<f64> =
            rows.iter().flat_map(|r| r.residuals.iter().map(move |e| e[i])).filter(|e| e.is_finite()).collect();
        if errors.is_empty() {
            return f64::NAN;
        }
        let std = match noise[i] {
            Noise::Known(std) => std,
            Noise::Estimated => level(&errors, floor[i], loss),
        };
        cost += loss.share * errors.len() as f64 * std.ln() + errors.iter().map(|e| loss.cost(e / std)).sum::<f64>();
        std
    });
    (noise_std, cost)
}

/// The level that makes the cost of these errors smallest: `sum z rho'(z) = beta N`.
fn level(errors: &[f64], floor: f64, loss: Loss) -> f64 {
    let count = errors.len() as f64;
    let mut std = (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt().max(floor);
    if loss == Loss::GAUSSIAN {
        return std;
    }
    for _ in 0..LEVEL_STEPS {
        let weighted: f64 = errors.iter().map(|e| loss.weight(e / std) * e * e).sum();
        let next = (weighted / (loss.share * count)).sqrt().max(floor);
        let moved = (next - std).abs();
        std = next;
        if moved <= LEVEL_TOLERANCE * std {
            break;
        }
    }
    std
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::options::Likelihood;

    #[test]
    fn one_in_a_hundred_outliers_hardly_moves_the_level() {
        let robust = Loss::of(Likelihood::Robust);
        // Sums of twelve uniform numbers from Knuth's generator are nearly Gaussian with one sigma of 1.
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut errors: Vec<f64> = (0..100).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect();
        let clean = level(&errors, 0.0, robust);
        assert!((clean / level(&errors, 0.0, Loss::GAUSSIAN) - 1.0).abs() < 0.01, "{clean}");
        errors[7] = 100.0;
        let bent = level(&errors, 0.0, Loss::GAUSSIAN);
        let kept = level(&errors, 0.0, robust);
        assert!(bent > 8.0 * clean && kept < 1.1 * clean, "{clean} {bent} {kept}");
        // The condition that it solves.
        let sum: f64 = errors.iter().map(|e| robust.weight(e / kept) * (e / kept).powi(2)).sum();
        assert!((sum / (robust.share * errors.len() as f64) - 1.0).abs() < 1e-6, "{sum}");
    }
}
