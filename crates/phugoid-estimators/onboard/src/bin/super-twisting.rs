//! The super-twisting law.
#![no_std]
#![no_main]

use phugoid_estimators::super_twisting::SuperTwisting;
use phugoid_onboard::{image, rows, run_new};

fn fly<const P: usize>() {
    run_new(|settings| rows::<P>(settings).map(SuperTwisting::new));
}

image!(fly);
