//! The sliding-mode parameter estimator.
#![no_std]
#![no_main]

use phugoid_estimators::smpe::Smpe;
use phugoid_onboard::{OUTPUTS, Plant, STATES, image, run_new};

fn fly<const P: usize>() {
    run_new(|settings| Smpe::<_, STATES, OUTPUTS, P>::new(Plant, settings));
}

image!(fly);
