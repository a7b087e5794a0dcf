//! The way of the solver to a trim, from a start of one's own.

use serde::Serialize;

use super::condition::{TrimCondition, check};
use super::error::TrimError;
use super::problem::{Problem, UNKNOWNS};
use crate::aircraft::Aircraft;

/// Where the solver starts. Any finite numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrimStart {
    /// Angle of attack to start from, rad.
    pub alpha: f64,
    /// Sideslip angle to start from, rad.
    pub beta: f64,
    /// Bank angle to start from, rad.
    pub phi: f64,
    /// Pitch angle to start from, rad.
    pub theta: f64,
    /// Throttle lever, 0 to 1.
    pub throttle: f64,
    /// Elevator to start from, rad, positive trailing edge down.
    pub elevator: f64,
    /// Aileron to start from, rad.
    pub aileron: f64,
    /// Rudder to start from, rad.
    pub rudder: f64,
}

/// Where the solver is after an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrimStep {
    /// Angle of attack after the iteration, rad.
    pub alpha_rad: f64,
    /// Throttle lever; beyond 0 to 1 while an extra force stands in for the thrust that the engine does not have.
    pub throttle: f64,
    /// Elevator after the iteration, rad, positive trailing edge down.
    pub elevator_rad: f64,
    /// Trim index of the thesis (2.31), with V' in m/s^2 as in [`Trim::trim_index`](super::Trim::trim_index).
    pub trim_index: f64,
    /// Largest of the eight residuals, as in [`Trim::largest_residual`](super::Trim::largest_residual).
    pub largest_residual: f64,
}

/// The solver's way from `start`: the start itself, then one step per iteration, the last one where it stopped.
///
/// [`trim`](super::trim) chooses its starts and checks limits; this shows the solver alone. It has arrived where the last
/// `largest_residual` is below 1e-11.
///
/// # Errors
/// [`TrimError::Condition`] for a condition or a start that makes no sense.
pub fn approach<A: Aircraft>(
    aircraft: &A,
    condition: &TrimCondition,
    start: &TrimStart,
) -> Result<Vec<TrimStep>, TrimError> {
    check(condition, aircraft.atmosphere())?;
    let TrimStart { alpha, beta, phi, theta, throttle, elevator, aileron, rudder } = *start;
    let start: [f64; UNKNOWNS] = [alpha, beta, phi, theta, throttle, elevator, aileron, rudder];
    if let Some(value) = start.iter().copied().find(|v| !v.is_finite()) {
        return Err(TrimError::Condition { field: "start", value, expected: "finite numbers" });
    }
    let gravity = aircraft.gravity();
    let mut steps = Vec::new();
    Problem::new(aircraft, condition).solve(start, &mut |unknowns, residuals| {
        // The first residual is V'/g, the next five are the rates of the index as they are.
        let speed_rate = gravity * residuals[0];
        let rates = &residuals[1..6];
        steps.push(TrimStep {
            alpha_rad: unknowns[0],
            throttle: unknowns[4],
            elevator_rad: unknowns[5],
            trim_index: speed_rate * speed_rate + rates.iter().map(|rate| rate * rate).sum::<f64>(),
            largest_residual: residuals.iter().fold(0.0, |m: f64, r| m.max(r.abs())),
        });
    });
    Ok(steps)
}
