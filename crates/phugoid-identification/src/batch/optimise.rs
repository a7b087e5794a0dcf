//! Gauss-Newton with a Levenberg-Marquardt safeguard, inside bounds.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector};

use super::error::BatchError;
use super::information::solve;
use super::layout::Place;
use super::likelihood::Evaluation;
use super::result::Iteration;

/// When the search for the minimum of the cost ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimiserSettings {
    /// Largest number of accepted steps.
    pub maximum_iterations: usize,
    /// The minimum is reached when the next step `d` is shorter than this many standard errors (`sqrt(d^T M d)`, with
    /// the information `M`): every unknown is then closer than that fraction of its own standard error to the optimum.
    pub step_tolerance: f64,
    /// A search that comes no nearer is accepted, and says so, where the next step is at most this many standard errors
    /// long; a longer one is an error ([`BatchError::NotConverged`]).
    pub acceptable_step: f64,
}

impl Default for OptimiserSettings {
    /// 100 iterations, 1e-3 standard errors, acceptable from 0.05 standard errors on.
    fn default() -> Self {
        Self { maximum_iterations: 100, step_tolerance: 1e-3, acceptable_step: 0.05 }
    }
}

/// First damping after a Gauss-Newton step that made things worse; below it damping is dropped.
const FIRST_DAMPING: f64 = 1e-4;
/// Factor of the damping from one attempt to the next.
const DAMPING_FACTOR: f64 = 10.0;
/// Dampings tried from one point before the search gives up.
const ATTEMPTS: usize = 20;
/// Relative change of the cost below which rounding decides.
const ROUNDING: f64 = 1e-12;

/// The point at which the search ended, with what was computed there.
#[derive(Clone, Debug)]
pub(crate) struct Minimum<T> {
    pub(crate) unknowns: Vec<f64>,
    pub(crate) evaluation: Evaluation<T>,
    pub(crate) iterations: Vec<Iteration>,
    /// Unknowns that rest on a bound.
    pub(crate) at_limit: Vec<bool>,
    /// Length of the next step in standard errors, where the search ended before that was below its tolerance.
    pub(crate) short_of: Option<f64>,
}

/// What the last steps near the minimum told of the curvature of the cost: each step with the change of the gradient.
///
/// The Fisher information is the curvature on average over the noise. On one flight, the more so where the model lacks
/// something, the curvature differs from it, and the search then creeps: each step leaves nine tenths of the way, or
/// turns back. The last steps in a formula for quasi-Newton methods (Broyden, Fletcher, Goldfarb and Shanno, on the
/// information of the point as the first matrix, as Nocedal, Mathematics of Computation 35, 1980, does it; Powell's
/// damping keeps it positive definite) show it, and with it how far away the minimum really is.
#[derive(Default)]
struct Secants {
    /// Step and change of the gradient, the oldest first.
    pairs: VecDeque<[DVector<f64>; 2]>,
}

/// Longest step that is remembered, in standard errors: over a longer one the curvature is not that of the minimum.
const NEAR: f64 = 3.0;
/// Least part of the curvature along a step that Powell's damping leaves (Nocedal & Wright, Numerical Optimization,
/// procedure 18.2).
const LEAST_CURVATURE: f64 = 0.2;

impl Secants {
    /// Keeps the last `most` steps.
    fn remember(&mut self, most: usize, step: DVector<f64>, change: DVector<f64>, information: &DMatrix<f64>) {
        let length = step.dot(&(information * &step)).sqrt();
        if length > 0.0 && length <= NEAR {
            self.pairs.push_back([step, change]);
        }
        if self.pairs.len() > most {
            self.pairs.pop_front();
        }
    }

    /// The curvature at a point with this information.
    fn curvature(&self, information: &DMatrix<f64>) -> DMatrix<f64> {
        let mut curvature = information.clone();
        for [step, change] in &self.pairs {
            let along = &curvature * step;
            let expected = step.dot(&along);
            if expected.is_nan() || expected <= 0.0 {
                continue;
            }
            let found = step.dot(change);
            let change = match found < LEAST_CURVATURE * expected {
                true => {
                    let part = (1.0 - LEAST_CURVATURE) * expected / (expected - found);
                    part * change + (1.0 - part) * &along
                }
                false => change.clone(),
            };
            curvature += &change * change.transpose() / step.dot(&change) - &along * along.transpose() / expected;
        }
        curvature
    }
}

