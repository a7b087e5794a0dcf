//! Stepwise regression: which of many terms the equations of motion need beside those that the model has.
//!
//! After modified stepwise regression (V. Klein, J. G. Batterson, P. C. Murphy, *Determination of Airplane Model
//! Structure From Flight Data by Using Modified Stepwise Regression*, NASA TP-1916, 1981): one term at a time is taken
//! in, that with the largest partial F, and terms that later ones make needless are taken out again. The terms of the
//! model always stay. Three things differ. The partial F is that of residuals that last (coloured), and never more than
//! the noise of the sensors allows. What noise in the regressors pretends is measured and taken off. And a term has to
//! matter: it has to make a share of its coefficient, and to explain a part of what sensors do not.

use nalgebra::{DMatrix, DVector};

use crate::batch::{RowCorrelation, Table, TableEquation as Equation};

/// Relative error of a bias that comes from that of the noise level.
const LEVEL_UNCERTAIN: f64 = 0.1;
/// Part of a value that its bias cannot reach, however large the noise.
const MOST_BIAS: f64 = 0.5;
/// Least part of a regressor's motion that the other terms may leave, as a part of its standard deviation: below, the
/// flight does not tell it from them.
const OWN: f64 = 0.05;
/// Candidates whose correlated residuals are worked out at each step: those that lower the squares most.
const SHORTLIST: usize = 16;
/// Most terms that are taken in.
const MOST: usize = 5;
/// Rows of a block at whose end a change may be: one second.
const BLOCK: usize = 20;
/// A change explains much more than a term from this factor on.
const MUCH_MORE: f64 = 2.0;
/// Iterations of the weights of the equations.
const WEIGHTINGS: usize = 3;

/// From when on a candidate counts as missing in the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Criterion {
    /// Smallest partial F, corrected for the colour of the residuals.
    pub(super) partial_f: f64,
    /// Smallest share of the coefficient's motion that only this term makes.
    pub(super) share: f64,
    /// Smallest part of the squares beyond the noise of the sensors that it explains.
    pub(super) excess: f64,
}

/// What one candidate would do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Trial {
    /// Column of the candidate.
    pub(super) column: usize,
    /// Its parameter, with what noise in the regressors does to it taken off.
    pub(super) value: f64,
    /// One sigma of it.
    pub(super) std_error: f64,
    /// Partial F: the square of value over standard error.
    pub(super) partial_f: f64,
    /// Standard deviation of what only this term makes, over that of the coefficient.
    pub(super) share: f64,
    /// Part of the squares beyond the noise of the sensors that it explains; infinite where there are none.
    pub(super) excess: f64,
    /// Drop of the squares, in residual variances that last: twice the gain of log likelihood.
    drop: f64,
    /// How much larger the variance is than with white residuals.
    colour: f64,
}

/// The equations with all terms of the model and all candidates.
pub(super) struct Regression {
    equations: Vec<Columns>,
    /// Columns of the model.
    own: usize,
    columns: usize,
    /// By column: the coefficient that it belongs to.
    coefficient: Vec<usize>,
    /// By column: of two that explain equally much the smaller rank is taken.
    rank: Vec<u8>,
    /// Rows over which noise is correlated by the smoothing.
    window: usize,
}

/// One equation.
struct Columns {
    name: String,
    /// By copy.
    copies: Vec<Copy>,
    used: Vec<bool>,
    count: f64,
}

/// One equation as measured, or with noise added.
struct Copy {
    /// Zero in a row that is not used.
    left: Vec<f64>,
    /// By column; empty for one that is not in the equation.
    columns: Vec<Vec<f64>>,
    /// `sum [columns, left]^T [columns, left]`.
    gram: DMatrix<f64>,
    /// `sum [columns, left]`.
    sum: Vec<f64>,
}

/// A level of residuals against that of the sensors.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Level {
    pub(super) equation: String,
    pub(super) residual_std: f64,
    pub(super) noise_std: f64,
}

/// A regression on some of the columns.
struct Fit {
    set: Vec<usize>,
    values: DVector<f64>,
    /// Inverse of the scaled normal matrix, and the scale of each column.
    inverse: DMatrix<f64>,
    scale: Vec<f64>,
}

