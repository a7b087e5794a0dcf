//! From an aircraft and a flight record to aerodynamic parameters with bounds.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
mod advice;
pub mod axes;
pub mod batch;
pub mod compatibility;
mod effective;
mod error;
pub mod estimate;
pub mod estimation;
mod excitation;
pub mod export;
pub mod form;
pub mod front_end;
pub mod health;
pub mod inspect;
mod intake;
pub mod lateral;
pub mod longitudinal;
pub mod manoeuvres;
pub mod method;
pub mod model_file;
pub mod monitor;
pub mod motion;
pub mod noise;
mod offer;
mod options;
pub mod output;
pub mod prepare;
mod readiness;
pub mod rigid;
mod run;
pub mod session;
pub mod six;
pub mod stack;
mod summary;
pub mod term;
pub mod trim;
mod verdict;
mod words;

// The helpers of the integration tests, used in unit tests too, call this crate by its name.
#[cfg(test)]
extern crate self as phugoid_identification;
