//! Whether a flight can tell that a term is another one before and after a moment.

use crate::core::options::CAPACITY;
use crate::judge::constancy::{ALIKE, MATERIAL, MOVING};
use crate::judge::equations::{BLOCK_S, ByBlock, Equations};
use crate::judge::normal::Normal;
use crate::methods::{Run, Task};
use crate::model_file::Role;
use crate::motion::MotionModel;

/// A derivative has to change the motion of its coefficient by this part of what the largest term makes of it, as a derivative
/// that a flight is asked for has to.
const SHARE: f64 = 0.05;

/// Of each column of a run, what the motion on both sides of a moment allows to say.
pub(crate) struct BothSides {
    columns: Vec<Option<Side>>,
    /// What the database of the model has in the place of each column: the derivative is that and the increment.
    database: Vec<f64>,
}

/// Of one column, in the equation in which its change shows most.
#[derive(Clone, Copy, Debug)]
struct Side {
    is_constant: bool,
    /// The regressor moves as in a manoeuvre on both sides, and on neither much less than on the other.
    is_alike: bool,
    /// Motion of the equation that one unit of the parameter makes, as a part of that by the largest term.
    reach: f64,
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
        let database: Vec<f64> = task.prepared.database_parts.iter().map(|part| part.value).collect();
        let of_database = |j: usize| places.get(j).and_then(|place| database.get(*place)).copied().unwrap_or(0.0);
        let mut columns: Vec<Option<Side>> = vec![None; run.columns.len()];
        for equation in equations.by_block() {
            if split < 1.0 || split >= equation.sums.len() as f64 {
                continue;
            }
            let constant = |j: usize| equations.columns[equation.used[j]].term.is_constant();
            let value = |j: usize| equation.values[j] + of_database(equation.used[j]);
            for (j, side) in sides(&equation, split as usize, &constant, &value).into_iter().enumerate() {
                let Some(column) = places.get(equation.used[j]).and_then(|place| columns.get_mut(*place)) else {
                    continue;
                };
                let Some(side) = side else { continue };
                if column.is_none_or(|known| side.is_alike && (!known.is_alike || side.reach > known.reach)) {
                    *column = Some(side);
                }
            }
        }
        Some(Self { columns, database })
    }

    /// Whether a change of a column from one value to another is one that the flight can tell: a derivative by more than what
    /// missing terms make, a constant against the motion of its coefficient.
    pub(crate) fn tells(&self, column: usize, before: f64, after: f64) -> bool {
        let Some(side) = self.columns.get(column).copied().flatten() else { return false };
        let change = (after - before).abs();
        let database = self.database.get(column).copied().unwrap_or(0.0);
        let larger = (before + database).abs().max((after + database).abs());
        let counts = change * side.reach;
        let is_material = if side.is_constant { counts >= MATERIAL } else { change >= MATERIAL * larger };
        side.is_alike && counts >= SHARE && is_material
    }
}

/// What each regressor of an equation tells on both sides of a block; `None` where it cannot be told from the others. `value` is the
/// whole derivative.
fn sides(
    equation: &ByBlock,
    split: usize,
    is_constant: &dyn Fn(usize) -> bool,
    value: &dyn Fn(usize) -> f64,
) -> Vec<Option<Side>> {
    let u = equation.used.len();
    let groups = Normal::groups(equation, 1);
    let sum = |groups: &[Normal]| groups.iter().fold(Normal::zeros(u), |sum, group| sum.plus(group, 1.0)).motion();
    let Some((before, after)) = sum(&groups[..split]).zip(sum(&groups[split..])) else { return vec![None; u] };
    let less = |j: usize| before[j].min(after[j]);
    let moved = |j: usize| value(j).abs() * less(j).sqrt();
    let largest = (0..u).filter(|j| !is_constant(*j)).map(moved).fold(0.0, f64::max);
    let side = |j: usize| {
        let more = before[j].max(after[j]);
        let (first, second) = equation.moving[j].split_at(split);
        let moves = [first, second].iter().all(|side| side.iter().filter(|moves| **moves).count() >= MOVING);
        (more > 0.0 && largest > 0.0).then(|| Side {
            is_constant: is_constant(j),
            is_alike: less(j) >= ALIKE * more && (moves || is_constant(j)),
            reach: less(j).sqrt() / largest,
        })
    };
    (0..u).map(side).collect()
}
