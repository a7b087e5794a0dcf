//! Which of many candidate terms a coefficient needs: forward selection in orthogonal functions, and its check.
//!
//! *Multivariate orthogonal functions* (E. A. Morelli, *Global Nonlinear Aerodynamic Modeling Using Multivariate
//! Orthogonal Functions*, Journal of Aircraft 32, 1995): each candidate is made orthogonal to the terms that were taken
//! before. What one more orthogonal function explains of the coefficient does not depend on the others, so that the term
//! that explains most is known at each step. The predicted square error
//!
//! ```text
//! PSE = 1/N sum e^2 + sigma_max^2 n/N,      sigma_max^2 = 1/N sum (z - mean z)^2
//! ```
//!
//! falls while a term explains more than a needless one is allowed to, and its smallest value ends the model. PRESS (D. M.
//! Allen, Technometrics 16, 1974) is the mean square of each residual predicted without its own row, `e/(1 - h)`.
//!
//! *Modified stepwise regression* (V. Klein, J. G. Batterson, P. C. Murphy, NASA TP-1916, 1981): a term is taken in while
//! its partial F reaches F to enter, and taken out when the later ones make it needless.
//!
//! The F of both is corrected for residuals that last from row to row. Noise alone, and noise that lasts, lower PSE and
//! PRESS: of a coefficient that nothing explains the PSE takes every term whose F exceeds one, a third of all. So a term
//! has to have the F to remove at the end, whichever criterion ended the selection.

use nalgebra::{DMatrix, DVector};

use super::criterion::Criterion;
use crate::batch::RowCorrelation;

/// Least part of a candidate's motion that the other terms may leave, as a part of its standard deviation: below, the
/// flight does not tell it from them.
const OWN: f64 = 0.05;
/// Most terms that are taken in, the constant apart.
const MOST: usize = 20;
/// Rows that there have to be for each term.
const ROWS: f64 = 5.0;
/// Two candidates are alike if what the terms leave of them has this correlation, and explain a flight equally well within
/// so many nats of log likelihood.
const ALIKE: f64 = 0.95;
const EQUAL: f64 = 3.0;
/// A candidate that would explain this part of what the best one does is named beside it.
const NEARLY: f64 = 0.8;

/// The coefficient and the candidates, row by row.
pub(super) struct Problem {
    /// The coefficient; zero in a row that is not used.
    pub(super) left: Vec<f64>,
    /// The candidates, without the constant; zero in a row that is not used.
    pub(super) columns: Vec<Vec<f64>>,
    /// Which rows are used.
    pub(super) used: Vec<bool>,
}

/// When a term is taken in, and when it has to go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rule {
    pub(super) criterion: Criterion,
    pub(super) f_to_enter: f64,
    pub(super) f_to_remove: f64,
}

/// One step of the selection, with the model of all terms up to it.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// The term that is taken in; `None` for the constant alone.
    pub(super) column: Option<usize>,
    pub(super) r_squared: f64,
    pub(super) pse: f64,
    pub(super) press: f64,
    /// Partial F of the term, corrected for colour; NaN for the constant.
    pub(super) partial_f: f64,
    /// Candidates that would have explained nearly as much.
    pub(super) alike: Vec<usize>,
}

/// One term of the final model.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    /// `None` for the constant.
    pub(super) column: Option<usize>,
    pub(super) value: f64,
    pub(super) std_error: f64,
    pub(super) partial_f: f64,
}

/// What the selection found.
#[derive(Clone, Debug)]
pub(super) struct Selection {
    /// Steps in their order, the first with the constant alone.
    pub(super) steps: Vec<Step>,
    /// Terms that a step took in and that the check took out again, with their partial F.
    pub(super) removed: Vec<(usize, f64)>,
    /// The final model, the constant first.
    pub(super) fitted: Vec<Fitted>,
    pub(super) r_squared: f64,
    pub(super) residual_std: f64,
    /// Candidates that the flight does not tell from the terms of the final model, with the one that each resembles most
    /// (`None` for the constant: it does not move).
    pub(super) not_told: Vec<(usize, Option<usize>)>,
    pub(super) rows: usize,
}

