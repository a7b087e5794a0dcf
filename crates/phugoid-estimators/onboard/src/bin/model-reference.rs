//! The model-reference law tuned by rule.
#![no_std]
#![no_main]

use phugoid_estimators::adaptive_model::AdaptiveModel;
use phugoid_onboard::{OUTPUTS, Plant, STATES, image, run_new};

fn fly<const P: usize>() {
    run_new(|settings| AdaptiveModel::<_, STATES, OUTPUTS, P>::new(Plant, &settings));
}

image!(fly);
