//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../../../../tests/shared_data.rs"]
mod shared_data;
#[path = "../../../../tests/studies.rs"]
mod studies;

mod against_record;
mod air;
mod damage;
mod declared_by_default;
mod earth;
mod engines;
mod flap;
mod golden_flight;
mod known_base;
mod scenario_options;
mod sensors;
mod uncertain_base;
