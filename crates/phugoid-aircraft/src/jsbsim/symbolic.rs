//! Makes programs of functions: carries them out with names of numbers in place of numbers.

use std::collections::HashMap;

use super::function::{Action, Op, apply};
use super::model::{Link, Model, State};
use super::program::{Instruction, Operation, Program, Register};
use super::table::Table;

/// The name of a number: what it is computed from.
pub(crate) type Name = usize;

/// How a number follows from others, each before it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Node {
    Input,
    /// Bits of a constant.
    Constant(u64),
    Apply(Action, Box<[Name]>),
    /// Place of a number among the keys of a table: its rows (`false`) or its columns. Tables with the same keys are one here.
    Place(Keys, Name),
    /// Value of a table of one or two variables, by its places.
    Value(usize, Name, Option<Name>),
    /// Value of a table of three variables.
    Table(usize, [Name; 3]),
}

/// The first table that has some keys, and whether they are its columns.
type Keys = (usize, bool);

/// The properties of a model, each the name of a number; its functions are carried out as [`State`] does.
#[derive(Debug)]
pub(crate) struct Symbolic<'a> {
    model: &'a Model,
    /// What properties hold that nothing here has written.
    state: &'a State,
    nodes: Vec<Node>,
    known: HashMap<Node, Name>,
    keys: HashMap<Box<[u64]>, Keys>,
    written: HashMap<usize, Name>,
    held: HashMap<usize, Name>,
    /// Results of functions, each with the number of changes of properties until then.
    called: HashMap<usize, (usize, Name)>,
    changes: usize,
}

impl<'a> Symbolic<'a> {
    /// Where every property is what a state holds.
    pub(super) fn new(model: &'a Model, state: &'a State) -> Self {
        Self {
            model,
            state,
            nodes: Vec::new(),
            known: HashMap::new(),
            keys: HashMap::new(),
            written: HashMap::new(),
            held: HashMap::new(),
            called: HashMap::new(),
            changes: 0,
        }
    }

    fn node(&mut self, node: Node) -> Name {
        if let Some(&found) = self.known.get(&node) {
            return found;
        }
        self.nodes.push(node.clone());
        let made = self.nodes.len() - 1;
        self.known.insert(node, made);
        made
    }

    /// A number that is set before each run.
    pub(super) fn input(&mut self) -> Name {
        self.nodes.push(Node::Input);
        self.nodes.len() - 1
    }

    /// A number that never changes.
    pub(super) fn constant(&mut self, value: f64) -> Name {
        self.node(Node::Constant(value.to_bits()))
    }

