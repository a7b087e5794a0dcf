//! A model that was read: what it has, and where its values are.

use std::collections::HashMap;
use std::sync::Arc;

use phugoid_flight_dynamics::scalar::Scalar;

use super::deviation::Move;
use super::document::{Function, Header, Role, StaticShot, Variable};
use super::error::DavemlError;
use super::program::{Evaluator, Program, Table};
use super::scattered::Surface;

/// A model in DAVE-ML, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct Model {
    header: Header,
    variables: Vec<Variable>,
    functions: Vec<Function>,
    /// Positions by identifier.
    by_id: HashMap<String, usize>,
    /// Positions by name: those of an input and of another variable, which may share one.
    by_name: HashMap<String, Vec<usize>>,
    inputs: Vec<usize>,
    outputs: Vec<usize>,
    shots: Vec<StaticShot>,
    repaired: Vec<u32>,
    program: Arc<Program>,
}

impl Model {
    pub(super) fn new(
        header: Header,
        variables: Vec<Variable>,
        functions: Vec<Function>,
        by_id: HashMap<String, usize>,
        program: Arc<Program>,
        used: &[bool],
    ) -> Self {
        let mut by_name: HashMap<String, Vec<usize>> = HashMap::new();
        for (position, variable) in variables.iter().enumerate() {
            by_name.entry(variable.name.clone()).or_default().push(position);
        }
        let which = |wanted: &dyn Fn(usize, &Variable) -> bool| {
            let positions = variables.iter().enumerate().filter(|(position, variable)| wanted(*position, variable));
            positions.map(|(position, _)| position).collect::<Vec<_>>()
        };
        let inputs = which(&|_, variable| variable.role == Role::Input);
        let outputs =
            which(&|position, variable| variable.is_output || variable.role == Role::Computed && !used[position]);
        Self {
            header,
            variables,
            functions,
            by_id,
            by_name,
            inputs,
            outputs,
            shots: Vec::new(),
            repaired: Vec::new(),
            program,
        }
    }

    pub(super) fn set_shots(&mut self, shots: Vec<StaticShot>) {
        self.shots = shots;
    }

    pub(super) fn set_repaired(&mut self, lines: Vec<u32>) {
        self.repaired = lines;
    }

    /// Lines, from 1, on which markup in a description was read as text, because the file is no XML otherwise. Empty for
    /// every sound file.
    pub fn repaired_lines(&self) -> &[u32] {
        &self.repaired
    }

    /// Where the file comes from.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// All variables, in the order of the file. Positions in this list are what an [`Evaluator`] counts by.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The functions, in the order of the file.
    pub fn functions(&self) -> &[Function] {
        &self.functions
    }

    /// The check cases, in the order of the file.
    pub fn shots(&self) -> &[StaticShot] {
        &self.shots
    }

    /// Variables that have to be set: marked as input, control or disturbance, or neither computed nor given a value.
    pub fn inputs(&self) -> impl ExactSizeIterator<Item = &Variable> {
        self.inputs.iter().map(|position| &self.variables[*position])
    }

    /// Variables that come out: marked as output, or computed and used by no other.
    pub fn outputs(&self) -> impl ExactSizeIterator<Item = &Variable> {
        self.outputs.iter().map(|position| &self.variables[*position])
    }

    /// Positions of [`Model::inputs`] in [`Model::variables`].
    pub fn input_positions(&self) -> &[usize] {
        &self.inputs
    }

    /// Positions of [`Model::outputs`] in [`Model::variables`].
    pub fn output_positions(&self) -> &[usize] {
        &self.outputs
    }

