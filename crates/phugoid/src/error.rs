//! The error type of this crate.

use phugoid_flight_data::csv::WriteError;
use phugoid_flight_data::deletion::DeletionError;
use phugoid_flight_data::reader::ReadError;
use phugoid_flight_data::table::TableError;
use phugoid_flight_dynamics::f16::F16DataError;
use phugoid_flight_dynamics::modes::ModesError;
use phugoid_flight_dynamics::trim::TrimError;
use phugoid_identification::estimate::EstimateError;
use phugoid_identification::method::UnknownMethod;
use phugoid_identification::model_file::{ModelError, ModelFileError};

use crate::studies::{AircraftError, DesignError, FlightError, NamedError, ScenarioError, StudyError};

/// Why a function of this crate has no result.
///
/// Every variant carries the error of the part that failed, with its fields; the text is that part's own and says what
/// was found, what was expected and what to do. The errors of [`Record`](crate::Record), [`Model`](crate::Model) and
/// [`Session`](crate::Session) become one of these by `?`.
///
/// ```
/// use phugoid::{Error, EstimateError, EstimateOptions, Model, Record, estimate};
/// let record = Record::from_columns("short", [("time_s", vec![0.0, 0.1]), ("alpha_deg", vec![2.0, 2.1])])?;
/// match estimate(&record, &Model::named("f16")?, &EstimateOptions::default()) {
///     Err(Error::Estimate(EstimateError::MissingChannel { channel, .. })) => assert!(record.channel(&channel).is_none()),
///     other => panic!("a record without an airspeed cannot be estimated: {other:?}"),
/// }
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A flight cannot be read from a file.
    #[error(transparent)]
    Read(Box<ReadError>),
    /// A record cannot be written to a file.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Values of a record cannot be deleted as asked for.
    #[error(transparent)]
    Delete(Box<DeletionError>),
    /// Columns in memory do not make a record.
    #[error(transparent)]
    Columns(#[from] TableError),
    /// There is no model under this name or in this file, or its text is wrong.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No estimator has this name.
    #[error(transparent)]
    Method(#[from] UnknownMethod),
    /// The record or the model does not allow what was asked for.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// There is no scenario under this name.
    #[error(transparent)]
    NoScenario(#[from] NamedError),
    /// A scenario file cannot be read, or its text is wrong.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A scenario cannot be flown.
    #[error(transparent)]
    Flight(#[from] FlightError),
    /// An aircraft cannot be opened: no such file, data that make no aircraft, or options that they do not allow.
    #[error(transparent)]
    Aircraft(#[from] AircraftError),
    /// There is no trim in this condition.
    #[error(transparent)]
    Trim(#[from] TrimError),
    /// A linear model has no natural modes to give.
    #[error(transparent)]
    Modes(#[from] ModesError),
    /// No scenario of the comparison has this name.
    #[error("there is no scenario `{name}` of the comparison: {}", expected(*nearest, known))]
    NoEntry {
        /// The name asked for.
        name: String,
        /// The name that is most similar, if one is similar at all.
        nearest: Option<&'static str>,
        /// All names, in the order in which they are shown.
        known: Vec<&'static str>,
    },
    /// Many flights cannot be flown or estimated.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// An input cannot be designed.
    #[error(transparent)]
    Design(#[from] DesignError),
}

fn expected(nearest: Option<&str>, known: &[&str]) -> String {
    match nearest {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("there are {}", known.join(", ")),
    }
}

impl From<F16DataError> for Error {
    fn from(error: F16DataError) -> Self {
        Self::Aircraft(error.into())
    }
}

impl From<ReadError> for Error {
    fn from(error: ReadError) -> Self {
        Self::Read(Box::new(error))
    }
}

impl From<DeletionError> for Error {
    fn from(error: DeletionError) -> Self {
        Self::Delete(Box::new(error))
    }
}

impl From<ModelFileError> for Error {
    fn from(error: ModelFileError) -> Self {
        Self::Model(error.into())
    }
}
