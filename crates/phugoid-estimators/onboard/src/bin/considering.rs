//! Both filters for state and parameters, following the errors of constants.
#![no_std]
#![no_main]

use phugoid_estimators::ekf::ConsideringEkf;
use phugoid_estimators::smpe::ConsideringSmpe;
use phugoid_onboard::{CONSTANTS, OUTPUTS, Plant, STATES, image, run_new};

fn fly<const P: usize>() {
    run_new(|settings| ConsideringSmpe::<_, STATES, OUTPUTS, P, CONSTANTS>::new(Plant, settings));
    run_new(|settings| ConsideringEkf::<_, STATES, OUTPUTS, P, CONSTANTS>::new(Plant, settings));
}

image!(fly);
