//! The recursive Fourier-transform regression.
#![no_std]
#![no_main]

use phugoid_estimators::fourier::FourierRegression;
use phugoid_onboard::{image, rows, run_new};

fn fly<const P: usize>() {
    run_new(|settings| rows::<P>(settings).and_then(FourierRegression::new));
}

image!(fly);
