//! The judgement of a run: results with verdicts and advice, terms that the model lacks, derivatives in other axes.

mod advice;
pub(crate) mod contradiction;
mod effective;
mod equations;
mod fit;
pub mod form;
pub(crate) mod offer;
pub(crate) mod readiness;
mod reasons;
pub(crate) mod summary;
mod verdict;
