//! What an identified model is for the writer: coefficients as sums of products, each with a value that was estimated and
//! how well it is known.

/// A model to be written by [`super::write`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IdentifiedModel {
    /// Name of the model.
    pub name: String,
    /// Who made it; a file of the standard has an author.
    pub author: String,
    /// Organisation of the author; may be empty.
    pub organisation: String,
    /// Date of the identification, ISO 8601.
    pub created: String,
    /// What it is a model of, and where it holds.
    pub description: String,
    /// Geometry and reference condition: numbers that the model refers to.
    pub constants: Vec<Constant>,
    /// What has to be known to evaluate the model, such as the angle of attack; or the coefficients of a database that
    /// the model is an increment to.
    pub inputs: Vec<Input>,
    /// Variables between the inputs and the terms, such as a rate made dimensionless. Each may use those of any place.
    pub derived: Vec<Derived>,
    /// The coefficients: the outputs.
    pub coefficients: Vec<Coefficient>,
    /// Correlations between estimated values. Those that are not listed are not known to be zero: the standard has no way
    /// to say so.
    pub correlations: Vec<Correlation>,
    /// Values of the inputs for which check data are written.
    pub check_points: Vec<CheckPoint>,
}

/// A number that is not estimated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constant {
    /// Identifier; see [`super::identifier`].
    pub id: String,
    /// Name for others; the identifier if it is empty.
    pub name: String,
    /// Unit in the spelling of the standard.
    pub units: String,
    /// Its value, in `units`; finite.
    pub value: f64,
    /// What it is; may be empty.
    pub description: String,
}

/// A variable that is set from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Input {
    /// Identifier; see [`super::identifier`].
    pub id: String,
    /// Name for others, best one of the standard such as `angleOfAttack`; the identifier if it is empty.
    pub name: String,
    /// Unit in the spelling of the standard.
    pub units: String,
    /// Which direction is positive; may be empty.
    pub sign: String,
    /// What it is; may be empty.
    pub description: String,
    /// Whether the name is one of the standard.
    pub standard: bool,
}

/// A variable that is computed from others.
#[derive(Clone, Debug, PartialEq)]
pub struct Derived {
    /// Identifier; see [`super::identifier`].
    pub id: String,
    /// Name for others; the identifier if it is empty.
    pub name: String,
    /// Unit in the spelling of the standard.
    pub units: String,
    /// How it is computed.
    pub value: Expression,
}

/// A formula.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// A number; finite.
    Number(f64),
    /// The variable with this identifier.
    Variable(String),
    /// The sum of all.
    Sum(Vec<Expression>),
    /// The product of all.
    Product(Vec<Expression>),
    /// The first less the second.
    Difference(Box<Expression>, Box<Expression>),
    /// The first over the second.
    Quotient(Box<Expression>, Box<Expression>),
    /// The magnitude.
    Magnitude(Box<Expression>),
    /// The largest of all.
    Largest(Vec<Expression>),
}

/// A coefficient as the sum of its terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coefficient {
    /// Identifier; see [`super::identifier`].
    pub id: String,
    /// Name for others, best one of the standard such as `aeroBodyMomentCoefficient_Pitch`; the identifier if it is empty.
    pub name: String,
    /// What it is; may be empty.
    pub description: String,
    /// Whether the name is one of the standard.
    pub standard: bool,
    /// Its terms; none makes it zero.
    pub terms: Vec<Term>,
}

/// A term of a coefficient: a value times variables.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Term {
    /// Identifier of the derivative, such as `Cm_alpha`; see [`super::identifier`].
    pub id: String,
    /// Unit in the spelling of the standard; `nd` if it is empty.
    pub units: String,
    /// Identifiers of the variables that the value is multiplied with, one of them again for its square. None makes it the
    /// constant of the coefficient.
    pub factors: Vec<String>,
    /// The value; finite.
    pub value: f64,
    /// Its standard uncertainty, in the unit of the value; not negative. None for what was not estimated.
    pub standard_uncertainty: Option<f64>,
}

/// A correlation between the values of two terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correlation {
    /// Identifier of a term with an uncertainty.
    pub first: String,
    /// Identifier of another.
    pub second: String,
    /// Coefficient of correlation, from -1 to 1.
    pub coefficient: f64,
}

/// Values of inputs for a check case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CheckPoint {
    /// Name of the case.
    pub name: String,
    /// Identifiers of the inputs, all of them, with their values in the unit of the input.
    pub inputs: Vec<(String, f64)>,
}
