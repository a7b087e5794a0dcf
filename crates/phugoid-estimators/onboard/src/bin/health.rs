//! The health monitor beside any estimator.
#![no_std]
#![no_main]

use core::hint::black_box;

use phugoid_estimators::health::{Expected, HealthMonitor, MonitorSettings, Watched};
use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::{Estimator, Inspect};
use phugoid_onboard::{AnyEstimator, OUTPUTS, Plant, STATES, any_sample, image, settings};

fn fly<const P: usize>() {
    let expected = [Some(Expected { value: 0.0, tolerance: 0.1, failure_std: 1.0, constant: false }); P];
    let expected = black_box(expected);
    let settings: Option<EstimatorSettings<STATES, OUTPUTS, P>> = settings();
    let Some(settings) = settings else { return };
    let Ok(mut monitor) = HealthMonitor::new(Plant, &settings, &expected, black_box(MonitorSettings::default())) else {
        return;
    };
    let monitor = black_box(&mut monitor);
    let mut estimator = AnyEstimator::<P>::hidden();
    let sample = any_sample();
    let watched = Watched {
        estimate: &estimator.update(&sample),
        covariance: &black_box([[0.0; P]; P]),
        residuals: &estimator.innovations().normalised,
        noise_std: &black_box([0.01; OUTPUTS]),
        noise_scales: &black_box([1.0; 4]),
    };
    black_box(monitor.update(&sample, &watched));
    black_box((monitor.expected(), monitor.threshold()));
    monitor.acknowledge();
    black_box(monitor);
}

image!(fly);
