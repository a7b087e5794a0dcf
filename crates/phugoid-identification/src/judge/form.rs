//! Derivatives in stability axes and in body axes, each made of the other with its covariance.
//!
//! A model file has lift and drag along the stability axes (turned from the body axes by the angle of attack) and
//! moments and rates in body axes. Both conventions are in use; a comparison with other people's derivatives needs one
//! of them:
//!
//! ```text
//! CX = CL sin a - CD cos a        CX_alpha = (CL_alpha + CD_0) sin a - (CD_alpha - CL_0) cos a
//! CZ = -CL cos a - CD sin a       CZ_alpha = -(CL_alpha + CD_0) cos a - (CD_alpha - CL_0) sin a
//!
//! [Cl, Cn]_s = R [Cl, Cn]_b      [p, r]_s = R [p, r]_b      R = [cos a, sin a; -sin a, cos a]
//! [Cl_p, Cl_r; Cn_p, Cn_r]_s = R [Cl_p, Cl_r; Cn_p, Cn_r]_b R^T       [CY_p, CY_r]_s = [CY_p, CY_r]_b R^T
//! ```
//!
//! all at the reference angle of attack, where they are exact (Klein & Morelli, Aircraft System Identification, section
//! 3.3; Stevens & Lewis 2.3-3). `CL_0` and `CD_0` are the values there: of a whole build-up the constant terms, of
//! increments those of the increments. Every new derivative is a sum of old ones, `y = T x`, so that the covariance is
//! `T P T^T`.

use std::fmt;

use crate::core::estimation::Estimation;
use crate::core::term::{Coefficient, Term, Variable};
use crate::model_file::{Base, ModelFile, Role};

/// The axes that derivatives refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Form {
    /// As model files have them: `CL`, `CD` in stability axes, all else in body axes.
    Model,
    /// `CL`, `CD`; moments, `p_hat` and `r_hat` about the stability axes.
    Stability,
    /// `CX`, `CZ`; moments and rates about the body axes.
    Body,
}

impl Form {
    /// The word of the command line and of reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Stability => "stability",
            Self::Body => "body",
        }
    }

    fn has_body_forces(self) -> bool {
        self == Self::Body
    }

    fn has_stability_moments(self) -> bool {
        self == Self::Stability
    }
}

/// The symbol of a force or moment coefficient in body or stability axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // the symbols are the field's
pub enum Symbol {
    CL,
    CD,
    CX,
    CZ,
    Cm,
    CY,
    /// Rolling moment about body x.
    Cl,
    /// Yawing moment about body z.
    Cn,
    /// Rolling moment about the stability x axis.
    Cls,
    /// Yawing moment about the stability z axis.
    Cns,
}

impl From<Coefficient> for Symbol {
    fn from(coefficient: Coefficient) -> Self {
        match coefficient {
            Coefficient::Lift => Self::CL,
            Coefficient::Drag => Self::CD,
            Coefficient::PitchingMoment => Self::Cm,
            Coefficient::SideForce => Self::CY,
            Coefficient::RollingMoment => Self::Cl,
            Coefficient::YawingMoment => Self::Cn,
        }
    }
}

/// What a derivative is taken with respect to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Argument {
    /// Nothing: the value at the reference point.
    Constant,
    /// A flight variable of model files.
    Variable(Variable),
    /// Roll rate about the stability x axis, `p_s b / 2V`.
    StabilityRollRate,
    /// Yaw rate about the stability z axis, `r_s b / 2V`.
    StabilityYawRate,
    /// An extra input of the model file, by its number.
    Extra(usize),
}

/// One derivative: a coefficient, and the variable it is differentiated with respect to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Derivative {
    /// The coefficient that is differentiated.
    pub symbol: Symbol,
    /// The variable with respect to which it is differentiated.
    pub argument: Argument,
}

impl fmt::Display for Derivative {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.argument {
            Argument::Constant => write!(f, "{:?}_0", self.symbol),
            Argument::Variable(variable) => write!(f, "{:?}_{}", self.symbol, variable.short_name()),
            Argument::StabilityRollRate => write!(f, "{:?}_ps", self.symbol),
            Argument::StabilityYawRate => write!(f, "{:?}_rs", self.symbol),
            Argument::Extra(number) => write!(f, "{:?}_input{number}", self.symbol),
        }
    }
}

