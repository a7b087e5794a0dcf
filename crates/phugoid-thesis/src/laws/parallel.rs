//! The estimated model that runs beside the plant.

use phugoid_estimators::Sample;
use phugoid_estimators::discretization::{Part, sub_steps};

/// The equal integration steps of an interval of `interval_s`, none longer than `maximum_step_s` (both in s).
pub(crate) fn parts(interval_s: f64, maximum_step_s: f64) -> impl Iterator<Item = Part> {
    let steps = sub_steps(interval_s, maximum_step_s);
    (0..steps).map(move |k| Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 })
}

/// The value of the output that measures a state ([`measuring_output`](phugoid_estimators::Model::measuring_output) names it).
/// `None` where no output measures the state, and where its value is missing from this sample.
pub(crate) fn measured<I, const R: usize>(output: Option<usize>, sample: &Sample<I, R>) -> Option<f64> {
    sample.outputs.get(output?).copied().filter(|y| y.is_finite())
}
