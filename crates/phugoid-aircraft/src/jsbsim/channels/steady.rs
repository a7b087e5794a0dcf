//! Components without a memory as functions: their outputs follow from the state of the moment alone.

use super::super::function::{Action, Op};
use super::super::model::{Function, Model};
use super::Channels;
use super::component::{Clip, Comparison, Component, Kind, Parameter, Test};

/// The operations of a component, for the model that they are meant for.
#[derive(Debug)]
pub(in crate::jsbsim) struct Steady {
    ops: Vec<Op>,
    /// Properties that the component reads itself.
    pub(in crate::jsbsim) properties: Vec<usize>,
    /// Functions that it computes.
    pub(in crate::jsbsim) functions: Vec<usize>,
}

impl Channels {
    /// The component that alone writes a property, if it has neither memory nor delay and its channel always runs.
    pub(in crate::jsbsim) fn steady(&self, model: &Model, property: usize) -> Option<Steady> {
        let writes = |component: &&Component| component.outputs.contains(&property);
        let mut found = self
            .channels
            .iter()
            .flat_map(|channel| channel.components.iter().filter(writes).map(|component| (component, channel.execute)));
        let (component, execute) = found.next()?;
        if found.next().is_some() || execute.is_some() || component.delay.is_some() {
            return None;
        }
        let mut steady = Steady { ops: Vec::new(), properties: component.reads(), functions: Vec::new() };
        steady.component(model, component)?;
        Some(steady)
    }
}

impl Steady {
    /// Makes it the function of a property, in whose place no value can be set.
    pub(in crate::jsbsim) fn become_function(self, model: &mut Model, property: usize) {
        let (file, line) = model.properties[property].mentioned.clone().unwrap_or_default();
        model.properties[property].function = Some(model.functions.len());
        model.functions.push(Function { ops: self.ops, copy: None, file, line });
    }

    fn component(&mut self, model: &Model, component: &Component) -> Option<()> {
        let input = component.inputs.first().copied();
        match &component.kind {
            Kind::Summer { bias } => {
                component.inputs.iter().for_each(|input| self.parameter(*input));
                self.ops.push(Op::Constant(*bias));
                self.apply(Action::Sum, component.inputs.len() + 1);
            }
            Kind::Gain { gain } => {
                self.parameter(*gain);
                self.parameter(input?);
                self.apply(Action::Product, 2);
            }
            Kind::Scheduled { gain, table } => {
                self.parameter(*gain);
                self.ops.push(Op::Table(*table));
                self.parameter(input?);
                self.apply(Action::Product, 3);
                self.properties.extend(model.tables[*table].variables.iter().flatten().map(|(index, _)| *index));
            }
            Kind::Switch { default, tests } => self.switch(*default, tests),
            Kind::Function(function) => {
                self.ops.extend_from_slice(&model.functions[*function].ops);
                self.functions.push(*function);
                if let Some(input) = input {
                    self.parameter(input);
                    self.apply(Action::Product, 2);
                }
            }
            _ => return None,
        }
        match component.clip {
            None => Some(()),
            Some(Clip { cyclic: true, .. }) => None,
            Some(Clip { least, most, cyclic: false }) => {
                self.parameter(most);
                self.apply(Action::Min, 2);
                self.parameter(least);
                self.apply(Action::Max, 2);
                Some(())
            }
        }
    }

    fn apply(&mut self, action: Action, count: usize) {
        self.ops.push(Op::Apply(action, count));
    }

    fn parameter(&mut self, parameter: Parameter) {
        self.ops.push(match parameter {
            Parameter::Number(value) => Op::Constant(value),
            Parameter::Property(index, sign) => Op::Property(index, sign),
        });
    }

    /// The value of the first test that holds.
    fn switch(&mut self, default: Parameter, tests: &[(Test, Parameter)]) {
        match tests.split_first() {
            None => self.parameter(default),
            Some(((test, value), others)) => {
                self.test(test);
                self.parameter(*value);
                self.switch(default, others);
                self.apply(Action::IfThen, 3);
            }
        }
    }

    fn test(&mut self, test: &Test) {
        match test {
            Test::All(tests) | Test::Any(tests) => {
                tests.iter().for_each(|test| self.test(test));
                let action = if matches!(test, Test::All(_)) { Action::And } else { Action::Or };
                self.apply(action, tests.len());
            }
            Test::Compare(left, comparison, right) => {
                self.parameter(*left);
                self.parameter(*right);
                let action = match comparison {
                    Comparison::Equal => Action::Eq,
                    Comparison::Unequal => Action::Nq,
                    Comparison::Less => Action::Lt,
                    Comparison::LessOrEqual => Action::Le,
                    Comparison::Greater => Action::Gt,
                    Comparison::GreaterOrEqual => Action::Ge,
                };
                self.apply(action, 2);
            }
        }
    }
}
