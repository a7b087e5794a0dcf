//! Why a flight in closed loop could not be made.

use phugoid_evaluation::ledger::LedgerError;
use phugoid_flight_dynamics::sensors::SensorError;
use phugoid_identification::error::EstimateError;
use phugoid_simulation::flight::FlightError;
use phugoid_simulation::scenario::ScenarioError;

/// Why a flight could not be made.
#[derive(Debug, thiserror::Error)]
pub enum RecoveryError {
    /// The scenario cannot be flown.
    #[error(transparent)]
    Flight(#[from] FlightError),
    /// Something in the scenario is wrong.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A sensor cannot be.
    #[error("a sensor of the scenario: {0}")]
    Sensor(#[from] SensorError),
    /// The estimator cannot be set up, or cannot go on.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// What is kept of a study cannot be read or written.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
    /// No gains for the undamaged aircraft.
    #[error("no gains can be placed for the undamaged aircraft: its linear model has numbers that are not finite")]
    NoGains,
    /// Parts of a scenario that a flight in closed loop does not have.
    #[error("{0}")]
    Unsuitable(String),
}
