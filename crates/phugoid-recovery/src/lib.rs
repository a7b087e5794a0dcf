#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod body;
mod changes;
pub mod controller;
pub mod draw;
mod error;
pub mod flight;
pub mod forces;
mod history;
pub mod known;
mod learning;
pub mod outcome;
pub mod page;
pub mod performance;
pub mod pilot;
pub mod polar;
mod robust;
mod scale;
pub mod sensing;
pub mod study;
mod truth;
