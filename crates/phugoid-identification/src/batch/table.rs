//! The equations of motion of a record as columns of numbers, for regressions that try many terms.
//!
//! Samples are thinned to a spacing below which the windows of the smoothing make neighbours alike, and put on a grid
//! of times, so that what lies a number of rows apart lies as many spacings apart in time, and columns that were worked
//! out with different models of the same record fit together. Beside the equations as measured stand copies with white
//! noise of a given level added: what it does to an estimate is what the noise that is there has done already.

use super::equation_error::{EquationErrorSettings, nothing_integrated, rows_of, state_of};
use super::error::BatchError;
use super::layout::Layout;
use super::measured::{Measured, Outliers};
use super::problem::{Manoeuvre, Structure};
use super::regressor_noise::{PAIRS, either_sign};

/// Rows without values that part two manoeuvres, or two stretches with a gap between: more than residuals are followed
/// over.
pub(crate) const APART: usize = 200;
/// Samples that are worked out at a time: bounds the memory that a long record takes.
const CHUNK: usize = 2000;

/// Times (s) of the rows of one manoeuvre; NaN for the rows of a gap, and after the end.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    times: Vec<f64>,
}

impl Grid {
    /// Every sample that lies at least `spacing_s` after the last one taken. Where samples are missing, rows without a
    /// time stand for them.
    pub(crate) fn new(time_s: &[f64], spacing_s: f64) -> Self {
        let mut times: Vec<f64> = Vec::new();
        let mut last = f64::NEG_INFINITY;
        for t in time_s {
            let passed = t - last;
            // Not `>=` alone: times are rounded.
            if passed < spacing_s * (1.0 - 1e-6) {
                continue;
            }
            if last.is_finite() {
                let missing = (passed / spacing_s - 1.0).round().max(0.0);
                times.extend(std::iter::repeat_n(f64::NAN, (missing as usize).min(APART)));
            }
            times.push(*t);
            last = *t;
        }
        times.extend(std::iter::repeat_n(f64::NAN, APART));
        Self { times }
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.times.len()
    }
}

/// One equation of motion over all manoeuvres, row by row of their grids; NaN where it has no value.
#[derive(Clone, Debug)]
pub(crate) struct Equation {
    /// Name of the left side: `d(q)/dt`, or that of the output.
    pub(crate) name: String,
    /// Position of the output that measures the left side, or the state whose rate it is.
    pub(crate) output: usize,
    /// Whether the left side is a measured acceleration.
    pub(crate) measured: bool,
    /// Left side less what is known.
    pub(crate) left: Vec<f64>,
    /// By parameter of the structure; empty for one that is not in the equation.
    pub(crate) regressors: Vec<Vec<f64>>,
}

/// The equations, as measured or with noise added.
pub(crate) type Table = Vec<Equation>;

