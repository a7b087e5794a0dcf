//! The flagship on a linear short period: what it must find, and what must not upset it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::settings::{
    ChangeDetection, ChangePrior, EstimatorSettings, ParameterPrior, ProcessNoise, SettingsError,
};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::{
    ChangeState, DetectorState, Estimate, Estimator, LinearizedOutputs, LinearizedRates, Model, ParameterStatus, Phase,
    Sample,
};
use plants::*;
use proptest::prelude::*;
use rand::RngExt;

type Jet = Smpe<ShortPeriod, 2, 3, 8>;
type JetSample = Sample<[f64; 1], 3>;

fn jet_priors() -> [ParameterPrior; 4] {
    let around = |truth: f64, start: f64| ParameterPrior::bounded(start, truth - truth.abs(), truth + truth.abs());
    [around(JET_TRUTH[0], -0.35), around(JET_TRUTH[1], -10.0), around(JET_TRUTH[2], 6.5), around(JET_TRUTH[3], -0.8)]
}

fn jet_settings() -> EstimatorSettings<2, 3, 8> {
    EstimatorSettings::automatic(&jet_priors(), JET_NOISE, 0.01).expect("sound settings")
}

fn jet() -> Jet {
    Jet::new(JET, jet_settings()).unwrap()
}

fn truth8() -> [f64; 8] {
    let mut theta = [0.0; 8];
    theta[..4].copy_from_slice(&JET_TRUTH[..4]);
    theta
}

fn run(estimator: &mut Jet, flight: &[JetSample]) -> Vec<Estimate<8>> {
    flight.iter().map(|sample| estimator.update(sample)).collect()
}

fn jet_flight(seed: u64, n: usize) -> Vec<JetSample> {
    fly(&JET, &regular(n, 0.01), [0.0; 2], |_| truth8(), |t| [elevator_3211(t)], JET_NOISE, &mut seeded(seed))
}

/// Root mean square over flights and parameters of the error in units of the claimed standard error.
fn normalised_rms(finals: &[Estimate<8>], truth: &[f64; 8]) -> f64 {
    let mut sum = 0.0;
    for estimate in finals {
        for j in 0..4 {
            let e = (estimate.parameters[j] - truth[j]) / estimate.corrected_std_error[j];
            sum += e * e;
        }
    }
    (sum / (4.0 * finals.len() as f64)).sqrt()
}

fn assert_finite(estimate: &Estimate<8>) {
    for values in [&estimate.parameters, &estimate.std_error, &estimate.corrected_std_error, &estimate.observability] {
        assert!(values.iter().all(|v| v.is_finite()), "{estimate:?}");
    }
}

#[test]
fn finds_the_short_period_within_its_bounds() {
    // 2-sigma coverage over 60 seeded flights of 10 s: 240 verdicts, binomial 95 % has a standard deviation of 1.4 %.
    let mut inside = 0;
    let mut finals = Vec::new();
    for seed in 0..60 {
        let last = *run(&mut jet(), &jet_flight(seed, 1000)).last().unwrap();
        for j in 0..4 {
            let error = (last.parameters[j] - JET_TRUTH[j]).abs();
            if error < 2.0 * last.corrected_std_error[j] {
                inside += 1;
            }
            // Every parameter of a 3-2-1-1 ends within a tenth of the prior.
            assert_eq!(last.parameter_status[j], ParameterStatus::Converged, "seed {seed} parameter {j}");
            assert!(last.corrected_std_error[j] >= last.std_error[j]);
        }
        finals.push(last);
    }
    let coverage = f64::from(inside) / 240.0;
    let rms = normalised_rms(&finals, &truth8());
    println!("2-sigma coverage {coverage}, rms error over claimed {rms}");
    assert!((0.91..=1.0).contains(&coverage), "{coverage}");
    assert!((0.8..1.2).contains(&rms), "{rms}");
}

#[test]
fn starts_causally_and_replays_what_it_collected() {
    let flight = jet_flight(1, 40);
    let mut estimator = jet();
    let all = run(&mut estimator, &flight);
    let priors = jet_priors();
    for k in 0..20 {
        // 0.2 s at 100 Hz: twenty frames are collected, nothing is claimed yet.
        assert_eq!(all[k].status.phase, Phase::Starting);
        for j in 0..4 {
            assert_eq!(all[k].parameters[j], priors[j].initial);
            assert_eq!(all[k].std_error[j], priors[j].std);
        }
    }
    assert_eq!(all[20].status.phase, Phase::Sliding);
    assert_ne!(all[20].parameters[2], priors[2].initial);
    // A different future changes nothing: only samples up to this one are used.
    let mut other = jet_flight(1, 40);
    for sample in &mut other[30..] {
        sample.outputs = [1.0; 3];
    }
    let again = run(&mut jet(), &other);
    assert_eq!(all[..30], again[..30]);
}

#[test]
fn an_outlier_in_the_first_sample_does_not_start_the_state() {
    let mut flight = jet_flight(2, 1000);
    flight[0].outputs = [20.0 * JET_NOISE[0], -20.0 * JET_NOISE[1], 20.0 * JET_NOISE[2]];
    let last = *run(&mut jet(), &flight).last().unwrap();
    assert!(normalised_rms(&[last], &truth8()) < 2.5);
}

