//! The equations of motion at the final estimates: where the flight moves each regressor, and how much of the motion
//! the estimates explain there.
//!
//! A verdict on the whole record is diluted by every quiet second in it. So the record is cut into blocks of a second,
//! and for each equation (the rate of a measured state, or a measured acceleration) the sums of squares and products of
//! its regressors and its residual are kept per block. From these follow, without going through the record again, the
//! blocks in which a regressor moves, and over any set of blocks how much of the left side the estimates explain and
//! how much any other values of the same terms could. States are smoothed and differentiated, and regressors averaged,
//! as in [`equation_error()`](crate::batch::equation_error()).

use nalgebra::{DMatrix, DVector};
use phugoid_estimators::discretization::InputHold;

use phugoid_flight_data::statistics::{median, median_step};

use crate::batch::{
    BatchParameter, EquationErrorSettings, InitialState, Manoeuvre, Noise, OutputChannel, Structure, equations_at,
    noise_of, noisy,
};
use crate::core::options::{CAPACITY, Likelihood};
use crate::core::output::Output;
use crate::core::term::{Coefficient, Term};
use crate::judge::chance::ratio_above;
use crate::methods::{Run, Task};
use crate::model_file::Role;
use crate::motion::{MotionModel, terms};

/// Length of a block, s.
const BLOCK_S: f64 = 1.0;
/// Blocks that are worked out at a time: bounds the memory that a long record takes.
const CHUNK: u64 = 20;
/// A regressor moves in a block where its mean square is at least this part of that in the block where it moves most.
/// The limit does not depend on how long the record is.
const MOVES: f64 = 0.1;
/// Part of a regressor's square that the others may not share, at least: below it the terms cannot be told apart in this
/// equation.
pub(crate) const OWN: f64 = 1e-6;
/// Fewest samples in the blocks over which the explained share is judged.
const FEWEST: f64 = 20.0;

/// One estimated term: its column.
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) coefficient: Coefficient,
    pub(crate) term: Term,
}

/// The equations of a record at one set of estimates.
pub(crate) struct Equations {
    pub(crate) columns: Vec<Column>,
    start_s: f64,
    /// The blocks with samples: how many blocks after the first one each is. A gap takes no room, however long it is.
    blocks: Vec<u64>,
    /// Part of the rows of which the errors are independent where those of the samples are: one per half a window, see [`by_chance()`].
    independent: f64,
    equations: Vec<Equation>,
}

/// One equation: its regressors and its residual, by block.
struct Equation {
    output: Output,
    /// Columns with a regressor that is not zero.
    used: Vec<usize>,
    values: Vec<f64>,
    /// Subtracted from regressors and residual before products are formed, so that constants cost no digits.
    offset: Vec<f64>,
    /// Sums of products of `[regressors, residual, 1]` by block.
    sums: Vec<DMatrix<f64>>,
    /// The same of the sums, and of the differences, of each row and the one half a window before it, by the block of the later one.
    pairs: [Vec<DMatrix<f64>>; 2],
}

/// One equation by block, as regressors and residuals were measured.
pub(crate) struct ByBlock {
    /// Columns with a regressor.
    pub(crate) used: Vec<usize>,
    /// The values at which the residuals are.
    pub(crate) values: Vec<f64>,
    /// Sums of products of `[regressors, residual]` by block.
    pub(crate) sums: Vec<DMatrix<f64>>,
    /// Number of samples by block.
    pub(crate) samples: Vec<f64>,
    /// By regressor: whether it moves in the block.
    pub(crate) moving: Vec<Vec<bool>>,
}

