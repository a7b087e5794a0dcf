//! Constants that leave a trace in residuals: what a flight itself says of them, and what that makes of the estimate.
//!
//! A filter that ignores the constants `c` has residuals `e = zeta c + noise` with the variance `s` that it believes, and knows `zeta`
//! ([`considered`](crate::supervisor::considered)). So the flight says of some of them, the learnt ones `S`,
//!
//! ```text
//! M = sum zeta^T zeta / s,   g = sum zeta^T e / s          over the rows that count fully
//! V = (P_S^-1 + M_SS/phi)^-1,   c_S = V g_S/phi            P: declared variances, phi: what coloured residuals are worth less
//! theta + T_S c_S,   T' = T - T_S V M_S./phi               errors per unit of each constant, the learnt ones as well
//! C + T_S V (M_SS/phi) V T_S^T + T' P T'^T                 random part, and the part of the declared errors
//! ```
//!
//! which for `phi = 1` is the filter that has `c_S` among its parameters (B. Friedland, *Treatment of bias in recursive
//! filtering*, IEEE Trans. Automatic Control AC-14, 1969: estimate and covariance in two stages). The filter itself does not change: what is
//! learnt is applied to what is shown, so that it may be begun and given up at any sample.
//!
//! *What is learnt* is decided from covariances and not from residuals: the constants whose standard uncertainty after the flight is
//! below a part of the declared one, all that are learnt taken together. Factors on states and forces (scales of airspeed and vanes, mass,
//! inertia, thrust) are never to be among [`Model::learnable_constants`](crate::Model::learnable_constants): with process noise their
//! regressors are states with errors, and they come out too small with a small bound.

use crate::dense::Cholesky;
use crate::kernels::{add_scaled, dot};

/// Most constants that can be learnt.
pub const MOST_LEARNT: usize = 4;

/// What residuals have said of the constants that can be learnt, collected row by row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collected<const K: usize> {
    /// `M`, row = learnable constant.
    information: [[f64; K]; MOST_LEARNT],
    /// `g`.
    score: [f64; MOST_LEARNT],
    /// Score and information of the running block, the latter among the learnable constants.
    block: [f64; MOST_LEARNT],
    block_information: [[f64; MOST_LEARNT]; MOST_LEARNT],
    scatter: Scatter,
}

/// How the scores `g_b` of the blocks scatter about what the constants make of them, `M_b c`: sums over the blocks from which
/// `sum (g_b - M_b c)_k^2` follows for any `c`.
#[derive(Clone, Copy, Debug)]
struct Scatter {
    /// `sum g_k^2`.
    square: [f64; MOST_LEARNT],
    /// `sum g_k M_kj`.
    cross: [[f64; MOST_LEARNT]; MOST_LEARNT],
    /// `sum M_ki M_kj`, by `k`.
    outer: [[[f64; MOST_LEARNT]; MOST_LEARNT]; MOST_LEARNT],
}

impl Scatter {
    const NONE: Self = Self {
        square: [0.0; MOST_LEARNT],
        cross: [[0.0; MOST_LEARNT]; MOST_LEARNT],
        outer: [[[0.0; MOST_LEARNT]; MOST_LEARNT]; MOST_LEARNT],
    };

    fn add(&mut self, score: &[f64; MOST_LEARNT], information: &[[f64; MOST_LEARNT]; MOST_LEARNT]) {
        for k in 0..MOST_LEARNT {
            self.square[k] += score[k] * score[k];
            add_scaled(&mut self.cross[k], score[k], &information[k]);
            for i in 0..MOST_LEARNT {
                add_scaled(&mut self.outer[k][i], information[k][i], &information[k]);
            }
        }
    }

    /// Of the score of one constant, where all have the values `c`.
    fn about(&self, k: usize, c: &[f64; MOST_LEARNT]) -> f64 {
        let made: f64 = self.outer[k].iter().zip(c).map(|(row, own)| own * dot(row, c)).sum();
        (self.square[k] - 2.0 * dot(&self.cross[k], c) + made).max(0.0)
    }
}

impl<const K: usize> Collected<K> {
    pub(crate) const NONE: Self = Self {
        information: [[0.0; K]; MOST_LEARNT],
        score: [0.0; MOST_LEARNT],
        block: [0.0; MOST_LEARNT],
        block_information: [[0.0; MOST_LEARNT]; MOST_LEARNT],
        scatter: Scatter::NONE,
    };