/// A first-order lag whose record starts with the step: the state moves by 160 sigma inside the start window, and its
/// median is half of that away from where the record begins.
#[test]
fn a_record_that_starts_in_the_middle_of_a_motion_is_started_with_care() {
    let mut square = 0.0;
    for seed in 0..40 {
        let flight = fly(&FirstOrder, &regular(100, 0.01), [0.0], |_| [3.0], |_| [1.0], [1e-3, 0.0], &mut seeded(seed));
        // The derivative has no noise and is not used.
        let settings =
            EstimatorSettings::automatic(&[ParameterPrior::bounded(5.0, 1.0, 9.0)], [1e-3, 0.0], 0.01).unwrap();
        let mut estimator = Smpe::<_, 1, 2, 1>::new(FirstOrder, settings).unwrap();
        for sample in &flight {
            estimator.update(sample);
        }
        let last = estimator.estimate();
        square += ((last.parameters[0] - 3.0) / last.corrected_std_error[0]).powi(2) / 40.0;
    }
    let rms = square.sqrt();
    println!("started in a motion: rms error over claimed {rms}");
    assert!((0.7..1.3).contains(&rms), "{rms}");
}

#[test]
fn outliers_of_twenty_sigma_cost_little() {
    // Theory section 5: 5 % of all values, 20 sigma; kappa 3 with the second threshold stays at 1.0 of the bound.
    let (mut clean, mut dirty) = (Vec::new(), Vec::new());
    let (mut clean_square, mut dirty_square) = (0.0, 0.0);
    for seed in 0..30 {
        let mut flight = jet_flight(seed, 1000);
        clean.push(*run(&mut jet(), &flight).last().unwrap());
        let mut rng = seeded(9000 + seed);
        for sample in &mut flight {
            for i in 0..3 {
                if rng.random::<f64>() < 0.05 {
                    sample.outputs[i] += 20.0 * JET_NOISE[i] * if rng.random::<bool>() { 1.0 } else { -1.0 };
                }
            }
        }
        let mut estimator = jet();
        let all = run(&mut estimator, &flight);
        assert!(all.iter().any(|e| e.status.phase == Phase::Rejected));
        assert_eq!(estimator.detector().unwrap().adoptions, 0, "seed {seed}");
        dirty.push(*all.last().unwrap());
    }
    for (a, b) in clean.iter().zip(&dirty) {
        for j in 0..4 {
            clean_square += ((a.parameters[j] - JET_TRUTH[j]) / JET_TRUTH[j]).powi(2);
            dirty_square += ((b.parameters[j] - JET_TRUTH[j]) / JET_TRUTH[j]).powi(2);
        }
    }
    let ratio = (dirty_square / clean_square).sqrt();
    let rms = normalised_rms(&dirty, &truth8());
    println!("outliers: rms error over clean {ratio}, over claimed {rms}");
    assert!(ratio < 1.25, "{ratio}");
    assert!(rms < 1.25, "{rms}");
}

#[test]
fn missing_frames_missing_values_and_irregular_times_are_ordinary() {
    let mut finals = Vec::new();
    for seed in 0..30 {
        let mut rng = seeded(500 + seed);
        let mut t = 0.0;
        let times: Vec<f64> = (0..900)
            .map(|_| {
                t += 0.002 + 0.02 * rng.random::<f64>();
                t
            })
            .collect();
        let mut flight =
            fly(&JET, &times, [0.0; 2], |_| truth8(), |t| [elevator_3211(t)], JET_NOISE, &mut seeded(seed));
        let mut predicted = 0;
        for sample in &mut flight[1..] {
            if rng.random::<f64>() < 0.1 {
                sample.outputs = [f64::NAN; 3];
            } else if rng.random::<f64>() < 0.2 {
                sample.outputs[rng.random_range(0..3)] = f64::NAN;
            }
        }
        let mut estimator = jet();
        for sample in &flight {
            let estimate = estimator.update(sample);
            assert_finite(&estimate);
            if estimate.status.phase == Phase::Predicting {
                assert!(sample.outputs.iter().all(|y| y.is_nan()));
                predicted += 1;
            }
        }
        assert!(predicted > 40, "{predicted}");
        assert_eq!(estimator.restarts(), 0);
        finals.push(estimator.estimate());
    }
    let rms = normalised_rms(&finals, &truth8());
    println!("irregular, 10 % dropped, 20 % incomplete: rms error over claimed {rms}");
    assert!((0.7..1.25).contains(&rms), "{rms}");
}

#[test]
fn a_dead_channel_is_lived_with() {
    let mut flight = jet_flight(3, 1500);
    for sample in &mut flight {
        sample.outputs[1] = f64::NAN;
    }
    let mut settings = jet_settings();
    // q is never read, so its start must come from the settings.
    settings.initial_state_std = [0.0, 0.01];
    let mut estimator = Jet::new(JET, settings).unwrap();
    let last = *run(&mut estimator, &flight).last().unwrap();
    assert_finite(&last);
    assert!(normalised_rms(&[last], &truth8()) < 2.5);
    assert!(last.observability[0] > 0.9);
}

#[test]
fn time_that_does_not_increase_is_refused() {
    let flight = jet_flight(4, 600);
    let mut plain = jet();
    let mut disturbed = jet();
    for (k, sample) in flight.iter().enumerate() {
        let a = plain.update(sample);
        let b = disturbed.update(sample);
        assert_eq!(a, b);
        if k % 50 == 30 {
            for time_s in [sample.time_s, sample.time_s - 0.5, f64::NAN, f64::NEG_INFINITY, f64::INFINITY] {
                let refused = disturbed.update(&Sample { time_s, ..*sample });
                assert_eq!(refused.parameters, b.parameters);
                assert_eq!(refused.status.phase, Phase::Rejected);
            }
        }
    }
    assert_eq!(disturbed.rejected_samples(), 12 * 5);
}

