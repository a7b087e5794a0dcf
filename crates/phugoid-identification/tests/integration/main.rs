//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../common/mod.rs"]
mod common;

mod alpha_rate;
mod axes;
mod bad_input;
pub(crate) mod batch;
mod batch_frequency;
mod batch_hfb320;
mod batch_pipeline;
mod batch_real_records;
mod batch_unstable;
mod draft;
mod effective;
mod followed_constants;
mod form;
mod golden;
mod health;
mod hfb320;
mod longitudinal;
mod model_file;
mod model_support;
mod options;
mod readiness;
mod session;
mod six;
mod totals;
mod two_methods;
mod units;
