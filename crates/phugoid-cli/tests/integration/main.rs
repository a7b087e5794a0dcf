//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/live.rs"]
mod live_program;
#[cfg(feature = "fleet")]
#[path = "../common/stores.rs"]
mod stores;
#[path = "../../../../tests/telemetry.rs"]
mod telemetry;

mod aircraft;
mod axes;
mod check;
mod compare;
mod deletion;
mod destinations;
mod field;
mod fleet;
mod fly;
mod help;
mod init;
mod inspect;
mod kept_runs;
mod live;
mod logs;
mod mapped_replay;
mod mistakes;
mod monitor;
mod offer;
mod px4_log;
mod records;
mod regress;
mod reproduce;
mod results;
mod strangers;
mod systematic;
mod tune;
mod view;
