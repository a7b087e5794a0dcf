//! Whether a flight can tell that a term is another one before and after a moment.

use nalgebra::{DMatrix, DVector};

use crate::core::options::CAPACITY;
use crate::judge::equations::{ByBlock, Equations};
use crate::judge::normal::Normal;
use crate::methods::{Run, Task};
use crate::model_file::Role;
use crate::motion::MotionModel;

/// A change counts where the two values differ by this part of the larger one: terms that a model lacks make less.
pub(super) const MATERIAL: f64 = 0.25;
/// The regressor has to move by this part as much (in mean squares) on the side on which it moves less, and in this many
/// blocks as in a manoeuvre at the least: the noise of the measurements, and gusts that the vane does not see, make the value of one
/// that hardly moves too small.
const ALIKE: f64 = 0.2;
const MOVING: usize = 1;
/// A derivative has to change the motion of its coefficient by this part of what the largest term makes of it, as a derivative
/// that a flight is asked for has to.
const SHARE: f64 = 0.05;

/// A constant that changes alone has to make this part of what the largest derivative of its coefficient makes about its mean: where
/// nothing changes, terms that a model lacks make 0.03 of it in flights whose evidence counts, and trim shifts of a degree of elevator 0.2
/// and more (docs/methods.md, looking back).
const TRIM_SHIFT: f64 = 0.15;

/// Whether two values of a derivative differ by more than missing terms make.
pub(super) fn is_material(before: f64, after: f64) -> bool {
    (after - before).abs() >= MATERIAL * before.abs().max(after.abs())
}

/// Whether a regressor moves on neither side much less than on the other, in mean squares of what the others do not share.
pub(super) fn is_alike([before, after]: [f64; 2]) -> bool {
    let more = before.max(after);
    more > 0.0 && before.min(after) >= ALIKE * more
}

/// Whether a regressor, of which is given in which blocks it moves, does so on both sides of a block.
pub(super) fn moves_on_both_sides(moving: &[bool], split: usize) -> bool {
    let (before, after) = moving.split_at(split.min(moving.len()));
    [before, after].iter().all(|side| side.iter().filter(|moves| **moves).count() >= MOVING)
}

/// The values of all terms of an equation together are others where they make this part of its motion another one: where nothing changes,
/// terms that a model lacks make at most 0.21 of it, and damages whose parts cannot be told apart 0.30 and more (docs/methods.md, looking
/// back).
const CHANGED: f64 = 0.3;

/// Of each column of a run, what the motion on both sides of a moment allows to say.
pub(crate) struct BothSides {
    columns: Vec<Option<Side>>,
    equations: Vec<Moved>,
}

/// The regressors of an equation on both sides of a moment.
struct Moved {
    /// The column of the run of each regressor.
    columns: Vec<usize>,
    /// Mean products of the regressors before and after, without what they share with the constant.
    sides: [DMatrix<f64>; 2],
}

impl Moved {
    /// `places` are the columns of the run by those of the equations.
    fn of(equation: &ByBlock, split: usize, places: &[usize], is_constant: &dyn Fn(usize) -> bool) -> Self {
        let u = equation.used.len();
        let constant = (0..u).find(|j| is_constant(*j));
        let mean = |blocks: &[DMatrix<f64>], samples: &[f64]| {
            let sum = blocks.iter().fold(DMatrix::zeros(u, u), |sum, block| sum + block.view((0, 0), (u, u)));
            let mean = sum / samples.iter().sum::<f64>().max(1.0);
            match constant.filter(|c| mean[(*c, *c)] > 0.0) {
                Some(c) => DMatrix::from_fn(u, u, |a, b| mean[(a, b)] - mean[(a, c)] * mean[(c, b)] / mean[(c, c)]),
                None => mean,
            }
        };
        let (before, after) = equation.sums.split_at(split);
        let (samples_before, samples_after) = equation.samples.split_at(split);
        let columns = equation.used.iter().map(|used| places.get(*used).copied().unwrap_or(usize::MAX)).collect();
        Self { columns, sides: [mean(before, samples_before), mean(after, samples_after)] }
    }

