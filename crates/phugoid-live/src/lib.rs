//! Estimates while the aircraft flies: receives telemetry, records it, and publishes parameters with bounds.
//!
//! `docs/live.md` describes the sources, the documents that are published and the recording.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod arrival;
pub mod document;
pub mod engine;
pub mod link;
pub mod mavlink;
pub mod page;
pub mod publish;
pub mod receiver;
pub mod recording;
pub mod run;
#[cfg(feature = "server")]
pub mod server;
pub mod source;
pub mod stop;
mod text;
mod timing;
#[cfg(feature = "tui")]
pub mod tui;
pub mod view;
