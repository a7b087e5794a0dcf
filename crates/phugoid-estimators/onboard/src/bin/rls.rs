//! Recursive least squares.
#![no_std]
#![no_main]

use core::hint::black_box;

use phugoid_estimators::rls::RecursiveLeastSquares;
use phugoid_onboard::{any_sample, image, rows, run_new, settings};

fn fly<const P: usize>() {
    run_new(|settings| rows::<P>(settings).map(RecursiveLeastSquares::new));
    if let Some(Ok(mut observed)) = settings().map(|settings| rows::<P>(settings).map(RecursiveLeastSquares::new)) {
        black_box(observed.update_observed(&any_sample(), |row| {
            black_box(row);
        }));
    }
}

image!(fly);
