//! The implicit-sign law.
#![no_std]
#![no_main]

use core::hint::black_box;

use phugoid_estimators::implicit_sign::ImplicitSign;
use phugoid_onboard::{image, rows, run_new};

fn fly<const P: usize>() {
    run_new(|settings| rows::<P>(settings).and_then(|rows| ImplicitSign::new(rows, black_box(2.0))));
}

image!(fly);
