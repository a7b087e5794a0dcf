//! Whether a flight can tell that a term is another one before and after a moment.

use crate::core::options::CAPACITY;
use crate::judge::equations::{BLOCK_S, ByBlock, Equations};
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

/// Of each column of a run, what the motion on both sides of a moment allows to say.
pub(crate) struct BothSides {
    columns: Vec<Option<Side>>,
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
        let split = ((time_s - equations.start_s()) / BLOCK_S).round();
        let is_term = |role: &Role| !matches!(role, Role::Bias(_));
        let places: Vec<usize> =
            task.file.estimated().enumerate().filter(|(_, p)| is_term(&p.role)).map(|(column, _)| column).collect();
        let mut columns: Vec<Option<Side>> = vec![None; run.columns.len()];
        for equation in equations.by_block() {
            if split < 1.0 || split >= equation.sums.len() as f64 {
                continue;
            }
            let constant = |j: usize| equations.columns[equation.used[j]].term.is_constant();
            for (j, side) in sides(&equation, split as usize, &constant).into_iter().enumerate() {
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
        Some(Self { columns })
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