/// The equations of the manoeuvres on their grids: as measured, then with noise of `noise_std` by output added, in
/// pairs of opposite signs. `parameters` is where a model that is not linear in them is linearised. Equations without a
/// regressor are left out.
///
/// # Errors
/// [`BatchError::BadInput`] where a state is nowhere measured.
pub(crate) fn tables<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    grids: &[Grid],
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
    parameters: &[f64],
    noise_std: &[[f64; R]],
) -> Result<Vec<Table>, BatchError> {
    let held = structure.held_at(parameters);
    let columns = held.parameters.len();
    let rows = grids.iter().map(Grid::rows).sum();
    let copies = 1 + 2 * PAIRS as usize;
    let states: [Option<usize>; R] = std::array::from_fn(|i| state_of::<N, R>(manoeuvres, i));
    let empty = |i: usize| Equation {
        name: states[i].map_or_else(
            || structure.outputs[i].name.clone(),
            |state| format!("d({})/dt", structure.states[state].name),
        ),
        output: i,
        measured: states[i].is_none(),
        left: vec![f64::NAN; rows],
        regressors: vec![Vec::new(); columns],
    };
    let mut tables: Vec<Table> = (0..copies).map(|_| (0..R).map(empty).collect()).collect();
    let mut found_any = false;
    let mut failure = None;
    let mut offset = 0;
    for (index, (whole, grid)) in manoeuvres.iter().zip(grids).enumerate() {
        let time = whole.time_s;
        // The row of each sample; the grid's times are samples of the record.
        let mut places = vec![None; time.len()];
        let mut next = 0;
        for (row, t) in grid.times.iter().enumerate().filter(|(_, t)| t.is_finite()) {
            while next < time.len() && time[next] < *t {
                next += 1;
            }
            if next < time.len() && time[next] == *t {
                places[next] = Some(offset + row);
            }
        }
        offset += grid.rows();
        let margin = 2.0 * settings.half_window_s;
        for first in (0..time.len()).step_by(CHUNK) {
            let last = (first + CHUNK).min(time.len());
            let from = time.partition_point(|t| *t < time[first] - margin);
            let to = time.partition_point(|t| *t <= time[last - 1] + margin);
            if to - from < 4 {
                continue;
            }
            let part = [whole.part(from..to)];
            let (half, smooth) = (settings.half_window_s, settings.smooth_regressors);
            let measured = match Measured::of(&part[0], &held, half, smooth, Outliers::LeftOut) {
                Ok(measured) => measured,
                // A part in which a state was not measured has no equations.
                Err(error) => {
                    failure = Some(error);
                    continue;
                }
            };
            found_any = true;
            let layout: Layout<N> = Layout::new(&held, &part, nothing_integrated(&part));
            for (copy, table) in tables.iter_mut().enumerate() {
                let noisy = (copy > 0).then(|| {
                    let (pair, sign) = ((copy as u64 - 1) / 2, if copy % 2 == 1 { -1.0 } else { 1.0 });
                    let at = |(k, y): (usize, &[f64; R])| -> [f64; R] {
                        let place = |i: usize| [pair, index as u64, (from + k) as u64, i as u64];
                        std::array::from_fn(|i| y[i] + sign * noise_std[index][i] * either_sign(place(i)))
                    };
                    let outputs: Vec<[f64; R]> = measured.outputs.iter().enumerate().map(at).collect();
                    measured.with(&part[0], &outputs)
                });
                let measured = std::slice::from_ref(noisy.as_ref().unwrap_or(&measured));
                let found = rows_of(&part, measured, &layout, &layout.start(), &[true; R]);
                let Some(found) = found.first() else { continue };
                for k in first..last {
                    let Some(row) = places[k] else { continue };
                    for (i, equation) in table.iter_mut().enumerate() {
                        let residual = found.residuals[k - from][i];
                        if !residual.is_finite() {
                            continue;
                        }
                        let sensitivities = found.sensitivity(k - from, i);
                        let mut left = residual;
                        for ((s, value), column) in
                            sensitivities.iter().zip(parameters).zip(equation.regressors.iter_mut())
                        {
                            left += s * value;
                            if *s != 0.0 && column.is_empty() {
                                *column = vec![0.0; rows];
                            }
                            if let Some(place) = column.get_mut(row) {
                                *place = *s;
                            }
                        }
                        equation.left[row] = left;
                    }
                }
            }
        }
    }
    if let (false, Some(error)) = (found_any, failure) {
        return Err(error);
    }
    let used: Vec<bool> = (0..R).map(|i| tables[0][i].regressors.iter().any(|c| !c.is_empty())).collect();
    for table in &mut tables {
        let mut at = used.iter();
        table.retain(|_| at.next().copied().unwrap_or(false));
    }
    Ok(tables)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_is_thinned_and_keeps_gaps() {
        let time: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).filter(|t| !(0.395..0.595).contains(t)).collect();
        let grid = Grid::new(&time, 0.05);
        let rows: Vec<f64> = grid.times[..grid.rows() - APART].to_vec();
        assert_eq!(rows.len(), 20);
        for (k, t) in rows.iter().enumerate() {
            assert!(t.is_nan() == (8..12).contains(&k), "{k}: {t}");
            assert!(t.is_nan() || (t - 0.05 * k as f64).abs() < 1e-9, "{k}: {t}");
        }
        // The gap of a day does not become a day of rows.
        assert!(Grid::new(&[0.0, 0.1, 86_400.0], 0.1).rows() < 3 + 2 * APART + 1);
    }
}
