//! From an aircraft and a flight record to aerodynamic parameters with bounds.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
pub mod batch;
pub mod compatibility;
mod core;
pub mod export;
pub mod inspect;
mod judge;
pub mod manoeuvres;
mod methods;
pub mod model_file;
mod models;
pub mod motion;
mod pipeline;
mod preparation;

pub use self::core::{axes, error, estimation, health, method, options, output, term};
pub use judge::form;
pub use models::{lateral, longitudinal, rigid, six};
pub use pipeline::{estimate, monitor, session, stack};
pub use preparation::{front_end, noise, prepare, trim};

// The helpers of the integration tests, used in unit tests too, call this crate by its name.
#[cfg(test)]
extern crate self as phugoid_identification;