    fn value_of(&self, name: Name) -> Option<f64> {
        match self.nodes[name] {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// The result of an action.
    pub(super) fn apply(&mut self, action: Action, arguments: &[Name]) -> Name {
        let constants: Option<Vec<f64>> = arguments.iter().map(|&name| self.value_of(name)).collect();
        if let Some(constants) = constants {
            return self.constant(apply(action, &constants));
        }
        let first = arguments.first().and_then(|&name| self.value_of(name));
        match (action, arguments, first) {
            // One after the other, so that what functions begin with in common is computed once.
            (Action::Sum | Action::Difference | Action::Product, [first, rest @ ..], _) if rest.len() != 1 => {
                rest.iter().fold(*first, |sum, &next| self.apply(action, &[sum, next]))
            }
            (Action::Product, [_, other], Some(1.0)) => *other,
            (Action::IfThen | Action::Switch, [_, rest @ ..], Some(choice)) => {
                // Which of them is chosen, by their numbers.
                let numbers: Vec<f64> = (0..rest.len()).map(|number| number as f64).collect();
                let chosen = apply(action, &[&[choice], numbers.as_slice()].concat());
                if chosen.is_nan() { self.constant(f64::NAN) } else { rest[chosen as usize] }
            }
            _ => self.node(Node::Apply(action, arguments.into())),
        }
    }

    /// What a property holds, as [`State::read`].
    pub(super) fn read(&mut self, index: usize) -> Name {
        if let Some(function) = self.model.properties[index].function {
            return self.call(function);
        }
        match self.written.get(&index) {
            Some(&name) => name,
            None => self.constant(self.state.held_by(index)),
        }
    }

    /// Sets a property and what is tied to it, as [`State::write`].
    pub(super) fn write(&mut self, index: usize, name: Name) {
        let property = &self.model.properties[index];
        if property.function.is_some() {
            return;
        }
        self.put(index, name);
        let degrees = !property.links.is_empty() && property.name.ends_with("-deg");
        for &(other, link) in &property.links {
            let along = match link {
                Link::Times(factor) => {
                    let factor = self.constant(factor);
                    self.apply(Action::Product, &[factor, name])
                }
                Link::Magnitude => {
                    let radians = if degrees { self.apply(Action::ToRadians, &[name]) } else { name };
                    self.apply(Action::Abs, &[radians])
                }
            };
            self.put(other, along);
        }
    }

    fn put(&mut self, index: usize, name: Name) {
        if self.written.insert(index, name) != Some(name) {
            self.changes += 1;
        }
    }

    /// The value of a function, as [`State::call`].
    pub(super) fn call(&mut self, function: usize) -> Name {
        if let Some(&held) = self.held.get(&function) {
            return held;
        }
        let before = self.changes;
        if let Some(&(changes, name)) = self.called.get(&function)
            && changes == before
        {
            return name;
        }
        let model = self.model;
        let mut stack: Vec<Name> = Vec::new();
        for op in &model.functions[function].ops {
            let value = match *op {
                Op::Constant(value) => self.constant(value),
                Op::Property(index, sign) => self.signed(index, sign),
                Op::Table(table) => self.look_up(table),
                Op::Apply(action, count) => {
                    let arguments = stack.split_off(stack.len().saturating_sub(count));
                    self.apply(action, &arguments)
                }
            };
            stack.push(value);
        }
        let name = match stack.last() {
            Some(&last) => last,
            None => self.constant(f64::NAN),
        };
        if let Some(copy) = model.functions[function].copy {
            self.write(copy, name);
        }
        if self.changes == before {
            self.called.insert(function, (before, name));
        }
        name
    }

    fn signed(&mut self, index: usize, sign: f64) -> Name {
        let (sign, name) = (self.constant(sign), self.read(index));
        self.apply(Action::Product, &[sign, name])
    }

    /// The value of a table at its properties.
    fn look_up(&mut self, table: usize) -> Name {
        let lookup = &self.model.tables[table];
        let mut at = [None; 3];
        for (name, variable) in at.iter_mut().zip(lookup.variables) {
            *name = variable.map(|(index, sign)| self.signed(index, sign));
        }
        let zero = self.constant(0.0);
        let at = at.map(|name| name.unwrap_or(zero));
        let constants = at.map(|name| self.value_of(name));
        if let [Some(x), Some(y), Some(z)] = constants {
            return self.constant(lookup.table.value([x, y, z]));
        }
        match lookup.table.flat() {
            None => self.node(Node::Table(table, at)),
            Some((rows, columns, _)) => {
                let row = self.place(table, false, rows, at[0]);
                let column = (!columns.is_empty()).then(|| self.place(table, true, columns, at[1]));
                self.node(Node::Value(table, row, column))
            }
        }
    }

    fn place(&mut self, table: usize, columns: bool, keys: &[f64], x: Name) -> Name {
        let bits = keys.iter().map(|key| key.to_bits()).collect();
        let keys = *self.keys.entry(bits).or_insert((table, columns));
        self.node(Node::Place(keys, x))
    }

    /// Computes functions in order, each once, as [`State::hold`] without the values from before.
    pub(super) fn hold(&mut self, functions: &[usize]) {
        for function in functions {
            self.held.remove(function);
        }
        for &function in functions {
            let name = self.call(function);
            self.held.insert(function, name);
        }
    }

    /// The sum of functions; 0 of none.
    pub(super) fn total(&mut self, functions: &[usize]) -> Name {
        let names: Vec<Name> = functions.iter().map(|&function| self.call(function)).collect();
        if names.is_empty() { self.constant(0.0) } else { self.apply(Action::Sum, &names) }
    }

    /// A program that computes some numbers from inputs, with the registers of both; none for an input that no number depends on.
    pub(super) fn program(&self, inputs: &[Name], outputs: &[Name]) -> (Program, Vec<Option<Register>>, Vec<Register>) {
        let mut needed = vec![false; self.nodes.len()];
        for &name in outputs {
            needed[name] = true;
        }
        for name in (0..self.nodes.len()).rev() {
            if needed[name] {
                self.sources(name).into_iter().for_each(|source| needed[source] = true);
            }
        }
        let chains = self.chains(&needed, outputs);
        let mut building = Building::default();
        let mut registers = vec![Register::MAX; self.nodes.len()];
        for name in (0..self.nodes.len()).filter(|&name| needed[name]) {
            match &chains[name] {
                Chain::Inside => {}
                Chain::None => registers[name] = building.add(self.model, &self.nodes[name], &registers),
                Chain::Whole(action, links) => registers[name] = building.add_chain(*action, links, &registers),
            }
        }
        let inputs = inputs.iter().map(|&name| needed[name].then_some(registers[name])).collect();
        (building.program, inputs, outputs.iter().map(|&name| registers[name]).collect())
    }

    /// Sums of sums and products of products, of which only the last is used, are one chain.
    fn chains(&self, needed: &[bool], outputs: &[Name]) -> Vec<Chain> {
        let mut uses = vec![0_usize; self.nodes.len()];
        for &output in outputs {
            // Not inside a chain, whatever else uses it.
            uses[output] += 2;
        }
        for name in (0..self.nodes.len()).filter(|&name| needed[name]) {
            self.sources(name).into_iter().for_each(|source| uses[source] += 1);
        }
        let pair = |name: Name| match &self.nodes[name] {
            Node::Apply(action @ (Action::Sum | Action::Product), from) => match from.as_ref() {
                [a, b] => Some((*action, [*a, *b])),
                _ => None,
            },
            _ => None,
        };
        let mut chains: Vec<Chain> = self.nodes.iter().map(|_| Chain::None).collect();
        for name in (0..self.nodes.len()).filter(|&name| needed[name]) {
            let Some((action, [first, last])) = pair(name) else { continue };
            if uses[first] != 1 {
                continue;
            }
            let links = match (std::mem::replace(&mut chains[first], Chain::Inside), pair(first)) {
                (Chain::Whole(before, mut links), _) if before == action => {
                    links.push(last);
                    links
                }
                (Chain::None, Some((before, [a, b]))) if before == action => vec![a, b, last],
                (other, _) => {
                    chains[first] = other;
                    continue;
                }
            };
            chains[name] = Chain::Whole(action, links);
        }
        chains
    }

    fn sources(&self, name: Name) -> Vec<Name> {
        match &self.nodes[name] {
            Node::Input | Node::Constant(_) => Vec::new(),
            Node::Apply(_, from) => from.to_vec(),
            Node::Place(_, x) => vec![*x],
            Node::Value(_, row, column) => column.iter().chain([row]).copied().collect(),
            Node::Table(_, at) => at.to_vec(),
        }
    }
}

/// What a node is of a chain of sums or of products.
#[derive(Debug)]
enum Chain {
    None,
    /// Only the next one of the chain uses it.
    Inside,
    /// The last, with all numbers that the chain goes through.
    Whole(Action, Vec<Name>),
}

/// A program in the making.
#[derive(Default)]
struct Building {
    program: Program,
    /// Where keys and values of tables are among its numbers.
    keys: HashMap<Keys, [u32; 2]>,
    values: HashMap<usize, u32>,
}

impl Building {
    /// Adds a node; gives its register, or the number of its place.
    fn add(&mut self, model: &Model, node: &Node, registers: &[Register]) -> Register {
        let register = |name: &Name| registers[*name];
        let operation = match node {
            Node::Input => return self.register(0.0),
            Node::Constant(bits) => return self.register(f64::from_bits(*bits)),
            Node::Apply(action, from) => match (*action, from.as_ref()) {
                (Action::Sum, [a, b]) => Operation::Add(register(a), register(b)),
                (Action::Difference, [a, b]) => Operation::Subtract(register(a), register(b)),
                (Action::Product, [a, b]) => Operation::Multiply(register(a), register(b)),
                (Action::Quotient, [a, b]) => Operation::Divide(register(a), register(b)),
                (action, [a]) => Operation::One(action, register(a)),
                (action, [a, b]) => Operation::Two(action, [register(a), register(b)]),
                (action, [a, b, c]) => Operation::Three(action, [a, b, c].map(register)),
                (action, from) => {
                    let [start, end] = self.arguments(from, registers);
                    Operation::Many(action, start, end)
                }
            },
            Node::Place(keys, x) => {
                let keys = self.keys_of(model, *keys);
                let place = self.program.places as u32;
                self.program.places += 1;
                let operation = Operation::Locate { keys, x: register(x) };
                self.program.instructions.push(Instruction { to: place, operation });
                return place;
            }
            Node::Value(table, row, column) => {
                let flat = model.tables[*table].table.flat();
                let (_, columns, numbers) = flat.unwrap_or_default();
                let width = columns.len().max(1);
                let values = *self.values.entry(*table).or_insert_with(|| {
                    let start = self.program.pairs.len() as u32;
                    let next = numbers.iter().skip(width).zip(numbers).map(|(next, value)| next - value);
                    let next = next.chain(std::iter::repeat(0.0));
                    self.program.pairs.extend(numbers.iter().zip(next).map(|(&value, more)| [value, more]));
                    start
                });
                match column {
                    None => Operation::Linear { values, row: register(row) },
                    Some(column) => Operation::Bilinear {
                        values,
                        width: width as u32,
                        row: register(row),
                        column: register(column),
                    },
                }
            }
            Node::Table(table, at) => {
                self.program.tables.push(Table::clone(&model.tables[*table].table));
                let table = self.program.tables.len() as u32 - 1;
                Operation::Table { table, at: at.map(|name| registers[name]) }
            }
        };
        self.instruction(operation)
    }

    /// Adds a chain of sums or products.
    fn add_chain(&mut self, action: Action, links: &[Name], registers: &[Register]) -> Register {
        let [start, end] = self.arguments(links, registers);
        self.instruction(if action == Action::Sum {
            Operation::Sum(start, end)
        } else {
            Operation::Product(start, end)
        })
    }

    fn instruction(&mut self, operation: Operation) -> Register {
        let to = self.register(0.0);
        self.program.instructions.push(Instruction { to, operation });
        to
    }

    /// Appends arguments; gives where they begin and end.
    fn arguments(&mut self, names: &[Name], registers: &[Register]) -> [u32; 2] {
        let start = self.program.arguments.len() as u32;
        self.program.arguments.extend(names.iter().map(|&name| registers[name]));
        [start, self.program.arguments.len() as u32]
    }

    fn register(&mut self, holding: f64) -> Register {
        self.program.initial.push(holding);
        self.program.initial.len() as Register - 1
    }

    fn keys_of(&mut self, model: &Model, keys: Keys) -> [u32; 2] {
        let (table, of_columns) = keys;
        let (rows, columns, _) = model.tables[table].table.flat().unwrap_or_default();
        let numbers = if of_columns { columns } else { rows };
        *self.keys.entry(keys).or_insert_with(|| push(&mut self.program.numbers, numbers))
    }
}

/// Appends numbers; gives where they begin and end.
fn push(numbers: &mut Vec<f64>, more: &[f64]) -> [u32; 2] {
    let start = numbers.len() as u32;
    numbers.extend_from_slice(more);
    [start, numbers.len() as u32]
}