    /// The variable with this identifier or else this name; see [`Model::position`].
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.position_in(name, false).map(|position| &self.variables[position])
    }

    /// Position of the variable with this identifier, or else this name, in [`Model::variables`]. Of several with the
    /// same name it is an output if there is one.
    ///
    /// # Errors
    /// [`DavemlError::UnknownSignal`].
    pub fn position(&self, name: &str) -> Result<usize, DavemlError> {
        self.by_id.get(name).copied().or_else(|| self.position_in(name, false)).ok_or_else(|| unknown(name))
    }

    /// Position of the variable with this identifier, or else this name, if it can be set. Of several with the same name
    /// it is an input if there is one.
    ///
    /// # Errors
    /// [`DavemlError::UnknownSignal`]; [`DavemlError::NotAnInput`] for a variable that is computed.
    pub fn input_position(&self, name: &str) -> Result<usize, DavemlError> {
        let known = self.by_id.get(name).copied();
        let position = known.or_else(|| self.position_in(name, true)).ok_or_else(|| unknown(name))?;
        match self.can_be_set(position) {
            true => Ok(position),
            false => Err(DavemlError::NotAnInput { id: self.variables[position].id.clone(), line: None }),
        }
    }

    pub(super) fn position_of_id(&self, id: &str) -> Option<usize> {
        self.by_id.get(id).copied().or_else(|| self.position_in(id, false))
    }

    /// Position of the variable with this name, or else this identifier.
    pub(super) fn position_in(&self, name: &str, to_set: bool) -> Option<usize> {
        let Some(named) = self.by_name.get(name) else { return self.by_id.get(name).copied() };
        let suits = |position: &&usize| {
            let variable = &self.variables[**position];
            if to_set { variable.role == Role::Input } else { variable.is_output }
        };
        named.iter().find(suits).or_else(|| named.first()).copied()
    }

    pub(super) fn can_be_set(&self, position: usize) -> bool {
        self.program.computed.get(position).is_some_and(|computed| !computed)
    }

    /// Lowest and highest breakpoint of the tables over the variable at this position, in its unit; none without such a
    /// table. Tables of scattered points do not count.
    pub(crate) fn table_ends(&self, position: usize) -> Option<[f64; 2]> {
        let gridded = self.program.tables.iter().filter_map(|table| match table {
            Table::Gridded(gridded) => Some(&gridded.axes),
            Table::Scattered(_) => None,
        });
        let of_it = gridded.flatten().filter(|axis| axis.independent.variable == position && axis.points.len() > 1);
        let ends = of_it.filter_map(|axis| Some([*axis.points.first()?, *axis.points.last()?]));
        ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// The table of the function at this position of [`Model::functions`].
    pub(super) fn table(&self, function: usize) -> Option<&Table> {
        // Each function has brought its table with it.
        self.program.tables.get(function)
    }

    /// The same model with values moved.
    pub(super) fn with_moves(&self, moves: Vec<Move>) -> Self {
        let mut program = Program::clone(&self.program);
        program.moves.extend(moves);
        Self { program: Arc::new(program), ..self.clone() }
    }

    /// The same model with other values of the table of these functions; none where there are no such values.
    pub(super) fn with_tables(&self, functions: &[usize], values: impl Fn(&[f64]) -> Option<Vec<f64>>) -> Option<Self> {
        let mut program = Program::clone(&self.program);
        for function in functions {
            match program.tables.get_mut(*function)? {
                Table::Gridded(gridded) => gridded.values = values(&gridded.values)?.into(),
                Table::Scattered(scattered) => {
                    let surface = &scattered.surface;
                    scattered.surface = Arc::new(Surface::new(surface.points.clone(), values(&surface.values)?)?);
                }
            }
        }
        Some(Self { program: Arc::new(program), ..self.clone() })
    }

    /// What evaluates the model. It needs no reference to it, and a copy costs no reading.
    pub fn evaluator(&self) -> Evaluator {
        Evaluator::new(Arc::clone(&self.program))
    }

    /// The same for any [`Scalar`], such as numbers that carry exact derivatives.
    pub fn evaluator_of<T: Scalar>(&self) -> Evaluator<T> {
        Evaluator::new(Arc::clone(&self.program))
    }

    /// Evaluates the model once, with these inputs by identifier or name in their own units and all others as in the
    /// file. For more than once, [`Model::evaluator`] looks names up only at the beginning.
    ///
    /// ```
    /// # use phugoid_aircraft::daveml::{DavemlError, Model};
    /// # let model = Model::parse("<DAVEfunc><variableDef name='x' varID='x' units='ft'/></DAVEfunc>")?;
    /// let evaluated = model.evaluate(&[("x", 10.0)])?;
    /// let x = model.position("x")?;
    /// assert_eq!(evaluated.get(x), 10.0);
    /// assert_eq!(model.variables()[x].unit().map(|unit| unit.to_si(10.0)), Some(3.048));
    /// # Ok::<(), DavemlError>(())
    /// ```
    ///
    /// # Errors
    /// [`DavemlError::UnknownSignal`]; [`DavemlError::NotAnInput`].
    pub fn evaluate(&self, inputs: &[(&str, f64)]) -> Result<Evaluator, DavemlError> {
        let mut evaluator = self.evaluator();
        for (name, value) in inputs {
            evaluator.set(self.input_position(name)?, *value);
        }
        evaluator.run();
        Ok(evaluator)
    }
}

fn unknown(name: &str) -> DavemlError {
    DavemlError::UnknownSignal { name: name.to_owned(), line: None }
}