impl ByBlock {
    /// The equation without the weaker one of two regressors that are the same term of two coefficients and cannot be told apart:
    /// with a product of inertia the rolling moment turns the nose too, and each of its terms stands in the equation of r' as
    /// one of the yawing moment does. What is left out is part of the left side, at its value.
    fn without_repeated(self, is_same_term: &dyn Fn(usize, usize) -> bool) -> Self {
        let u = self.used.len();
        let product = |a: usize, b: usize| self.sums.iter().map(|block| block[(a, b)]).sum::<f64>();
        let is_weaker = |a: usize, b: usize| {
            let (own, other, both) = (product(a, a), product(b, b), product(a, b));
            let is_repeated = own * other - both * both <= OWN * own * other;
            is_repeated && is_same_term(self.used[a], self.used[b]) && (own < other || own == other && a > b)
        };
        let kept: Vec<usize> = (0..u).filter(|&a| !(0..u).any(|b| a != b && is_weaker(a, b))).collect();
        let places: Vec<usize> = kept.iter().copied().chain([u]).collect();
        let of_kept =
            |block: &DMatrix<f64>| DMatrix::from_fn(places.len(), places.len(), |a, b| block[(places[a], places[b])]);
        Self {
            used: kept.iter().map(|&a| self.used[a]).collect(),
            values: kept.iter().map(|&a| self.values[a]).collect(),
            sums: self.sums.iter().map(of_kept).collect(),
            moving: kept.iter().map(|&a| self.moving[a].clone()).collect(),
            samples: self.samples,
        }
    }
}

/// Singular value of the products of regressors of unit length below which it is none.
const LEAST_PART: f64 = 1e-9;
/// Correlation that is taken from rows at the most: beyond, hardly anything of the constant is left, which need not be judged.
const MOST_COLOUR: f64 = 0.99;
/// Most iterations of a singular value decomposition: some ten are usual.
const MOST_SWEEPS: usize = 500;

/// How much of the motion of one equation is explained where it is excited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Explained {
    /// The output that the equation is about: the state whose rate it gives, or the acceleration.
    pub(crate) output: Output,
    /// Time in which the regressors move, s.
    pub(crate) seconds: f64,
    /// Squares of the left side about the mean, and those that the estimates leave.
    pub(crate) left_side: f64,
    pub(crate) left_by_estimates: f64,
    /// Share of the squares about the mean that the estimates explain: 1 is all, negative is worse than none.
    pub(crate) by_estimates: f64,
    /// The share that the best values of the same terms explain.
    pub(crate) by_terms: f64,
    /// How often chance makes what the best values explain beyond the estimates as much as it is, 0 to 1.
    pub(crate) by_chance: f64,
}

impl Explained {
    /// What the estimates leave of what the terms could explain: 0 nothing, 1 all of it, more where they do harm.
    pub(crate) fn lost(&self) -> f64 {
        if self.by_terms > 0.0 { (self.by_terms - self.by_estimates) / self.by_terms } else { 0.0 }
    }
}

