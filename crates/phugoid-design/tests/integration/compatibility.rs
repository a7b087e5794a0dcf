//! Data compatibility on simulated flights, whose truth is known: errors put into the sensors come back within their bounds.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

use phugoid_design::fit::{Limits, fitted};
use phugoid_design::modes::ModeFrequencies;
use phugoid_design::{Kind, Request, shape};
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use phugoid_identification::compatibility::{
    Compatibility, CompatibilityOptions, Group, SensorVerdict, compatibility, input_skew,
};
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::manoeuvre::Surface;
use phugoid_simulation::scenario::{Scenario, built_in};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Gravity of the simulated aircraft, m/s^2.
const GRAVITY: f64 = 32.17 * 0.3048;

const SENSORS: &str = r#"
[sensors]
true_airspeed = { noise = "1 ft/s", bias = "2 ft/s" }
alpha = { noise = "0.1 deg", bias = "0.3 deg" }
beta = { noise = "0.1 deg", bias = "-0.4 deg" }
phi = { noise = "0.05 deg" }
theta = { noise = "0.05 deg" }
psi = { noise = "0.05 deg" }
p = { noise = "0.02 deg/s", bias = "0.1 deg/s" }
q = { noise = "0.02 deg/s", bias = "-0.05 deg/s" }
r = { noise = "0.02 deg/s", bias = "0.08 deg/s" }
ax = { noise = "0.002 g" }
ay = { noise = "0.002 g", bias = "0.01 g" }
az = { noise = "0.002 g", bias = "0.015 g" }
altitude = { noise = "1 m" }
"#;

/// The F-16 with a multisine on all three surfaces for 30 s.
fn three_axes(sensors: &str) -> (Scenario, Flight) {
    let text = phugoid_simulation::scenario::BUILT_IN.iter().find(|(n, _)| *n == "f16-calm").unwrap().1;
    let text = format!("{}{sensors}", &text[..text.find("[sensors]").unwrap()]);
    let scenario = Scenario::parse(&text, "three axes").unwrap();
    let request = Request {
        surfaces: vec![Surface::Elevator, Surface::Aileron, Surface::Rudder],
        duration_s: 30.0,
        lead_s: 0.5,
        sample_rate_hz: 100.0,
        band_hz: None,
        linear_sweep: false,
    };
    let modes = ModeFrequencies::of_scenario(&scenario).unwrap();
    let found = fitted(&shape(Kind::Multisine, &request, &modes).unwrap(), &scenario, &Limits::default()).unwrap();
    (found.scenario, found.flight)
}

fn check(result: &Compatibility, name: &str, truth: f64) {
    let e = result.error(name).unwrap_or_else(|| panic!("{name}"));
    // One flight, one seed: outside four standard errors in 1 of 16,000 cases for an honest bound.
    assert!((e.value - truth).abs() < 4.0 * e.std_error, "{name}: {} +- {}, truth {truth}", e.value, e.std_error);
    assert!(e.std_error <= e.prior_std, "{name}");
}

