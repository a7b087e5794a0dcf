#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod analysis;
pub mod campaign;
pub mod content;
pub mod key;
pub mod logs;
pub mod page;
#[cfg(feature = "parquet")]
pub mod reports;
pub mod row;
#[cfg(feature = "parquet")]
pub mod run;
#[cfg(feature = "parquet")]
pub mod schema;
pub mod shard;
pub mod simulated;
pub mod source;
pub mod statistics;
#[cfg(feature = "parquet")]
pub mod store;
#[cfg(feature = "parquet")]
pub mod study;
pub mod unit;
