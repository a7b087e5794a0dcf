//! A model as a list of operations on numbers, in an order in which everything is computed before it is used.

use std::sync::Arc;

use phugoid_flight_dynamics::scalar::Scalar;

use super::axis::Place;
use super::deviation::{Move, Size};
use super::functions::{Binary, Unary, holds};
use super::gridded::Gridded;
use super::scattered::Scattered;

/// An operation on the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Number(f64),
    /// The value of a variable.
    Load(u32),
    Unary(Unary),
    Binary(Binary),
    /// Goes on at this operation.
    Jump(u32),
    /// The same where the number on the stack, which it takes away, is not true.
    JumpUnless(u32),
}

/// A table of a function.
#[derive(Clone, Debug)]
pub(super) enum Table {
    Gridded(Gridded),
    Scattered(Box<Scattered>),
}

/// How a variable is computed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// Operations from one position to another.
    Calculation { begin: u32, end: u32 },
    /// A table, and where the remembered intervals of its axes begin.
    Table { table: u32, hints: u32 },
}

/// One variable that is computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) variable: u32,
    pub(super) source: Source,
}

/// Limits of a variable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) lower: f64,
    pub(super) upper: f64,
}

impl Limits {
    /// The value within the limits; NaN stays NaN, and a limit has the derivative zero.
    fn applied<T: Scalar>(self, value: T) -> T {
        if value.real() < self.lower {
            T::from(self.lower)
        } else if value.real() > self.upper {
            T::from(self.upper)
        } else {
            value
        }
    }
}

/// All operations of a model.
#[derive(Clone, Debug, Default)]
pub(super) struct Program {
    pub(super) ops: Vec<Op>,
    pub(super) tables: Vec<Table>,
    pub(super) steps: Vec<Step>,
    /// One for each variable.
    pub(super) limits: Vec<Limits>,
    /// Values at the beginning, one for each variable; NaN where the file gives none.
    pub(super) initial: Vec<f64>,
    /// Whether a variable is computed, one for each.
    pub(super) computed: Vec<bool>,
    /// Variables that are set from outside.
    pub(super) free: Vec<u32>,
    /// Values that are not those of the file; none of a model as it is read.
    pub(super) moves: Vec<Move>,
    pub(super) stack: usize,
    pub(super) places: usize,
    pub(super) hints: usize,
}

/// Evaluates a model, again and again, without taking memory. Made by [`super::Model::evaluator`].
///
/// Numbers are in the units of the file. Set inputs, [`Evaluator::run`], read values; what is not set keeps its last
/// value, at the beginning that of the file, and NaN where the file gives none. With
/// [`Dual`](phugoid_flight_dynamics::scalar::Dual) numbers the derivatives are exact; of what is held at a limit or
/// constant in steps they are zero, and at a kink they are those of one side.
#[derive(Clone, Debug)]
pub struct Evaluator<T = f64> {
    program: Arc<Program>,
    room: Room<T>,
    /// The bounds of all moves, one after the other.
    bounds: Vec<T>,
}

/// What an evaluation is written to.
#[derive(Clone, Debug)]
struct Room<T> {
    /// What was set, before limits.
    set: Vec<T>,
    values: Vec<T>,
    stack: Vec<T>,
    places: Vec<Place<T>>,
    hints: Vec<u32>,
}

impl<T: Scalar> Evaluator<T> {
    pub(super) fn new(program: Arc<Program>) -> Self {
        let start: Vec<T> = program.initial.iter().map(|value| T::from(*value)).collect();
        let room = Room {
            set: start.clone(),
            values: start,
            stack: Vec::with_capacity(program.stack),
            places: vec![Place { index: 0, fraction: T::from(0.0) }; program.places],
            hints: vec![0; program.hints],
        };
        let bounds = Vec::with_capacity(program.moves.iter().map(|one| one.bounds.len()).sum());
        Self { program, room, bounds }
    }

    /// Sets the variable at this position of [`super::Model::variables`], in its unit, and answers whether it can be
    /// set: a computed variable, or a position beyond the last, cannot, and nothing changes.
    pub fn set(&mut self, variable: usize, value: T) -> bool {
        let free = self.program.computed.get(variable).is_some_and(|computed| !computed);
        if free {
            self.room.set[variable] = value;
        }
        free
    }

    /// Gives every input and constant the value that it has in the file, and NaN where it has none.
    pub fn reset(&mut self) {
        for (set, initial) in self.room.set.iter_mut().zip(&self.program.initial) {
            *set = T::from(*initial);
        }
    }

    /// Computes every variable from what was set. An input that is NaN makes NaN of all that is calculated or looked up
    /// with it; only a comparison with NaN is false, as always, so a `piecewise` may take another piece.
    pub fn run(&mut self) {
        let Self { program, room, bounds } = self;
        let moves = &program.moves;
        if moves.is_empty() {
            return room.pass(program, |_, value| value);
        }
        let sizes = || moves.iter().flat_map(|one| &one.bounds);
        if sizes().any(|size| matches!(size, Size::Variable(_))) {
            room.pass(program, |_, value| value);
        }
        bounds.clear();
        bounds.extend(sizes().map(|size| match *size {
            Size::Number(number) => T::from(number),
            Size::Variable(variable) => room.values[variable as usize],
        }));
        room.pass(program, |variable, value| {
            let mut first = 0;
            moves.iter().fold(value, |value, one| {
                let own = &bounds[first..first + one.bounds.len()];
                first += one.bounds.len();
                if one.variable as usize == variable { one.applied(value, own) } else { value }
            })
        });
    }

