//! Why an input could not be designed.

/// Why an input could not be designed.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// The request cannot be met.
    #[error("{0}")]
    Unsuitable(String),
    /// The flight that the input is fitted to.
    #[error(transparent)]
    Flight(#[from] phugoid_simulation::flight::FlightError),
    /// The accuracy that the input promises could not be computed.
    #[error(transparent)]
    Study(#[from] phugoid_evaluation::accuracy::StudyError),
}
