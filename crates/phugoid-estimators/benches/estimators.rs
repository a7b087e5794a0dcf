//! Time of one update. The synthetic plant costs next to nothing, so this is the estimator itself. Compare the methods within
//! one run.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../tests/methods/mod.rs"]
mod methods;
#[path = "../tests/plants/mod.rs"]
mod plants;
#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use methods::{METHODS, Run, with_method};
use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::{Estimator, Sample};
use synthetic::{Synthetic, flight, priors};

struct Bench<'a, const R: usize> {
    criterion: &'a mut Criterion,
    name: String,
    flight: Vec<Sample<[f64; 1], R>>,
}

impl<const R: usize, const P: usize> Run<R, P> for Bench<'_, R> {
    fn run(&mut self, mut estimator: impl Estimator<R, P, Input = [f64; 1]>) {
        let flight = &self.flight;
        let mut index = 0;
        let mut lap = 0.0;
        self.criterion.bench_function(&self.name, |b| {
            b.iter(|| {
                let mut sample = flight[index];
                sample.time_s += lap;
                index += 1;
                if index == flight.len() {
                    index = 0;
                    lap += 40.0;
                }
                black_box(estimator.update(black_box(&sample)))
            });
        });
    }
}

fn measure<const R: usize, const P: usize>(c: &mut Criterion, method: &str, parameters: usize, detection: bool) {
    let model = Synthetic::<P>::new(parameters);
    let mut settings =
        EstimatorSettings::<4, R, P>::automatic(&priors(parameters), [0.01; R], 0.01).expect("sound settings");
    if !detection {
        settings.change_detection = None;
    }
    let off = if detection { "" } else { ", detection off" };
    let name = format!("{method} N=4 R={R} p={parameters} of P={P}{off}");
    let flight = flight::<R, P>(&model, 4000);
    with_method(method, model, settings, Bench { criterion: c, name, flight });
}

fn all(c: &mut Criterion) {
    for method in METHODS {
        measure::<6, 4>(c, method, 4, true);
        measure::<7, 11>(c, method, 11, true);
        measure::<6, 24>(c, method, 24, true);
    }
    // What unused room and the detection cost.
    measure::<6, 5>(c, "smpe", 5, true);
    measure::<6, 24>(c, "smpe", 5, true);
    measure::<7, 24>(c, "smpe", 11, true);
    for method in ["smpe", "ekf"] {
        measure::<6, 5>(c, method, 5, false);
        measure::<7, 11>(c, method, 11, false);
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_secs(1)).sample_size(30);
    targets = all
}
criterion_main!(benches);