#[test]
fn a_long_gap_starts_the_state_again_and_keeps_the_parameters() {
    let mut flight = jet_flight(5, 3000);
    // 12 s without a record, in which the aircraft has moved on.
    flight.drain(900..2100);
    let mut estimator = jet();
    let all = run(&mut estimator, &flight);
    assert_eq!(estimator.restarts(), 1);
    assert_eq!(all[900].status.phase, Phase::Starting);
    assert_eq!(all[900].parameters, all[899].parameters);
    assert_eq!(all[900].std_error, all[899].std_error);
    let last = all.last().unwrap();
    assert!(normalised_rms(&[*last], &truth8()) < 2.0);
    for j in 0..4 {
        assert!(last.std_error[j] < all[899].std_error[j]);
    }
    assert_eq!(estimator.detector().unwrap().adoptions, 0);
}

#[test]
fn a_gap_short_enough_is_predicted_through() {
    let mut flight = jet_flight(6, 1500);
    // A second without samples while the elevator rests.
    flight.drain(700..800);
    let mut settings = jet_settings();
    settings.maximum_gap_s = 2.0;
    let mut estimator = Jet::new(JET, settings).unwrap();
    let last = *run(&mut estimator, &flight).last().unwrap();
    assert_eq!(estimator.restarts(), 0);
    assert!(normalised_rms(&[last], &truth8()) < 2.0);
}

#[test]
fn an_unrecorded_input_does_not_spoil_the_parameters() {
    // A second of elevator that the record does not show: the estimated state is lost and nearly every row rejected.
    let mut lost = 0;
    for seed in 0..10 {
        let shown = |t: f64| [elevator_3211(t)];
        let real = |t: f64| [elevator_3211(t) + if (8.0..9.0).contains(&t) { 0.15 } else { 0.0 }];
        let mut flight = fly(&JET, &regular(2500, 0.01), [0.0; 2], |_| truth8(), real, JET_NOISE, &mut seeded(seed));
        for sample in &mut flight {
            sample.input = shown(sample.time_s);
        }
        // With change detection the challenger, whose state is free again, does the same without a restart.
        let mut watched = jet();
        let last = *run(&mut watched, &flight).last().unwrap();
        assert!(watched.restarts() + watched.detector().unwrap().adoptions > 0, "seed {seed}");
        for j in 0..4 {
            let error = (last.parameters[j] / JET_TRUTH[j] - 1.0).abs();
            assert!(error < 0.1, "watched, seed {seed} parameter {j}: {error}");
        }
        let mut settings = jet_settings();
        settings.change_detection = None;
        let mut estimator = Jet::new(JET, settings).unwrap();
        let all = run(&mut estimator, &flight);
        let sliding = all[1500..].iter().filter(|e| e.status.phase == Phase::Sliding).count();
        assert!(sliding > 900, "seed {seed}: {sliding} of 1000 frames slide");
        lost += estimator.restarts();
        let last = all.last().unwrap();
        for j in 0..4 {
            let error = (last.parameters[j] / JET_TRUTH[j] - 1.0).abs();
            assert!(error < 0.1, "seed {seed} parameter {j}: {error}");
        }
    }
    assert!(lost >= 10, "{lost}");
}

#[test]
fn without_excitation_the_bounds_stay_at_the_prior() {
    let flight = fly(&JET, &regular(2000, 0.01), [0.0; 2], |_| truth8(), |_| [0.0], JET_NOISE, &mut seeded(7));
    let mut estimator = jet();
    let last = *run(&mut estimator, &flight).last().unwrap();
    let priors = jet_priors();
    for j in 0..4 {
        assert_eq!(last.parameter_status[j], ParameterStatus::NotExcited, "parameter {j}");
        // Not exactly the prior: the median start leaves a transient, and the estimated state carries noise.
        assert!(last.std_error[j] > 0.8 * priors[j].std, "parameter {j}: {}", last.std_error[j]);
        assert!((last.parameters[j] - priors[j].initial).abs() < priors[j].std);
    }
    assert_eq!(estimator.detector().unwrap().adoptions, 0);
}

/// `Cma` of the unstable aircraft: time to double about 0.6 s.
const UNSTABLE: f64 = 0.9;

/// Closed-loop flight of the unstable aircraft under a simple feedback of pitch rate and angle of attack, with an
/// elevator part that the record does not show.
fn unstable_flight(n: i32, hidden: impl Fn(f64) -> f64) -> (Vec<JetSample>, [f64; 8]) {
    let mut truth = truth8();
    truth[0] = UNSTABLE;
    let mut rng = seeded(8);
    let dt = 0.01;
    let mut x = [0.0; 2];
    let mut flight: Vec<JetSample> = Vec::new();
    for k in 0..n {
        let t = f64::from(k) * dt;
        let shown = elevator_3211(t) + 1.6 * x[0] + 0.4 * x[1];
        let step = fly(&JET, &[t, t + dt], x, |_| truth, |_| [shown + hidden(t)], [0.0; 3], &mut rng);
        let outputs = core::array::from_fn(|i| step[0].outputs[i] + JET_NOISE[i] * normal(&mut rng));
        flight.push(Sample { time_s: t, input: [shown], outputs });
        x = [step[1].outputs[0], step[1].outputs[1]];
    }
    (flight, truth)
}

fn unstable_settings() -> EstimatorSettings<2, 3, 8> {
    let mut priors = jet_priors();
    priors[0] = ParameterPrior::bounded(0.0, -2.0, 2.0);
    EstimatorSettings::automatic(&priors, JET_NOISE, 0.01).unwrap()
}