impl Regression {
    /// Joins tables of the same rows: the first columns of each are those of the model (`own`), the rest its
    /// candidates. `batches` has the tables by batch and copy; `None` where nothing can be computed.
    pub(super) fn new(
        batches: Vec<Vec<Table>>,
        own: usize,
        coefficient: Vec<usize>,
        rank: Vec<u8>,
        window: usize,
    ) -> Option<Self> {
        let columns = coefficient.len();
        let copies = batches.first()?.len();
        let whole = batches.first()?.first()?;
        // Measured accelerations, and the rates of states that carry a parameter which no acceleration sees.
        let moves = |e: &Equation, j: usize| e.regressors.get(j).is_some_and(|column| !column.is_empty());
        let seen = |j: usize| whole.iter().any(|e| e.measured && moves(e, j));
        let needed = |e: &&Equation| (0..own).any(|j| moves(e, j) && (e.measured || !seen(j)));
        let mut equations = Vec::new();
        for first in whole.iter().filter(needed) {
            // The same equation of every batch and copy.
            let of = |batch: &Vec<Table>, copy: usize| {
                batch.get(copy).and_then(|table| table.iter().position(|e| e.output == first.output))
            };
            let rows = first.left.len();
            let mut used = vec![true; rows];
            for batch in &batches {
                for (copy, table) in batch.iter().enumerate() {
                    let place = of(batch, copy)?;
                    for (used, value) in used.iter_mut().zip(&table[place].left) {
                        *used &= value.is_finite();
                    }
                }
            }
            let mut by_copy = Vec::with_capacity(copies);
            for copy in 0..copies {
                let mut all: Vec<Vec<f64>> = Vec::with_capacity(columns);
                let masked = |values: &[f64]| -> Vec<f64> {
                    values.iter().zip(&used).map(|(v, used)| if *used { *v } else { 0.0 }).collect()
                };
                let mut left = Vec::new();
                for (number, batch) in batches.iter().enumerate() {
                    let table = &batch.get(copy)?[of(batch, copy)?];
                    if number == 0 {
                        left = masked(&table.left);
                    }
                    let from = if number == 0 { 0 } else { own };
                    all.extend(table.regressors.iter().skip(from).map(|c| masked(c)));
                }
                if all.len() != columns {
                    return None;
                }
                by_copy.push(Copy::new(left, all));
            }
            let count = used.iter().filter(|used| **used).count() as f64;
            if count > columns as f64 {
                equations.push(Columns { name: first.name.clone(), copies: by_copy, used, count });
            }
        }
        (!equations.is_empty()).then_some(Self { equations, own, columns, coefficient, rank, window })
    }

    /// The weighted normal matrix of a copy, left side last.
    fn gram(&self, copy: usize, weights: &[f64]) -> DMatrix<f64> {
        let mut sum = DMatrix::zeros(self.columns + 1, self.columns + 1);
        for (equation, weight) in self.equations.iter().zip(weights) {
            sum += &equation.copies[copy].gram * *weight;
        }
        sum
    }

    /// The weights of the equations with these terms: one over the variance of each one's residuals, and the fit.
    fn weighted(&self, set: &[usize]) -> Option<(Vec<f64>, Fit)> {
        let variance_of_left = |e: &Columns| {
            let copy = &e.copies[0];
            let n = self.columns;
            (copy.gram[(n, n)] / e.count.max(1.0)).max(f64::MIN_POSITIVE)
        };
        let mut weights: Vec<f64> = self.equations.iter().map(|e| 1.0 / variance_of_left(e)).collect();
        let mut fit = Fit::of(&self.gram(0, &weights), set, self.columns)?;
        for _ in 0..WEIGHTINGS {
            for (weight, equation) in weights.iter_mut().zip(&self.equations) {
                let squares = fit.squares(&equation.copies[0].gram, self.columns);
                let floor = 1e-18 * variance_of_left(equation);
                *weight = 1.0 / (squares / equation.count.max(1.0)).max(floor).max(f64::MIN_POSITIVE);
            }
            fit = Fit::of(&self.gram(0, &weights), set, self.columns)?;
        }
        Some((weights, fit))
    }

    /// Residuals of an equation of a copy, row by row.
    fn residuals(&self, equation: &Columns, copy: usize, fit: &Fit) -> Vec<f64> {
        let copy = &equation.copies[copy];
        let mut left = copy.left.clone();
        for (column, value) in fit.set.iter().zip(fit.values.iter()) {
            for (e, x) in left.iter_mut().zip(&copy.columns[*column]) {
                *e -= value * x;
            }
        }
        left
    }

