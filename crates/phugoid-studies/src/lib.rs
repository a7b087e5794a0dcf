//! Scenarios, Monte Carlo studies and Cramer-Rao bounds.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod quantity;
