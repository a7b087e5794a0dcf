#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod aircraft;
mod closed_loop;
pub mod constant_thrust;
pub mod course;
pub mod damaged;
pub mod equivalent;
pub mod flight;
pub mod manoeuvre;
pub mod model_error;
mod mounting;
pub mod named;
pub mod quantity;
pub mod scenario;
pub mod sensing;
pub mod signals;
pub mod start;
mod text;
mod toml_tree;
