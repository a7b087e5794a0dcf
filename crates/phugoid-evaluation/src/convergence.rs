//! Convergence study: the time after which the estimates stay close to the truth.

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
    /// Name of the parameter, as in the model file.
    pub name: String,
    /// True value of the parameter in the flight, in its unit.
    pub truth: f64,
    /// Estimate after the last sample, in the parameter's unit; NaN if there is none.
    pub value: f64,
    /// Time after the start of the input from which on the error stays within the tolerance, s; none if it never does.
    pub reached_after_s: Option<f64>,
}

/// Result of a convergence study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConvergenceStudy {
    /// Name of the scenario that was flown.
    pub scenario: String,
    /// Name of the model file with which the flight was estimated.
    pub model: String,
    /// Largest error that counts as having reached the truth, fraction of the true value.
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
///
/// ```
/// use phugoid_evaluation::convergence::convergence;
/// use phugoid_evaluation::published::{CALM_MODEL, CALM_SCENARIO};
/// use phugoid_identification::model_file::ModelFile;
/// use phugoid_simulation::scenario::Scenario;
///
/// let scenario = Scenario::parse(&CALM_SCENARIO.replace("20 s", "12 s"), "f16-calm")?;
/// let model = ModelFile::parse("f16-model", CALM_MODEL)?;
/// let study = convergence(&scenario, &model, 0.2)?;
/// assert!((study.input_starts_s - 0.5).abs() < 0.02); // the first 3-2-1-1 starts at 0.5 s
/// let pitching = study.parameters.iter().find(|p| p.name == "dCm_alpha").expect("the model has it");
/// assert!(pitching.reached_after_s.is_some_and(|t| t < 11.5)); // within 20 % of the truth, and it stays there
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn convergence(scenario: &Scenario, model: &ModelFile, tolerance: f64) -> Result<ConvergenceStudy, StudyError> {
    let flight = fly(scenario)?;
    let trim = flight.trim.elevator_rad;
    let elevator = flight.truth.channel("elevator").map(|c| c.values.as_slice()).unwrap_or_default();
    let Some(start) = elevator.iter().position(|e| (e - trim).abs() > 1e-12).and_then(|k| flight.truth.time.get(k))
    else {
        return Err(StudyError::Unsuitable(format!("{}: the elevator does not move", scenario.name)));
    };
    let options = EstimateOptions { truth: flight.true_parameters.clone(), ..EstimateOptions::causal() };
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
