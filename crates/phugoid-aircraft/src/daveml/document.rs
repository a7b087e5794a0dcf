//! What a DAVE-ML text says besides its equations: header, variables, uncertainties, functions and check data.

use std::sync::Arc;

use super::units::Unit;

/// Where a file comes from, as its `fileHeader` says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Header {
    /// Name of the model; empty if it has none.
    pub name: String,
    /// Name and organisation of each author.
    pub authors: Vec<(String, String)>,
    /// Date of creation as it is written, in most files ISO 8601.
    pub created: String,
    /// Version as it is written; empty if there is none.
    pub version: String,
    /// Description; empty if there is none.
    pub description: String,
}

/// How a variable takes part in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It is set from outside: marked as input, control or disturbance, or neither computed nor given a value.
    Input,
    /// It has an initial value and nothing computes it. It can still be set.
    Constant,
    /// A calculation or a function computes it.
    Computed,
}

/// A variable of a model (`variableDef`).
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The identifier that calculations use, unique in the file.
    pub id: String,
    /// The name that the outside uses; need not be unique.
    pub name: String,
    /// Its unit as it is written; [`super::Unit::parse`] understands most.
    pub units: String,
    /// Description; empty if there is none.
    pub description: String,
    /// Symbol for documents, such as a Greek letter; empty if there is none.
    pub symbol: String,
    /// Axis system; empty if there is none.
    pub axis_system: String,
    /// Which direction is positive; empty if the file does not say.
    pub sign: String,
    /// Value before anything sets or computes it, in `units`.
    pub initial: Option<f64>,
    /// What the value is limited to from below, in `units`.
    pub minimum: Option<f64>,
    /// What the value is limited to from above, in `units`.
    pub maximum: Option<f64>,
    /// How it takes part.
    pub role: Role,
    /// Marked as input (`isInput`).
    pub is_input: bool,
    /// Marked as a parameter of the simulation (`isControl`).
    pub is_control: bool,
    /// Marked as disturbance (`isDisturbance`).
    pub is_disturbance: bool,
    /// Marked as output (`isOutput`).
    pub is_output: bool,
    /// Marked as state (`isState`).
    pub is_state: bool,
    /// Marked as derivative of a state (`isStateDeriv`).
    pub is_state_derivative: bool,
    /// Its name is one of the standard (`isStdAIAA`).
    pub is_standard: bool,
    /// How well its value is known, if the file says.
    pub uncertainty: Option<Uncertainty>,
    /// Line of its definition, from 1.
    pub line: u32,
}

impl Variable {
    /// Its unit in relation to SI; none where [`Unit::parse`] does not know it.
    pub fn unit(&self) -> Option<Unit> {
        Unit::parse(&self.units)
    }
}

/// What an uncertainty changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Bounds are added to the value, in its unit.
    Additive,
    /// Bounds are a fraction of the value.
    Multiplicative,
    /// Bounds are a percentage of the value.
    Percentage,
    /// Bounds are values themselves.
    Absolute,
}

/// How well a value or a table is known (`uncertainty`). It never changes what is evaluated; [`super::Model::moved`] makes a model with
/// the value moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// What the bounds refer to.
    pub effect: Effect,
    /// Which values are how likely.
    pub distribution: Distribution,
}

impl Uncertainty {
    /// Its bounds: one of a normal distribution, one or two of a uniform one.
    pub fn bounds(&self) -> &[Bound] {
        match &self.distribution {
            Distribution::Normal { bound, .. } => std::slice::from_ref(bound),
            Distribution::Uniform { bounds } => bounds,
        }
    }

    pub(super) fn bounds_mut(&mut self) -> &mut [Bound] {
        match &mut self.distribution {
            Distribution::Normal { bound, .. } => std::slice::from_mut(bound),
            Distribution::Uniform { bounds } => bounds,
        }
    }

    /// Standard deviation of a value of `nominal`, in its unit: of a normal distribution the bound over its number of
    /// sigmas, of a uniform one the width over the root of twelve. None where a bound is a table or a variable, and for
    /// absolute bounds of a normal distribution, which the standard does not explain.
    pub fn standard_deviation(&self, nominal: f64) -> Option<f64> {
        let scale = match self.effect {
            Effect::Additive => 1.0,
            Effect::Multiplicative => nominal.abs(),
            Effect::Percentage => 0.01 * nominal.abs(),
            Effect::Absolute => match &self.distribution {
                Distribution::Normal { .. } => return None,
                Distribution::Uniform { .. } => 1.0,
            },
        };
        let constant = |bound: &Bound| match bound {
            Bound::Value(value) => Some(*value),
            Bound::Table(_) | Bound::Variable(_) => None,
        };
        match &self.distribution {
            Distribution::Normal { sigmas, bound, .. } => Some(scale * constant(bound)?.abs() / sigmas),
            Distribution::Uniform { bounds } => {
                let width = match bounds.as_slice() {
                    [one] => 2.0 * constant(one)?.abs(),
                    [one, other] if self.effect == Effect::Absolute => (constant(one)? - constant(other)?).abs(),
                    [one, other] => constant(one)?.abs() + constant(other)?.abs(),
                    _ => return None,
                };
                Some(scale * width / 12.0_f64.sqrt())
            }
        }
    }
}

/// Which values are how likely.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// A bell curve about the nominal value.
    Normal {
        /// How many standard deviations the bound stands for; positive.
        sigmas: f64,
        /// The bound on either side.
        bound: Bound,
        /// Identifiers of variables whose random number is that of this one.
        correlates_with: Vec<String>,
        /// Identifiers of variables with their coefficient of correlation.
        correlations: Vec<(String, f64)>,
    },
    /// Every value between the bounds is equally likely.
    Uniform {
        /// One bound on either side, or two.
        bounds: Vec<Bound>,
    },
}

/// A bound of an uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub enum Bound {
    /// A number.
    Value(f64),
    /// A number for each value of the table that it belongs to, in the order of that table.
    Table(Arc<[f64]>),
    /// The identifier of a variable.
    Variable(String),
}

/// A function of a model: which table gives which variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Its name.
    pub name: String,
    /// Identifiers of its independent variables, in the order of the table's dimensions.
    pub independents: Vec<String>,
    /// Identifier of the variable that it computes.
    pub dependent: String,
    /// How well its table is known, if the file says.
    pub uncertainty: Option<Uncertainty>,
    /// Line of its definition, from 1.
    pub line: u32,
}

/// A check case: values of inputs and what has to come out (`staticShot`).
#[derive(Clone, Debug, PartialEq)]
pub struct StaticShot {
    /// Its name.
    pub name: String,
    /// Inputs; those that are not listed take their initial value.
    pub inputs: Vec<Signal>,
    /// Values of variables in between.
    pub internals: Vec<Signal>,
    /// Values of outputs.
    pub outputs: Vec<Signal>,
    /// Line of its definition, from 1.
    pub line: u32,
}

/// A value of a variable in check data.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// The name or the identifier, as it is written.
    pub name: String,
    /// Its unit as it is written; empty where a signal is given by identifier.
    pub units: String,
    /// Its value, in `units`.
    pub value: f64,
    /// Largest difference that is allowed, in `units`; none if it is not written.
    pub tolerance: Option<f64>,
    /// Position of the variable in [`super::Model::variables`].
    pub variable: usize,
    /// Line of the signal, from 1.
    pub line: u32,
}