#[test]
fn biases_of_all_sensors_come_back_within_their_bounds() {
    let (_, flight) = three_axes(SENSORS);
    let options = CompatibilityOptions {
        groups: vec![Group::AirDataScales],
        gravity: Some(GRAVITY),
        flat_earth: true,
        ..CompatibilityOptions::default()
    };
    let result = compatibility(&flight.measured, &options).unwrap();
    let degree = 1_f64.to_radians();
    let g = 9.80665;
    for (name, truth) in [
        ("bias_true_airspeed", 2.0 * 0.3048),
        ("bias_alpha", 0.3 * degree),
        ("bias_beta", -0.4 * degree),
        ("bias_p", 0.1 * degree),
        ("bias_q", -0.05 * degree),
        ("bias_r", 0.08 * degree),
        ("bias_ax", 0.0),
        ("bias_ay", 0.01 * g),
        ("bias_az", 0.015 * g),
        ("bias_theta", 0.0),
        ("scale_alpha", 0.0),
    ] {
        check(&result, name, truth);
    }
    // The gyroscopes, whose errors drift away, are told to a few thousandths of a degree per second.
    for name in ["bias_p", "bias_q", "bias_r"] {
        let e = result.error(name).unwrap();
        assert!(e.verdict == SensorVerdict::Significant && e.std_error < 0.01 * degree, "{name}: {}", e.std_error);
    }
    // The reconstructed angle of attack is nearer to the truth than the vane, and its bound holds.
    let alpha = result.channel("alpha").unwrap();
    let truth = &flight.truth.channel("alpha").unwrap().values;
    let vane = &flight.measured.channel("alpha").unwrap().values;
    let rms = |a: &[f64]| (a.iter().zip(truth).map(|(x, t)| (x - t).powi(2)).sum::<f64>() / truth.len() as f64).sqrt();
    assert!(rms(&alpha.values) < 0.5 * rms(vane), "{} {}", rms(&alpha.values), rms(vane));
    for ((value, std), truth) in alpha.values.iter().zip(&alpha.std_error).zip(truth) {
        assert!((value - truth).abs() < 4.0 * std && *std > 0.0, "{value} +- {std}, truth {truth}");
    }
    // No reconstruction knows less than one sample of its own sensor does, whose errors it knows.
    for (name, noise) in [("true_airspeed", 0.3048), ("alpha", 0.1 * degree), ("beta", 0.1 * degree)] {
        let sensor = |kind: &str| result.error(&format!("{kind}_{name}")).map_or(0.0, |e| e.std_error);
        let channel = result.channel(name).unwrap();
        for (value, std) in channel.values.iter().zip(&channel.std_error) {
            let alone = noise.hypot(sensor("bias")).hypot(sensor("scale") * value);
            assert!(*std < alone, "{name}: {std}, by the sensor alone {alone}");
        }
    }
}

fn channel<'a>(record: &'a mut Record, name: &str) -> &'a mut Vec<f64> {
    &mut record.channels.iter_mut().find(|c| c.name == name).unwrap().values
}

#[test]
fn delays_scales_and_vane_positions_come_back() {
    let sensors = SENSORS.replace(
        "alpha = { noise = \"0.1 deg\", bias = \"0.3 deg\" }",
        "alpha = { noise = \"0.1 deg\", delay = \"25 ms\" }",
    );
    let (_, flight) = three_axes(&sensors);
    let mut record = flight.measured.clone();
    // A vane 4 m ahead, its scale factor 1.08: what the fuselage does to the flow.
    let q = flight.truth.channel("q").unwrap().values.clone();
    let speed = flight.truth.channel("true_airspeed").unwrap().values.clone();
    for (k, alpha) in channel(&mut record, "alpha").iter_mut().enumerate() {
        *alpha = 1.08 * (*alpha - q[k] * 4.0 / speed[k]);
    }
    let options = CompatibilityOptions {
        vanes_x: [4.0, 0.0],
        groups: vec![Group::AirDataScales, Group::Delays],
        gravity: Some(GRAVITY),
        flat_earth: true,
        ..CompatibilityOptions::default()
    };
    let result = compatibility(&record, &options).unwrap();
    check(&result, "scale_alpha", 0.08);
    check(&result, "delay_alpha", 0.025);
    check(&result, "delay_true_airspeed", 0.0);
    let delay = result.error("delay_alpha").unwrap();
    assert!(delay.std_error < 0.005 && delay.verdict == SensorVerdict::Significant, "{}", delay.std_error);
    // Corrected, the vane agrees with the truth to its noise (0.1 deg, and what the delay leaves).
    let corrected = result.corrections.apply(&record);
    let truth = &flight.truth.channel("alpha").unwrap().values;
    let values = &corrected.channel("alpha").unwrap().values;
    let known: Vec<f64> = values.iter().zip(truth).map(|(v, t)| v - t).filter(|d| d.is_finite()).collect();
    let rms = (known.iter().map(|d| d * d).sum::<f64>() / known.len() as f64).sqrt();
    assert!(rms < 0.12_f64.to_radians(), "{}", rms.to_degrees());
}

/// No vane is late by 0.8 s: there is no number for it, but a reason, and nothing is corrected by it.
#[test]
fn an_impossible_delay_is_refused() {
    let sensors = SENSORS.replace(
        "alpha = { noise = \"0.1 deg\", bias = \"0.3 deg\" }",
        "alpha = { noise = \"0.1 deg\", delay = \"800 ms\" }",
    );
    let (_, flight) = three_axes(&sensors);
    let options = CompatibilityOptions { gravity: Some(GRAVITY), flat_earth: true, ..CompatibilityOptions::default() };
    let result = compatibility(&flight.measured, &options).unwrap();
    let refused: Vec<_> = result.errors.iter().filter(|e| e.verdict == SensorVerdict::Refused).collect();
    assert!(refused.iter().any(|e| e.name.ends_with("_alpha")), "{refused:?}");
    for e in refused {
        assert!(e.value.is_nan() && !e.offered && e.reason.is_some(), "{e:?}");
    }
    for (channel, c) in &result.corrections.channels {
        assert!((-0.05..=0.5).contains(&c.delay_s), "{channel}: {c:?}");
    }
}

