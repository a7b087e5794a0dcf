//! One update of the sliding-mode estimator on an aircraft model: the on-board cost, and the cost of unused capacity.
//!
//! `cargo bench -p phugoid-identification`. Change detection on; 100 Hz; a gentle elevator motion, all outputs measured.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use criterion::{Criterion, criterion_group, criterion_main};
use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_identification::longitudinal::{Database, LongitudinalInput, LongitudinalModel, OUTPUTS, STATES};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::prepare::build;

const NOISE: [f64; OUTPUTS] = [0.3, 1.7e-3, 0.9e-3, 1.7e-3, 0.1, 0.1, 0.0];

fn f16() -> (LongitudinalModel, Vec<ParameterPrior>, LongitudinalInput, [f64; STATES]) {
    let text = include_str!("../../../data/models/f16.toml").split("\n[biases]").next().unwrap();
    let file = ModelFile::parse("f16", text).unwrap();
    let aircraft = F16::new(F16Options { cg: 0.3, ..F16Options::default() }).unwrap();
    let model = build(&file, Database::F16(Box::new(aircraft)), 0.0417, -0.03425);
    let priors = file.parameters.iter().map(|p| ParameterPrior::bounded(0.0, -2.0 * p.prior_std, 2.0 * p.prior_std));
    let input = LongitudinalInput {
        elevator: -0.03425,
        air_density: 0.653,
        thrust: 9909.5,
        mass: 9299.8,
        iyy: 75673.6,
        controls_held: true,
        ..LongitudinalInput::default()
    };
    (model, priors.collect(), input, [205.74, 0.0417, 0.0417, 0.0])
}

fn hfb320() -> (LongitudinalModel, Vec<ParameterPrior>, LongitudinalInput, [f64; STATES]) {
    let file = ModelFile::named("hfb320").unwrap();
    let model = build(&file, Database::None, 0.0, 0.0);
    let priors = file.parameters.iter().map(|p| ParameterPrior::absolute(p.start, p.prior_std));
    let input = LongitudinalInput {
        elevator: -0.008,
        air_density: 0.792,
        thrust: 11550.0,
        mass: 7472.0,
        iyy: 91388.0,
        ..LongitudinalInput::default()
    };
    (model, priors.collect(), input, [106.0, 0.112, 0.105, 0.0])
}

fn update<const P: usize>(
    criterion: &mut Criterion,
    name: &str,
    (model, priors, input, x): (LongitudinalModel, Vec<ParameterPrior>, LongitudinalInput, [f64; STATES]),
) {
    let mut settings: EstimatorSettings<STATES, OUTPUTS, P> =
        EstimatorSettings::automatic(&priors, NOISE, 0.01).unwrap();
    settings.input_hold = InputHold::Linear;
    let mut out = LinearizedOutputs::<STATES, OUTPUTS, P>::ZERO;
    let theta = std::array::from_fn(|j| priors.get(j).map_or(0.0, |p| p.initial));
    model.linearized_outputs(&x, &theta, &input, &mut out);
    let outputs = out.outputs;
    let mut smpe = Smpe::new(model, settings).unwrap();
    let mut k = 0_u32;
    criterion.bench_function(name, |bencher| {
        bencher.iter(|| {
            k += 1;
            let time_s = 0.01 * f64::from(k);
            let wiggle = (0.7 * time_s).sin();
            let mut sample = Sample { time_s, input, outputs };
            sample.input.elevator += 1e-3 * wiggle;
            for (y, std) in sample.outputs.iter_mut().zip(NOISE) {
                *y += std * wiggle;
            }
            smpe.update(&sample)
        });
    });
}

fn jacobians<const P: usize>(
    criterion: &mut Criterion,
    name: &str,
    (model, priors, input, x): (LongitudinalModel, Vec<ParameterPrior>, LongitudinalInput, [f64; STATES]),
) {
    let theta: [f64; P] = std::array::from_fn(|j| priors.get(j).map_or(0.0, |p| p.initial));
    let mut rates = LinearizedRates::<STATES, P>::ZERO;
    criterion.bench_function(&format!("{name}, rates and Jacobians"), |bencher| {
        bencher.iter(|| {
            Model::<STATES, OUTPUTS, P>::linearized_rates(&model, std::hint::black_box(&x), &theta, &input, &mut rates);
            rates.rates[0]
        });
    });
}

fn all(criterion: &mut Criterion) {
    jacobians::<5>(criterion, "F-16, p = 5", f16());
    jacobians::<12>(criterion, "HFB-320, p = 11", hfb320());
    update::<5>(criterion, "SMPE update, F-16, p = 5, capacity 5", f16());
    update::<11>(criterion, "SMPE update, F-16, p = 5, capacity 11", f16());
    update::<24>(criterion, "SMPE update, F-16, p = 5, capacity 24", f16());
    update::<11>(criterion, "SMPE update, HFB-320, p = 11, capacity 11", hfb320());
    update::<24>(criterion, "SMPE update, HFB-320, p = 11, capacity 24", hfb320());
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30).measurement_time(std::time::Duration::from_secs(2));
    targets = all
}
criterion_main!(benches);
