//! The verdict beside any estimator.
#![no_std]
#![no_main]

use core::hint::black_box;

use phugoid_estimators::Estimator;
use phugoid_estimators::verdict::VerdictMonitor;
use phugoid_onboard::{AnyEstimator, OUTPUTS, any_sample, image};

fn fly<const P: usize>() {
    let mut monitor = VerdictMonitor::<OUTPUTS, P>::new();
    let (monitor, mut estimator) = (black_box(&mut monitor), AnyEstimator::<P>::hidden());
    let estimate = estimator.update(&any_sample());
    monitor.update(&estimate, &estimator);
    black_box(monitor.verdict(&estimate, &estimator));
}

image!(fly);