/// Derivatives of one estimation, in one choice of axes, with their covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivatives {
    /// The axes that the derivatives refer to.
    pub form: Form,
    /// The derivatives in order; each occurs at most once.
    pub names: Vec<Derivative>,
    /// Values, per radian, in the order of `names`.
    pub values: Vec<f64>,
    /// Covariance, row and column as in `names`.
    pub covariance: Vec<Vec<f64>>,
    /// True for increments to a database.
    pub increments: bool,
}

impl Derivatives {
    /// The derivatives of an estimation, and the names of the parameters that are not derivatives: products, powers and
    /// sensor biases.
    ///
    /// The covariance is that of the corrected standard errors; a fixed parameter is exact.
    pub fn of(estimation: &Estimation, file: &ModelFile) -> (Self, Vec<String>) {
        let (mut names, mut at, mut left) = (Vec::new(), Vec::new(), Vec::new());
        for (index, result) in estimation.parameters.iter().enumerate() {
            let role = file.parameters.iter().find(|p| p.name == result.name).map(|p| &p.role);
            let derivative = match role {
                Some(Role::Term(coefficient, term)) => argument(term).map(|a| (*coefficient, a)),
                Some(Role::Offset(coefficient)) => Some((*coefficient, Argument::Constant)),
                Some(Role::Bias(_)) | None => None,
            };
            match derivative.map(|(coefficient, argument)| Derivative { symbol: coefficient.into(), argument }) {
                Some(derivative) if !names.contains(&derivative) => {
                    names.push(derivative);
                    at.push(index);
                }
                _ => left.push(result.name.clone()),
            }
        }
        let parameters = &estimation.parameters;
        let std = |i: usize| parameters[i].corrected_std_error;
        let correlation = |i: usize, j: usize| match estimation.correlation.get(i).and_then(|row| row.get(j)) {
            _ if i == j => 1.0,
            Some(r) if r.is_finite() => *r,
            _ => 0.0,
        };
        let covariance =
            at.iter().map(|&i| at.iter().map(|&j| correlation(i, j) * std(i) * std(j)).collect()).collect();
        let values = at.iter().map(|&i| parameters[i].value).collect();
        (Self { form: Form::Model, names, values, covariance, increments: file.base != Base::None }, left)
    }

    /// The same derivatives in another form, at the reference angle of attack `alpha`, rad.
    ///
    /// A pair of which only one is there (`CL_q` without `CD_q`) has the other equal to zero, known exactly, as the
    /// model has it. The covariance of the result is therefore singular where it has more derivatives than were
    /// estimated.
    ///
    /// ```
    /// use phugoid_identification::form::{Argument, Derivative, Derivatives, Form, Symbol};
    /// use phugoid_identification::term::Variable;
    /// let lift_slope = Derivative { symbol: Symbol::CL, argument: Argument::Variable(Variable::Alpha) };
    /// let stability = Derivatives {
    ///     form: Form::Model,
    ///     names: vec![lift_slope],
    ///     values: vec![5.0],
    ///     covariance: vec![vec![0.01]],
    ///     increments: false,
    /// };
    /// let body = stability.to(Form::Body, 0.0); // at zero angle of attack CZ is -CL
    /// let of_cz = body.names.iter().position(|d| d.to_string() == "CZ_alpha").ok_or("missing")?;
    /// assert_eq!((body.values[of_cz], body.std_errors()[of_cz]), (-5.0, 0.1));
    /// # Ok::<(), &str>(())
    /// ```
    #[must_use]
    pub fn to(&self, form: Form, alpha: f64) -> Self {
        let mut all = self.clone();
        if all.form.has_body_forces() != form.has_body_forces() {
            all = all.mapped(|d| turn_forces(d, alpha));
        }
        if all.form.has_stability_moments() != form.has_stability_moments() {
            all = all.mapped(|d| turn_moments(d, alpha));
        }
        Self { form, ..all }
    }

    /// Standard errors, per radian, in the order of [`names`](Self::names): the roots of the diagonal of the
    /// covariance.
    pub fn std_errors(&self) -> Vec<f64> {
        (0..self.names.len()).map(|i| self.covariance[i][i].max(0.0).sqrt()).collect()
    }

    /// The name of a derivative as in model files, `d` before increments.
    pub fn name(&self, index: usize) -> String {
        format!("{}{}", if self.increments { "d" } else { "" }, self.names[index])
    }

