//! Which of the equations that share parameters is believed: the minima of a regression whose weights are unknown.
//!
//! Lift and drag stand in both measured accelerations. With the residual variance of each equation at its optimum, the cost
//! `sum_i N_i ln(std_i)` may be low where one of them is met exactly and the other is taken for noise, or the other way round: there
//! are as many minima as equations, at most, and from one start the search finds one of them. Where the drag lacks a term, the
//! terms of the lift can make up for it in the one equation, and the wrong minimum is hundreds of nats higher. So each equation is
//! believed in turn, and the lowest cost counts.

use nalgebra::{DMatrix, DVector};

use super::error::BatchError;
use super::information::solve;
use super::likelihood::Evaluation;
use super::optimise::Minimum;
use super::response::Rows;

/// Weight of the equation that is believed at first, over those of the others.
const BELIEVED: f64 = 1e4;
/// Steps of the weights: each takes the residuals of the values before.
const STEPS: usize = 60;
/// Relative change of the weights at which they count as found.
const TOLERANCE: f64 = 1e-6;
/// Least mean square of an equation's residual over that at the minimum: what is below it is rounding.
const LEAST: f64 = 1e-12;
/// Nats by which another minimum has to be lower.
const NOTICEABLE: f64 = 0.1;

/// Squares and products of one equation at a point, in units of its residual there.
struct Sums {
    products: Evaluation<()>,
    squares: f64,
    count: f64,
}

impl Sums {
    fn of<const R: usize>(rows: &[Rows<R>], output: usize, unknowns: usize) -> Self {
        let residuals = || rows.iter().flat_map(|r| &r.residuals).map(|e| e[output]).filter(|e| e.is_finite());
        let mut products = Evaluation::nothing(unknowns);
        rows.iter().for_each(|r| products.add_of(r, |i| i == output));
        Self { products, squares: residuals().map(|e| e * e).sum(), count: residuals().count() as f64 }
    }

    /// Mean square of the residual a step away. The equations are linear in the unknowns.
    fn mean_square(&self, step: &DVector<f64>) -> f64 {
        let Evaluation { descent, information, .. } = &self.products;
        let squares = self.squares - 2.0 * descent.dot(step) + step.dot(&(information * step));
        (squares / self.count).max(LEAST)
    }

    fn shares(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|sums| sums.products.information.diagonal());
        own.iter().zip(&others).any(|(a, b)| *a > 0.0 && *b > 0.0)
    }
}

/// The lowest minimum that is reached from the start or from there with one equation believed, and where its search began. `fit`
/// finds the nearest minimum, and `rows` are its residuals and sensitivities, divided by one sigma of each equation.
///
/// # Errors
/// Those of `fit` from the start.
pub(super) fn lowest<T, const R: usize>(
    start: Vec<f64>,
    fit: impl Fn(Vec<f64>) -> Result<Minimum<T>, BatchError>,
    rows: impl Fn(&T) -> &[Rows<R>],
) -> Result<(Minimum<T>, Vec<f64>), BatchError> {
    let mut best = (fit(start.clone())?, start);
    let found = best.0.unknowns.clone();
    for step in steps(rows(&best.0.evaluation.detail), found.len()) {
        let start: Vec<f64> = found.iter().zip(step.iter()).map(|(value, step)| value + step).collect();
        // A search that does not end from there leaves what was found.
        if let Ok(minimum) = fit(start.clone())
            && minimum.evaluation.cost < best.0.evaluation.cost - NOTICEABLE
        {
            best = (minimum, start);
        }
    }
    Ok(best)
}

/// Steps from a minimum to others with a lower cost, by the equations alone.
fn steps<const R: usize>(rows: &[Rows<R>], unknowns: usize) -> Vec<DVector<f64>> {
    let equations: Vec<Sums> =
        (0..R).map(|output| Sums::of(rows, output, unknowns)).filter(|sums| sums.count > 0.0).collect();
    let alone = |i: usize| (0..equations.len()).all(|j| j == i || !equations[i].shares(&equations[j]));
    let believed = (0..equations.len()).filter(|&i| !alone(i));
    believed.filter_map(|i| step(&equations, i)).collect()
}

