//! What is asked of an estimation and what it answers: plain data that every other part shares, without computation
//! beyond their own conversions.

pub mod axes;
pub(crate) mod correlation;
pub mod error;
pub mod estimation;
pub mod health;
pub mod method;
pub(crate) mod number;
pub mod options;
pub mod output;
#[cfg(test)]
pub(crate) mod random;
pub(crate) mod scaling;
pub(crate) mod shifts;
pub(crate) mod soundness;
pub mod stack;
pub(crate) mod systematic;
pub mod term;
pub(crate) mod words;