    /// The levels of the residuals with these terms, and what the noise of the sensors makes of them.
    pub(super) fn levels(&self, set: &[usize]) -> Vec<Level> {
        let Some((_, fit)) = self.weighted(set) else { return Vec::new() };
        let level = |e: &Columns| Level {
            equation: e.name.clone(),
            residual_std: (fit.squares(&e.copies[0].gram, self.columns) / e.count.max(1.0)).sqrt(),
            noise_std: correlation_of_noise(self, e, &fit).at(0).sqrt(),
        };
        self.equations.iter().map(level).collect()
    }

    /// The candidates beside these terms, the largest partial F first: those that lower the squares most.
    pub(super) fn trials(&self, set: &[usize]) -> Vec<Trial> {
        let Some((weights, _)) = self.weighted(set) else { return Vec::new() };
        let grams: Vec<DMatrix<f64>> = (0..self.copies()).map(|copy| self.gram(copy, &weights)).collect();
        let Some(fits) = grams.iter().map(|gram| Fit::of(gram, set, self.columns)).collect::<Option<Vec<_>>>() else {
            return Vec::new();
        };
        let mut list: Vec<(f64, usize)> = (self.own..self.columns)
            .filter(|j| !set.contains(j))
            .filter_map(|j| {
                let one = fits[0].one_more(&grams[0], j, self.columns)?;
                let about_mean: f64 = self.equations.iter().zip(&weights).map(|(e, w)| w * e.about_mean(j)).sum();
                (one.own > OWN * OWN * about_mean).then_some((one.value * one.value * one.own, j))
            })
            .collect();
        list.sort_by(|a, b| b.0.total_cmp(&a.0));
        list.truncate(SHORTLIST);
        let mut trials: Vec<Trial> =
            list.iter().filter_map(|(drop, j)| self.trial(&weights, &grams, &fits, *j, *drop)).collect();
        trials.sort_by(|a, b| b.partial_f.total_cmp(&a.partial_f));
        trials
    }

    fn copies(&self) -> usize {
        self.equations.first().map_or(0, |e| e.copies.len())
    }

    fn trial(&self, weights: &[f64], grams: &[DMatrix<f64>], fits: &[Fit], column: usize, drop: f64) -> Option<Trial> {
        let one = fits[0].one_more(&grams[0], column, self.columns)?;
        // Without columns that are nowhere different from zero.
        let set = &fits[0].set;
        let with: Vec<usize> = set.iter().copied().chain([column]).collect();
        let whole = Fit::of(&grams[0], &with, self.columns)?;
        // What noise in the regressors does to it.
        let mut bias = 0.0;
        for (gram, fit) in grams.iter().zip(fits).skip(1) {
            bias += (fit.one_more(gram, column, self.columns)?.value - one.value) / (grams.len() - 1) as f64;
        }
        let value = one.value - bias;
        // The part of the regressor that the other terms leave, and its products with itself some rows on.
        let (mut lasting, mut of_noise) = (0.0, 0.0);
        let (mut excess_squares, mut in_which) = (0.0, (0.0, 0));
        for (index, (equation, weight)) in self.equations.iter().zip(weights).enumerate() {
            let own = equation.left_over(&one.projection, set, column);
            let squares: f64 = own.iter().map(|z| z * z).sum();
            if squares <= 0.0 {
                continue;
            }
            if squares * weight > in_which.0 {
                in_which = (squares * weight, index);
            }
            let residuals = self.residuals(equation, 0, &whole);
            let residual = RowCorrelation::of_residual(&residuals, equation.count);
            let noise = correlation_of_noise(self, equation, &whole);
            lasting += weight * weight * residual.spread(&own);
            of_noise += weight * weight * noise.spread(&own);
            let before = fits[0].squares(&equation.copies[0].gram, self.columns);
            excess_squares += weight * (before - equation.count * noise.at(0)).max(0.0);
        }
        let white = one.own;
        let variance = lasting.max(of_noise).max(white) / (one.own * one.own);
        let part = if value == 0.0 { f64::INFINITY } else { (bias / one.value).abs() };
        let left = if part < MOST_BIAS { 2.0 * part * part / (1.0 - 2.0 * part) } else { f64::INFINITY };
        let std_error = variance.sqrt().hypot(LEVEL_UNCERTAIN * bias).hypot(left * one.value);
        let partial_f = (value / std_error).powi(2);
        let share = self.share(in_which.1, &one.projection, set, &whole, column);
        let colour = (lasting.max(of_noise) / white).max(1.0);
        Some(Trial {
            column,
            value,
            std_error,
            partial_f: if partial_f.is_finite() { partial_f } else { 0.0 },
            share,
            excess: if excess_squares > 0.0 { drop / excess_squares } else { f64::INFINITY },
            drop: drop / colour,
            colour,
        })
    }

