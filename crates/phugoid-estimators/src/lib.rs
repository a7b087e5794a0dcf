//! Causal estimators of aerodynamic parameters, with bounds.
//!
//! Every plant here is linear in its unknown parameters,
//!
//! ```text
//! x' = f(x, u) + Phi(x, u) theta        x: N states, theta: p <= P parameters
//! y  = h(x, theta, u) + noise           y: R measured outputs
//! ```
//!
//! and is described once by a [`Model`]. An estimator is written once against that trait and never hears of an
//! aircraft. It takes one [`Sample`] at a time and gives back an [`Estimate`]; it allocates nothing, does not block,
//! does not panic, and takes a bounded number of operations per update.
//!
//! | module | what |
//! |---|---|
//! | [`smpe`] | the flagship: sliding-mode parameter estimator with bounds, biases and change detection |
//! | [`ekf`] | the joint extended Kalman filter, with all that surrounds SMPE |
//! | [`health`] | the estimate against what is expected: a flag with a stated false-alarm rate, and the onset |
//! | [`rls`] | recursive least squares with forgetting, on a regression without derivatives |
//! | [`fourier`] | recursive Fourier-transform regression with the end-point term |
//! | [`implicit_sign`], [`super_twisting`] | sliding laws on the same regression, for teaching |
//! | [`regression`] | what the regression methods share: equations, filters, and where the states come from |
//! | [`adaptive_model`] | the model-reference law tuned by rule, for an aircraft |
//! | [`discretization`] | the RK4 step map of a model with its exact derivatives |
//! | [`ud`] | covariances as `U D U^T`, positive definite by construction |
//! | [`verdict`] | may a parameter be believed now: excitation, collinearity, convergence, whiteness |
//! | [`noise`] | measurement noise told from the measurements |
//!
//! `P` is the capacity fixed at compile time; the number of parameters in use is a run-time length. One compiled
//! estimator with `P = 24` serves a laptop, another with `P = 5` a flight computer (docs/performance.md measures what
//! the unused capacity costs).
#![no_std]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod adaptive_model;
mod change_detection;
mod columns;
mod dense;
pub mod discretization;
pub mod ekf;
mod estimate;
pub mod fourier;
pub mod health;
pub mod implicit_sign;
mod innovation;
mod kernels;
mod model;
pub mod noise;
pub mod regression;
pub mod rls;
pub mod settings;
pub mod smpe;
mod statistics;
pub mod super_twisting;
pub mod supervisor;
pub mod ud;
pub mod verdict;

pub use estimate::{
    ChangeState, DetectorReport, DetectorState, Estimate, Estimator, Inspect, ParameterStatus, Phase, Status,
};
pub use innovation::{Innovations, RowPhase};
pub use model::{Input, LinearizedOutputs, LinearizedRates, Model, Sample};
