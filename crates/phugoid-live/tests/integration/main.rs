//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../../../../tests/telemetry.rs"]
mod telemetry;

mod attacks;
mod documents;
#[cfg(feature = "server")]
mod page;
mod replay;
mod view;