/// Scale factors of bank and pitch attitude, five seconds without rows, outliers: the motion begins anew after the gap.
#[test]
fn attitude_scales_come_back_beside_a_gap_and_outliers() {
    let (_, flight) = three_axes(SENSORS);
    let mut record = flight.measured.clone();
    for (name, scale) in [("phi", 0.03), ("theta", -0.03)] {
        channel(&mut record, name).iter_mut().for_each(|v| *v *= 1.0 + scale);
    }
    for k in (50..record.len()).step_by(200) {
        channel(&mut record, "alpha")[k] += 0.2;
        channel(&mut record, "q")[k + 17] += 0.5;
    }
    let keep = |k: usize| !(12.0..17.0).contains(&flight.measured.time[k]);
    for channel in &mut record.channels {
        channel.values = (0..channel.values.len()).filter(|k| keep(*k)).map(|k| channel.values[k]).collect();
    }
    record.time = (0..record.time.len()).filter(|k| keep(*k)).map(|k| record.time[k]).collect();
    let options = CompatibilityOptions { gravity: Some(GRAVITY), flat_earth: true, ..CompatibilityOptions::default() };
    let result = compatibility(&record, &options).unwrap();
    for (name, truth) in [("scale_phi", 0.03), ("scale_theta", -0.03), ("scale_alpha", 0.0), ("delay_alpha", 0.0)] {
        check(&result, name, truth);
    }
    let phi = result.error("scale_phi").unwrap();
    assert!(phi.offered && phi.held_out_gain > 0.0, "{phi:?}");
    let corrected = result.corrections.apply(&record).channel("phi").unwrap().values[100];
    let spoilt = record.channel("phi").unwrap().values[100];
    assert!((spoilt / corrected - 1.0 - phi.value).abs() < 0.01 || result.error("bias_phi").unwrap().offered);
}

/// Two flights together know the sensors better than one does.
#[test]
fn two_flights_tell_more_than_one() {
    let (_, flight) = three_axes(SENSORS);
    let half = |from: f64, to: f64| flight.measured.between(from, to).unwrap();
    let options = CompatibilityOptions { gravity: Some(GRAVITY), flat_earth: true, ..CompatibilityOptions::default() };
    let one = compatibility(&half(0.0, 15.0), &options).unwrap();
    let both = compatibility(&half(0.0, 15.0), &CompatibilityOptions { further: vec![half(15.0, 30.0)], ..options });
    let both = both.unwrap();
    for (name, truth) in [("bias_q", -0.05_f64.to_radians()), ("bias_beta", -0.4_f64.to_radians())] {
        check(&both, name, truth);
        let (alone, together) = (one.error(name).unwrap().std_error, both.error(name).unwrap().std_error);
        assert!(together < 0.9 * alone, "{name}: {alone} {together}");
    }
}

/// Positions over ground tell the wind.
#[test]
fn wind_comes_back_from_positions() {
    let (_, flight) = three_axes(SENSORS);
    let mut record = flight.measured.clone();
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let wind = [8.0, -5.0];
    for (name, wind) in ["north", "east"].into_iter().zip(wind) {
        let truth = &flight.truth.channel(name).unwrap().values;
        let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
        let values = truth.iter().zip(&record.time).map(|(x, t)| x + wind * t + noise()).collect();
        record.channels.push(Channel { name: name.to_owned(), quantity: Quantity::Length, values });
    }
    let options = CompatibilityOptions {
        groups: vec![Group::Wind],
        gravity: Some(GRAVITY),
        flat_earth: true,
        ..CompatibilityOptions::default()
    };
    let result = compatibility(&record, &options).unwrap();
    check(&result, "wind_north", 8.0);
    check(&result, "wind_east", -5.0);
}