    /// The value of the variable at this position of [`super::Model::variables`] after the last [`Evaluator::run`], in
    /// its unit; NaN beyond the last variable.
    pub fn get(&self, variable: usize) -> T {
        self.room.values.get(variable).copied().unwrap_or_else(|| T::from(f64::NAN))
    }

    /// The values of all variables, in the order of [`super::Model::variables`], each in its unit.
    pub fn values(&self) -> &[T] {
        &self.room.values
    }
}

impl<T: Scalar> Room<T> {
    /// Computes every variable; each value, before its limits, is what `moved` makes of it.
    #[inline]
    fn pass(&mut self, program: &Program, moved: impl Fn(usize, T) -> T) {
        for &variable in &program.free {
            let variable = variable as usize;
            self.values[variable] = program.limits[variable].applied(moved(variable, self.set[variable]));
        }
        for step in &program.steps {
            let value = match step.source {
                Source::Calculation { begin, end } => calculate(program, begin, end, &self.values, &mut self.stack),
                Source::Table { table, hints } => {
                    let hints = &mut self.hints[hints as usize..];
                    match &program.tables[table as usize] {
                        Table::Gridded(gridded) => gridded.value(&self.values, &mut self.places, hints),
                        Table::Scattered(scattered) => scattered.value(&self.values, &mut hints[0]),
                    }
                }
            };
            let variable = step.variable as usize;
            self.values[variable] = program.limits[variable].applied(moved(variable, value));
        }
    }
}

/// The result of the operations from `begin` to `end`.
fn calculate<T: Scalar>(program: &Program, begin: u32, end: u32, values: &[T], stack: &mut Vec<T>) -> T {
    let nothing = || T::from(f64::NAN);
    stack.clear();
    let mut position = begin as usize;
    let end = end as usize;
    while position < end {
        let op = program.ops[position];
        position += 1;
        match op {
            Op::Number(number) => stack.push(T::from(number)),
            Op::Load(variable) => stack.push(values[variable as usize]),
            Op::Unary(function) => {
                if let Some(top) = stack.last_mut() {
                    *top = function.of(*top);
                }
            }
            Op::Binary(function) => {
                let second = stack.pop().unwrap_or_else(nothing);
                if let Some(top) = stack.last_mut() {
                    *top = function.of(*top, second);
                }
            }
            Op::Jump(target) => position = begin as usize + target as usize,
            Op::JumpUnless(target) => {
                if !stack.pop().is_some_and(holds) {
                    position = begin as usize + target as usize;
                }
            }
        }
    }
    stack.pop().unwrap_or_else(nothing)
}

/// An order of `count` variables in which each comes after those it needs, or a circle of variables. `needs` lists for
/// each variable what it needs; variables that are not computed need nothing.
pub(super) fn order(needs: &[Vec<usize>]) -> Result<Vec<usize>, Vec<usize>> {
    let mut waiting: Vec<usize> = needs.iter().map(Vec::len).collect();
    let mut users: Vec<Vec<usize>> = vec![Vec::new(); needs.len()];
    for (user, needed) in needs.iter().enumerate() {
        for &variable in needed {
            users[variable].push(user);
        }
    }
    let mut order: Vec<usize> = (0..needs.len()).filter(|variable| waiting[*variable] == 0).collect();
    let mut next = 0;
    while let Some(&variable) = order.get(next) {
        next += 1;
        for &user in &users[variable] {
            waiting[user] -= 1;
            if waiting[user] == 0 {
                order.push(user);
            }
        }
    }
    let Some(start) = (0..needs.len()).find(|variable| waiting[*variable] > 0) else { return Ok(order) };
    // Each variable that is left needs another that is left: following them leads into a circle.
    let mut place = vec![usize::MAX; needs.len()];
    let mut path = Vec::new();
    let mut variable = start;
    while place[variable] == usize::MAX {
        place[variable] = path.len();
        path.push(variable);
        match needs[variable].iter().find(|needed| waiting[**needed] > 0) {
            Some(&needed) => variable = needed,
            None => break,
        }
    }
    path.push(variable);
    Err(path.split_off(place[variable]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_has_each_variable_after_what_it_needs() {
        assert_eq!(order(&[vec![1, 2], vec![2], vec![]]), Ok(vec![2, 1, 0]));
        assert_eq!(order(&[vec![3], vec![2], vec![1], vec![]]), Err(vec![1, 2, 1]));
        assert_eq!(order(&[vec![0]]), Err(vec![0, 0]));
        assert_eq!(order(&[vec![1], vec![2], vec![1]]), Err(vec![1, 2, 1]));
    }
}
