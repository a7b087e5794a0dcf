//! Complex least squares over equations and frequencies.

use super::equation::{Bins, Equation};
use crate::bounded::{limited, unit};
use crate::columns::Columns;
use crate::dense::Cholesky;
use crate::kernels::{add_scaled, dot};

/// The last solution of the least squares, with its covariance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution<const P: usize> {
    /// Estimated parameters and biases, parameter units.
    pub(super) theta: [f64; P],
    /// Columns scaled to the prior standard deviation.
    pub(super) covariance: [[f64; P]; P],
    count: usize,
}

/// Normal equations of one equation of motion: parameters, and the noise of the measurements at the ends of the record.
struct Normal<const P: usize> {
    information: [[f64; P]; P],
    score: [f64; P],
    /// Parameters with end noise, end noise with itself, its score.
    mixed: [[f64; P]; 2],
    ends: [[f64; 2]; 2],
    end_score: [f64; 2],
    /// Sum of the weighted squares of the left hand side.
    squares: f64,
    /// Number of independent real values among the transforms.
    independent: f64,
}

impl<const P: usize> Normal<P> {
    /// Adds up equation `z - w centre = w delta` over the frequencies. `|s|^2` enters the noise of a dynamic one, and
    /// its ends.
    fn new(
        equation: &Equation<P>,
        bins: &Bins,
        scale: &[f64; P],
        centre: &[f64; P],
        dynamic: bool,
        ends: bool,
    ) -> Self {
        let mut normal = Self {
            information: [[0.0; P]; P],
            score: [0.0; P],
            mixed: [[0.0; P]; 2],
            ends: [[0.0; 2]; 2],
            end_score: [0.0; 2],
            squares: 0.0,
            independent: 1.0,
        };
        let variance = equation.std * equation.std;
        let length_s = equation.energy / bins.interval_s();
        let band_hz = bins.width() / (2.0 * core::f64::consts::PI);
        let independent = (1.0 + band_hz * length_s).min(bins.count() as f64);
        normal.independent = 2.0 * independent;
        let share = independent / bins.count() as f64;
        for m in 0..bins.count() {
            let noise =
                if dynamic { bins.pole[m].squared_size() * equation.energy + equation.seams } else { equation.energy };
            let weight = share / (variance * equation.excess * noise);
            let mut rows = [[0.0; P]; 2];
            let mut left = [equation.z[m].re, equation.z[m].im];
            for j in 0..P {
                if !equation.used[j] {
                    continue;
                }
                let w = equation.w[j][m];
                left[0] -= w.re * centre[j];
                left[1] -= w.im * centre[j];
                rows[0][j] = w.re * scale[j];
                rows[1][j] = w.im * scale[j];
            }
            let last = if equation.is_open() { 1.0 } else { 0.0 };
            let noisy = [[last, equation.first[m].re], [0.0, equation.first[m].im]];
            for part in 0..2 {
                let row = &rows[part];
                for i in 0..P {
                    if equation.used[i] {
                        add_scaled(&mut normal.information[i], weight * row[i], row);
                    }
                }
                add_scaled(&mut normal.score, weight * left[part], row);
                normal.squares += weight * left[part] * left[part];
                if dynamic && ends {
                    for (k, a) in noisy[part].into_iter().enumerate() {
                        add_scaled(&mut normal.mixed[k], weight * a, row);
                        normal.ends[k][0] += weight * a * noisy[part][0];
                        normal.ends[k][1] += weight * a * noisy[part][1];
                        normal.end_score[k] += weight * a * left[part];
                    }
                }
            }
        }
        if dynamic && ends {
            normal.ends[0][0] += 1.0 / variance;
            normal.ends[1][1] += 1.0 / variance;
            normal.eliminate();
        }
        normal
    }

    /// Takes the end noise out: Schur complement.
    fn eliminate(&mut self) {
        let [[a, b], [_, d]] = self.ends;
        let determinant = a * d - b * b;
        let inverse = [[d / determinant, -b / determinant], [-b / determinant, a / determinant]];
        for k in 0..2 {
            for l in 0..2 {
                let f = inverse[k][l];
                for i in 0..P {
                    add_scaled(&mut self.information[i], -f * self.mixed[k][i], &self.mixed[l]);
                }
                add_scaled(&mut self.score, -f * self.end_score[l], &self.mixed[k]);
                self.squares -= f * self.end_score[k] * self.end_score[l];
            }
        }
    }

    /// Weighted sum of squares that is left with the solution `delta`.
    fn residual(&self, delta: &[f64; P]) -> f64 {
        let mut sum = self.squares - 2.0 * dot(&self.score, delta);
        for i in 0..P {
            sum += delta[i] * dot(&self.information[i], delta);
        }
        sum.max(0.0)
    }
}

impl<const P: usize> Solution<P> {
    pub(super) fn prior(initial: &[f64; P], count: usize) -> Self {
        let covariance =
            core::array::from_fn(|i| core::array::from_fn(|j| if i == j && i < count { 1.0 } else { 0.0 }));
        Self { theta: *initial, covariance, count }
    }

    /// Variance of `row theta`, the row scaled to the prior standard deviation.
    pub(super) fn spread(&self, row: &[f64; P]) -> f64 {
        let n = self.count.min(P);
        (0..n).map(|i| row[i] * dot(&self.covariance[i][..n], &row[..n])).sum()
    }

    /// Least squares on everything up to now. Keeps the last solution if there is none.
    pub(super) fn solve<const N: usize, const R: usize>(
        &mut self,
        bins: &Bins,
        columns: &Columns<R, P>,
        dynamic: &mut [Equation<P>; N],
        algebraic: &mut [Equation<P>; R],
        end_point: bool,
    ) {
        // What is forgotten gives way to the prior about the last estimate, not about the first one: it stays.
        let centre = if bins.forgetting > 0.0 { self.theta } else { columns.initial };
        let normal_of = |equation: &Equation<P>, is_dynamic: bool| {
            Normal::new(equation, bins, &columns.std, &centre, is_dynamic, end_point)
        };
        let mut information = [[0.0; P]; P];
        let mut delta = [0.0; P];
        let both = dynamic.iter().map(|e| (e, true)).chain(algebraic.iter().map(|e| (e, false)));
        for (equation, is_dynamic) in both.filter(|(e, _)| e.has_data()) {
            let normal = normal_of(equation, is_dynamic);
            for i in 0..P {
                add_scaled(&mut information[i], 1.0, &normal.information[i]);
            }
            add_scaled(&mut delta, 1.0, &normal.score);
        }
        for i in 0..self.count.min(P) {
            information[i][i] += 1.0;
        }
        let Some(cholesky) = Cholesky::new(&mut information, self.count) else { return };
        cholesky.solve(&mut delta);
        if !delta.iter().all(|d| d.is_finite()) {
            return;
        }
        for j in 0..self.count.min(P) {
            self.theta[j] = limited(centre[j] + columns.std[j] * delta[j], columns.clip_low[j], columns.clip_high[j]);
            let mut column = unit(j);
            cholesky.solve(&mut column);
            self.covariance[j] = column;
        }
        // The excess enters the next solution.
        let both = dynamic.iter_mut().map(|e| (e, true)).chain(algebraic.iter_mut().map(|e| (e, false)));
        for (equation, is_dynamic) in both.filter(|(e, _)| e.has_data()) {
            let normal = normal_of(equation, is_dynamic);
            let own = equation.used.iter().filter(|used| **used).count() as f64;
            let freedom = (normal.independent - own).max(1.0);
            equation.excess = (equation.excess * normal.residual(&delta) / freedom).max(1.0);
        }
    }
}
