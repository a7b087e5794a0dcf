//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../common/damage.rs"]
mod damage;
#[cfg(target_os = "linux")]
#[path = "../common/damaged.rs"]
mod damaged;
#[cfg(any(feature = "excel", feature = "matlab", feature = "parquet"))]
#[path = "../common/flight.rs"]
mod flight;
#[cfg(target_os = "linux")]
#[path = "../common/hostile.rs"]
mod hostile;
#[path = "../logs/mod.rs"]
mod logs;
#[path = "../../../../tests/shared_data.rs"]
mod shared_data;

mod align;
mod bad_input;
mod columnar;
mod damaged_logs;
mod dataflash;
mod excel;
mod flights;
mod logs_to_records;
mod matlab;
mod mcap;
mod memory;
mod plausibility;
mod properties;
mod tables;
mod times;
mod tlog;
mod ulog;
mod units_document;
