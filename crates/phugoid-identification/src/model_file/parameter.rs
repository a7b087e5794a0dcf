//! The parameters of a model file: what each multiplies, what is known beforehand and what is expected in flight.

use crate::core::output::Output;
use crate::core::term::{Coefficient, Term};

/// What a parameter of the model multiplies, and so what it stands for.
#[derive(Clone, Debug, PartialEq)]
pub enum Role {
    /// A term of the build-up of a coefficient: the parameter is a derivative.
    Term(Coefficient, Term),
    /// A constant in a coefficient that takes up model error.
    Offset(Coefficient),
    /// The constant error of a sensor.
    Bias(Output),
}

impl Role {
    /// True for the constant term of a coefficient: what a trim shift changes.
    pub(crate) fn is_constant_term(&self) -> bool {
        matches!(self, Self::Term(_, term) if term.is_constant())
    }

    /// True for what stands alone, whatever the motion: the constant term of a coefficient, an offset, a bias.
    pub(crate) fn is_constant(&self) -> bool {
        match self {
            Self::Term(_, term) => term.is_constant(),
            Self::Offset(_) | Self::Bias(_) => true,
        }
    }
}

/// A parameter: name, role and what is known of it beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name, e.g. `CL_alpha`, `dCm_q`, `offset_Cm`, `bias_alpha`.
    pub name: String,
    /// What the parameter multiplies, and so what it stands for.
    pub role: Role,
    /// Start value, SI, per radian where an angle is involved.
    pub start: f64,
    /// One sigma of what is known beforehand about its distance from the start value.
    pub prior_std: f64,
    /// Lower and upper limit of the estimate, in the unit of the parameter; none where the file gives none.
    pub bounds: Option<[f64; 2]>,
    /// One sigma of a plausible sudden change; none for the automatic rule.
    pub change_std: Option<f64>,
    /// True if it is known and not estimated.
    pub fixed: bool,
}

impl Parameter {
    /// True for parameters that only support the others: offsets and sensor biases.
    pub fn is_nuisance(&self) -> bool {
        !matches!(self.role, Role::Term(..))
    }

    /// Unit as printed: `per rad`, `-`; that of the sensor for a bias.
    pub fn unit(&self) -> String {
        match &self.role {
            Role::Bias(output) => output.unit().to_owned(),
            Role::Term(_, term) => term.parameter_unit(),
            Role::Offset(_) => "-".to_owned(),
        }
    }
}

/// What is expected of one parameter, per radian where an angle is involved.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// Name in the model file.
    pub name: String,
    /// Expected value, in the unit of the parameter.
    pub value: f64,
    /// Largest deviation from the expected value that still counts as healthy, in the unit of the parameter.
    pub tolerance: f64,
    /// Standard deviation of the change that a failure would make, in the unit of the parameter; `None` takes the rule
    /// of the change detector.
    pub failure_std: Option<f64>,
}
