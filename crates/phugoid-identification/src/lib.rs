#![doc = include_str!("../README.md")]
//!
//! ## Modules
//!
//! | module | what it is for |
//! |---|---|
//! | [`estimate`] | from a record and a model file to an [`Estimation`](estimation::Estimation): the function to start with |
//! | [`session`] | the same estimation live, sample by sample |
//! | [`monitor`] | the same, with a monitor that says whether the aircraft is still as expected |
//! | [`model_file`] | model files: reading, checking, the built-in ones |
//! | [`options`], [`method`](mod@method) | options of an estimation, and the methods to choose from |
//! | [`estimation`], [`health`], [`error`] | the results as plain data, and the errors |
//! | [`inspect`], [`manoeuvres`] | what a record holds, and which derivatives could be estimated from it, without estimating |
//! | [`compatibility`] | errors of the sensors from the kinematics of a rigid body; corrected records |
//! | [`regress`](mod@regress) | which polynomial a coefficient of a flight asks for: orthogonal functions, stepwise regression |
//! | [`aircraft`] | a model file, or an identified model, as an aircraft that trims and flies |
//! | [`form`] | derivatives in body axes and stability axes, with their covariance |
//! | [`export`] | estimates as CSV and Parquet; identified models for JSBSim and Gazebo |
//! | [`batch`] | equation error, output error and filter error for any model, not only aircraft |
//! | [`axes`], [`output`], [`term`] | the words of model files: axes, measured channels, terms of the coefficients |
//! | [`longitudinal`], [`lateral`], [`six`], [`rigid`] | the equations of motion as models for the estimators |
//! | [`motion`] | the interface between these models and the estimation |
//! | [`prepare`], [`trim`], [`noise`], [`front_end`] | steps of the preparation: signals, level trim, noise levels, smoothed states |
//! | [`stack`] | how much stack an estimation needs |
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
pub mod aircraft;
pub mod batch;
pub mod compatibility;
mod core;
pub mod draft;
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
pub mod regress;

pub use self::core::{axes, error, estimation, health, method, options, output, stack, term};
pub use judge::form;
pub use models::{lateral, longitudinal, rigid, six};
pub use pipeline::{estimate, monitor, session};
pub use preparation::{front_end, noise, parts, prepare, trim};

// The helpers of the integration tests, used in unit tests too, call this crate by its name.
#[cfg(test)]
extern crate self as phugoid_identification;
