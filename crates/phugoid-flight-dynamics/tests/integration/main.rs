//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../light_aircraft/mod.rs"]
mod light_aircraft;
#[path = "../reference/mod.rs"]
mod reference;

mod check_case;
mod daveml;
mod dryden;
mod dual;
mod earth;
mod equations;
mod globe;
mod increments;
mod integrate;
mod linearize;
mod second_aircraft;
mod sensors;
mod simulate;
mod trim;