impl Equations {
    /// The equations of the task's record at the estimates of its run. None where the record is too short for them or
    /// the model has no estimated terms.
    pub(crate) fn of<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
        task: &Task<M, N, R>,
        run: &Run<R>,
    ) -> Option<Self> {
        Self::at(task, run, &task.prepared.outputs)
    }

    /// The same with the noise of the measured states put on them once more, several times with white signs: on average regressors
    /// and residuals have by as much more noise in them as they have of the sensors (as in [`noisy`]).
    pub(crate) fn noisier<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
        task: &Task<M, N, R>,
        run: &Run<R>,
    ) -> Vec<Self> {
        let outputs = &task.prepared.outputs;
        let of_state: [bool; R] = std::array::from_fn(|row| row < N);
        let levels = noise_of(outputs, &of_state);
        noisy(outputs, &levels).filter_map(|outputs| Self::at(task, run, &outputs)).collect()
    }

    /// The equations with these outputs in the place of the measured ones.
    fn at<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
        task: &Task<M, N, R>,
        run: &Run<R>,
        outputs: &[[f64; R]],
    ) -> Option<Self> {
        let Task { prepared, file, .. } = *task;
        let names = M::AXES.outputs();
        let own: Vec<(usize, &crate::model_file::Parameter)> =
            file.estimated().enumerate().filter(|(_, p)| !matches!(p.role, Role::Bias(_))).collect();
        let values: Vec<f64> = own.iter().map(|(column, _)| run.columns[*column].value).collect();
        let columns: Vec<Column> = own
            .iter()
            .zip(terms(file).0)
            .map(|((_, p), (coefficient, term))| Column { name: p.name.clone(), coefficient, term })
            .collect();
        if columns.is_empty() || values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let structure = Structure::<N, R> {
            parameters: own.iter().map(|(_, p)| BatchParameter::free(p.name.as_str(), p.start)).collect(),
            states: std::array::from_fn(|i| InitialState::free(names[i].name())),
            outputs: std::array::from_fn(|i| OutputChannel::new(names[i].name(), Noise::Estimated)),
            maximum_step_s: 1.0,
            maximum_gap_s: f64::INFINITY,
            likelihood: Likelihood::Gaussian,
        };
        let step_s = median_step(&prepared.time)?;
        let settings = EquationErrorSettings::automatic(step_s);
        let half_window_s = settings.half_window_s;
        let outputs = with_predicted::<N, R>(outputs, |row| file.outputs[names[row].index()], &run.predicted);
        let time = &prepared.time;
        let start_s = *time.first()?;
        let mut blocks: Vec<u64> = time.iter().map(|t| ((t - start_s) / BLOCK_S).floor() as u64).collect();
        blocks.dedup();
        let chunks: Vec<u64> = blocks.chunk_by(|a, b| a / CHUNK == b / CHUNK).map(|chunk| chunk[0] / CHUNK).collect();
        let independent = step_s / half_window_s;
        let mut found = Self { columns, start_s, blocks, independent, equations: Vec::new() };
        for chunk in chunks {
            let [from_s, to_s] = [0, 1].map(|next| start_s + (chunk as f64 + f64::from(next)) * CHUNK as f64 * BLOCK_S);
            let margin = 2.0 * half_window_s;
            let [from, to] = [from_s - margin, to_s + margin].map(|t| time.partition_point(|s| *s < t));
            if to - from < 4 {
                continue;
            }
            let part = Manoeuvre {
                name: "the record",
                plant: prepared,
                first: from,
                time_s: &time[from..to],
                // The input of the model says itself whether it is held between samples.
                hold: InputHold::Linear,
                outputs: &outputs[from..to],
                initial_state: None,
            };
            // A part in which a state was not measured has no equations.
            let Ok(rows) = equations_at(&part, &structure, &settings, &values) else { continue };
            for (k, t) in time[from..to].iter().enumerate().filter(|(_, t)| (from_s..to_s).contains(*t)) {
                let Some(block) = found.block(*t) else { continue };
                let at_s = *t - half_window_s;
                let before = time[from..to].partition_point(|s| *s < at_s - 0.5 * step_s);
                let before = (time[from + before] < at_s + 0.5 * step_s).then_some(before);
                for row in 0..R {
                    let at = |k: usize| {
                        Some((rows.sensitivity(k, row), rows.residuals[k][row]))
                            .filter(|(_, residual)| residual.is_finite())
                    };
                    if let Some(now) = at(k) {
                        found.add(names[row], block, now, before.and_then(at), &values);
                    }
                }
            }
        }
        (!found.equations.is_empty()).then_some(found)
    }

    /// The time at which each block begins, s.
    pub(crate) fn times_s(&self) -> Vec<f64> {
        self.blocks.iter().map(|block| self.start_s + *block as f64 * BLOCK_S).collect()
    }

    /// The number of blocks before a time (s), which is taken to the nearest beginning of a block.
    pub(crate) fn blocks_before(&self, time_s: f64) -> usize {
        let at = (time_s - self.start_s) / BLOCK_S;
        self.blocks.partition_point(|block| *block as f64 + 0.5 <= at)
    }

    /// The equations by block.
    pub(crate) fn by_block(&self) -> Vec<ByBlock> {
        let is_same_term = |a: usize, b: usize| self.columns[a].term == self.columns[b].term;
        self.equations.iter().map(|equation| equation.by_block().without_repeated(&is_same_term)).collect()
    }

    /// The block that a time lies in; none outside the record and in a gap.
    pub(crate) fn block(&self, time_s: f64) -> Option<usize> {
        let block = ((time_s - self.start_s) / BLOCK_S).floor();
        if block >= 0.0 { self.blocks.binary_search(&(block as u64)).ok() } else { None }
    }

    /// A row of an equation, its regressors and its residual, and the one half a window before it.
    fn add(&mut self, output: Output, block: usize, now: (&[f64], f64), before: Option<(&[f64], f64)>, values: &[f64]) {
        let (regressors, residual) = now;
        let place = match self.equations.iter().position(|e| e.output == output) {
            Some(place) => place,
            None => {
                let used: Vec<usize> = (0..regressors.len()).filter(|&j| regressors[j] != 0.0).collect();
                if used.is_empty() {
                    return;
                }
                let mut offset: Vec<f64> = used.iter().map(|&j| regressors[j]).collect();
                offset.push(residual);
                let size = used.len() + 2;
                let own = used.iter().map(|&j| values[j]).collect();
                let [sums, of_sums, of_differences] =
                    [0, 1, 2].map(|_| vec![DMatrix::zeros(size, size); self.blocks.len()]);
                let pairs = [of_sums, of_differences];
                self.equations.push(Equation { output, used, values: own, offset, sums, pairs });
                self.equations.len() - 1
            }
        };
        let equation = &mut self.equations[place];
        let now = equation.row(regressors, residual);
        equation.sums[block].ger(1.0, &now, &now, 1.0);
        if let Some((regressors, residual)) = before {
            let before = equation.row(regressors, residual);
            for (products, row) in equation.pairs.iter_mut().zip([&now + &before, now - before]) {
                products[block].ger(1.0, &row, &row, 1.0);
            }
        }
    }

    /// The blocks in which the regressor of a column moves, and those right after them, in which the aircraft answers.
    /// None for a column that no equation contains, or whose regressor never moves.
    pub(crate) fn exciting(&self, column: usize) -> Option<Vec<bool>> {
        let mut excited = vec![false; self.blocks.len()];
        for equation in &self.equations {
            let Some(i) = equation.used.iter().position(|&j| j == column) else { continue };
            for block in equation.moving(i) {
                excited[block] = true;
                // Behind a gap the answer is over.
                if self.blocks.get(block + 1).is_some_and(|next| next - self.blocks[block] == 1) {
                    excited[block + 1] = true;
                }
            }
        }
        excited.contains(&true).then_some(excited)
    }

    /// How much of each equation is explained where one of its regressors moves, from a time (s) on.
    pub(crate) fn explained(&self, from_s: f64) -> Vec<Explained> {
        let of = |equation: &Equation| equation.explained(&self.judged(equation, from_s), self.independent);
        self.equations.iter().filter_map(of).collect()
    }

    /// What the estimates lose of one equation ([`Explained::lost`]) if what noise in the regressors makes of them is not counted, from the same
    /// equations with that noise once more, `noisier`; `None` where they do not tell.
    ///
    /// Noise in a regressor makes a residual of values that are right. What more of it adds to the squares of the residual, it has added once
    /// already, and that is taken off (W. A. Fuller, *Measurement Error Models*, Wiley, 1987, section 1.2). What the best values explain stays as it
    /// is: noise makes it less.
    pub(crate) fn lost_beyond_noise(&self, output: Output, from_s: f64, noisier: &[Self]) -> Option<f64> {
        let of = |equations: &'_ Self| equations.equations.iter().position(|equation| equation.output == output);
        let own = &self.equations[of(self)?];
        let blocks = self.judged(own, from_s);
        let explained = |equation: &Equation| equation.explained(&blocks, self.independent);
        let of_noisier = |other: &Self| explained(&other.equations[of(other)?]).map(|found| found.left_by_estimates);
        let left: Vec<f64> = noisier.iter().map(of_noisier).collect::<Option<_>>()?;
        let mean = left.iter().sum::<f64>() / left.len() as f64;
        let found = explained(own)?;
        let without_noise = Explained {
            by_estimates: found.by_estimates + (mean - found.left_by_estimates) / found.left_side,
            ..found
        };
        Some(without_noise.lost()).filter(|lost| lost.is_finite())
    }

    /// The blocks from a time (s) on in which a regressor of an equation moves.
    fn judged(&self, equation: &Equation, from_s: f64) -> Vec<usize> {
        let begun = ((from_s - self.start_s) / BLOCK_S).floor() + f64::from(u8::from(from_s > self.start_s));
        let first = self.blocks.partition_point(|block| (*block as f64) < begun);
        // Beyond the record nothing would be judged.
        let first = if first < self.blocks.len() { first } else { 0 };
        let mut moves = vec![false; self.blocks.len()];
        for i in 0..equation.used.len() {
            equation.moving(i).into_iter().for_each(|block| moves[block] = true);
        }
        (first..moves.len()).filter(|&block| moves[block]).collect()
    }
}

