//! Properties, tables and functions of one aircraft, compiled to indices, and their values at one moment.

use std::collections::HashMap;
use std::path::PathBuf;

use super::function::{Op, apply};
use super::table::Table;

/// Names of properties, and what stands behind each.
#[derive(Debug, Clone, Default)]
pub(super) struct Model {
    index: HashMap<String, usize>,
    /// One for each property.
    pub(super) properties: Vec<Property>,
    pub(super) tables: Vec<Lookup>,
    pub(super) functions: Vec<Function>,
}

/// A property of the tree.
#[derive(Debug, Clone)]
pub(super) struct Property {
    pub(super) name: String,
    /// Its value before anything ran.
    pub(super) initial: f64,
    /// Whether a `<property>`, a component or a function of the files makes it.
    pub(super) declared: bool,
    /// The function whose value it is, if it has none of its own.
    pub(super) function: Option<usize>,
    /// What is written along with it.
    pub(super) links: Vec<(usize, Link)>,
    /// The file and the line, from 1, that first name it; none for one that no file names.
    pub(super) mentioned: Option<(PathBuf, u32)>,
    /// Whether a part of the files makes it that is left out here.
    pub(super) left_out: bool,
}

impl Property {
    fn new(name: String) -> Self {
        Self {
            name,
            initial: 0.0,
            declared: false,
            function: None,
            links: Vec::new(),
            mentioned: None,
            left_out: false,
        }
    }
}

/// How the value of a property follows from that of another.
#[derive(Debug, Clone, Copy)]
pub(super) enum Link {
    /// A factor times it.
    Times(f64),
    /// Its magnitude in radians.
    Magnitude,
}

/// A table and the properties that it is looked up by, each with its sign.
#[derive(Debug, Clone)]
pub(super) struct Lookup {
    pub(super) table: Table,
    pub(super) variables: [Option<(usize, f64)>; 3],
}

/// A function: operations in the order in which they are carried out, on a stack.
#[derive(Debug, Clone)]
pub(super) struct Function {
    pub(super) ops: Vec<Op>,
    /// The property that its value is copied to whenever it is computed, where that was there before it.
    pub(super) copy: Option<usize>,
    /// Where it stands, for messages.
    pub(super) file: PathBuf,
    /// Line, from 1.
    pub(super) line: u32,
}

/// Values of all properties at one moment.
#[derive(Debug, Clone)]
pub(super) struct State {
    values: Vec<f64>,
    /// Values of functions that are computed once in a pass.
    held: Vec<Option<f64>>,
    stack: Vec<f64>,
}

/// One spelling for each property: without blanks, a leading `/`, or the index of a first element.
fn normalised(name: &str) -> String {
    let name = name.trim();
    name.strip_prefix('/').unwrap_or(name).replace("[0]", "")
}

impl Model {
    /// The index of a property, which is made if it is not there.
    pub(super) fn property(&mut self, name: &str) -> usize {
        let name = normalised(name);
        if let Some(&found) = self.index.get(&name) {
            return found;
        }
        let made = self.properties.len();
        self.index.insert(name.clone(), made);
        self.properties.push(Property::new(name.clone()));
        self.link(&name, made);
        made
    }

    /// The index of a property that is there.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.index.get(&normalised(name)).copied()
    }

    /// Ties the angles of a surface in radians and degrees, and their magnitude, to each other.
    fn link(&mut self, name: &str, made: usize) {
        const SURFACES: [&str; 7] =
            ["elevator", "left-aileron", "right-aileron", "rudder", "flap", "speedbrake", "spoiler"];
        let Some(rest) = name.strip_prefix("fcs/") else { return };
        let rest = rest.strip_prefix("mag-").unwrap_or(rest);
        let Some(surface) = SURFACES
            .iter()
            .find(|surface| rest.strip_prefix(**surface).is_some_and(|form| form == "-pos-rad" || form == "-pos-deg"))
        else {
            return;
        };
        let radian_name = format!("fcs/{surface}-pos-rad");
        let degree_name = format!("fcs/{surface}-pos-deg");
        let magnitude_name = format!("fcs/mag-{surface}-pos-rad");
        // The three are made together, so that each is there when another is written.
        let [radian, degree, magnitude] =
            [&radian_name, &degree_name, &magnitude_name].map(|name| self.property_alone(name, made));
        let degrees = 180.0 / std::f64::consts::PI;
        self.properties[radian].links = vec![(degree, Link::Times(degrees)), (magnitude, Link::Magnitude)];
        self.properties[degree].links = vec![(radian, Link::Times(1.0 / degrees)), (magnitude, Link::Magnitude)];
    }

    fn property_alone(&mut self, name: &str, made: usize) -> usize {
        if self.properties[made].name == name {
            return made;
        }
        if let Some(&found) = self.index.get(name) {
            return found;
        }
        let new = self.properties.len();
        self.index.insert(name.to_owned(), new);
        self.properties.push(Property::new(name.to_owned()));
        new
    }

    /// Properties that are written along with one.
    pub(super) fn linked(&self, index: usize) -> impl Iterator<Item = usize> {
        self.properties[index].links.iter().map(|&(other, _)| other)
    }

    /// Sets the value that a property begins with, and those of what is tied to it.
    pub(super) fn begin(&mut self, index: usize, value: f64) {
        self.properties[index].initial = value;
        for (other, link) in self.properties[index].links.clone() {
            let degrees = self.properties[index].name.ends_with("-deg");
            self.properties[other].initial = linked(link, value, degrees);
        }
    }
}

