//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../plants/mod.rs"]
mod plants;
#[path = "../synthetic/mod.rs"]
mod synthetic;

mod considered;
mod discretization;
mod ekf;
mod feedback;
mod health;
mod identity;
mod invariance;
mod lyapunov;
mod no_panic;
mod noise;
mod regression;
mod smpe;
mod ud;
mod verdict;
