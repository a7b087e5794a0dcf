//! Formulas that a user writes, such as `-a*sin(y)*x + B*u`: read, checked and evaluated with exact derivatives.
//!
//! Numbers, names, `+ - * / ^`, parentheses and the functions of [`Function`]. `^` binds closest and from the right, a sign in front
//! binds less: `-x^2` is `-(x^2)`. Between two factors stands a `*`. A formula can do nothing but compute: it has no loops and
//! calls nothing, its length and the depth of its nesting are bounded ([`MOST_CHARACTERS`], [`DEEPEST`]), and so are the time and
//! the stack that it takes.
//!
//! The usual crates were looked at: exmex reads `-x^2` as `(-x)^2`, fasteval and meval have not been kept up for years, and none
//! evaluates with dual numbers.

mod function;
mod node;
mod parse;
mod token;

pub(crate) use function::Function;
pub(crate) use node::Node;
pub(crate) use parse::{Meaning, parse};

/// The longest formula, characters.
pub(crate) const MOST_CHARACTERS: usize = 1000;
/// The deepest nesting of parentheses, functions, powers and signs, and the most steps from a result to a number in it: a sum of
/// so many terms.
pub(crate) const DEEPEST: usize = 100;

/// What is wrong with a formula, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("character {character}: {message}")]
pub(crate) struct ExpressionError {
    /// Number of the character, from 1.
    pub(crate) character: usize,
    /// What was found and what to write.
    pub(crate) message: String,
}
