#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod aircraft;
mod comparison;
mod error;
mod estimation;
mod examination;
mod simulation;
mod studies;

pub use phugoid_aircraft::flown::FlownOptions;
pub use phugoid_flight_data::deletion::{Deleted, Deletion, DeletionError, DeletionFile, DeletionFileError};
pub use phugoid_flight_data::memory::Memory;
pub use phugoid_flight_data::reader::ReadError;
pub use phugoid_flight_data::record::{Channel, Quantity, Record};
pub use phugoid_flight_data::table::TableError;
pub use phugoid_flight_dynamics::aircraft::Aircraft;
pub use phugoid_flight_dynamics::built_in::{AircraftName, BuiltInAircraft};
pub use phugoid_flight_dynamics::f16::{F16, F16Options, F16Tables};
pub use phugoid_flight_dynamics::trim::{Trim, TrimCondition};
pub use phugoid_identification::compatibility::{Compatibility, CompatibilityOptions};
pub use phugoid_identification::estimate::{EstimateError, EstimateOptions, Method, StructureSearch, with_offered};
pub use phugoid_identification::estimation::{
    Estimation, EstimationStatus, EventKind, FinalStatus, ParameterResult, Phase, Readiness, ReasonCode, VerdictReason,
};
pub use phugoid_identification::inspect::Inspection;
#[doc(inline)]
pub use phugoid_identification::model_file::{ModelError, ModelFile as Model};
pub use phugoid_identification::session::{Session, Snapshot, Step};

pub use aircraft::{Linearization, linearize, trim};
pub use comparison::{compare, compare_entries, entry};
pub use error::Error;
pub use estimation::{estimate, estimate_with_progress};
pub use examination::{compatibility, inspect};
pub use simulation::{simulate, simulate_with_progress};
pub use studies::{
    AircraftError, AnyAircraft, Arena, DesignError, Entry, Flight, FlightError, NamedError, Scenario, ScenarioError,
    StudyError,
};

/// The crates from which this one takes its items, for functions that it does not re-export. Their interfaces change
/// more often than the interface of this crate.
pub mod parts {
    pub use crate::studies::{Surface, design};
    pub use phugoid_estimators as estimators;
    pub use phugoid_flight_data as flight_data;
    pub use phugoid_flight_dynamics as flight_dynamics;
    pub use phugoid_identification as identification;
}