impl Equation {
    /// Regressors that are used, the residual and one, without the offsets.
    fn row(&self, regressors: &[f64], residual: f64) -> DVector<f64> {
        let u = self.used.len();
        DVector::from_fn(u + 2, |i, _| match i {
            _ if i < u => regressors[self.used[i]] - self.offset[i],
            _ if i == u => residual - self.offset[u],
            _ => 1.0,
        })
    }

    fn by_block(&self) -> ByBlock {
        let size = self.used.len() + 1;
        // The offsets are put back: value = sum of rows with the constant one in the last place.
        let back = DMatrix::from_fn(size, size + 1, |a, b| match b {
            _ if b == size => self.offset[a],
            _ if a == b => 1.0,
            _ => 0.0,
        });
        let sums = self.sums.iter().map(|block| &back * block * back.transpose()).collect();
        let samples = self.sums.iter().map(|block| block[(size, size)]).collect();
        let moving = |i: usize| {
            let mut moves = vec![false; self.sums.len()];
            self.moving(i).into_iter().for_each(|block| moves[block] = true);
            moves
        };
        let moving = (0..self.used.len()).map(moving).collect();
        ByBlock { used: self.used.clone(), values: self.values.clone(), sums, samples, moving }
    }

    /// The blocks in which a regressor moves.
    fn moving(&self, i: usize) -> Vec<usize> {
        let one = self.used.len() + 1;
        let present: Vec<usize> = (0..self.sums.len()).filter(|&block| self.sums[block][(one, one)] > 0.0).collect();
        let mean = |block: usize| self.sums[block][(i, one)] / self.sums[block][(one, one)];
        let Some(middle) = median(&mut present.iter().map(|&block| mean(block)).collect::<Vec<f64>>()) else {
            return Vec::new();
        };
        let power = |block: usize| {
            let s = &self.sums[block];
            s[(i, i)] / s[(one, one)] - 2.0 * middle * mean(block) + middle * middle
        };
        let most = present.iter().map(|&block| power(block)).fold(0.0, f64::max);
        present.into_iter().filter(|&block| most > 0.0 && power(block) >= MOVES * most).collect()
    }

