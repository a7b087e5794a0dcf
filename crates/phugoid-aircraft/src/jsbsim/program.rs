//! Functions of an aircraft as one list of operations on registers, without the properties that stand between them.
//!
//! [`Symbolic`](super::symbolic::Symbolic) makes them. An operation computes what the functions would compute, in the same order
//! and with the same rounding; what two functions share is computed once, and what does not depend on the inputs not at all.

use super::function::{Action, apply};
use super::table::{Table, place_from};

/// Where a number is kept.
pub(super) type Register = u32;

/// How a number follows from others. Tables of one and two variables use the place of each variable among its keys, which
/// tables with the same keys share.
#[derive(Debug, Clone, Copy)]
pub(super) enum Operation {
    /// Sum.
    Add(Register, Register),
    /// The first less the second.
    Subtract(Register, Register),
    /// Product.
    Multiply(Register, Register),
    /// Sum of a range of the arguments, from the first on.
    Sum(u32, u32),
    /// Product of a range of the arguments, from the first on.
    Product(u32, u32),
    /// The first over the second, infinite where that is 0.
    Divide(Register, Register),
    /// An action of one number.
    One(Action, Register),
    /// An action of two numbers.
    Two(Action, [Register; 2]),
    /// An action of three numbers.
    Three(Action, [Register; 3]),
    /// An action of a range of the arguments.
    Many(Action, u32, u32),
    /// Finds the place of a number among a range of the numbers.
    Locate { keys: [u32; 2], x: Register },
    /// Interpolates in the pairs from `values` on, each of a number and of what the next row has more.
    Linear { values: u32, row: u32 },
    /// The same by rows of `width` numbers.
    Bilinear { values: u32, width: u32, row: u32, column: u32 },
    /// The value of a table of three variables.
    Table { table: u32, at: [Register; 3] },
}

/// An operation and the register that it writes; that of a place for [`Operation::Locate`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Instruction {
    pub(super) to: Register,
    pub(super) operation: Operation,
}

/// Instructions in order, and the numbers that they refer to.
#[derive(Debug, Clone, Default)]
pub(super) struct Program {
    pub(super) instructions: Vec<Instruction>,
    /// What the registers hold before the first run: constants in their places, 0 elsewhere.
    pub(super) initial: Vec<f64>,
    /// Keys of tables.
    pub(super) numbers: Vec<f64>,
    /// Values of tables, each with what the next row has more, and 0 in the last row.
    pub(super) pairs: Vec<[f64; 2]>,
    pub(super) arguments: Vec<Register>,
    /// Tables of three variables.
    pub(super) tables: Vec<Table>,
    /// Number of places.
    pub(super) places: usize,
}

/// Numbers of one program.
#[derive(Debug, Clone)]
pub(super) struct Registers {
    pub(super) values: Vec<f64>,
    /// Interval among some keys, and how far in it from 0 to 1. An interval that was found before is looked at first.
    places: Vec<(usize, f64)>,
    arguments: Vec<f64>,
}

impl Program {
    /// Registers in which no input is set.
    pub(super) fn registers(&self) -> Registers {
        Registers { values: self.initial.clone(), places: vec![(0, 0.0); self.places], arguments: Vec::new() }
    }

    /// Computes everything.
    pub(super) fn run(&self, registers: &mut Registers) {
        self.run_some(&self.instructions, registers);
    }

    /// Computes what some instructions of it give.
    pub(super) fn run_some(&self, instructions: &[Instruction], registers: &mut Registers) {
        let Registers { values, places, arguments } = registers;
        let (values, places) = (values.as_mut_slice(), places.as_mut_slice());
        let numbers = self.numbers.as_slice();
        // At a row, a share of the way to the next one; of the last row there is none, and its share is 0.
        let along = |pair: usize, share: f64| match self.pairs.get(pair) {
            Some(&[first, more]) => first + share * more,
            None => f64::NAN,
        };
        for instruction in instructions {
            let value = |register: Register| values[register as usize];
            let result = match instruction.operation {
                Operation::Add(a, b) => value(a) + value(b),
                Operation::Subtract(a, b) => value(a) - value(b),
                Operation::Multiply(a, b) => value(a) * value(b),
                Operation::Sum(start, end) => {
                    let from = &self.arguments[start as usize..end as usize];
                    from.iter().fold(0.0, |sum, &register| sum + value(register))
                }
                Operation::Product(start, end) => {
                    let from = &self.arguments[start as usize..end as usize];
                    from.iter().fold(1.0, |product, &register| product * value(register))
                }
                Operation::Divide(a, b) => {
                    let below = value(b);
                    if below == 0.0 { f64::INFINITY } else { value(a) / below }
                }
                Operation::One(action, a) => apply(action, &[value(a)]),
                Operation::Two(action, from) => apply(action, &from.map(value)),
                Operation::Three(action, from) => apply(action, &from.map(value)),
                Operation::Many(action, start, end) => {
                    arguments.clear();
                    let from = &self.arguments[start as usize..end as usize];
                    arguments.extend(from.iter().map(|&register| values[register as usize]));
                    apply(action, arguments)
                }
                Operation::Locate { keys: [start, end], x } => {
                    let place = &mut places[instruction.to as usize];
                    *place = place_from(&numbers[start as usize..end as usize], values[x as usize], place.0);
                    continue;
                }
                Operation::Linear { values, row } => {
                    let (row, share) = places[row as usize];
                    along(values as usize + row, share)
                }
                Operation::Bilinear { values, width, row, column } => {
                    let ((row, row_share), (column, column_share)) = (places[row as usize], places[column as usize]);
                    let start = values as usize + row * width as usize + column;
                    let first = along(start, row_share);
                    if column_share == 0.0 {
                        first
                    } else {
                        first + column_share * (along(start + 1, row_share) - first)
                    }
                }
                Operation::Table { table, at } => self.tables[table as usize].value(at.map(value)),
            };
            values[instruction.to as usize] = result;
        }
    }

    /// The instructions whose result depends on some registers, in order.
    pub(super) fn depending_on(&self, changed: &[Register]) -> Vec<Instruction> {
        let mut moved = vec![false; self.initial.len()];
        let mut moved_places = vec![false; self.places];
        for &register in changed {
            moved[register as usize] = true;
        }
        let mut found = Vec::new();
        for instruction in &self.instructions {
            let any = |from: &[Register]| from.iter().any(|&register| moved[register as usize]);
            let depends = match instruction.operation {
                Operation::Add(a, b)
                | Operation::Subtract(a, b)
                | Operation::Multiply(a, b)
                | Operation::Divide(a, b) => any(&[a, b]),
                Operation::One(_, a) => any(&[a]),
                Operation::Two(_, from) => any(&from),
                Operation::Three(_, from) | Operation::Table { at: from, .. } => any(&from),
                Operation::Sum(start, end) | Operation::Product(start, end) | Operation::Many(_, start, end) => {
                    any(&self.arguments[start as usize..end as usize])
                }
                Operation::Locate { x, .. } => any(&[x]),
                Operation::Linear { row, .. } => moved_places[row as usize],
                Operation::Bilinear { row, column, .. } => moved_places[row as usize] || moved_places[column as usize],
            };
            if depends {
                let of_place = matches!(instruction.operation, Operation::Locate { .. });
                let moved = if of_place { &mut moved_places } else { &mut moved };
                moved[instruction.to as usize] = true;
                found.push(*instruction);
            }
        }
        found
    }
}
