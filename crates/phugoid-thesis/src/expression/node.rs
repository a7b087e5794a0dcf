//! A formula as a tree.

use phugoid_flight_dynamics::scalar::Dual;

use super::function::Function;

/// A formula, or a part of one. Its depth is bounded, so that what descends into it recurses no deeper.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Node {
    Number(f64),
    /// One of the variables, by its place.
    Variable(usize),
    Negative(Box<Node>),
    Sum(Box<Node>, Box<Node>),
    Difference(Box<Node>, Box<Node>),
    Product(Box<Node>, Box<Node>),
    Quotient(Box<Node>, Box<Node>),
    Power(Box<Node>, Box<Node>),
    Call(Function, Box<Node>),
}

impl Node {
    /// The value with its derivatives, given those of the variables; a variable that is not given is NaN.
    pub(crate) fn at<const D: usize>(&self, variables: &[Dual<D>]) -> Dual<D> {
        match self {
            Self::Number(value) => Dual::from(*value),
            Self::Variable(place) => variables.get(*place).copied().unwrap_or(Dual::from(f64::NAN)),
            Self::Negative(a) => -a.at(variables),
            Self::Sum(a, b) => a.at(variables) + b.at(variables),
            Self::Difference(a, b) => a.at(variables) - b.at(variables),
            Self::Product(a, b) => a.at(variables) * b.at(variables),
            Self::Quotient(a, b) => a.at(variables) / b.at(variables),
            Self::Power(a, b) => power(a.at(variables), b.at(variables)),
            Self::Call(function, a) => {
                let a = a.at(variables);
                let (value, slope) = function.at(a.value);
                a.chain(value, slope)
            }
        }
    }

    /// Whether one of the variables for which this is true stands in it.
    pub(crate) fn contains(&self, is_one: &impl Fn(usize) -> bool) -> bool {
        match self {
            Self::Number(_) => false,
            Self::Variable(place) => is_one(*place),
            Self::Negative(a) | Self::Call(_, a) => a.contains(is_one),
            Self::Sum(a, b)
            | Self::Difference(a, b)
            | Self::Product(a, b)
            | Self::Quotient(a, b)
            | Self::Power(a, b) => a.contains(is_one) || b.contains(is_one),
        }
    }

    /// Whether it is `f + Phi theta`, the variables for which this is true being `theta`: they stand in sums and products
    /// alone, and in no product with one another.
    pub(crate) fn is_linear_in(&self, is_one: &impl Fn(usize) -> bool) -> bool {
        let linear = |node: &Self| node.is_linear_in(is_one);
        match self {
            Self::Number(_) | Self::Variable(_) => true,
            Self::Negative(a) => linear(a),
            Self::Sum(a, b) | Self::Difference(a, b) => linear(a) && linear(b),
            Self::Product(a, b) => linear(a) && linear(b) && !(a.contains(is_one) && b.contains(is_one)),
            Self::Quotient(a, b) => linear(a) && !b.contains(is_one),
            Self::Power(..) | Self::Call(..) => !self.contains(is_one),
        }
    }
}

/// `a^b`. The derivative by the exponent needs the logarithm of `a`, and is asked for only where the exponent varies: a square of a
/// negative number has its derivative too.
fn power<const D: usize>(a: Dual<D>, b: Dual<D>) -> Dual<D> {
    let value = libm::pow(a.value, b.value);
    let by_base = if b.value == 0.0 { 0.0 } else { b.value * libm::pow(a.value, b.value - 1.0) };
    let mut result = a.chain(value, by_base);
    if b.derivatives.iter().any(|d| *d != 0.0) {
        let by_exponent = if value == 0.0 { 0.0 } else { value * libm::log(a.value) };
        for (sum, d) in result.derivatives.iter_mut().zip(b.derivatives) {
            *sum += by_exponent * d;
        }
    }
    result
}