    /// `y = T x`, `T P T^T`: each derivative adds to those that `parts` names.
    fn mapped(&self, parts: impl Fn(Derivative) -> Vec<(Derivative, f64)>) -> Self {
        let mut names: Vec<Derivative> = Vec::new();
        let mut entries: Vec<(usize, usize, f64)> = Vec::new();
        for (column, derivative) in self.names.iter().enumerate() {
            for (name, factor) in parts(*derivative) {
                let row = names.iter().position(|n| *n == name).unwrap_or_else(|| {
                    names.push(name);
                    names.len() - 1
                });
                entries.push((row, column, factor));
            }
        }
        let (rows, columns) = (names.len(), self.names.len());
        let mut map = vec![vec![0.0; columns]; rows];
        for (row, column, factor) in entries {
            map[row][column] += factor;
        }
        let values = map.iter().map(|row| dot(row, &self.values)).collect();
        let half: Vec<Vec<f64>> = map.iter().map(|row| self.covariance.iter().map(|c| dot(row, c)).collect()).collect();
        let covariance = half.iter().map(|row| map.iter().map(|other| dot(row, other)).collect()).collect();
        Self { form: self.form, names, values, covariance, increments: self.increments }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The variable that a term of first order belongs to; `None` for products and powers.
fn argument(term: &Term) -> Option<Argument> {
    if term.is_constant() {
        return Some(Argument::Constant);
    }
    let index = term.single()?;
    Some(match Variable::ALL.get(index) {
        Some(variable) => Argument::Variable(*variable),
        None => Argument::Extra(index - Variable::ALL.len()),
    })
}

/// Lift and drag into body axes, or back: the same matrix both ways, because it is its own inverse.
///
/// `[CX, CZ] = M [CL, CD]`, `M = [sin a, -cos a; -cos a, -sin a]`, `dM/da = [cos a, sin a; sin a, -cos a]`.
fn turn_forces(d: Derivative, alpha: f64) -> Vec<(Derivative, f64)> {
    let (sin, cos) = alpha.sin_cos();
    let (pair, column, slope) = match d.symbol {
        Symbol::CL => ([Symbol::CX, Symbol::CZ], [sin, -cos], [cos, sin]),
        Symbol::CD => ([Symbol::CX, Symbol::CZ], [-cos, -sin], [sin, -cos]),
        Symbol::CX => ([Symbol::CL, Symbol::CD], [sin, -cos], [cos, sin]),
        Symbol::CZ => ([Symbol::CL, Symbol::CD], [-cos, -sin], [sin, -cos]),
        _ => return vec![(d, 1.0)],
    };
    let with = |argument: Argument, factors: [f64; 2]| {
        pair.into_iter().zip(factors).map(move |(symbol, factor)| (Derivative { symbol, argument }, factor))
    };
    let mut parts: Vec<_> = with(d.argument, column).collect();
    if d.argument == Argument::Constant {
        parts.extend(with(Argument::Variable(Variable::Alpha), slope));
    }
    parts
}

/// Rolling and yawing moment and the rates about x and z into the other axes.
fn turn_moments(d: Derivative, alpha: f64) -> Vec<(Derivative, f64)> {
    use Argument::{StabilityRollRate, StabilityYawRate};
    let (sin, cos) = alpha.sin_cos();
    let (roll, yaw) = (Argument::Variable(Variable::RollRate), Argument::Variable(Variable::YawRate));
    // [l, n]_s = [cos, sin; -sin, cos] [l, n]_b, and back.
    let symbols = match d.symbol {
        Symbol::Cl => vec![(Symbol::Cls, cos), (Symbol::Cns, -sin)],
        Symbol::Cn => vec![(Symbol::Cls, sin), (Symbol::Cns, cos)],
        Symbol::Cls => vec![(Symbol::Cl, cos), (Symbol::Cn, sin)],
        Symbol::Cns => vec![(Symbol::Cl, -sin), (Symbol::Cn, cos)],
        Symbol::CY => vec![(Symbol::CY, 1.0)],
        _ => return vec![(d, 1.0)],
    };
    // p_b = cos p_s - sin r_s, r_b = sin p_s + cos r_s: the derivatives turn as the rates do.
    let arguments = match d.argument {
        a if a == roll => vec![(StabilityRollRate, cos), (StabilityYawRate, -sin)],
        a if a == yaw => vec![(StabilityRollRate, sin), (StabilityYawRate, cos)],
        StabilityRollRate => vec![(roll, cos), (yaw, sin)],
        StabilityYawRate => vec![(roll, -sin), (yaw, cos)],
        a => vec![(a, 1.0)],
    };
    let pairs = symbols.iter().flat_map(|s| arguments.iter().map(move |a| (s, a)));
    pairs.map(|((symbol, f), (argument, g))| (Derivative { symbol: *symbol, argument: *argument }, f * g)).collect()
}