    /// Standard deviation of what only this column makes over that of its coefficient, in the equation that shows it
    /// most.
    fn share(&self, equation: usize, projection: &DVector<f64>, set: &[usize], whole: &Fit, column: usize) -> f64 {
        let equation = &self.equations[equation];
        let own = equation.left_over(projection, set, column);
        let mut coefficient = vec![0.0; own.len()];
        let mut value_of_column = 0.0;
        for (j, value) in whole.set.iter().zip(whole.values.iter()) {
            if *j == column {
                value_of_column = *value;
            }
            if self.coefficient[*j] == self.coefficient[column] {
                for (sum, x) in coefficient.iter_mut().zip(&equation.copies[0].columns[*j]) {
                    *sum += value * x;
                }
            }
        }
        let std = |values: &[f64]| {
            let used = || values.iter().zip(&equation.used).filter(|(_, used)| **used).map(|(v, _)| v);
            let mean = used().sum::<f64>() / equation.count;
            (used().map(|v| (v - mean).powi(2)).sum::<f64>() / equation.count).sqrt()
        };
        value_of_column.abs() * std(&own) / std(&coefficient)
    }

    /// The terms that the equations need beside those of the model, in the order in which they were taken in, with the
    /// trials of the first step.
    pub(super) fn select(&self, criterion: &Criterion) -> (Vec<Trial>, Vec<Trial>) {
        let own: Vec<usize> = (0..self.own).collect();
        let mut taken: Vec<usize> = Vec::new();
        let mut first = Vec::new();
        let mut refused: Vec<usize> = Vec::new();
        while taken.len() < MOST {
            let set: Vec<usize> = own.iter().copied().chain(taken.iter().copied()).collect();
            let trials = self.trials(&set);
            let of_change = trials.iter().filter(|t| criterion.holds(t) && self.is_change(&set, t));
            let left_out: Vec<usize> = of_change.map(|t| t.column).chain(refused.iter().copied()).collect();
            let best = best(&trials, criterion, &self.rank, &left_out).map(|t| t.column);
            if first.is_empty() {
                first = trials;
            }
            let Some(best) = best else { break };
            taken.push(best);
            // What a later term makes needless is taken out again, and not taken in once more.
            let confirmed = self.confirm(&own, &taken);
            let needless: Vec<usize> = confirmed.iter().filter(|t| !criterion.holds(t)).map(|t| t.column).collect();
            taken.retain(|j| !needless.contains(j));
            refused.extend(needless);
        }
        (self.confirm(&own, &taken), first)
    }

    /// Whether other values of the parameters from some time on explain much more than a candidate does: what a change
    /// of the aircraft leaves in the residuals resembles many terms a little.
    fn is_change(&self, set: &[usize], trial: &Trial) -> bool {
        let Some((weights, _)) = self.weighted(set) else { return false };
        let all = self.equations.iter().zip(weights);
        let concerned: Vec<(&Columns, f64)> =
            all.filter(|(e, _)| !e.copies[0].columns[trial.column].is_empty()).collect();
        let n = set.len();
        // Sums of squares and products of the set and the left side, up to the end of each block.
        let rows = concerned.iter().map(|(e, _)| e.used.len()).max().unwrap_or(0);
        let mut sums: Vec<DMatrix<f64>> = Vec::with_capacity(rows / BLOCK + 1);
        let mut sum = DMatrix::<f64>::zeros(n + 1, n + 1);
        let mut row = DVector::<f64>::zeros(n + 1);
        for k in 0..rows {
            for (equation, weight) in &concerned {
                if equation.used.get(k) != Some(&true) {
                    continue;
                }
                let copy = &equation.copies[0];
                for (place, j) in row.iter_mut().zip(set) {
                    *place = copy.columns[*j].get(k).copied().unwrap_or(0.0);
                }
                row[n] = copy.left[k];
                sum.ger(*weight, &row, &row, 1.0);
            }
            if (k + 1) % BLOCK == 0 {
                sums.push(sum.clone());
            }
        }
        let all: Vec<usize> = (0..n).collect();
        let squares = |gram: &DMatrix<f64>| Fit::of(gram, &all, n).map(|fit| fit.squares(gram, n));
        let Some(whole) = squares(&sum) else { return false };
        let left = |before: &DMatrix<f64>| Some(squares(before)? + squares(&(&sum - before))?);
        let least = sums.iter().filter_map(left).fold(whole, f64::min);
        let used = (0..n).filter(|j| sum[(*j, *j)] > 0.0).count() as f64;
        let count: f64 = concerned.iter().map(|(e, _)| e.count).sum();
        // What as many needless parameters would explain (G. Schwarz, Annals of Statistics 6, 1978).
        let by_change = whole - least - used * count.max(1.0).ln();
        by_change > MUCH_MORE * trial.drop * trial.colour
    }

