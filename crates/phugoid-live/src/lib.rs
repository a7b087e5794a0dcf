//! Estimates while the aircraft flies: receives telemetry, records it, and publishes parameters with bounds.
//!
//! `docs/live.md` describes the sources, the documents that are published and the recording.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod page;
#[cfg(feature = "tui")]
pub mod tui;
pub mod view;
