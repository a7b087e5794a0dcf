//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../../../phugoid-flight-dynamics/tests/light_aircraft/mod.rs"]
mod light_aircraft;
#[path = "../../../../tests/shared_data.rs"]
mod shared_data;
#[path = "../../../../tests/studies.rs"]
mod studies;

mod accuracy;
mod arena;
mod batch;
mod begun_again;
mod compatibility_field;
mod cramer_rao_f16;
mod detection;
mod input_timing;
mod lateral;
mod look_back;
mod manoeuvres;
mod noise_levels;
mod offer;
mod predicted_bound;
mod recorders;
mod second_aircraft;
mod second_answer;
mod smoothed_states;
mod stack;
mod told_by_flight;
