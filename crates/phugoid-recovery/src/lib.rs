#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod changes;
pub mod controller;
pub mod draw;
mod error;
pub mod flight;
mod history;
pub mod known;
pub mod outcome;
pub mod page;
pub mod pilot;
mod robust;
mod scale;
pub mod sensing;
pub mod study;