/// The step to the minimum that is reached where one equation is believed at first; none where the cost is not lower there.
fn step(equations: &[Sums], believed: usize) -> Option<DVector<f64>> {
    let unknowns = equations[believed].products.descent.len();
    let mut weights: Vec<f64> = (0..equations.len()).map(|i| if i == believed { BELIEVED } else { 1.0 }).collect();
    let mut step = DVector::zeros(unknowns);
    for _ in 0..STEPS {
        let mut information = DMatrix::zeros(unknowns, unknowns);
        let mut descent = DVector::zeros(unknowns);
        for (sums, weight) in equations.iter().zip(&weights) {
            information += &sums.products.information * *weight;
            descent += &sums.products.descent * *weight;
        }
        step = solve(&information, &descent, 0.0, &vec![false; unknowns])?;
        let next: Vec<f64> = equations.iter().map(|sums| 1.0 / sums.mean_square(&step)).collect();
        let moved = next.iter().zip(&weights).any(|(a, b)| (a / b - 1.0).abs() > TOLERANCE);
        weights = next;
        if !moved {
            break;
        }
    }
    let gained: f64 = equations.iter().map(|sums| -0.5 * sums.count * sums.mean_square(&step).ln()).sum();
    (gained > NOTICEABLE).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::super::layout::Place;
    use super::super::loss::Loss;
    use super::super::optimise::OptimiserSettings;
    use super::super::problem::Noise;
    use super::super::relaxation::{self, Fitted};
    use super::super::result::UnknownKind;
    use super::*;

    const SAMPLES: usize = 400;

    /// Lift by two terms in both equations and drag by one in the second, which lacks a twentieth of the second term. Noise of a
    /// thousandth by a generator.
    fn residuals(unknowns: &[f64]) -> Vec<Rows<2>> {
        let mut state = 7_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            2e-3 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        };
        let mut rows = Rows {
            columns: vec![0, 1, 2],
            outputs: vec![[0.0; 2]; SAMPLES],
            residuals: Vec::new(),
            sensitivities: Vec::new(),
            loss: Loss::GAUSSIAN,
            growth: 1.0,
        };
        for k in 0..SAMPLES {
            let t = k as f64;
            let (x, w) = ((0.1 * t).sin(), (0.037 * t).cos());
            let (lift, drag) = ([x, w, 0.0], [0.2 * x, 0.2 * w, x * x]);
            let by = |terms: &[f64; 3], values: &[f64]| terms.iter().zip(values).map(|(a, b)| a * b).sum::<f64>();
            let truth = [1.0, 1.0, 1.0];
            rows.residuals.push([
                by(&lift, &truth) + noise() - by(&lift, unknowns),
                by(&drag, &truth) + 0.05 * w + noise() - by(&drag, unknowns),
            ]);
            rows.sensitivities.extend(lift.iter().chain(&drag));
        }
        vec![rows]
    }

    fn places() -> Vec<Place> {
        let place = |index: usize| Place {
            kind: UnknownKind::Parameter { index },
            name: format!("p{index}"),
            start: 0.0,
            prior_std: f64::INFINITY,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
        };
        (0..3).map(place).collect()
    }

    fn fit(start: Vec<f64>) -> Result<Minimum<Fitted<2>>, BatchError> {
        let settings = OptimiserSettings { step_tolerance: 1e-6, ..OptimiserSettings::default() };
        let noise = [Noise::Estimated; 2];
        relaxation::fit(&places(), start, &noise, &[1e-9; 2], Loss::GAUSSIAN, &settings, |unknowns| {
            Ok(residuals(unknowns))
        })
    }

    /// From where the second equation is met exactly the search stays there: the second lift term is a quarter off, and the first
    /// equation counts as noise. The minimum that meets the first equation is hundreds of nats lower.
    #[test]
    fn the_lower_of_two_minima_is_found_from_the_higher_one() {
        let start = vec![1.0, 1.25, 1.0];
        let stays = fit(start.clone()).unwrap();
        assert!((stays.unknowns[1] - 1.25).abs() < 0.01, "{:?}", stays.unknowns);

        let (found, from) = lowest(start, fit, |fitted: &Fitted<2>| &fitted.rows).unwrap();
        assert!((found.unknowns[1] - 1.0).abs() < 0.001, "{:?}", found.unknowns);
        let lower = stays.evaluation.cost - found.evaluation.cost;
        assert!((300.0..1000.0).contains(&lower), "{lower}");
        // It is the nearest one to where its search began, so that a repetition ends there too.
        assert_eq!(fit(from).unwrap().unknowns, found.unknowns);
    }

    /// Where the start leads to the lowest minimum, nothing is searched again: the values are the same to the last bit.
    #[test]
    fn the_lowest_minimum_is_left_as_it_was_found() {
        let start = vec![1.0, 1.01, 1.0];
        let (found, from) = lowest(start.clone(), fit, |fitted: &Fitted<2>| &fitted.rows).unwrap();
        assert_eq!(found.unknowns, fit(start.clone()).unwrap().unknowns);
        assert_eq!(from, start);
    }
}