/// What a manoeuvre does not move stays at its prior and is called so: in symmetric flight with a steady speed the scale factor of
/// the airspeed cannot be told from its bias.
#[test]
fn what_cannot_be_told_is_called_so() {
    let mut scenario = built_in("f16-calm").unwrap().unwrap();
    scenario.sensors.altitude.noise = "1 m".parse().unwrap();
    let flight = fly(&scenario).unwrap();
    let options = CompatibilityOptions { gravity: Some(GRAVITY), flat_earth: true, ..CompatibilityOptions::default() };
    let result = compatibility(&flight.measured, &options).unwrap();
    let scale = result.error("scale_true_airspeed").unwrap();
    assert!(scale.std_error > 0.001, "{}", scale.std_error);
    assert!(result.error("wind_north").is_none());
    for e in &result.errors {
        println!("{} {:.2e} +- {:.1e} ({:.1e}) {}", e.name, e.value, e.std_error, e.prior_std, e.verdict.words());
    }
    println!("{:?}", result.notes);
    for e in &result.errors {
        assert!(e.value.abs() < 4.0 * e.std_error, "{}: {} +- {}", e.name, e.value, e.std_error);
    }
    let unknown = result.errors.iter().filter(|e| e.verdict == SensorVerdict::NotIdentifiable).count();
    assert!(unknown > 0 || result.notes.iter().any(|n| n.contains("hardly told apart")), "{:?}", result.notes);
}

/// Without the vane the angle of attack comes from airspeed, attitude, altitude and accelerations; its bound holds.
#[test]
fn angle_of_attack_without_a_vane() {
    let (_, flight) = three_axes(SENSORS);
    let mut record = flight.measured.clone();
    record.channels.retain(|c| c.name != "alpha");
    let options = CompatibilityOptions {
        groups: Vec::new(),
        gravity: Some(GRAVITY),
        flat_earth: true,
        ..CompatibilityOptions::default()
    };
    let result = compatibility(&record, &options).unwrap();
    let alpha = result.channel("alpha").unwrap();
    let truth = &flight.truth.channel("alpha").unwrap().values;
    let worst = alpha.std_error.iter().fold(0.0_f64, |m, s| m.max(*s));
    println!("without a vane: std {:.3} deg", worst.to_degrees());
    assert!(worst < 2_f64.to_radians());
    for ((value, std), truth) in alpha.values.iter().zip(&alpha.std_error).zip(truth) {
        assert!((value - truth).abs() < 4.0 * std, "{value} +- {std}, truth {truth}");
    }
}

/// 15 ms of elevator skew are found, and taking them out removes the bias that they make. The elevator moves all the time, in a
/// multisine: a few steps of a 3-2-1-1 hide their skew in the state.
#[test]
fn an_elevator_skew_is_found_and_its_bias_removed() {
    let model = ModelFile::named("f16-model").unwrap();
    let calm = built_in("f16-calm").unwrap().unwrap();
    let request = Request {
        surfaces: vec![Surface::Elevator],
        duration_s: 20.0,
        lead_s: 0.5,
        sample_rate_hz: 100.0,
        band_hz: None,
        linear_sweep: false,
    };
    let modes = ModeFrequencies::of_scenario(&calm).unwrap();
    let designed = fitted(&shape(Kind::Multisine, &request, &modes).unwrap(), &calm, &Limits::default()).unwrap();
    let straight = designed.flight.measured.clone();
    let mut scenario = designed.scenario;
    scenario.sensors.elevator.delay = "25 ms".parse().unwrap();
    let skewed = fly(&scenario).unwrap().measured;
    let skew = input_skew(&skewed, &model, "elevator").unwrap();
    assert!((skew.delay_s - 0.025).abs() < 4.0 * skew.std_error_s, "{} +- {}", skew.delay_s, skew.std_error_s);
    // Output error fits the record as it is; a causal estimator may take part of the skew for process noise or for a change.
    let options = EstimateOptions { method: Some(Method::OutputError), ..EstimateOptions::default() };
    let cm_q = |record: &Record| {
        let estimation = estimate(record, &model, &options, &mut |_| ()).unwrap();
        let parameter = estimation.parameters.iter().find(|p| p.name == "dCm_q").unwrap();
        (parameter.value, parameter.std_error)
    };
    let mut corrections = phugoid_identification::compatibility::Corrections::default();
    corrections.channels.entry("elevator".to_owned()).or_default().delay_s = skew.delay_s;
    let corrected = corrections.apply(&skewed);
    // The same noise in all three; only the elevator's is interpolated in the third.
    let [(truth, sigma), (with, _), (without, _)] = [&straight, &skewed, &corrected].map(cm_q);
    println!(
        "skew {:.2} +- {:.2} ms; dCm_q {truth:.4} +- {sigma:.4} without skew, {with:.4} with, {without:.4} corrected",
        1e3 * skew.delay_s,
        1e3 * skew.std_error_s
    );
    assert!((with - truth).abs() > 2.0 * sigma, "the skew does no harm: {truth} +- {sigma} {with}");
    assert!((without - truth).abs() < 0.1 * (with - truth).abs(), "{truth} {with} {without}");
    assert!((without - truth).abs() < sigma, "{truth} +- {sigma} {without}");
}

