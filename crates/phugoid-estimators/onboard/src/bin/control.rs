//! No method: an image that does panic. The check has to find it, or it finds nothing at all.
#![no_std]
#![no_main]

use core::hint::black_box;

use phugoid_onboard::image;

fn fly<const P: usize>() {
    let values = black_box([0.0_f64; P]);
    black_box(values[black_box(P)]);
}

image!(fly);