#[test]
fn an_unstable_aircraft_is_identified_in_closed_loop() {
    let (flight, truth) = unstable_flight(1000, |_| 0.0);
    let mut estimator = Jet::new(JET, unstable_settings()).unwrap();
    let last = *run(&mut estimator, &flight).last().unwrap();
    println!("unstable: Cma {} +- {}", last.parameters[0], last.corrected_std_error[0]);
    assert!(normalised_rms(&[last], &truth) < 2.0);
    assert!((last.parameters[0] - UNSTABLE).abs() < 0.05);
    assert_eq!(estimator.restarts(), 0);
}

/// A second of elevator that the record does not show: the estimated state is lost, and on an unstable model it runs
/// away for good unless it is started again.
#[test]
fn a_lost_state_is_started_again() {
    let (flight, truth) = unstable_flight(2500, |t| if (8.0..9.0).contains(&t) { 0.15 } else { 0.0 });
    let mut settings = unstable_settings();
    settings.change_detection = None;
    let mut estimator = Jet::new(JET, settings).unwrap();
    let all = run(&mut estimator, &flight);
    let sliding = all[1500..].iter().filter(|e| e.status.phase == Phase::Sliding).count();
    println!("lost state: {} restarts, {sliding} of the last 1000 frames slide", estimator.restarts());
    assert!(sliding > 900, "{sliding}");
    assert!((1..10).contains(&estimator.restarts()), "{}", estimator.restarts());
    assert!((all[2499].parameters[0] - truth[0]).abs() < 0.1);
}

#[test]
fn sensor_biases_need_their_columns() {
    let bias = [0.0035, 0.0009, 0.1];
    let mut with_square: f64 = 0.0;
    let mut without_square: f64 = 0.0;
    let mut finals = Vec::new();
    for seed in 0..10 {
        let mut flight = jet_flight(seed, 2000);
        for sample in &mut flight {
            for i in 0..3 {
                sample.outputs[i] += bias[i];
            }
        }
        let without = *run(&mut jet(), &flight).last().unwrap();
        let settings = jet_settings().with_biases([0.005, 0.002, 0.2]);
        let mut estimator = Jet::new(JET, settings).unwrap();
        let with = *run(&mut estimator, &flight).last().unwrap();
        assert_eq!(estimator.column_count(), 7);
        assert_eq!(estimator.bias_column(2), Some(6));
        for i in 0..3 {
            let error = (with.parameters[4 + i] - bias[i]).abs();
            assert!(error < 4.0 * with.corrected_std_error[4 + i], "bias {i} seed {seed}: {error}");
        }
        for j in 0..4 {
            with_square += (with.parameters[j] / JET_TRUTH[j] - 1.0).powi(2);
            without_square += (without.parameters[j] / JET_TRUTH[j] - 1.0).powi(2);
        }
        finals.push(with);
    }
    let rms = normalised_rms(&finals, &truth8());
    println!(
        "biases: rms relative error {} with, {} without columns; over claimed {rms}",
        (with_square / 40.0).sqrt(),
        (without_square / 40.0).sqrt()
    );
    assert!(rms < 1.3, "{rms}");
    assert!(without_square > 4.0 * with_square);
}

#[test]
fn process_noise_adapts_to_what_drives_the_states() {
    // Gusts as white noise on alpha of 1e-4 rad^2/s, given to the estimator a hundred times too small.
    let drive = 1e-4_f64;
    let dt = 0.01;
    let mut rng = seeded(12);
    let mut x = [0.0; 2];
    let mut flight: Vec<JetSample> = Vec::new();
    for k in 0..6000 {
        let t = f64::from(k) * dt;
        let input = [elevator_busy(t)];
        let step = fly(&JET, &[t, t + dt], x, |_| truth8(), |_| input, [0.0; 3], &mut rng);
        let outputs = core::array::from_fn(|i| step[0].outputs[i] + JET_NOISE[i] * normal(&mut rng));
        flight.push(Sample { time_s: t, input, outputs });
        x = [step[1].outputs[0] + (drive * dt).sqrt() * normal(&mut rng), step[1].outputs[1]];
    }
    let mut settings = jet_settings();
    settings.process_noise = ProcessNoise::adaptive([0.01 * drive, 0.0]);
    let mut estimator = Jet::new(JET, settings).unwrap();
    let last = *run(&mut estimator, &flight).last().unwrap();
    let [scale, ..] = estimator.process_noise_scales();
    println!("process noise scale {scale} for 100");
    assert!((50.0..200.0).contains(&scale), "{scale}");
    assert!(normalised_rms(&[last], &truth8()) < 2.0);
}

#[test]
fn coloured_residuals_widen_the_corrected_bounds() {
    // An alpha vane error of 0.2 deg that swings at 0.5 Hz: not white, and the plain covariance does not know it.
    let mut finals = Vec::new();
    let mut plain: f64 = 0.0;
    for seed in 0..40 {
        let mut rng = seeded(700 + seed);
        let phase = rng.random_range(0.0..core::f64::consts::TAU);
        let mut flight = jet_flight(seed, 2000);
        for sample in &mut flight {
            sample.outputs[0] += 0.0035 * (2.9 * sample.time_s + phase).sin();
        }
        let mut settings = jet_settings();
        settings.change_detection = None;
        let mut estimator = Jet::new(JET, settings).unwrap();
        let last = *run(&mut estimator, &flight).last().unwrap();
        for j in 0..4 {
            plain += ((last.parameters[j] - JET_TRUTH[j]) / last.std_error[j]).powi(2) / 160.0;
        }
        finals.push(last);
    }
    let corrected = normalised_rms(&finals, &truth8());
    println!("coloured: rms error {} of the plain and {corrected} of the corrected bound", plain.sqrt());
    assert!(corrected < 0.7 * plain.sqrt(), "{corrected} {}", plain.sqrt());
}

