//! The judgement of a run: results with verdicts and advice, terms that the model lacks, derivatives in other axes.

mod advice;
mod agreement;
mod attitude;
pub(crate) mod both_sides;
mod by_surfaces;
mod chance;
mod constancy;
mod contradiction;
mod disputed;
mod effective;
mod equations;
mod explained;
mod fit;
pub mod form;
mod input_noise;
mod integrity;
mod normal;
pub(crate) mod offer;
pub(crate) mod physics;
pub(crate) mod readiness;
pub(crate) mod reasons;
mod smoothed;
pub(crate) mod summary;
mod systematic;
pub(crate) mod total;
mod verdict;