    /// The taken terms, each beside all others.
    fn confirm(&self, own: &[usize], taken: &[usize]) -> Vec<Trial> {
        let of = |column: &usize| {
            let others = taken.iter().copied().filter(|j| j != column);
            let set: Vec<usize> = own.iter().copied().chain(others).collect();
            let (weights, _) = self.weighted(&set)?;
            let grams: Vec<DMatrix<f64>> = (0..self.copies()).map(|copy| self.gram(copy, &weights)).collect();
            let fits = grams.iter().map(|g| Fit::of(g, &set, self.columns)).collect::<Option<Vec<_>>>()?;
            let one = fits[0].one_more(&grams[0], *column, self.columns)?;
            self.trial(&weights, &grams, &fits, *column, one.value * one.value * one.own)
        };
        taken.iter().filter_map(of).collect()
    }
}

impl Criterion {
    /// Whether a candidate counts as missing.
    pub(super) fn holds(&self, trial: &Trial) -> bool {
        trial.partial_f >= self.partial_f && trial.share >= self.share && trial.excess >= self.excess
    }
}

/// Log likelihood (nats) by which a term of the next rank has to be better.
const BY_RANK: f64 = 3.0;

/// The candidate to take in: of those that count as missing the one that explains most, a simpler one where it explains
/// nearly as much.
fn best<'a>(trials: &'a [Trial], criterion: &Criterion, rank: &[u8], refused: &[usize]) -> Option<&'a Trial> {
    let gain = |t: &Trial| 0.5 * t.drop - BY_RANK * f64::from(rank[t.column]);
    trials
        .iter()
        .filter(|t| criterion.holds(t) && !refused.contains(&t.column))
        .max_by(|a, b| gain(a).total_cmp(&gain(b)))
}

impl Copy {
    fn new(left: Vec<f64>, columns: Vec<Vec<f64>>) -> Self {
        let n = columns.len();
        let all = || columns.iter().map(Vec::as_slice).chain([left.as_slice()]);
        let sum = all().map(|column| column.iter().sum()).collect();
        // Most candidates are in some of the equations only.
        let places: Vec<usize> = all().enumerate().filter(|(_, c)| !c.is_empty()).map(|(place, _)| place).collect();
        let present = all().filter(|c| !c.is_empty()).flatten().copied();
        let matrix = DMatrix::from_iterator(left.len(), places.len(), present);
        let products = matrix.transpose() * &matrix;
        let mut gram = DMatrix::zeros(n + 1, n + 1);
        for (a, &i) in places.iter().enumerate() {
            for (b, &j) in places.iter().enumerate() {
                gram[(i, j)] = products[(a, b)];
            }
        }
        Self { left, columns, gram, sum }
    }
}

impl Columns {
    /// Squares of a column about its mean.
    fn about_mean(&self, column: usize) -> f64 {
        let copy = &self.copies[0];
        copy.gram[(column, column)] - copy.sum[column] * copy.sum[column] / self.count.max(1.0)
    }

    /// What other columns leave of one, row by row.
    fn left_over(&self, projection: &DVector<f64>, set: &[usize], column: usize) -> Vec<f64> {
        let copy = &self.copies[0];
        let mut own =
            if copy.columns[column].is_empty() { vec![0.0; copy.left.len()] } else { copy.columns[column].clone() };
        for (j, factor) in set.iter().zip(projection.iter()) {
            for (z, x) in own.iter_mut().zip(&copy.columns[*j]) {
                *z -= factor * x;
            }
        }
        own
    }
}

