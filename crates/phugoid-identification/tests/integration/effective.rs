//! What a flight tells of q and the rate of alpha: their sum, and their parts only where it told them apart.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use crate::common;

use common::Normal;
use common::f16::{NOISE, TRIM, channel, three_two_one_one, unbiased};
use phugoid_estimators::discretization::{self, InputHold, IntervalInput, Part};
use phugoid_estimators::{LinearizedOutputs, Model};
use phugoid_flight_data::record::{Channel, Quantity, Record};
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::Estimation;
use phugoid_identification::longitudinal::{LongitudinalModel, OUTPUTS, STATES};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::prepare::prepare;

/// Room for the six increments of [`model`], in its order: CL, CD, Cm with alpha, q, the rate of alpha, elevator.
const P: usize = 6;
const TRUTH: [f64; P] = [0.4, 0.1, -0.2, -2.0, -1.5, 0.15];

fn model() -> ModelFile {
    let text = unbiased()
        .replace("Cm = [\"alpha\", \"q_hat\",", "Cm = [\"alpha\", \"q_hat\", \"alpha_dot_hat\",")
        .replace("[parameters] ", "[process_noise]\n\n[parameters]\ndCm_alpha_dot = { bounds = [-6, 6] }\n#");
    ModelFile::parse("alpha-dot", &text).unwrap_or_else(|e| panic!("{e}"))
}

/// A flight of the model itself at 50 Hz with this elevator (deflection from trim, rad).
fn fly(seconds: f64, seed: u64, elevator: impl Fn(f64) -> f64) -> Estimation {
    let samples = (50.0 * seconds) as usize;
    let time: Vec<f64> = (0..samples).map(|k| 0.02 * k as f64).collect();
    let names = ["true_airspeed", "alpha", "theta", "q", "ax", "az"];
    let mut channels = vec![
        channel("elevator", Quantity::Angle, time.iter().map(|t| TRIM[1] + elevator(*t)).collect()),
        channel("altitude", Quantity::Length, vec![6096.0; samples]),
    ];
    channels.extend(names.map(|name| -> Channel {
        let quantity = match name {
            "true_airspeed" => Quantity::Speed,
            "q" => Quantity::AngularRate,
            "ax" | "az" => Quantity::Acceleration,
            _ => Quantity::Angle,
        };
        channel(name, quantity, vec![0.0; samples])
    }));
    let mut record = Record { source: "simulated".to_owned(), time, channels, ..Record::default() };
    let prepared = prepare::<LongitudinalModel, _, _>(&record, &model()).unwrap();
    let mut normal = Normal::new(seed);
    let mut x = [205.74, TRIM[0], TRIM[0], 0.0];
    for k in 0..samples {
        let input = prepared.inputs[k];
        let mut out = LinearizedOutputs::<STATES, OUTPUTS, P>::ZERO;
        prepared.model.linearized_outputs(&x, &TRUTH, &input, &mut out);
        for i in 0..6 {
            record.channels[2 + i].values[k] = out.outputs[i] + NOISE[i] * normal.next();
        }
        let interval = IntervalInput { from: input, to: input, hold: InputHold::Zero };
        let (mut sensitivity, mut transition) = ([[0.0; P]; STATES], [[0.0; STATES]; STATES]);
        let part = Part { from: 0.0, to: 1.0 };
        x = discretization::step::<_, STATES, OUTPUTS, P>(
            &prepared.model,
            &x,
            &TRUTH,
            &interval,
            0.02,
            part,
            0,
            &mut sensitivity,
            &mut transition,
        );
    }
    let options = EstimateOptions { change_detection: Some(false), ..EstimateOptions::default() };
    estimate(&record, &model(), &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"))
}

fn std(estimation: &Estimation, name: &str) -> f64 {
    let found = estimation.parameters.iter().find(|p| p.name == name);
    found.unwrap_or_else(|| panic!("no {name}")).corrected_std_error
}

#[test]
fn one_manoeuvre_tells_the_sum_and_says_so() {
    let (mut worst, sum) = (0.0_f64, TRUTH[3] + TRUTH[4]);
    for seed in 0..6 {
        let estimation = fly(10.0, seed, |t| three_two_one_one(t, 0.026));
        let [effective] = estimation.effective.as_slice() else { panic!("{:?}", estimation.effective) };
        println!("{effective:?}, {} {}", std(&estimation, "dCm_q"), std(&estimation, "dCm_alpha_dot"));
        assert_eq!(effective.name, "dCm_q + dCm_alpha_dot");
        assert!(!effective.separable, "{effective:?}");
        // The sum is known several times better than either part.
        assert!(effective.std_error < 0.33 * std(&estimation, "dCm_alpha_dot"), "{effective:?}");
        let told = estimation.verdict.iter().any(|s| s.contains("cannot be told apart") && s.contains("effective"));
        assert!(told, "{:?}", estimation.verdict);
        worst = worst.max((effective.value - sum).abs() / effective.std_error);
    }
    // Six draws of a normal number: beyond 3.5 sigma once in 350 such tests.
    assert!(worst < 3.5, "{worst}");
}
