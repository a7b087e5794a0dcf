#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | what it has |
//! |---|---|
//! | [`smpe`] | the sliding-mode parameter estimator, with bounds, sensor biases and change detection |
//! | [`ekf`] | the joint extended Kalman filter, with everything that surrounds SMPE |
//! | [`supervisor`] | what these two share: start, restart, change detection, colour correction, limits |
//! | [`settings`] | the settings of all estimators: priors, noise levels, timing |
//! | [`regression`] | what the regression methods share: equations, filters, and where the states come from |
//! | [`rls`] | recursive least squares with forgetting, on a regression without derivatives |
//! | [`fourier`] | recursive Fourier-transform regression with the end-point term |
//! | [`implicit_sign`], [`super_twisting`] | sliding laws on the same regression, for teaching |
//! | [`adaptive_model`] | the model-reference law tuned by rule |
//! | [`health`] | compares the plant with what is expected of it: a flag with a stated false-alarm rate, and the onset |
//! | [`verdict`] | whether a parameter can be used now: excitation, collinearity, convergence, whiteness |
//! | [`discretization`] | the RK4 step map of a model with its exact derivatives |
//! | [`ud`] | covariances as `U D U^T`, positive definite by construction |
//! | [`noise`] | measurement noise from the measurements themselves |
#![no_std]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod adaptive_model;
mod bounded;
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
pub mod levels;
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
pub use model::{ConstantEffects, Input, LinearizedOutputs, LinearizedRates, Model, RegressorShift, Sample};