/// One more column beside a fit.
struct OneMore {
    /// Its value in the regression with it.
    value: f64,
    /// Weighted squares of what the other columns leave of it.
    own: f64,
    /// The others' values in the regression of it on them.
    projection: DVector<f64>,
}

impl Fit {
    /// `left` is the position of the left side in the normal matrix; `None` where the data do not determine the values.
    fn of(gram: &DMatrix<f64>, set: &[usize], left: usize) -> Option<Self> {
        // A column that is nowhere different from zero has no value, and needs none.
        let set: Vec<usize> = set.iter().copied().filter(|&j| gram[(j, j)] > 0.0).collect();
        let scale: Vec<f64> = set.iter().map(|&j| 1.0 / gram[(j, j)].sqrt()).collect();
        let n = set.len();
        let normal = DMatrix::from_fn(n, n, |a, b| gram[(set[a], set[b])] * scale[a] * scale[b]);
        let inverse = normal.cholesky()?.inverse();
        let right = DVector::from_fn(n, |a, _| gram[(set[a], left)] * scale[a]);
        let mut values = &inverse * right;
        values.iter_mut().zip(&scale).for_each(|(v, s)| *v *= s);
        values.iter().all(|v| v.is_finite()).then_some(Self { set, values, inverse, scale })
    }

    /// Squares of the residuals by a normal matrix.
    fn squares(&self, gram: &DMatrix<f64>, left: usize) -> f64 {
        let mut squares = gram[(left, left)];
        for (&j, value) in self.set.iter().zip(self.values.iter()) {
            squares -= 2.0 * value * gram[(j, left)];
            for (b, other) in self.set.iter().enumerate() {
                squares += value * self.values[b] * gram[(j, *other)];
            }
        }
        squares.max(0.0)
    }

    fn one_more(&self, gram: &DMatrix<f64>, column: usize, left: usize) -> Option<OneMore> {
        let n = self.set.len();
        let cross = DVector::from_fn(n, |a, _| gram[(self.set[a], column)] * self.scale[a]);
        let mut projection = &self.inverse * &cross;
        projection.iter_mut().zip(&self.scale).for_each(|(v, s)| *v *= s);
        let mut own = gram[(column, column)];
        let mut right = gram[(column, left)];
        for (a, &j) in self.set.iter().enumerate() {
            own -= projection[a] * gram[(j, column)];
            right -= projection[a] * gram[(j, left)];
        }
        // Below this rounding decides.
        let value = right / own;
        (own > 1e-10 * gram[(column, column)] && value.is_finite()).then_some(OneMore { value, own, projection })
    }
}

