//! The thesis's comparison with a model-reference estimator (equations 3.1 to 3.3): the same flight, the same samples, all
//! methods side by side.
//!
//! The unknown is `dCm_q`, as in the thesis. The gains of all laws are searched for on training flights first, so that no
//! law loses for want of a gain; the flagship has none. [`ComparisonCase`] is the format of the file, [`ComparisonCase::run`]
//! compares on one flight, [`random`] on many truths of both signs.

mod case;
mod method;
pub mod random;
mod run;
mod tuning;

pub use case::{Comparison, ComparisonCase, UNKNOWN};
pub use method::{Flown, Gain, Method, Normalised, Score, Setting, Track};
pub use tuning::{Tuned, training_flights, tune};

use super::embedded::case as embedded_case;
use super::{Entry, Reproduction};
use phugoid_evaluation::accuracy::StudyError;

/// Entries of the comparison.
pub(super) const ENTRIES: &[Entry] = &[
    Entry { id: "model-reference/1", title: "Model reference, scenario 1: found too, later", run },
    Entry { id: "model-reference/2", title: "Model reference, scenario 2: not found", run },
    Entry { id: "model-reference/random", title: "Model reference, random truths of both signs", run: random::run },
];

pub(super) const FILES: [(&str, &str); 2] = [
    ("model-reference/1", include_str!("../../../../scenarios/thesis/model-reference-1.toml")),
    ("model-reference/2", include_str!("../../../../scenarios/thesis/model-reference-2.toml")),
];

/// A published comparison by id, e.g. `model-reference/1`.
///
/// # Errors
/// [`StudyError::Unsuitable`]: there is none of that id.
pub fn published_comparison(id: &str) -> Result<ComparisonCase, StudyError> {
    embedded_case(&FILES, id, ComparisonCase::parse)
}

fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    published_comparison(id)?.run(id, progress)
}
