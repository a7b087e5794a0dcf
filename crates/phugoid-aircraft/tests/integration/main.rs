//! Integration tests: one program, since each is linked with every library again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../../../../tests/shared_data.rs"]
mod shared_data;
#[path = "../simulators/mod.rs"]
mod simulators;

mod daveml_broken;
mod daveml_flown;
mod daveml_models;
mod daveml_moved;
mod daveml_standard;
mod daveml_trim;
mod daveml_write;
mod flown;
mod flown_closed;
mod jsbsim;
mod jsbsim_flown;
mod nesc;
mod published_atmosphere;
mod tp1538;
mod transport;
mod transport_broken;
mod transport_flight;