    /// A row: `zeta`, the residual and its variance.
    #[inline]
    pub(crate) fn add(&mut self, constants: &[usize], zeta: &[f64; K], residual: f64, variance: f64) {
        let weight = 1.0 / variance;
        for (place, constant) in constants.iter().enumerate().take(MOST_LEARNT) {
            let own = zeta.get(*constant).copied().unwrap_or(0.0) * weight;
            if own != 0.0 {
                add_scaled(&mut self.information[place], own, zeta);
                self.score[place] += own * residual;
                self.block[place] += own * residual;
                for (sum, other) in self.block_information[place].iter_mut().zip(constants) {
                    *sum += own * zeta.get(*other).copied().unwrap_or(0.0);
                }
            }
        }
    }

    /// Ends a block of the colour correction.
    pub(crate) fn close_block(&mut self) {
        self.scatter.add(&self.block, &self.block_information);
        self.block = [0.0; MOST_LEARNT];
        self.block_information = [[0.0; MOST_LEARNT]; MOST_LEARNT];
    }

    /// As it is shown, with `count` constants in use.
    pub(crate) fn evidence<'a>(&'a self, constants: &'a [usize], count: usize) -> Evidence<'a> {
        let of = |row: &'a [f64; K]| &row[..count.min(K)];
        Evidence {
            constants: &constants[..constants.len().min(MOST_LEARNT)],
            information: self.information.each_ref().map(of),
            score: &self.score,
            scatter: &self.scatter,
        }
    }
}

/// What a flight says of the constants that can be learnt.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// The constants that can be learnt, by their places among all.
    constants: &'a [usize],
    /// `M`, row = learnable constant, column = constant.
    information: [&'a [f64]; MOST_LEARNT],
    score: &'a [f64; MOST_LEARNT],
    scatter: &'a Scatter,
}

/// When a constant is learnt, and how far residuals are believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearningRule {
    /// A constant is learnt where its standard uncertainty after the flight is below this part of the declared one.
    pub most_left: f64,
    /// By this factor less than white residuals of a right model would say, beside what their colour takes off. At least 1.
    pub misfit: f64,
    /// Whether the colour of the residuals takes off what they say, as it widens the bounds of the estimate.
    pub colour: bool,
    /// A value of more than so many declared standard uncertainties contradicts what is declared, and nothing is learnt.
    pub farthest: f64,
}

impl Default for LearningRule {
    /// 0.4, and 4: on 107 flights of another simulator in which nothing was wrong, what was learnt of four constants lay 0.9 to 2.3 of
    /// its standard errors (root mean square) off, because models lack terms. And 3.
    fn default() -> Self {
        Self { most_left: 0.4, misfit: 4.0, colour: true, farthest: 3.0 }
    }
}

/// Values of some constants, and their covariance.
struct Solved {
    values: [f64; MOST_LEARNT],
    covariance: [[f64; MOST_LEARNT]; MOST_LEARNT],
}

/// The constants that are learnt, and what they make of an estimate.
#[derive(Clone, Copy, Debug)]
pub struct Learnt<'a> {
    evidence: Evidence<'a>,
    /// Number of constants learnt, and their rows in the evidence.
    count: usize,
    rows: [usize; MOST_LEARNT],
    values: [f64; MOST_LEARNT],
    /// `V`.
    covariance: [[f64; MOST_LEARNT]; MOST_LEARNT],
    /// `1/phi`.
    weight: f64,
}

/// What is learnt makes of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearntColumn {
    /// To be added to the estimate.
    pub shift: f64,
    /// Variance that the noise of what is learnt adds to its random part.
    pub variance: f64,
    /// `T_S V`, by constant learnt.
    through: [f64; MOST_LEARNT],
}