    /// The part of the motion that is another one with the second of two values of each column, on the side on which that is less;
    /// zero where one side moves much less than the other.
    fn changed(&self, values: &dyn Fn(usize) -> [f64; 2]) -> f64 {
        let values: Vec<[f64; 2]> = self.columns.iter().map(|column| values(*column)).collect();
        let square = |side: &DMatrix<f64>, of: &dyn Fn([f64; 2]) -> f64| {
            let values = DVector::from_iterator(values.len(), values.iter().map(|pair| of(*pair)));
            (side * &values).dot(&values).max(0.0)
        };
        let of_side = |side: &DMatrix<f64>| {
            let moved = square(side, &|[before, _]| before).max(square(side, &|[_, after]| after));
            [moved, square(side, &|[before, after]| after - before)]
        };
        let [before, after] = self.sides.each_ref().map(of_side);
        let part = |[moved, change]: [f64; 2]| (change / moved).sqrt();
        if is_alike([before[0], after[0]]) { part(before).min(part(after)) } else { 0.0 }
    }
}

/// Of one column, in the equation in which its change shows most.
#[derive(Clone, Copy, Debug)]
struct Side {
    is_constant: bool,
    /// The regressor moves as in a manoeuvre on both sides, and on neither much less than on the other.
    is_alike: bool,
    /// Motion of the equation that one unit of the parameter makes, as a part of that by the largest term.
    reach: f64,
    /// What one unit of a constant makes of the equation, as a part of what the largest derivative makes about its mean; zero for
    /// a derivative.
    shift: f64,
}

impl BothSides {
    /// `None` where the equations of motion cannot be formed, or the moment is not within the record.
    pub(crate) fn of<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
        task: &Task<M, N, R>,
        run: &Run<R>,
        time_s: f64,
    ) -> Option<Self> {
        let equations = Equations::of(task, run)?;
        let split = equations.blocks_before(time_s);
        let is_term = |role: &Role| !matches!(role, Role::Bias(_));
        let places: Vec<usize> =
            task.file.estimated().enumerate().filter(|(_, p)| is_term(&p.role)).map(|(column, _)| column).collect();
        let mut columns: Vec<Option<Side>> = vec![None; run.columns.len()];
        let mut moved = Vec::new();
        for equation in equations.by_block() {
            if split < 1 || split >= equation.sums.len() {
                continue;
            }
            let constant = |j: usize| equations.columns[equation.used[j]].term.is_constant();
            moved.push(Moved::of(&equation, split, &places, &constant));
            for (j, side) in sides(&equation, split, &constant).into_iter().enumerate() {
                let Some(column) = places.get(equation.used[j]).and_then(|place| columns.get_mut(*place)) else {
                    continue;
                };
                let Some(side) = side else { continue };
                let shift = column.map_or(side.shift, |known| known.shift.max(side.shift));
                if column.is_none_or(|known| side.is_alike && (!known.is_alike || side.reach > known.reach)) {
                    *column = Some(side);
                }
                if let Some(column) = column {
                    column.shift = shift;
                }
            }
        }
        Some(Self { columns, equations: moved })
    }

    /// Whether the terms of an equation, with the second of two values of each column, move the aircraft otherwise than with the
    /// first, by more than missing terms make. It does not matter which of them it is: where elevator, pitch rate and angle of attack
    /// moved together, a record knows what half a tail makes of the pitching moment, and of none of the three by itself.
    pub(crate) fn moves_otherwise(&self, values: &dyn Fn(usize) -> [f64; 2]) -> bool {
        self.equations.iter().any(|equation| equation.changed(values) >= CHANGED)
    }

    /// Whether a change of a column from one value to another is one that the flight can tell: a derivative by more than what
    /// missing terms make, a constant against the motion of its coefficient.
    pub(crate) fn tells(&self, column: usize, before: f64, after: f64) -> bool {
        let Some(side) = self.columns.get(column).copied().flatten() else { return false };
        let change = (after - before).abs();
        let counts = change * side.reach;
        let is_large = if side.is_constant { counts >= MATERIAL } else { is_material(before, after) };
        side.is_alike && counts >= SHARE && is_large
    }

    /// Whether another value of a constant, with everything else as it was, moves the aircraft by more than missing terms do.
    pub(crate) fn is_trim_shift(&self, column: usize, before: f64, after: f64) -> bool {
        let side = self.columns.get(column).copied().flatten();
        side.is_some_and(|side| (after - before).abs() * side.shift >= TRIM_SHIFT)
    }
}

