//! Scenarios, Monte Carlo studies, Cramer-Rao bounds, and the published cases that this project grew from.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod accuracy;
pub mod arena;
pub mod constant_thrust;
pub mod convergence;
pub mod cramer_rao;
pub mod damage;
pub mod design;
pub mod detection;
pub mod flight;
pub mod health;
pub mod manoeuvre;
pub mod model_error;
pub mod monte_carlo;
mod mounting;
pub mod named;
pub mod published;
pub mod quantity;
pub mod reproduction;
pub mod scenario;
mod sensing;
pub mod settling;
mod statistics;
pub mod tune;