fn damaged(t: f64) -> [f64; 8] {
    let mut theta = truth8();
    if t >= 20.0 {
        theta[0] *= 0.6;
        theta[2] *= 0.8;
        theta[3] *= 0.7;
    }
    theta
}

#[test]
fn a_damage_is_found_and_adopted() {
    let mut latencies = Vec::new();
    for seed in 0..10 {
        let flight = fly(
            &JET,
            &regular(4000, 0.01),
            [0.0; 2],
            damaged,
            |t| [elevator_busy(t)],
            JET_NOISE,
            &mut seeded(40 + seed),
        );
        let mut estimator = jet();
        let mut adopted = None;
        let mut doubted = None;
        for sample in &flight {
            let estimate = estimator.update(sample);
            assert_finite(&estimate);
            match estimate.status.change {
                ChangeState::Adopted => adopted = adopted.or(Some(estimate.time_s)),
                ChangeState::InDoubt => doubted = doubted.or(Some(estimate.time_s)),
                ChangeState::Steady | ChangeState::OnProbation => {}
                ChangeState::RolledBack => panic!("seed {seed}: a real change was taken back"),
            }
            assert!(sample.time_s >= 20.0 || adopted.is_none(), "seed {seed}: adopted before the damage");
        }
        let adopted = adopted.unwrap_or_else(|| panic!("seed {seed}: missed; {:?}", estimator.detector()));
        assert!(doubted.unwrap() <= adopted);
        latencies.push(adopted - 20.0);
        let last = estimator.estimate();
        let rms = normalised_rms(&[last], &damaged(40.0));
        assert!(rms < 2.5, "seed {seed}: {rms}");
    }
    latencies.sort_by(f64::total_cmp);
    println!("adopted after {latencies:.2?} s");
    assert!(latencies[9] < 1.5, "{latencies:?}");
}

/// rereaching.md 7(b) in small: bias columns, 3 % outliers of 20 sigma, 2 % dropped frames, damage at 10 s.
#[test]
fn a_damage_is_found_among_biases_outliers_and_drops() {
    let (mut found, mut early, mut extra, mut finals) = (0, 0, 0, Vec::new());
    let mut latencies = Vec::new();
    for seed in 0..40 {
        let damaged_at_10 = |t: f64| damaged(t + 10.0);
        let mut flight = fly(
            &JET,
            &regular(2500, 0.01),
            [0.0; 2],
            damaged_at_10,
            |t| [elevator_busy(t)],
            JET_NOISE,
            &mut seeded(300 + seed),
        );
        let mut rng = seeded(5300 + seed);
        for sample in &mut flight {
            for i in 0..3 {
                sample.outputs[i] += [0.003, 0.001, 0.1][i];
                if rng.random::<f64>() < 0.03 {
                    sample.outputs[i] += 20.0 * JET_NOISE[i];
                }
            }
            if rng.random::<f64>() < 0.02 {
                sample.outputs = [f64::NAN; 3];
            }
        }
        let mut estimator = Jet::new(JET, jet_settings().with_biases([0.005, 0.002, 0.2])).unwrap();
        let mut adopted = Vec::new();
        for sample in &flight {
            if estimator.update(sample).status.change == ChangeState::Adopted {
                adopted.push(sample.time_s);
            }
        }
        early += adopted.iter().filter(|t| **t < 10.0).count();
        match adopted.iter().find(|t| **t >= 10.0) {
            Some(t) => {
                found += 1;
                latencies.push(t - 10.0);
                finals.push(estimator.estimate());
            }
            None => println!("seed {seed}: missed, {:?}", estimator.detector()),
        }
        extra += adopted.iter().filter(|t| **t >= 10.0).count().saturating_sub(1);
    }
    latencies.sort_by(f64::total_cmp);
    let rms = normalised_rms(&finals, &damaged(40.0));
    println!(
        "found {found} of 40, {early} adoptions before, {extra} extra; median latency {:.2} s, largest {:.2} s; rms error \
         over claimed at the end {rms:.2}",
        latencies[latencies.len() / 2],
        latencies.last().unwrap()
    );
    // Measured on 100 flights: 92 found, 1 adoption before the damage. Learning from every window at once, as the
    // prototype did: 26 and 1; the first window after the damage was taken for model error.
    assert!(found >= 34, "{found}");
    assert!(early <= 1, "{early}");
    assert!(extra <= 2, "{extra}");
    assert!(rms < 1.6, "{rms}");
}

/// Found without being told against told at the instant: 60 flights, the errors half a second and two seconds after the damage.
#[test]
fn a_change_that_is_found_is_nearly_as_good_as_one_that_is_told() {
    let mut errors = [[0.0; 2]; 2];
    let mut told_settings = jet_settings();
    told_settings.change_detection = None;
    for seed in 0..60 {
        let (noise, stick) = (&mut seeded(640 + seed), |t: f64| [elevator_busy(t)]);
        let flight = fly(&JET, &regular(2250, 0.01), [0.0; 2], damaged, stick, JET_NOISE, noise);
        let (mut found, mut told) = (jet(), Jet::new(JET, told_settings).unwrap());
        for sample in &flight {
            if (sample.time_s - 20.0).abs() < 1e-6 {
                assert!(told.reopen_now());
                let before = told.estimate();
                // The change prior is there at once, and what is told is said with the next sample.
                assert!((0..4).all(|j| before.std_error[j] > 0.4 * jet_priors()[j].std), "{before:?}");
                assert_eq!(told.update(sample).status.change, ChangeState::Adopted);
            } else {
                told.update(sample);
            }
            found.update(sample);
            for (k, after_s) in [0.5, 2.0].into_iter().enumerate() {
                if (sample.time_s - 20.0 - after_s).abs() < 1e-6 {
                    for (i, estimate) in [found.estimate(), told.estimate()].into_iter().enumerate() {
                        let error = |j: usize| (estimate.parameters[j] - damaged(22.0)[j]) / jet_priors()[j].std;
                        errors[k][i] += (0..4).map(|j| error(j).powi(2)).sum::<f64>();
                    }
                }
            }
        }
    }
    let ratio = errors.map(|[found, told]| (found / told).sqrt());
    println!("root mean square error over the told one: {:.2} after 0.5 s, {:.2} after 2 s", ratio[0], ratio[1]);
    assert!(ratio[1] < 1.3, "{ratio:?}");
}

