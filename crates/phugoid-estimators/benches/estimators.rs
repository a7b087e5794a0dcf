//! Time of one update. The synthetic plant costs next to nothing, so this is the estimator itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../tests/plants/mod.rs"]
mod plants;
#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use phugoid_estimators::Estimator;
use phugoid_estimators::smpe::{ParameterPrior, ReReaching, Smpe, SmpeSettings};
use synthetic::{Synthetic, flight, priors};

fn smpe<const R: usize, const P: usize>(c: &mut Criterion, name: &str, parameters: usize, detection: bool) {
    let model = Synthetic::<P>::new(parameters);
    let priors: Vec<ParameterPrior> = priors(parameters);
    let mut settings = SmpeSettings::<4, R, P>::automatic(&priors, [0.01; R], 0.01).expect("sound settings");
    if !detection {
        settings.re_reaching = ReReaching::Off;
    }
    let flight = flight::<R, P>(&model, 4000);
    c.bench_function(name, |b| {
        let mut estimator = Smpe::new(model.clone(), settings).expect("sound settings");
        let mut index = 0;
        let mut lap = 0.0;
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

fn all(c: &mut Criterion) {
    smpe::<6, 5>(c, "smpe N=4 R=6 p=5 of P=5", 5, true);
    smpe::<6, 24>(c, "smpe N=4 R=6 p=5 of P=24", 5, true);
    smpe::<7, 11>(c, "smpe N=4 R=7 p=11 of P=11", 11, true);
    smpe::<7, 24>(c, "smpe N=4 R=7 p=11 of P=24", 11, true);
    smpe::<6, 24>(c, "smpe N=4 R=6 p=24 of P=24", 24, true);
    smpe::<6, 5>(c, "smpe N=4 R=6 p=5 of P=5, detection off", 5, false);
    smpe::<7, 11>(c, "smpe N=4 R=7 p=11 of P=11, detection off", 11, false);
}

criterion_group! {
    name = benches;
    config = Criterion::default().measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_secs(1)).sample_size(30);
    targets = all
}
criterion_main!(benches);
