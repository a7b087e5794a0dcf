//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../markup/mod.rs"]
mod markup;
#[path = "../synthetic/mod.rs"]
mod synthetic;

mod report;
mod reproduction;
