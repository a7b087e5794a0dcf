//! The model file: an aircraft, its coefficient build-up and what is known beforehand, in TOML.
//!
//! The format is described in `docs/model-file.md`.

mod aircraft;
mod error;
mod expected;
mod file;
mod known;
mod named;
mod parameter;
mod parse;
mod powers;
mod section;
mod settings;
mod simulation;
mod uncertainty;

pub use aircraft::{AirDensity, AircraftData, Base, RateSpeed, Reference, ReferenceValue, Source, Thrust};
pub use error::ModelFileError;
pub use file::ModelFile;
pub use known::KnownAircraft;
pub use named::ModelError;
pub use parameter::{Expectation, Parameter, Role};
pub(crate) use parse::LIGHT_TURBULENCE;
pub use powers::{ByPowers, DatabasePart};
pub use settings::{EstimatorTuning, InputHold, ProcessNoise};
pub use simulation::{EngineData, FuelData, FuelFlow, PropelledData, SimulationData, Slipstream};
pub use uncertainty::{BaseUncertainty, Propagation, Uncertainty};