    /// Of some blocks; `independent` is the part of the rows of which the errors are independent at best.
    fn explained(&self, blocks: &[usize], independent: f64) -> Option<Explained> {
        let u = self.used.len();
        let sum = over(&self.sums, blocks);
        if sum[(u + 1, u + 1)] < FEWEST {
            return None;
        }
        let values = DVector::from_row_slice(&self.values);
        let fit = Fit::of(&sum)?;
        let left_side = fit.by_estimates + 2.0 * values.dot(&fit.with_residual) + values.dot(&(&fit.gram * &values));
        let pairs = [over(&self.pairs[0], blocks), over(&self.pairs[1], blocks)];
        (left_side > 0.0).then(|| Explained {
            output: self.output,
            seconds: blocks.len() as f64 * BLOCK_S,
            left_side,
            left_by_estimates: fit.by_estimates,
            by_estimates: 1.0 - fit.by_estimates / left_side,
            by_terms: 1.0 - fit.by_best / left_side,
            by_chance: by_chance(&fit, &pairs, independent),
        })
    }
}

/// The sum of products over some blocks.
fn over(by_block: &[DMatrix<f64>], blocks: &[usize]) -> DMatrix<f64> {
    let [rows, columns] = by_block.first().map_or([0, 0], |first| [first.nrows(), first.ncols()]);
    blocks.iter().fold(DMatrix::zeros(rows, columns), |sum, &block| sum + &by_block[block])
}

/// The best values of the terms of an equation by least squares about the mean: constants are not judged.
struct Fit {
    gram: DMatrix<f64>,
    with_residual: DVector<f64>,
    /// Regressors, residual and one, as their sum is the error that the best values leave.
    error: DVector<f64>,
    /// Number of terms that can be told apart.
    terms: usize,
    /// Squares that the estimates leave, and that the best values do.
    by_estimates: f64,
    by_best: f64,
}

