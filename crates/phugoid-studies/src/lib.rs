//! Scenarios, Monte Carlo studies and Cramer-Rao bounds.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod cramer_rao;
pub mod monte_carlo;
pub mod quantity;