#[test]
fn what_has_no_change_prior_cannot_be_opened() {
    let mut settings = jet_settings();
    for prior in &mut settings.priors {
        prior.change_std = ChangePrior::None;
    }
    let mut estimator = Jet::new(JET, settings).unwrap();
    run(&mut estimator, &jet_flight(1, 300));
    let before = estimator.estimate();
    assert!(!estimator.reopen_now() && !estimator.reopen_columns_now(&[0]));
    assert_eq!(estimator.estimate(), before);
}

/// Of a change of one parameter the others stay as known as they were, and what an earlier change has opened stays unknown.
#[test]
fn the_columns_that_are_meant_are_opened_alone() {
    let mut settings = jet_settings();
    settings.change_detection = None;
    let mut estimator = Jet::new(JET, settings).unwrap();
    run(&mut estimator, &jet_flight(1, 1500));
    let before = estimator.estimate();
    // A column that does not exist is no column.
    assert!(!estimator.reopen_columns_now(&[]) && !estimator.reopen_columns_now(&[99]));
    assert_eq!(estimator.estimate(), before);
    assert!(estimator.reopen_columns_now(&[2]));
    let opened = estimator.estimate();
    for j in 0..4 {
        let grown = opened.std_error[j] / before.std_error[j];
        assert!(if j == 2 { grown > 3.0 } else { (grown - 1.0).abs() < 1e-9 }, "{j}: {grown}");
        assert_eq!(opened.parameters[j], before.parameters[j]);
    }
    assert!(estimator.reopen_now());
    assert!((0..4).all(|j| estimator.estimate().std_error[j] > 0.4 * jet_priors()[j].std));
}

#[test]
fn without_detection_the_damage_is_missed() {
    // The other half of the power check: it is the detector that finds it.
    let flight = fly(&JET, &regular(3000, 0.01), [0.0; 2], damaged, |t| [elevator_busy(t)], JET_NOISE, &mut seeded(40));
    let mut settings = jet_settings();
    settings.change_detection = None;
    let mut estimator = Jet::new(JET, settings).unwrap();
    let last = *run(&mut estimator, &flight).last().unwrap();
    assert_eq!(last.status.detector, DetectorState::Off);
    assert!(estimator.detector().is_none());
    assert!(normalised_rms(&[last], &damaged(30.0)) > 5.0);
}

#[test]
fn bounds_are_widened_while_a_change_is_in_doubt() {
    let flight = fly(&JET, &regular(2400, 0.01), [0.0; 2], damaged, |t| [elevator_busy(t)], JET_NOISE, &mut seeded(41));
    let mut estimator = jet();
    let all = run(&mut estimator, &flight);
    let first = all.iter().position(|e| e.status.change == ChangeState::InDoubt).expect("a doubt");
    for j in 0..4 {
        assert!(all[first].std_error[j] > 1.5 * all[first - 1].std_error[j], "parameter {j}");
        assert!(all[first].corrected_std_error[j] >= all[first].std_error[j], "parameter {j}");
    }
    let after = all.iter().position(|e| e.status.change == ChangeState::Adopted).expect("an adoption");
    // The former estimate is a rival until the new one has been excited and has predicted better.
    assert_eq!(all[after + 1].status.change, ChangeState::OnProbation);
    assert!(all[after..].iter().all(|e| e.status.change != ChangeState::RolledBack));
    assert_eq!(all.last().map(|e| e.status.change), Some(ChangeState::Steady));
}

/// A drop-out in the middle of a doubt decides nothing: the doubt goes on after it, and so do its wide bounds.
#[test]
fn a_gap_does_not_settle_a_doubt() {
    let mut adopted = 0;
    for seed in 40..50 {
        let flight =
            fly(&JET, &regular(3000, 0.01), [0.0; 2], damaged, |t| [elevator_busy(t)], JET_NOISE, &mut seeded(seed));
        let mut estimator = jet();
        let first = flight.iter().position(|s| estimator.update(s).status.change == ChangeState::InDoubt).unwrap();
        let doubted = estimator.estimate();
        // Three frames of the doubt, 0.8 s of nothing, and the rest.
        for sample in &flight[first + 1..first + 4] {
            estimator.update(sample);
        }
        if estimator.estimate().status.change != ChangeState::InDoubt {
            continue;
        }
        let mut decided = false;
        for sample in &flight[first + 84..] {
            let estimate = estimator.update(sample);
            assert_finite(&estimate);
            decided |= estimate.status.change != ChangeState::InDoubt;
            if !decided {
                assert!(estimate.std_error[0] > 0.3 * doubted.std_error[0], "seed {seed}");
            }
            if estimate.status.phase == Phase::Starting {
                assert_eq!(estimate.status.change, ChangeState::InDoubt, "seed {seed}");
            }
        }
        assert_eq!(estimator.restarts(), 1);
        let report = estimator.detector().unwrap();
        adopted += usize::from(report.adoptions == 1 && report.dropped == 0);
        assert!(normalised_rms(&[estimator.estimate()], &damaged(30.0)) < 2.5, "seed {seed}: {report:?}");
    }
    println!("{adopted} adopted across the gap");
    assert!(adopted >= 6, "{adopted}");
}