/// Where no sensor has an error none is to be found. The noise of the inertial sensors is integrated, and the bounds know of it:
/// without that the biases of az, p, q and r are 3.5 to 9 of their claimed sigmas off, and called significant in most flights.
/// 12 flights of `f16-six`; a mean square of 12 honest normal numbers is below 2.74 in 99.9 % of all cases (chi-square).
#[test]
fn biases_that_are_not_there_are_not_found() {
    let scenario = built_in("f16-six").unwrap().unwrap();
    let options = CompatibilityOptions { gravity: Some(GRAVITY), flat_earth: true, ..CompatibilityOptions::default() };
    let run = |run: usize| {
        let measured = fly(&Scenario { seed: run as u64, ..scenario.clone() }).unwrap().measured;
        Ok::<_, std::convert::Infallible>(compatibility(&measured, &options).unwrap())
    };
    let results = monte_carlo(12, run, || ()).unwrap_or_else(|never| match never {});
    let mut significant = 0;
    for name in ["bias_ax", "bias_ay", "bias_az", "bias_p", "bias_q", "bias_r"] {
        let errors = results.iter().map(|r| r.error(name).unwrap());
        let mean_square = errors.clone().map(|e| (e.value / e.std_error).powi(2)).sum::<f64>() / 12.0;
        significant += errors.filter(|e| e.verdict == SensorVerdict::Significant).count();
        println!("{name}: root mean square {:.2} sigma", mean_square.sqrt());
        assert!((0.2..2.74).contains(&mean_square), "{name}: {mean_square}");
    }
    // 5 % of 72 are 4; within three deviations of a binomial of 72.
    assert!(significant <= 9, "{significant} of 72");
}

/// SMPE on a model file whose outputs leave the angle of attack out: it works, costs accuracy, and its bounds own up to it. 40
/// flights of `f16-calm`; coverage of two sigma within four standard errors of 95 % (160 numbers: 1.7 % each, correlated).
#[test]
fn smpe_needs_no_vane() {
    let text = ModelFile::text("f16-model").unwrap();
    let without = text
        .replace("base = \"f16\"", "base = \"f16\"\noutputs = [\"true_airspeed\", \"theta\", \"q\", \"ax\", \"az\"]");
    let without = without.lines().filter(|l| !l.starts_with("alpha = \"0.1 deg\"")).collect::<Vec<_>>().join("\n");
    let scenario = built_in("f16-calm").unwrap().unwrap();
    let study = |text: &str| {
        let model = ModelFile::parse("model", text).unwrap_or_else(|e| panic!("{e}"));
        phugoid_evaluation::accuracy::accuracy(&scenario, &model, &EstimateOptions::default(), 40, &[20.0], &|| ())
            .unwrap()
            .checkpoints
            .remove(0)
    };
    let (with, without) = (study(text), study(&without));
    let mut covered = 0.0;
    for (a, b) in with.parameters.iter().zip(&without.parameters) {
        println!(
            "{}: rmse {:.3e} with, {:.3e} without the vane (bounds {:.3e}, {:.3e}); coverage {:.2}, {:.2}",
            a.name, a.rmse, b.rmse, a.cramer_rao, b.cramer_rao, a.coverage, b.coverage
        );
        assert!(b.cramer_rao >= a.cramer_rao && b.rmse < 1.6 * b.cramer_rao, "{}", a.name);
        covered += b.coverage / 4.0;
    }
    assert!((0.85..=1.0).contains(&covered), "{covered}");
}
