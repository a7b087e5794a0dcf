//! The joint extended Kalman filter.
#![no_std]
#![no_main]

use phugoid_estimators::ekf::JointEkf;
use phugoid_onboard::{OUTPUTS, Plant, STATES, image, run_new};

fn fly<const P: usize>() {
    run_new(|settings| JointEkf::<_, STATES, OUTPUTS, P>::new(Plant, settings));
}

image!(fly);
