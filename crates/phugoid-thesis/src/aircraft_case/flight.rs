//! The reference flight of a case.

use phugoid_evaluation::accuracy::StudyError;
use phugoid_simulation::flight::Flight;

use super::case::AircraftCase;

/// Flies the reference aircraft of a case.
///
/// # Errors
/// [`StudyError::Flight`].
pub fn fly(case: &AircraftCase) -> Result<Flight, StudyError> {
    Ok(phugoid_simulation::flight::fly(&case.scenario)?)
}