/// The window of the start holds a channel that comes late and a gap: all that was measured after the gap is used.
#[test]
fn a_gap_inside_the_start_loses_no_frame() {
    let mut flight = jet_flight(17, 1200);
    for sample in &mut flight[..40] {
        sample.outputs[0] = f64::NAN;
    }
    // One lonely frame, which is not corrected by, and then 0.6 s of nothing.
    for sample in &mut flight[1..] {
        sample.time_s += 0.6;
    }
    let mut settings = jet_settings();
    settings.correct_first_sample = false;
    let (mut whole, mut after) = (Jet::new(JET, settings).unwrap(), Jet::new(JET, settings).unwrap());
    let mut last = whole.update(&flight[0]);
    for sample in &flight[1..] {
        last = whole.update(sample);
        let other = after.update(sample);
        assert_eq!((last.parameters, last.std_error), (other.parameters, other.std_error), "at {} s", sample.time_s);
    }
    assert_eq!((whole.restarts(), after.restarts()), (1, 0));
    assert_eq!(last.parameter_status[0], ParameterStatus::Converged);
}

#[test]
fn nothing_is_adopted_in_calm_flight() {
    // Ten minutes: with a manoeuvre now and then, and with one all the time. And the detector arms itself.
    let mut armed = 0;
    for seed in 0..10 {
        let input = |t: f64| if seed % 2 == 0 { elevator_3211(t) } else { elevator_busy(t) };
        let flight =
            fly(&JET, &regular(6000, 0.01), [0.0; 2], |_| truth8(), |t| [input(t)], JET_NOISE, &mut seeded(60 + seed));
        let mut estimator = jet();
        let last = *run(&mut estimator, &flight).last().unwrap();
        let report = estimator.detector().unwrap();
        assert_eq!((report.adoptions, report.dropped), (0, 0), "seed {seed}: {report:?}");
        assert!(report.wander <= 0.15 + 1e-12, "{report:?}");
        assert!(!report.model_error);
        if last.status.detector == DetectorState::Armed {
            armed += 1;
        }
        // 3 w d_j, with d_j half the half width.
        let sensitivity = estimator.change_sensitivity();
        assert!((sensitivity[0] - 3.0 * report.wander * 0.5 * 0.6).abs() < 1e-12);
    }
    assert!(armed >= 5, "{armed}");
}

#[test]
fn a_wrong_model_is_called_a_wrong_model() {
    // The plant's lift curve bends (a flap of the test model: CLa swings with the manoeuvre), which no constant fits:
    // the detector must not chain adoptions.
    let swinging = |t: f64| {
        let mut theta = truth8();
        theta[0] *= 1.0 + 0.35 * (0.8 * t).sin();
        theta
    };
    let mut adoptions = 0;
    for seed in 0..5 {
        let flight = fly(
            &JET,
            &regular(6000, 0.01),
            [0.0; 2],
            swinging,
            |t| [elevator_busy(t)],
            JET_NOISE,
            &mut seeded(80 + seed),
        );
        let mut estimator = jet();
        let last = *run(&mut estimator, &flight).last().unwrap();
        let report = estimator.detector().unwrap();
        assert_finite(&last);
        adoptions += report.adoptions;
        assert_eq!(last.status.detector, DetectorState::Insensitive, "{report:?}");
    }
    println!("{adoptions} adoptions in 5 min of a parameter that swings by 35 %");
    assert!(adoptions <= 10, "{adoptions}");
}

#[test]
fn a_parameter_outside_its_bounds_is_said_to_be_at_its_limit() {
    let mut priors = jet_priors();
    priors[0] = ParameterPrior::bounded(-0.2, -0.3, -0.1);
    let mut settings = EstimatorSettings::automatic(&priors, JET_NOISE, 0.01).unwrap();
    settings.change_detection = None;
    let mut estimator = Jet::new(JET, settings).unwrap();
    let last = *run(&mut estimator, &jet_flight(9, 2000)).last().unwrap();
    assert_eq!(last.parameter_status[0], ParameterStatus::AtLimit, "{last:?}");
    assert!(last.parameters[0] >= -0.35 - 1e-12);
}

#[test]
fn a_fixed_parameter_stays_and_the_others_are_found() {
    let mut priors = jet_priors();
    priors[1] = ParameterPrior::fixed(JET_TRUTH[1]);
    let mut estimator = Jet::new(JET, EstimatorSettings::automatic(&priors, JET_NOISE, 0.01).unwrap()).unwrap();
    let last = *run(&mut estimator, &jet_flight(10, 1000)).last().unwrap();
    assert_eq!(last.parameters[1], JET_TRUTH[1]);
    assert_eq!(last.std_error[1], 0.0);
    assert!((last.parameters[0] - JET_TRUTH[0]).abs() < 4.0 * last.corrected_std_error[0]);
}

#[test]
fn the_unused_capacity_changes_nothing() {
    // Seven columns: no multiple of a block of the inner loops in either capacity.
    fn estimator<const P: usize>() -> Smpe<ShortPeriod, 2, 3, P> {
        let settings = EstimatorSettings::automatic(&jet_priors(), JET_NOISE, 0.01).unwrap();
        Smpe::new(JET, settings.with_biases([0.005, 0.002, 0.2])).unwrap()
    }
    let (mut wide, mut narrow) = (estimator::<24>(), estimator::<7>());
    for sample in &jet_flight(11, 800) {
        let (a, b) = (wide.update(sample), narrow.update(sample));
        assert_eq!(a.parameters[..7], b.parameters);
        assert_eq!(a.corrected_std_error[..7], b.corrected_std_error);
        assert!(a.parameters[7..].iter().all(|v| *v == 0.0));
        assert_eq!(wide.detector(), narrow.detector());
    }
}