impl Fit {
    /// From sums of products of `[regressors, residual, 1]`.
    fn of(sum: &DMatrix<f64>) -> Option<Self> {
        let u = sum.nrows() - 2;
        let samples = sum[(u + 1, u + 1)];
        let centred = |a: usize, b: usize| sum[(a, b)] - sum[(a, u + 1)] * sum[(b, u + 1)] / samples;
        let gram = DMatrix::from_fn(u, u, centred);
        let with_residual = DVector::from_fn(u, |a, _| centred(a, u));
        // Regressors of unit length, so that small ones are not taken for none.
        let scale = DVector::from_fn(u, |a, _| if gram[(a, a)] > 0.0 { 1.0 / gram[(a, a)].sqrt() } else { 0.0 });
        let scaled = DMatrix::from_fn(u, u, |a, b| scale[a] * gram[(a, b)] * scale[b]);
        let right = with_residual.component_mul(&scale);
        // Values that are no numbers, or too large to be squared, say nothing; the decomposition would not end with them.
        if !scaled.iter().chain(right.iter()).all(|v| v.is_finite()) {
            return None;
        }
        let parts = scaled.try_svd(true, true, f64::EPSILON, MOST_SWEEPS)?;
        let correction = parts.solve(&right, LEAST_PART).ok()?;
        let mut error = DVector::zeros(u + 2);
        error.rows_mut(0, u).copy_from(&-correction.component_mul(&scale));
        error[u] = 1.0;
        error[u + 1] = -sum.column(u + 1).dot(&error) / samples;
        let by_estimates = centred(u, u);
        let by_best = by_estimates - right.dot(&correction);
        Some(Self { terms: parts.rank(LEAST_PART), gram, with_residual, error, by_estimates, by_best })
    }
}

/// How often chance lets the best values of the terms leave as much less than the estimates as they do: the F test of the estimates
/// against them, with errors of first order.
///
/// Rows are smoothed, so that neighbours share their samples. Two values of a local cubic that are half a window apart share half of
/// them, with weights of either sign: white noise correlates them by -0.02, and the variance of a mean is that of one value in 0.89 of
/// half a window. So one row in half a window counts. Turbulence and model error last longer. The correlation `r` of what the best
/// values leave, between rows half a window apart, is that of J. P. Burg (*Maximum Entropy Spectral Analysis*, 1975; forwards
/// and backwards, so that it is no larger than one), and both sides are compared after it has been taken from them, `row(t) - r row(t -
/// h)` and `row(t - h) - r row(t)` (D. Cochrane, G. H. Orcutt, *Application of Least Squares Regression to Relationships Containing
/// Auto-correlated Error Terms*, Journal of the American Statistical Association 44, 1949): slow errors then do not hide what faster
/// motion tells. `pairs` are the products of the sums and of the differences of such rows.
fn by_chance(fit: &Fit, [sums, differences]: &[DMatrix<f64>; 2], independent: f64) -> f64 {
    let one = sums.nrows() - 1;
    let [alike, apart] = [sums, differences].map(|products| fit.error.dot(&(products * &fit.error)));
    let colour = if alike + apart > 0.0 { ((alike - apart) / (alike + apart)).clamp(0.0, MOST_COLOUR) } else { 0.0 };
    let white = sums * (0.25 * (1.0 - colour).powi(2)) + differences * (0.25 * (1.0 + colour).powi(2));
    let rows = 0.25 * sums[(one, one)] * independent;
    let Some(fit) = Fit::of(&white) else { return f64::NAN };
    let below = (rows as usize).saturating_sub(fit.terms + 1);
    // Of a record without noise nothing is left but rounding.
    let left = fit.by_best.max(0.0) / below as f64;
    let gained = (fit.by_estimates - fit.by_best).max(0.0) / fit.terms as f64;
    ratio_above(gained / left, fit.terms, below)
}

