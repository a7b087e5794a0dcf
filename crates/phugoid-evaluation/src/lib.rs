#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod accuracy;
pub mod arena;
pub mod chart;
pub mod convergence;
pub mod cramer_rao;
pub mod damage;
pub mod detection;
mod exact;
pub mod field;
pub mod health;
pub mod ledger;
pub mod monte_carlo;
pub mod published;
pub mod put_in;
pub mod settling;
pub mod statistics;
pub mod table;
pub mod tune;