/// Searches the minimum of a negative log-likelihood.
///
/// Each step solves `(B + lambda diag B) d = -g`, where `B` is the Fisher information `M`, and near the minimum what the
/// last steps have shown of the curvature: Gauss-Newton while that lowers the cost (`lambda = 0`), Levenberg-Marquardt
/// with growing damping where it does not or where `M` is singular. A step is cut at the bounds; an unknown on a bound
/// that the gradient presses against is left out of the step. `evaluate` gives none where the model has no finite
/// answer, and may where the cost is not below its second argument. `learn_from` is the most steps of which the
/// curvature is learnt; 0 takes the information for it.
pub(crate) fn minimise<T>(
    places: &[Place],
    start: Vec<f64>,
    first: Evaluation<T>,
    settings: &OptimiserSettings,
    learn_from: usize,
    mut evaluate: impl FnMut(&[f64], f64) -> Option<Evaluation<T>>,
) -> Result<Minimum<T>, BatchError> {
    let (mut unknowns, mut here) = (start, first);
    let mut damping = 0.0;
    let mut used = 0.0;
    let mut iterations = Vec::new();
    let mut secants = Secants::default();
    loop {
        let at_limit = limits(places, &unknowns, &here.descent);
        let mut curvature = secants.curvature(&here.information);
        let mut newton = solve(&curvature, &here.descent, 0.0, &at_limit);
        let next_step = match &newton {
            Some(step) => step.dot(&(&here.information * step)).max(0.0).sqrt(),
            None => f64::INFINITY,
        };
        iterations.push(Iteration { cost: here.cost, damping: used, next_step });
        let done = |unknowns, here, iterations| {
            let short_of = (next_step > settings.step_tolerance && next_step.is_finite()).then_some(next_step);
            Ok(Minimum { unknowns, evaluation: here, iterations, at_limit: at_limit.clone(), short_of })
        };
        if next_step <= settings.step_tolerance {
            return done(unknowns, here, iterations);
        }
        if iterations.len() > settings.maximum_iterations {
            if next_step <= settings.acceptable_step {
                return done(unknowns, here, iterations);
            }
            return Err(BatchError::NotConverged {
                iterations: settings.maximum_iterations,
                step: next_step,
                tolerance: settings.acceptable_step,
            });
        }
        let mut accepted = None;
        for _ in 0..ATTEMPTS {
            let step =
                if damping == 0.0 { newton.clone() } else { solve(&curvature, &here.descent, damping, &at_limit) };
            if let Some(step) = step {
                let trial = inside(places, &unknowns, &step);
                if let Some(there) = evaluate(&trial, here.cost).filter(|e| e.cost < here.cost && is_finite(e)) {
                    accepted = Some((trial, there));
                    break;
                }
                // What the step promises is below what rounding lets the cost show.
                if step.dot(&here.descent).abs() < ROUNDING * here.cost.abs().max(1.0) {
                    break;
                }
            }
            if !secants.pairs.is_empty() {
                // What was learnt on the way does not hold here.
                secants = Secants::default();
                curvature = here.information.clone();
                newton = solve(&curvature, &here.descent, 0.0, &at_limit);
                continue;
            }
            damping = (damping * DAMPING_FACTOR).max(FIRST_DAMPING);
        }
        let Some((trial, there)) = accepted else {
            // No direction lowers the cost any more: the minimum is reached to rounding, or the information is
            // singular, which the covariance reports.
            let reached = next_step.is_infinite() || next_step.powi(2) < 1e-6 * here.cost.abs().max(1.0);
            return if reached || next_step <= settings.acceptable_step {
                done(unknowns, here, iterations)
            } else {
                let (iterations, tolerance) = (iterations.len() - 1, settings.acceptable_step);
                Err(BatchError::NotConverged { iterations, step: next_step, tolerance })
            };
        };
        used = damping;
        damping = if damping <= FIRST_DAMPING { 0.0 } else { damping / DAMPING_FACTOR };
        // Where the information is singular the cost may fall by ever smaller amounts: stop when it no longer falls
        // visibly.
        let stands = next_step.is_infinite() && here.cost - there.cost < ROUNDING * here.cost.abs().max(1.0);
        let step = DVector::from_iterator(trial.len(), trial.iter().zip(&unknowns).map(|(to, from)| to - from));
        secants.remember(learn_from, step, &here.descent - &there.descent, &there.information);
        (unknowns, here) = (trial, there);
        if stands {
            let at_limit = limits(places, &unknowns, &here.descent);
            return Ok(Minimum { unknowns, evaluation: here, iterations, at_limit, short_of: None });
        }
    }
}

fn is_finite<T>(evaluation: &Evaluation<T>) -> bool {
    let matrix: &DMatrix<f64> = &evaluation.information;
    let vector: &DVector<f64> = &evaluation.descent;
    evaluation.cost.is_finite() && matrix.iter().chain(vector.iter()).all(|v| v.is_finite())
}

/// True for each unknown on a bound that the cost presses it against.
fn limits(places: &[Place], unknowns: &[f64], descent: &DVector<f64>) -> Vec<bool> {
    places
        .iter()
        .zip(unknowns)
        .zip(descent.iter())
        .map(|((p, v), d)| (*v <= p.lower && *d < 0.0) || (*v >= p.upper && *d > 0.0))
        .collect()
}

fn inside(places: &[Place], unknowns: &[f64], step: &DVector<f64>) -> Vec<f64> {
    places.iter().zip(unknowns).zip(step.iter()).map(|((p, v), d)| (v + d).clamp(p.lower, p.upper)).collect()
}