/// What the noise of the sensors makes of a residual: the difference of the copies with noise added.
fn correlation_of_noise(regression: &Regression, equation: &Columns, fit: &Fit) -> RowCorrelation {
    let measured = regression.residuals(equation, 0, fit);
    let mut by_lag = vec![0.0; regression.window + 1];
    let copies = equation.copies.len() - 1;
    for copy in 1..=copies {
        let noisy = regression.residuals(equation, copy, fit);
        let difference: Vec<f64> = noisy.iter().zip(&measured).map(|(a, b)| a - b).collect();
        for (lag, sum) in by_lag.iter_mut().enumerate() {
            let later = &difference[lag.min(difference.len())..];
            *sum += difference.iter().zip(later).map(|(a, b)| a * b).sum::<f64>()
                / (equation.count.max(1.0) * copies as f64);
        }
    }
    RowCorrelation::of_lags(by_lag)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::APART;
    use crate::core::random::Normal;

    const SAMPLES: usize = 1200;

    /// One equation `left = 2 x + missing * term + noise` with a constant and x in the model and three candidates: x^2,
    /// |x| and y, another signal; `keep` correlates the noise from row to row. The copies have noise of the same level
    /// added.
    fn regression(missing: [f64; 3], noise: f64, keep: f64, seed: u64) -> Regression {
        changing(missing, 0.0, noise, keep, seed)
    }

    /// The same, with another slope of x, by `change`, in the second half.
    fn changing(missing: [f64; 3], change: f64, noise: f64, keep: f64, seed: u64) -> Regression {
        let mut normal = Normal(seed);
        let mut slow = 0.0;
        let mut columns = vec![vec![0.0; SAMPLES + APART]; 5];
        let mut left = vec![f64::NAN; SAMPLES + APART];
        let mut clean = left.clone();
        for k in 0..SAMPLES {
            let t = 0.05 * k as f64;
            let x = (1.3 * t).sin() + 0.4 * (0.37 * t + 1.0).sin();
            // What a change resembles a little: x times something that wanders, as the airspeed does.
            let drifting = x * (0.1255 * t).sin();
            let y = if change == 0.0 { (0.9 * t + 0.3).cos() * (0.11 * t).sin() } else { drifting };
            slow = keep * slow + (1.0 - keep * keep).sqrt() * normal.next();
            for (column, value) in columns.iter_mut().zip([1.0, x, x * x, x.abs(), y]) {
                column[k] = value;
            }
            let slope = if 2 * k < SAMPLES { 2.0 } else { 2.0 + change };
            clean[k] = 0.3 + slope * x + missing[0] * x * x + missing[1] * x.abs() + missing[2] * y;
            left[k] = clean[k] + noise * slow;
        }
        let with = |more: &mut dyn FnMut() -> f64| -> Table {
            vec![Equation {
                name: "d(q)/dt".to_owned(),
                output: 3,
                measured: false,
                left: left.iter().map(|v| v + more()).collect(),
                regressors: columns.clone(),
            }]
        };
        let tables = vec![with(&mut || 0.0), with(&mut || noise * normal.next())];
        Regression::new(vec![tables], 2, vec![2; 5], vec![0, 0, 1, 2, 3], 8).expect("it can be computed")
    }

    const CRITERION: Criterion = Criterion { partial_f: 40.0, share: 0.02, excess: 0.1 };

    #[test]
    fn the_missing_term_is_found_with_its_value_and_no_other() {
        for (place, missing) in [[0.2, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.4]].into_iter().enumerate() {
            let (found, first) = regression(missing, 0.05, 0.0, 5).select(&CRITERION);
            assert_eq!(found.iter().map(|t| t.column).collect::<Vec<_>>(), [2 + place], "{first:?}");
            assert!((found[0].value - missing[place]).abs() < 3.0 * found[0].std_error, "{found:?}");
        }
        // Two at once.
        let (mut found, _) = regression([0.5, 0.0, 0.2], 0.05, 0.0, 7).select(&CRITERION);
        found.sort_by_key(|t| t.column);
        assert_eq!(found.iter().map(|t| t.column).collect::<Vec<_>>(), [2, 4]);
    }

    #[test]
    fn noise_that_lasts_is_not_taken_for_a_term() {
        let (mut false_offers, mut as_if_white) = (0, 0);
        for seed in 0..40 {
            let regression = regression([0.0; 3], 0.5, 0.95, seed);
            false_offers += usize::from(!regression.select(&CRITERION).0.is_empty());
            // The drop of the squares in variances of a white residual.
            let trials = regression.trials(&[0, 1]);
            as_if_white += usize::from(trials.iter().any(|t| t.drop * t.colour > CRITERION.partial_f));
        }
        assert!(false_offers == 0 && as_if_white > 4, "{false_offers} {as_if_white}");
    }

    #[test]
    fn a_change_of_the_aircraft_is_not_taken_for_a_term() {
        let lax = Criterion { partial_f: 4.0, share: 0.0, excess: 0.0 };
        let mut resembled = 0;
        for seed in 0..20 {
            let changed = changing([0.0; 3], -0.8, 0.02, 0.0, seed);
            resembled += usize::from(changed.trials(&[0, 1]).iter().any(|t| lax.holds(t)));
            let (found, first) = changed.select(&lax);
            assert!(found.is_empty(), "{seed}: {found:?} {first:?}");
        }
        assert!(resembled > 0);
        // A missing term is found although the flight could be cut in two as well.
        assert_eq!(regression([0.3, 0.0, 0.0], 0.02, 0.0, 1).select(&lax).0[0].column, 2);
    }

    #[test]
    fn the_level_of_the_residual_stands_beside_that_of_the_sensors() {
        let levels = regression([0.0; 3], 0.05, 0.0, 3).levels(&[0, 1]);
        assert!((levels[0].residual_std / levels[0].noise_std - 1.0).abs() < 0.1, "{levels:?}");
        let lacking = regression([0.2, 0.0, 0.0], 0.05, 0.0, 3).levels(&[0, 1]);
        assert!(lacking[0].residual_std > 2.0 * lacking[0].noise_std, "{lacking:?}");
    }
}
