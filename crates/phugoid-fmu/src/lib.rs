#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

#[cfg(feature = "write")]
mod description;
#[cfg(feature = "write")]
mod documentation;
#[cfg(feature = "write")]
mod export;
#[cfg(feature = "write")]
mod files;
mod instance;
#[cfg(feature = "write")]
mod library;
mod point;
mod resources;
mod variables;

#[cfg(feature = "write")]
pub use export::{ExportError, Exported, Licence, Source, export};
pub use instance::{Instance, InstanceError, Interface, Mode};
#[cfg(feature = "write")]
pub use library::{Library, LibraryError};
pub use point::{Point, PointError};
pub use resources::{FILE, FORMAT, ResourceError, Resources};
pub use variables::{
    Direction, INTEGRATION_STEP_S, NOMINALS, Role, STATES, TIME, Unit, Variability, Variable, variable, variables,
};
