//! Any bytes as an MCAP file, and the record that is made of it.
#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use phugoid_flight_data::log::mcap::{read, survey};
use phugoid_flight_data::profile::Profile;

mod common;

/// Topics of PX4 in MCAP: so that some of a file's fields are channels.
static PROFILE: LazyLock<Profile> = LazyLock::new(|| Profile::px4().expect("the built-in profile is one"));

fuzz_target!(|bytes: &[u8]| common::log(bytes, read, survey, &PROFILE));