/// What one unit of a constant makes of an equation, as a part of what the largest derivative makes about its mean.
fn shift(equation: &ByBlock, constant: usize) -> f64 {
    let sum = |a: usize, b: usize| equation.sums.iter().map(|block| block[(a, b)]).sum::<f64>();
    let own = sum(constant, constant);
    let about_mean = |j: usize| {
        let both = sum(j, constant);
        equation.values[j].abs() * (sum(j, j) - both * both / own).max(0.0).sqrt()
    };
    let largest = (0..equation.used.len()).filter(|j| *j != constant).map(about_mean).fold(0.0, f64::max);
    if largest > 0.0 { own.sqrt() / largest } else { 0.0 }
}

/// What each regressor of an equation tells on both sides of a block; `None` where it cannot be told from the others.
fn sides(equation: &ByBlock, split: usize, is_constant: &dyn Fn(usize) -> bool) -> Vec<Option<Side>> {
    let u = equation.used.len();
    let groups = Normal::groups(equation, 1);
    let motion = |groups: &[Normal]| Normal::sum(u, groups).motion();
    let Some((before, after)) = motion(&groups[..split]).zip(motion(&groups[split..])) else { return vec![None; u] };
    let less = |j: usize| before[j].min(after[j]);
    let moved = |j: usize| equation.values[j].abs() * less(j).sqrt();
    let largest = (0..u).filter(|j| !is_constant(*j)).map(moved).fold(0.0, f64::max);
    let side = |j: usize| {
        let motion = [before[j], after[j]];
        let moves = is_constant(j) || moves_on_both_sides(&equation.moving[j], split);
        (motion != [0.0; 2] && largest > 0.0).then(|| Side {
            is_constant: is_constant(j),
            is_alike: is_alike(motion) && moves,
            reach: less(j).sqrt() / largest,
            shift: if is_constant(j) { shift(equation, j) } else { 0.0 },
        })
    };
    (0..u).map(side).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constant and two regressors of which the second is nearly the first, in six blocks of a second; the motion of the last three
    /// is `after` times as large.
    fn equation(after: f64) -> ByBlock {
        let block = |size: f64| {
            let row = |k: usize| {
                let phase = std::f64::consts::TAU * k as f64 / 50.0;
                DVector::from_row_slice(&[1.0, size * phase.sin(), size * (phase.sin() + 0.1 * phase.cos()), 0.0])
            };
            (0..50).map(row).fold(DMatrix::zeros(4, 4), |sum, row| sum + &row * row.transpose())
        };
        ByBlock {
            used: vec![0, 1, 2],
            values: vec![0.5, 1.0, 1.0],
            sums: [1.0, 1.0, 1.0, after, after, after].map(block).to_vec(),
            samples: vec![50.0; 6],
            moving: vec![vec![true; 6]; 3],
        }
    }

    fn changed(after: f64, values: [[f64; 2]; 3]) -> f64 {
        Moved::of(&equation(after), 3, &[0, 1, 2], &|j| j == 0).changed(&|column| values[column])
    }

    #[test]
    fn what_terms_make_together_is_compared_and_not_what_each_makes() {
        // Half of all motion; the constant does not count.
        assert!((changed(1.0, [[0.5, 3.0], [1.0, 0.5], [1.0, 0.5]]) - 0.5).abs() < 1e-9);
        // From one regressor to its likeness: 0.1 cos of sin + sin + 0.1 cos, though each is another one by all of it.
        let moved = changed(1.0, [[0.5, 0.5], [1.0, 2.0], [1.0, 0.0]]);
        assert!((moved - 0.1 / 4.01_f64.sqrt()).abs() < 1e-3, "{moved}");
        // A side that hardly moves says nothing.
        assert_eq!(changed(0.3, [[0.5, 0.5], [1.0, 0.5], [1.0, 0.5]]), 0.0);
        // Nothing moves at all.
        assert_eq!(changed(1.0, [[0.5, 0.5], [0.0, 0.0], [0.0, 0.0]]), 0.0);
    }
}