/// Orthonormal functions of the terms taken so far.
struct Basis {
    functions: Vec<Vec<f64>>,
}

impl Basis {
    fn of<'a>(columns: impl Iterator<Item = &'a [f64]>) -> Self {
        let mut basis = Self { functions: Vec::new() };
        columns.for_each(|column| basis.add(column));
        basis
    }

    fn add(&mut self, column: &[f64]) {
        let own = self.left_over(column);
        let length = dot(&own, &own).sqrt();
        if length > 0.0 {
            self.functions.push(own.iter().map(|value| value / length).collect());
        }
    }

    /// What the functions leave of a column; twice, because the first time leaves rounding (L. Giraud et al., Numerische
    /// Mathematik 101, 2005).
    fn left_over(&self, column: &[f64]) -> Vec<f64> {
        let mut own = column.to_vec();
        for _ in 0..2 {
            for function in &self.functions {
                let along = dot(function, &own);
                own.iter_mut().zip(function).for_each(|(value, f)| *value -= along * f);
            }
        }
        own
    }

    /// The leverage of each row.
    fn leverage(&self, row: usize) -> f64 {
        self.functions.iter().map(|function| function[row] * function[row]).sum()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Problem {
    fn constant(&self) -> Vec<f64> {
        self.used.iter().map(|used| f64::from(*used)).collect()
    }

    fn count(&self) -> f64 {
        self.used.iter().filter(|used| **used).count() as f64
    }

    /// The constant and these candidates.
    fn basis(&self, set: &[usize]) -> Basis {
        let constant = self.constant();
        Basis::of(std::iter::once(constant.as_slice()).chain(set.iter().map(|j| self.columns[*j].as_slice())))
    }

    /// Selects terms. `None` where there are fewer rows than a regression needs, or the coefficient does not move.
    pub(super) fn select(&self, rule: &Rule) -> Option<Selection> {
        let count = self.count();
        let about_mean = self.basis(&[]).left_over(&self.left);
        let squares = dot(&about_mean, &about_mean);
        // What is left of a constant is rounding.
        if count < 4.0 * ROWS || squares.is_nan() || squares <= 1e-20 * dot(&self.left, &self.left) {
            return None;
        }
        let spread: Vec<f64> = self
            .columns
            .iter()
            .map(|column| {
                let own = self.basis(&[]).left_over(column);
                // What is left of a constant is rounding.
                let moved = dot(&own, &own);
                if moved > 1e-20 * dot(column, column) { moved } else { 0.0 }
            })
            .collect();
        let mut steps = vec![self.step(None, &self.basis(&[]), squares, f64::NAN, Vec::new())];
        let mut entered: Vec<usize> = Vec::new();
        let mut removed: Vec<(usize, f64)> = Vec::new();
        while entered.len() < MOST && (entered.len() + 2) as f64 * ROWS < count {
            let basis = self.basis(&entered);
            let residual = basis.left_over(&self.left);
            if dot(&residual, &residual) <= 1e-18 * squares {
                break;
            }
            let list: Vec<(f64, usize, Vec<f64>)> = (0..self.columns.len())
                .filter(|j| !entered.contains(j) && !removed.iter().any(|(r, _)| r == j))
                .filter_map(|j| {
                    let own = basis.left_over(&self.columns[j]);
                    let left = dot(&own, &own);
                    let told = spread[j] > 0.0 && left > OWN * OWN * spread[j];
                    told.then(|| (dot(&own, &residual).powi(2) / left, j, own))
                })
                .collect();
            let Some((best, _, of_best)) = list.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            // Of those that move as the best one does and explain the flight equally well, the first in the list, which
            // is the simplest.
            let before = dot(&residual, &residual);
            // Residuals that last say less by as much as they widen the variance of a term.
            let [f, lasting] = self.partial_f(*best, of_best, &residual, entered.len() + 2);
            let effective = count * (f / lasting).clamp(0.0, 1.0);
            let is_equal = |(drop, _, own): &&(f64, usize, Vec<f64>)| {
                let nats = 0.5 * effective * ((before - drop) / (before - best).max(f64::MIN_POSITIVE)).ln();
                let likeness = dot(own, of_best).abs() / (dot(own, own) * dot(of_best, of_best)).sqrt();
                nats < EQUAL && likeness > ALIKE
            };
            let Some((drop, column, own)) = list.iter().find(is_equal) else { break };
            let [partial_f, _] = self.partial_f(*drop, own, &residual, entered.len() + 2);
            let nearly =
                |(other, j, _): &(f64, usize, Vec<f64>)| (*other >= NEARLY * best && j != column).then_some(*j);
            let alike = list.iter().filter_map(nearly).collect();
            entered.push(*column);
            steps.push(self.step(Some(*column), &self.basis(&entered), squares, partial_f, alike));
            if rule.criterion == Criterion::F {
                if partial_f < rule.f_to_enter {
                    entered.pop();
                    break;
                }
                self.check(&mut entered, &mut removed, rule.f_to_remove);
            }
        }
        // The smallest value ends the model.
        let taken = match rule.criterion {
            Criterion::F => None,
            Criterion::Pse => smallest(&steps, |step| step.pse),
            Criterion::Press => smallest(&steps, |step| step.press),
        };
        if let Some(taken) = taken {
            entered.truncate(taken);
            self.check(&mut entered, &mut removed, rule.f_to_remove);
        }
        let fitted = self.fit(&entered)?;
        let residual = self.basis(&entered).left_over(&self.left);
        let left = dot(&residual, &residual);
        Some(Selection {
            steps,
            removed,
            r_squared: 1.0 - left / squares,
            residual_std: (left / (count - fitted.len() as f64).max(1.0)).sqrt(),
            not_told: self.not_told(&entered, &spread),
            fitted,
            rows: count as usize,
        })
    }

    fn step(&self, column: Option<usize>, basis: &Basis, squares: f64, partial_f: f64, alike: Vec<usize>) -> Step {
        let count = self.count();
        let residual = basis.left_over(&self.left);
        let left = dot(&residual, &residual);
        let press: f64 = residual
            .iter()
            .enumerate()
            .filter(|(row, _)| self.used[*row])
            .map(|(row, e)| (e / (1.0 - basis.leverage(row)).max(f64::MIN_POSITIVE)).powi(2))
            .sum();
        Step {
            column,
            r_squared: 1.0 - left / squares,
            pse: left / count + squares / count * basis.functions.len() as f64 / count,
            press: press / count,
            partial_f,
            alike,
        }
    }

    /// The partial F of a term that lowers the squares of a residual by `drop`, with `terms` terms in all: the drop over
    /// the variance that is left, divided by how much residuals that last widen the term's variance. `own` is what the
    /// other terms leave of it. Second, the same as if the residual were white.
    fn partial_f(&self, drop: f64, own: &[f64], residual: &[f64], terms: usize) -> [f64; 2] {
        let length = dot(own, own);
        let value = dot(own, residual) / length;
        let left: Vec<f64> = residual.iter().zip(own).map(|(e, x)| e - value * x).collect();
        let freedom = (self.count() - terms as f64).max(1.0);
        let variance = dot(&left, &left) / freedom;
        let lasting = RowCorrelation::of_residual(&left, freedom).spread(own);
        [variance.max(lasting / length), variance].map(|variance| drop / variance.max(f64::MIN_POSITIVE))
    }

    /// Takes out the term with the smallest partial F while that is below the limit.
    fn check(&self, entered: &mut Vec<usize>, removed: &mut Vec<(usize, f64)>, limit: f64) {
        loop {
            let beside = |column: usize| {
                let others: Vec<usize> = entered.iter().copied().filter(|j| *j != column).collect();
                let basis = self.basis(&others);
                let (own, residual) = (basis.left_over(&self.columns[column]), basis.left_over(&self.left));
                let drop = dot(&own, &residual).powi(2) / dot(&own, &own);
                let [partial_f, _] = self.partial_f(drop, &own, &residual, entered.len() + 1);
                partial_f
            };
            let weakest = entered.iter().map(|j| (*j, beside(*j))).min_by(|a, b| a.1.total_cmp(&b.1));
            match weakest {
                Some((column, f)) if f.is_nan() || f < limit => {
                    entered.retain(|j| *j != column);
                    removed.push((column, f));
                }
                _ => return,
            }
        }
    }

    /// Least squares with these terms and the constant, with standard errors corrected for colour.
    fn fit(&self, set: &[usize]) -> Option<Vec<Fitted>> {
        let constant = self.constant();
        let columns: Vec<&[f64]> =
            std::iter::once(constant.as_slice()).chain(set.iter().map(|j| self.columns[*j].as_slice())).collect();
        let scale: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt()).collect();
        let n = columns.len();
        let normal = DMatrix::from_fn(n, n, |i, j| dot(columns[i], columns[j]) / (scale[i] * scale[j]));
        let inverse = normal.cholesky()?.inverse();
        let right = DVector::from_fn(n, |i, _| dot(columns[i], &self.left) / scale[i]);
        let values = &inverse * right;
        let mut residual = self.left.clone();
        for ((value, column), scale) in values.iter().zip(&columns).zip(&scale) {
            residual.iter_mut().zip(*column).for_each(|(e, x)| *e -= value / scale * x);
        }
        let freedom = (self.count() - n as f64).max(1.0);
        let variance = dot(&residual, &residual) / freedom;
        let colour = RowCorrelation::of_residual(&residual, freedom);
        let fitted = (0..n).map(|i| {
            // What a parameter takes from each row: its row of the pseudo-inverse.
            let mut taken = vec![0.0; residual.len()];
            for (j, column) in columns.iter().enumerate() {
                let weight = inverse[(i, j)] / (scale[i] * scale[j]);
                taken.iter_mut().zip(*column).for_each(|(t, x)| *t += weight * x);
            }
            let white = variance * inverse[(i, i)] / (scale[i] * scale[i]);
            let std_error = colour.spread(&taken).max(white).sqrt();
            let value = values[i] / scale[i];
            Fitted {
                column: i.checked_sub(1).and_then(|i| set.get(i)).copied(),
                value,
                std_error,
                partial_f: (value / std_error).powi(2),
            }
        });
        Some(fitted.collect())
    }

    /// Candidates of which the terms of a model leave too little, each with the term that it resembles most.
    fn not_told(&self, set: &[usize], spread: &[f64]) -> Vec<(usize, Option<usize>)> {
        let mean = self.basis(&[]);
        let basis = self.basis(set);
        let outside = (0..self.columns.len()).filter(|j| !set.contains(j));
        outside
            .filter_map(|j| {
                let own = basis.left_over(&self.columns[j]);
                if spread[j] > 0.0 && dot(&own, &own) > OWN * OWN * spread[j] {
                    return None;
                }
                let about = mean.left_over(&self.columns[j]);
                let likeness = |k: &usize| {
                    let other = mean.left_over(&self.columns[*k]);
                    (dot(&about, &other) / (dot(&about, &about) * dot(&other, &other)).sqrt()).abs()
                };
                let like = set.iter().copied().filter(|_| spread[j] > 0.0);
                Some((j, like.max_by(|a, b| likeness(a).total_cmp(&likeness(b)))))
            })
            .collect()
    }
}

