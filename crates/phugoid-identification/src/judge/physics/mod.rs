//! What every aeroplane has in common, asked of the model file, the flight and the estimates.
//!
//! An estimator takes the units, signs, mass and geometry that it is given for true: a reversed elevator, knots read as
//! metres per second and a mass in pounds all fit a flight perfectly, with numbers that no aeroplane has. Each check
//! here is a function with its source; [`reasons`] is the list of them. A check that finds something implausible makes
//! the result doubtful and names the line to look at; one that finds something impossible makes it refused. What a
//! check needs and the flight does not have is not asked.
//!
//! Units, signs and sensors of single channels are asked before, by [`phugoid_flight_data::plausibility`].

pub(crate) mod aircraft;
mod derivatives;
mod finding;
mod flown;
mod late;

use phugoid_flight_data::record::Record;

use crate::core::estimation::{ParameterResult, VerdictReason};
use crate::methods::Task;
use crate::motion::Motion;
use aircraft::Body;
use derivatives::Derivatives;
pub(crate) use derivatives::is_mirrored;
use flown::Flown;

/// All checks on one result. The estimates are asked only where something moved.
pub(crate) fn reasons<M: Motion<N, R>, const N: usize, const R: usize>(
    record: &Record,
    task: &Task<M, N, R>,
    parameters: &[ParameterResult],
    correlation: &[Vec<f64>],
    excited: bool,
) -> Vec<VerdictReason> {
    let body = Body::of(task);
    let flown = Flown::of(record, task);
    let mut found: Vec<VerdictReason> = Vec::new();
    found.extend(aircraft::wing(&body));
    found.extend(aircraft::inertia(&body));
    found.extend(aircraft::radii(&body));
    found.extend(flown::lift(&flown));
    found.extend(flown::drag(&flown, &body));
    if excited {
        let derivatives = Derivatives::of(task, parameters, correlation, &flown);
        found.extend(derivatives::signs(&derivatives, &flown));
        found.extend(derivatives::lift_slope(&derivatives, &flown, &body));
        found.extend(derivatives::roll_damping(&derivatives, &flown, &body));
        found.extend(derivatives::fin_arm(&derivatives));
        found.extend(derivatives::elevator_arm(&derivatives, &body));
        found.extend(late::reasons(&derivatives, &flown, &body));
        found.extend(derivatives::product_of_inertia(&derivatives, &body));
        found.extend(derivatives::sizes(&derivatives));
        found.extend(derivatives::drag(&derivatives));
    }
    found
}