/// What is written along with a value. A magnitude is in radians, whatever the value is in.
fn linked(link: Link, value: f64, degrees: bool) -> f64 {
    match link {
        Link::Times(factor) => factor * value,
        Link::Magnitude if degrees => value.to_radians().abs(),
        Link::Magnitude => value.abs(),
    }
}

impl State {
    /// The values that a model begins with.
    pub(super) fn new(model: &Model) -> Self {
        Self {
            values: model.properties.iter().map(|property| property.initial).collect(),
            held: vec![None; model.functions.len()],
            stack: Vec::new(),
        }
    }

    /// What a property without a function holds.
    pub(super) fn held_by(&self, index: usize) -> f64 {
        self.values[index]
    }

    /// The value of a property; that of its function, where it has one.
    pub(super) fn read(&mut self, model: &Model, index: usize) -> f64 {
        match model.properties[index].function {
            None => self.values[index],
            Some(function) => self.call(model, function),
        }
    }

    /// Sets a property and what is tied to it. That of a function cannot be set.
    pub(super) fn write(&mut self, model: &Model, index: usize, value: f64) {
        let property = &model.properties[index];
        if property.function.is_some() {
            return;
        }
        self.values[index] = value;
        let degrees = !property.links.is_empty() && property.name.ends_with("-deg");
        for &(other, link) in &property.links {
            self.values[other] = linked(link, value, degrees);
        }
    }

    /// The value of a function; the held one, if it is held.
    pub(super) fn call(&mut self, model: &Model, function: usize) -> f64 {
        if let Some(held) = self.held[function] {
            return held;
        }
        let base = self.stack.len();
        for op in &model.functions[function].ops {
            let value = match *op {
                Op::Constant(value) => value,
                Op::Property(index, sign) => sign * self.read(model, index),
                Op::Table(table) => self.look_up(model, table),
                Op::Apply(action, count) => {
                    let from = self.stack.len().saturating_sub(count).max(base);
                    let value = apply(action, &self.stack[from..]);
                    self.stack.truncate(from);
                    value
                }
            };
            self.stack.push(value);
        }
        let value = self.stack.last().copied().unwrap_or(f64::NAN);
        self.stack.truncate(base);
        if let Some(copy) = model.functions[function].copy {
            self.write(model, copy, value);
        }
        value
    }

    /// The value of a table at its properties.
    pub(super) fn look_up(&mut self, model: &Model, table: usize) -> f64 {
        let lookup = &model.tables[table];
        let mut at = [0.0; 3];
        for (value, variable) in at.iter_mut().zip(lookup.variables) {
            if let Some((index, sign)) = variable {
                *value = sign * self.read(model, index);
            }
        }
        lookup.table.value(at)
    }

    /// Computes functions in order, each once, and holds their values until the next time. One that stands before another
    /// that it needs takes the value of the latter from the time before if there is one and `before` is set.
    pub(super) fn hold(&mut self, model: &Model, functions: &[usize], before: bool) {
        if !before {
            for &function in functions {
                self.held[function] = None;
            }
        }
        for &function in functions {
            self.held[function] = None;
            let value = self.call(model, function);
            self.held[function] = Some(value);
        }
    }
}