/// The number of terms, without the constant, at which a measure is smallest.
fn smallest(steps: &[Step], measure: impl Fn(&Step) -> f64) -> Option<usize> {
    steps.iter().enumerate().min_by(|a, b| measure(a.1).total_cmp(&measure(b.1))).map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::random::Normal;

    const ROWS_OF_FLIGHT: usize = 600;

    /// Candidates of an elevator multisine: alpha, q, elevator and their products, with |elevator| and one that is nearly
    /// alpha; the last one stands still.
    fn problem(truth: [f64; 12], noise: f64, keep: f64, seed: u64) -> Problem {
        let mut normal = Normal(seed.wrapping_mul(977).wrapping_add(5));
        let mut columns = vec![vec![0.0; ROWS_OF_FLIGHT + 20]; 12];
        let mut left = vec![0.0; ROWS_OF_FLIGHT + 20];
        let mut used = vec![false; ROWS_OF_FLIGHT + 20];
        let mut slow = 0.0;
        for k in 0..ROWS_OF_FLIGHT {
            // A gap in the middle.
            let row = if k < 300 { k } else { k + 20 };
            let t = 0.05 * k as f64;
            let a = 0.1 * (0.9 * t).sin() + 0.06 * (2.3 * t + 0.4).sin();
            let q = 0.04 * (0.9 * t + 1.2).cos() + 0.05 * (3.1 * t).sin();
            let e = 0.08 * (1.7 * t).sin() + 0.05 * (0.6 * t + 2.0).cos();
            let twin = a + 1e-4 * (5.0 * t).sin();
            let values = [a, q, e, a * a, a * q, a * e, q * q, q * e, e * e, e.abs(), twin, 0.3];
            for (column, value) in columns.iter_mut().zip(values) {
                column[row] = value;
            }
            slow = keep * slow + (1.0 - keep * keep).sqrt() * normal.next();
            used[row] = true;
            left[row] = 0.02 + values.iter().zip(truth).map(|(x, c)| c * x).sum::<f64>() + noise * slow;
        }
        Problem { left, columns, used }
    }

    /// `Cm = 0.02 - 0.5 alpha - 8 q - 1.1 elevator + 3 alpha^2`.
    const TRUTH: [f64; 12] = [-0.5, -8.0, -1.1, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

    fn rule(criterion: Criterion) -> Rule {
        // As `regress` makes it for twelve candidates and one false term in a hundred flights.
        let limit = 2.0 * (12.0_f64 / 0.01).ln();
        Rule { criterion, f_to_enter: limit, f_to_remove: limit }
    }

    fn taken(selection: &Selection) -> Vec<usize> {
        let mut taken: Vec<usize> = selection.fitted.iter().filter_map(|term| term.column).collect();
        taken.sort_unstable();
        taken
    }

    #[test]
    fn a_known_polynomial_is_recovered_with_its_values() {
        for criterion in [Criterion::Pse, Criterion::Press, Criterion::F] {
            for (keep, least) in [(0.0, 49), (0.8, 47)] {
                let (mut right, mut outside, mut values) = (0, 0, 0);
                for seed in 0..50 {
                    let found = problem(TRUTH, 0.004, keep, seed).select(&rule(criterion)).unwrap();
                    if taken(&found) != [0, 1, 2, 3] {
                        continue;
                    }
                    right += 1;
                    for term in &found.fitted {
                        let truth = term.column.map_or(0.02, |j| TRUTH[j]);
                        values += 1;
                        outside += u32::from((term.value - truth).abs() > 2.0 * term.std_error);
                    }
                    assert!(found.r_squared > 0.95, "{}", found.r_squared);
                }
                // Of 50 flights one, with residuals that last three, may come out otherwise.
                assert!(right >= least, "{criterion:?} {keep}: {right} of 50");
                // Two standard errors: 4.6 % beyond, and three standard deviations of the binomial, of one value in five
                // (the five of a flight share its noise).
                let share = f64::from(outside) / f64::from(values);
                assert!(share < 0.046 + 3.0 * (0.046 / f64::from(right)).sqrt(), "{criterion:?} {keep}: {share}");
            }
        }
    }

    #[test]
    fn noise_alone_selects_nothing_but_the_constant() {
        for criterion in [Criterion::Pse, Criterion::Press, Criterion::F] {
            for keep in [0.0, 0.8] {
                let flights = 150;
                let false_terms = (0..flights)
                    .filter(|seed| {
                        let found = problem([0.0; 12], 0.01, keep, 1000 + seed).select(&rule(criterion)).unwrap();
                        found.fitted.len() > 1
                    })
                    .count();
                // One in a hundred: more than six of 150 with a probability of 0.002.
                assert!(false_terms <= 6, "{criterion:?} {keep}: {false_terms} of {flights}");
            }
        }
        // The PSE alone would have taken many: that is what the check is for.
        let lax = Rule { criterion: Criterion::Pse, f_to_enter: 0.0, f_to_remove: 0.0 };
        let as_printed =
            (0..50).filter(|seed| problem([0.0; 12], 0.01, 0.0, *seed).select(&lax).unwrap().fitted.len() > 1);
        assert!(as_printed.count() > 40);
    }

    #[test]
    fn a_candidate_that_is_another_one_is_named_and_not_taken() {
        let found = problem(TRUTH, 0.004, 0.0, 3).select(&rule(Criterion::Pse)).unwrap();
        assert!(!taken(&found).contains(&10) && found.not_told.contains(&(10, Some(0))), "{:?}", found.not_told);
        // One that stands still resembles the constant.
        assert!(found.not_told.contains(&(11, None)), "{:?}", found.not_told);
        let first = found.steps.iter().find(|step| step.column == Some(0)).unwrap();
        assert!(first.alike.contains(&10), "{:?}", found.steps);
    }

    #[test]
    fn steps_have_the_measures_of_least_squares() {
        let problem = problem(TRUTH, 0.01, 0.0, 7);
        let found = problem.select(&Rule { criterion: Criterion::Pse, f_to_enter: 0.0, f_to_remove: 0.0 }).unwrap();
        let rows: Vec<usize> = (0..problem.used.len()).filter(|row| problem.used[*row]).collect();
        let mean = rows.iter().map(|row| problem.left[*row]).sum::<f64>() / rows.len() as f64;
        let squares: f64 = rows.iter().map(|row| (problem.left[*row] - mean).powi(2)).sum();
        let n = rows.len() as f64;
        for (length, step) in found.steps.iter().enumerate().take(5) {
            let set: Vec<usize> = found.steps[1..=length].iter().filter_map(|step| step.column).collect();
            let regressors = |without: Option<usize>| {
                let kept: Vec<usize> = rows.iter().copied().filter(|row| Some(*row) != without).collect();
                let x = DMatrix::from_fn(kept.len(), length + 1, |i, j| {
                    j.checked_sub(1).map_or(1.0, |j| problem.columns[set[j]][kept[i]])
                });
                let y = DVector::from_fn(kept.len(), |i, _| problem.left[kept[i]]);
                let values = x.clone().svd(true, true).solve(&y, 1e-14).unwrap();
                (values.clone(), (y - x * values).norm_squared())
            };
            let (_, left) = regressors(None);
            assert!((step.r_squared - (1.0 - left / squares)).abs() < 1e-9);
            assert!(
                (step.pse - (left / n + squares / n * (length + 1) as f64 / n)).abs() < 1e-12 * step.pse.abs().max(1.0)
            );
            // PRESS by leaving out each tenth row in turn, against the sum of the same rows' leverages.
            if length == 3 {
                let brute: f64 = rows
                    .iter()
                    .map(|row| {
                        let (values, _) = regressors(Some(*row));
                        let predicted: f64 = (0..=length)
                            .map(|j| values[j] * j.checked_sub(1).map_or(1.0, |j| problem.columns[set[j]][*row]))
                            .sum();
                        (problem.left[*row] - predicted).powi(2)
                    })
                    .sum();
                assert!((step.press - brute / n).abs() < 1e-9 * step.press, "{} {}", step.press, brute / n);
            }
        }
    }

    #[test]
    fn what_no_regression_can_say_is_none() {
        let mut still = problem([0.0; 12], 0.0, 0.0, 1);
        assert!(still.select(&rule(Criterion::Pse)).is_none());
        still.used.iter_mut().skip(10).for_each(|used| *used = false);
        assert!(still.select(&rule(Criterion::Pse)).is_none());
    }
}
