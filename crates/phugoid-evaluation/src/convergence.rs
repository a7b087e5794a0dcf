//! When do the estimates reach the truth?

use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::model_file::ModelFile;
use serde::Serialize;

use crate::accuracy::StudyError;
use crate::settling::settled_at;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

/// When one parameter reached the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reached {
    /// Parameter.
    pub name: String,
    /// True value.
    pub truth: f64,
    /// Estimate at the end.
    pub value: f64,
    /// Time after the start of the input from which on the error stays within the tolerance, s; none if it never does.
    pub reached_after_s: Option<f64>,
}

/// Result of a convergence study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConvergenceStudy {
    /// Scenario.
    pub scenario: String,
    /// Model file.
    pub model: String,
    /// Error counted as reached, fraction of the truth.
    pub tolerance: f64,
    /// When the input starts to move: the first sample whose elevator differs from that of the trim, s.
    pub input_starts_s: f64,
    /// Parameters in the model's order.
    pub parameters: Vec<Reached>,
}

/// Flies `scenario`, estimates with `model`, and says when each parameter came within `tolerance` (a fraction) of its
/// truth to stay.
///
/// # Errors
/// [`StudyError`]: the scenario cannot be flown, the model does not fit it, the elevator does not move.
pub fn convergence(scenario: &Scenario, model: &ModelFile, tolerance: f64) -> Result<ConvergenceStudy, StudyError> {
    let flight = fly(scenario)?;
    let trim = flight.trim.elevator_rad;
    let elevator = flight.truth.channel("elevator").map(|c| c.values.as_slice()).unwrap_or_default();
    let Some(start) = elevator.iter().position(|e| (e - trim).abs() > 1e-12).and_then(|k| flight.truth.time.get(k))
    else {
        return Err(StudyError::Unsuitable(format!("{}: the elevator does not move", scenario.name)));
    };
    let options = EstimateOptions { truth: flight.true_parameters.clone(), ..EstimateOptions::default() };
    let estimation = estimate(&flight.measured, model, &options, &mut |_| {})?;
    let time = &estimation.history.time_s;
    let parameters = estimation
        .history
        .parameters
        .iter()
        .filter_map(|history| {
            let truth = *flight.true_parameters.get(&history.name)?;
            Some(Reached {
                name: history.name.clone(),
                truth,
                value: history.value.last().copied().unwrap_or(f64::NAN),
                reached_after_s: settled_at(time, &history.value, truth, tolerance).map(|t| t - start),
            })
        })
        .collect();
    Ok(ConvergenceStudy {
        scenario: scenario.name.clone(),
        model: model.name.clone(),
        tolerance,
        input_starts_s: *start,
        parameters,
    })
}
