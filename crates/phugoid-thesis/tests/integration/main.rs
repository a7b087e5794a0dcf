//! Every integration test of this crate in one program: each program more is linked with all libraries once more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

#[path = "../../../phugoid-identification/tests/common/mod.rs"]
mod common;
#[path = "../../../phugoid-estimators/tests/plants/mod.rs"]
mod plants;

mod aircraft_cases;
mod entries;
mod extended_law;
mod golden;
mod law_on_flights;
mod laws;
mod model_reference;
mod model_reference_law;
mod one_parameter_law;
mod own_plant;
mod plant_cases;
mod plants_by_formula;
mod plants_themselves;
mod studies;
mod tune;
mod two_parameter_law;
mod unscented;