impl<'a> Evidence<'a> {
    /// Decides which constants are learnt. `std`: declared standard uncertainty of every constant; one that is not
    /// above zero, or no number, is exact. `None` where none is learnt.
    pub fn learn(&self, std: &[f64], rule: &LearningRule) -> Option<Learnt<'a>> {
        let declared = |row: usize| self.constants.get(row).and_then(|constant| std.get(*constant)).copied();
        let mut rows = [0; MOST_LEARNT];
        let mut count = 0;
        for row in 0..self.constants.len() {
            let said = self.at(row, row);
            if declared(row).is_some_and(|std| std > 0.0 && std.is_finite()) && said > 0.0 && said.is_finite() {
                rows[count] = row;
                count += 1;
            }
        }
        while count > 0 {
            let used = &rows[..count];
            let misfit = 1.0 / rule.misfit.max(1.0);
            // The scatter about what the constants make of the scores: about zero an error of theirs would count as colour.
            let first = self.solved(used, std, misfit)?;
            let mut all = [0.0; MOST_LEARNT];
            for (row, value) in used.iter().zip(first.values) {
                all[*row] = value;
            }
            let coloured = used.iter().filter(|_| rule.colour);
            let colour = coloured.map(|row| self.scatter.about(*row, &all) / self.at(*row, *row)).fold(1.0, f64::max);
            let Solved { values, covariance } = self.solved(used, std, misfit / colour)?;
            let part = |row: usize, size: f64| size / declared(row).unwrap_or(f64::NAN);
            let left = |i: usize| part(used[i], libm::sqrt(covariance[i][i]));
            let vaguest = (0..count).max_by(|i, j| left(*i).total_cmp(&left(*j)))?;
            if left(vaguest) < rule.most_left {
                let is_far = |(row, value): (&usize, &f64)| {
                    let size = part(*row, value.abs());
                    size.is_nan() || size > rule.farthest
                };
                if used.iter().zip(&values).any(is_far) {
                    return None;
                }
                return Some(Learnt { evidence: *self, count, rows, values, covariance, weight: misfit / colour });
            }
            rows.copy_within(vaguest + 1..count, vaguest);
            count -= 1;
        }
        None
    }

    /// Values and covariance of the constants of some rows, whose residuals count with a weight. `None` where they are no numbers.
    fn solved(&self, used: &[usize], std: &[f64], weight: f64) -> Option<Solved> {
        let mut inverse = [[0.0; MOST_LEARNT]; MOST_LEARNT];
        let mut values = [0.0; MOST_LEARNT];
        for (i, row) in used.iter().enumerate() {
            for (j, other) in used.iter().enumerate() {
                inverse[i][j] = weight * self.at(*row, *other);
            }
            let std = *std.get(*self.constants.get(*row)?)?;
            inverse[i][i] += 1.0 / (std * std);
            values[i] = weight * self.score[*row];
        }
        let factors = Cholesky::new(&mut inverse, used.len())?;
        let mut covariance = [[0.0; MOST_LEARNT]; MOST_LEARNT];
        for (i, column) in covariance.iter_mut().enumerate().take(used.len()) {
            column[i] = 1.0;
            factors.solve(column);
        }
        factors.solve(&mut values);
        Some(Solved { values, covariance })
    }

    /// An entry of `M_SS`, by rows.
    fn at(&self, row: usize, other: usize) -> f64 {
        let column = self.constants.get(other).copied().unwrap_or(usize::MAX);
        self.information.get(row).and_then(|row| row.get(column)).copied().unwrap_or(0.0)
    }
}

impl Learnt<'_> {
    /// What is learnt: the constant by its place among all, its value and its standard uncertainty after the flight, both in the unit and with
    /// the sign that the constant has in [`Model::constant_effects`](crate::Model::constant_effects).
    pub fn constants(&self) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        (0..self.count).filter_map(|i| {
            let constant = *self.evidence.constants.get(self.rows[i])?;
            Some((constant, self.values[i], libm::sqrt(self.covariance[i][i])))
        })
    }

    /// Of a column with these errors (`true - estimated`) per unit of each constant, parameter units. Errors that are not there count as zero;
    /// one that is no number makes the result none.
    pub fn column(&self, errors: &[f64]) -> LearntColumn {
        let mut own = [0.0; MOST_LEARNT];
        for (own, (constant, ..)) in own.iter_mut().zip(self.constants()) {
            *own = errors.get(constant).copied().unwrap_or(0.0);
        }
        let through = self.covariance.map(|row| dot(&row[..self.count], &own[..self.count]));
        let shift = dot(&own[..self.count], &self.values[..self.count]);
        let mut column = LearntColumn { shift, variance: 0.0, through };
        column.variance = self.covariance(&column, &column);
        column
    }

    /// What the noise of what is learnt adds to the covariance of two columns.
    pub fn covariance(&self, column: &LearntColumn, other: &LearntColumn) -> f64 {
        let mut sum = 0.0;
        for i in 0..self.count {
            for j in 0..self.count {
                sum += column.through[i] * other.through[j] * self.evidence.at(self.rows[i], self.rows[j]);
            }
        }
        self.weight * sum
    }

    /// The error of the corrected column per unit of a constant; `error`: that of the estimate.
    pub fn error(&self, column: &LearntColumn, constant: usize, error: f64) -> f64 {
        let of = |row: usize| self.evidence.information[row].get(constant).copied().unwrap_or(0.0);
        let taken: f64 = (0..self.count).map(|i| column.through[i] * of(self.rows[i])).sum();
        error - self.weight * taken
    }
}