#[test]
fn impossible_settings_are_refused_with_their_numbers() {
    let automatic = |priors: &[ParameterPrior]| EstimatorSettings::<2, 3, 4>::automatic(priors, JET_NOISE, 0.01);
    let five = [ParameterPrior::fixed(0.0); 5];
    assert_eq!(automatic(&five).unwrap_err(), SettingsError::Capacity { needed: 5, capacity: 4 });
    let outside = ParameterPrior::bounded(3.0, -1.0, 1.0);
    let error = automatic(&[outside]).unwrap_err();
    assert_eq!(error, SettingsError::Bounds { parameter: 0, lower: -1.0, initial: 3.0, upper: 1.0 });
    assert!(error.to_string().contains("upper 1"), "{error}");
    let nan = ParameterPrior { change_std: ChangePrior::Fixed(f64::NAN), ..ParameterPrior::absolute(1.0, 1.0) };
    assert_eq!(automatic(&[nan]).unwrap_err(), SettingsError::Prior { parameter: 0 });
    assert_eq!(
        EstimatorSettings::<2, 3, 4>::automatic(&jet_priors(), [0.0, f64::NAN, 0.0], 0.01).unwrap_err(),
        SettingsError::NoOutput
    );
    let with_biases = automatic(&jet_priors()).unwrap().with_biases([0.1; 3]);
    let error = Smpe::<_, 2, 3, 4>::new(JET, with_biases).err().unwrap();
    assert_eq!(error, SettingsError::Capacity { needed: 7, capacity: 4 });
    let mut wrong = automatic(&jet_priors()).unwrap();
    wrong.input_hold = InputHold::Linear;
    wrong.colour_block_s = 0.0;
    let error = Smpe::<_, 2, 3, 4>::new(JET, wrong).err().unwrap();
    assert_eq!(error, SettingsError::Setting { name: "colour_block_s", value: 0.0 });
    // Limits the wrong way round are no limits to hold a number between.
    let crossed = ChangeDetection { wander_limits: [0.7, 0.03], ..ChangeDetection::default() };
    let mut wrong = automatic(&jet_priors()).unwrap();
    wrong.change_detection = Some(crossed);
    let error = Smpe::<_, 2, 3, 4>::new(JET, wrong).err().unwrap();
    assert!(matches!(error, SettingsError::Setting { name, .. } if name.starts_with("change_detection")), "{error}");
}

/// The short period whose outputs have a pole: where the input says 9, every output sensitivity is out of all range.
struct Pole;

impl Model<2, 3, 8> for Pole {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        4
    }

    fn rates(&self, x: &[f64; 2], theta: &[f64; 8], u: &[f64; 1]) -> [f64; 2] {
        JET.rates(x, theta, &[if u[0] == 9.0 { 0.0 } else { u[0] }])
    }

    fn linearized_rates(&self, x: &[f64; 2], theta: &[f64; 8], u: &[f64; 1], out: &mut LinearizedRates<2, 8>) {
        JET.linearized_rates(x, theta, &[if u[0] == 9.0 { 0.0 } else { u[0] }], out);
    }

    fn linearized_outputs(&self, x: &[f64; 2], theta: &[f64; 8], u: &[f64; 1], out: &mut LinearizedOutputs<2, 3, 8>) {
        JET.linearized_outputs(x, theta, u, out);
        if u[0] == 9.0 {
            out.parameter_jacobian[2][..4].fill(1e200);
            out.state_jacobian[0] = [1e200; 2];
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        Some(state)
    }
}

#[test]
fn an_output_sensitivity_out_of_all_range_is_a_missing_value() {
    let mut flight = jet_flight(13, 1200);
    let mut estimator = Smpe::new(Pole, jet_settings()).unwrap();
    let mut before = None;
    for (k, sample) in flight.iter_mut().enumerate() {
        if k == 1000 {
            sample.input = [9.0];
        }
        let estimate = estimator.update(sample);
        if k == 1000 {
            let before: Estimate<8> = before.unwrap();
            for j in 0..4 {
                assert!((estimate.parameters[j] - before.parameters[j]).abs() < before.std_error[j]);
                assert!(estimate.std_error[j] <= before.std_error[j], "what was learnt is lost");
            }
        }
        before = Some(estimate);
    }
    assert_eq!(estimator.restarts(), 0);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, rng_seed: proptest::test_runner::RngSeed::Fixed(4), ..ProptestConfig::default() })]

    /// Any bit pattern in time, input or output: no panic, and never a number that is not finite.
    #[test]
    fn rubbish_never_gets_through(
        rubbish in prop::collection::vec((0..400_usize, 0..5_usize, any::<f64>()), 1..60),
        seed in 0..1000_u64,
    ) {
        let mut flight = jet_flight(seed, 400);
        for (k, field, value) in rubbish {
            match field {
                0 => flight[k].time_s = value,
                1 => flight[k].input = [value],
                channel => flight[k].outputs[channel - 2] = value,
            }
        }
        let mut settings = jet_settings().with_biases([0.005, 0.0, 0.2]);
        settings.process_noise = ProcessNoise::adaptive([1e-6, 1e-6]);
        let mut estimator = Jet::new(JET, settings).unwrap();
        for sample in &flight {
            let estimate = estimator.update(sample);
            assert_finite(&estimate);
        }
    }
}