/// The outputs, with what the method predicted in the place of a state that nothing measures.
fn with_predicted<const N: usize, const R: usize>(
    outputs: &[[f64; R]],
    is_measured: impl Fn(usize) -> bool,
    predicted: &[[f64; R]],
) -> Vec<[f64; R]> {
    let mut complete = outputs.to_vec();
    for row in (0..N).filter(|row| !is_measured(*row)) {
        for (y, predicted) in complete.iter_mut().zip(predicted) {
            y[row] = predicted[row];
        }
    }
    complete
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two blocks of `y = 2 x + 3 z`, in which a second coefficient has a tenth of `x` as its own regressor.
    fn repeated() -> ByBlock {
        let block = |from: usize| {
            let mut sum = DMatrix::zeros(4, 4);
            for k in from..from + 20 {
                let (x, z) = ((0.7 * k as f64).sin(), (0.3 * k as f64).cos());
                // At the values 1.5, 4 and 3: 0.1 of x is left.
                let row = DVector::from_vec(vec![x, 0.1 * x, z, 2.0 * x + 3.0 * z - (1.5 * x + 0.4 * x + 3.0 * z)]);
                sum.ger(1.0, &row, &row, 1.0);
            }
            sum
        };
        let moving = vec![vec![true, true], vec![false, false], vec![true, false]];
        ByBlock {
            used: vec![2, 5, 7],
            values: vec![1.5, 4.0, 3.0],
            sums: vec![block(0), block(20)],
            samples: vec![20.0; 2],
            moving,
        }
    }

    /// Samples in half a window, and in a block.
    const HALF: usize = 20;
    const BLOCK: usize = 100;

    /// White noise of one sigma 0.5, uniform.
    fn white(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            3.0_f64.sqrt() * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        }
    }

    /// So many seconds of `y = a x + b z` with noise through the window of the equations, at values that are wrong by `error`. Errors of
    /// first order are left of the noise after each sample by the part `lasting`.
    fn explained(seconds: usize, error: [f64; 2], noise: f64, lasting: f64, seed: u64) -> Explained {
        let mut next = white(seed);
        let mut last = 0.0;
        let mut coloured = || {
            last = lasting * last + (1.0 - lasting * lasting).sqrt() * noise * next();
            last
        };
        let errors: Vec<f64> = (0..seconds * BLOCK + 2 * HALF).map(|_| coloured()).collect();
        // Value of a local cubic at the middle of its window.
        let weight = |i: usize| 1.125 - 1.875 * ((i as f64 - HALF as f64) / HALF as f64).powi(2);
        let weights: f64 = (0..=2 * HALF).map(weight).sum();
        let smoothed = |k: usize| (0..=2 * HALF).map(|i| weight(i) * errors[k + i]).sum::<f64>() / weights;
        let truth = [1.0, -0.5];
        let values = [truth[0] + error[0], truth[1] + error[1]];
        let row = |k: usize| {
            let t = k as f64 / BLOCK as f64;
            let x = [(3.0 * t).sin() + 0.2, (5.0 * t).cos() - 0.1];
            (x, smoothed(k) - error[0] * x[0] - error[1] * x[1])
        };
        let rows: Vec<([f64; 2], f64)> = (0..seconds * BLOCK).map(row).collect();
        let mut equations = Equations {
            columns: Vec::new(),
            start_s: 0.0,
            blocks: (0..seconds as u64).collect(),
            independent: 1.0 / HALF as f64,
            equations: Vec::new(),
        };
        let of = |k: usize| (&rows[k].0[..], rows[k].1);
        for k in 0..rows.len() {
            let before = k.checked_sub(HALF);
            equations.add(Output::Ax, k / BLOCK, of(k), before.map(of), &values);
        }
        equations.explained(f64::NEG_INFINITY)[0]
    }

    #[test]
    fn true_values_lose_by_chance_as_often_as_is_said() {
        // White noise of samples, and noise that lasts for a second; four seconds and half a minute.
        for (seconds, lasting) in [(4, 0.0), (30, 0.0), (30, 0.99)] {
            let chances: Vec<f64> =
                (0..400).map(|seed| explained(seconds, [0.0; 2], 1.0, lasting, seed).by_chance).collect();
            for limit in [0.1, 0.01] {
                let below = chances.iter().filter(|chance| **chance < limit).count() as f64 / 400.0;
                // Four standard errors of a fraction of so many.
                let most = limit + 4.0 * (limit * (1.0 - limit) / 400.0).sqrt();
                assert!(below <= most, "{seconds} s, {lasting}: {below} below {limit}");
            }
        }
    }

    #[test]
    fn free_values_fit_a_second_of_noise_and_wrong_ones_are_told_in_three() {
        let by_chance = explained(1, [0.0; 2], 8.0, 0.0, 8);
        assert!(by_chance.by_terms > 0.6 && by_chance.lost() > 0.75 && by_chance.by_chance > 0.1, "{by_chance:?}");
        // Noise that lasts for a second hides nothing of faster motion.
        for (seconds, noise, lasting) in [(3, 0.0, 0.0), (3, 1.0, 0.0), (10, 0.5, 0.99)] {
            let wrong = explained(seconds, [0.8, -0.4], noise, lasting, 8);
            assert!(wrong.by_terms > 0.6 && wrong.lost() > 0.4 && wrong.by_chance < 1e-4, "{seconds} s: {wrong:?}");
        }
    }

    /// Half a minute of `y = x - 0.5 z` at values that are wrong by `error`, with noise in the regressor x alone, `more` of it on top.
    fn with_noise_in_a_regressor(error: [f64; 2], more: f64) -> Equations {
        let values = [1.0 + error[0], -0.5 + error[1]];
        let [mut noise, mut added] = [white(3), white(4)];
        let row = |k: usize| {
            let t = k as f64 / BLOCK as f64;
            let (x, z) = (0.3 * (3.0 * t).sin(), 0.3 * (5.0 * t).cos());
            let measured = x + 0.6 * (noise() + more * added());
            ([measured, z], x - 0.5 * z - values[0] * measured - values[1] * z)
        };
        let rows: Vec<([f64; 2], f64)> = (0..30 * BLOCK).map(row).collect();
        let mut equations = Equations {
            columns: Vec::new(),
            start_s: 0.0,
            blocks: (0..30).collect(),
            independent: 1.0,
            equations: Vec::new(),
        };
        for (k, (regressors, residual)) in rows.iter().enumerate() {
            let before = k.checked_sub(HALF).map(|k| (&rows[k].0[..], rows[k].1));
            equations.add(Output::Az, k / BLOCK, (&regressors[..], *residual), before, &values);
        }
        equations
    }

    #[test]
    fn what_noise_in_a_regressor_loses_is_not_lost_by_the_estimates() {
        let lost = |error: [f64; 2]| {
            let own = with_noise_in_a_regressor(error, 0.0);
            let noisier = [-1.0, 1.0].map(|more| with_noise_in_a_regressor(error, more));
            let beyond = own.lost_beyond_noise(Output::Az, f64::NEG_INFINITY, &noisier).unwrap();
            (own.explained(f64::NEG_INFINITY)[0].lost(), beyond)
        };
        let (by_right, by_right_beyond) = lost([0.0; 2]);
        assert!(by_right > 0.9 && by_right_beyond < 0.1, "{by_right} {by_right_beyond}");
        let (by_wrong, by_wrong_beyond) = lost([-1.5, 1.0]);
        assert!(by_wrong > 0.9 && by_wrong_beyond > 0.9, "{by_wrong} {by_wrong_beyond}");
        // Without the same with more noise nothing is said, and of an equation that is not there.
        let own = with_noise_in_a_regressor([0.0; 2], 0.0);
        assert_eq!(own.lost_beyond_noise(Output::Az, f64::NEG_INFINITY, &[]), None);
        assert_eq!(own.lost_beyond_noise(Output::Ax, f64::NEG_INFINITY, &[]), None);
    }

    #[test]
    fn the_weaker_one_of_two_that_cannot_be_told_apart_is_left_out_at_its_value() {
        let is_same_term = |a: usize, b: usize| [a, b].iter().all(|column| [2, 5].contains(column));
        let kept = repeated().without_repeated(&is_same_term);
        assert_eq!((&kept.used[..], &kept.values[..]), (&[2, 7][..], &[1.5, 3.0][..]));
        assert_eq!(kept.moving, [[true, true], [true, false]]);
        // The residual is what it was: of the left side, 0.4 x is the other one's.
        let sum = &kept.sums[0] + &kept.sums[1];
        let found = sum[(0, 2)] / sum[(0, 0)];
        assert!((found - 0.1).abs() < 0.05, "{found}");
        assert_eq!(
            sum,
            DMatrix::from_fn(3, 3, |a, b| {
                let places = [0, 2, 3];
                repeated().sums.iter().map(|block| block[(places[a], places[b])]).sum::<f64>()
            })
        );
    }

    #[test]
    fn two_terms_that_move_alike_are_both_kept() {
        let kept = repeated().without_repeated(&|_, _| false);
        assert_eq!((kept.used, kept.sums), (repeated().used, repeated().sums));
    }
}
