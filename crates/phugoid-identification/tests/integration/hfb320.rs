//! A real flight: HFB-320, against the filter-error estimate published with it (R. V. Jategaonkar, Flight Vehicle System
//! Identification, 2nd ed.). Eleven parameters, change detection on.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use std::collections::BTreeMap;

use phugoid_estimators::discretization::{self, IntervalInput, Part};
use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::record::Record;
use phugoid_identification::axes::Axes;
use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
use phugoid_identification::estimation::{Estimation, EstimationStatus, ReasonCode};
use phugoid_identification::longitudinal::{LongitudinalModel, OUTPUTS, STATES};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::prepare::prepare;

/// Names in the published table and in the model file.
const NAMES: [(&str, &str); 11] = [
    ("CD0", "CD_0"),
    ("CDV", "CD_V"),
    ("CDalpha", "CD_alpha"),
    ("CL0", "CL_0"),
    ("CLV", "CL_V"),
    ("CLalpha", "CL_alpha"),
    ("Cm0", "Cm_0"),
    ("CmV", "Cm_V"),
    ("Cmalpha", "Cm_alpha"),
    ("Cmq", "Cm_q"),
    ("Cmde", "Cm_elevator"),
];

fn flight() -> Option<Record> {
    Some(csv::read_path(&common::shared_file("flight/hfb320.csv")?, &CsvOptions::default()).unwrap())
}

fn reference() -> Option<BTreeMap<String, f64>> {
    let text = std::fs::read_to_string(common::shared_file("flight/reference.json")?).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let published = &json["hfb320"]["reference_filter_error"];
    Some(NAMES.iter().map(|(book, ours)| ((*ours).to_owned(), published[*book].as_f64().unwrap())).collect())
}

fn model() -> ModelFile {
    ModelFile::named("hfb320").unwrap()
}

fn run(record: &Record) -> Estimation {
    run_by(Method::Smpe, record)
}

fn run_by(method: Method, record: &Record) -> Estimation {
    let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
    estimate(record, &model(), &options, &mut |_| {}).unwrap()
}

/// Estimate of a parameter at the last sample not after `time_s`.
fn at(estimation: &Estimation, name: &str, time_s: f64) -> f64 {
    let history = &estimation.history;
    let k = history.time_s.partition_point(|t| *t <= time_s + 1e-9) - 1;
    history.parameters.iter().find(|p| p.name == name).unwrap().value[k]
}

#[test]
fn ends_at_the_published_estimate() {
    let (Some(record), Some(reference)) = (flight(), reference()) else { return };
    let estimation = run(&record);
    println!("parameter     reference   estimate  percent      2 sigma  at 10 s  at 20 s (percent)");
    for parameter in &estimation.parameters {
        let published = reference[&parameter.name];
        let percent = |v: f64| 100.0 * (v / published - 1.0);
        println!(
            "{:12} {published:10.5} {:10.5} {:8.2} {:12.5} {:8.2} {:8.2} {} {:?}",
            parameter.name,
            parameter.value,
            percent(parameter.value),
            2.0 * parameter.corrected_std_error,
            percent(at(&estimation, &parameter.name, 10.0)),
            percent(at(&estimation, &parameter.name, 20.0)),
            parameter.status,
            parameter.converged_at_s,
        );
    }
    for event in &estimation.events {
        println!("{:7.2} s {} {}", event.time_s, event.kind, event.message);
    }
    for sentence in &estimation.verdict {
        println!("- {sentence}");
    }
    assert_eq!(estimation.parameters.len(), 11);
    // No false alarm about units on a real flight.
    assert!(!estimation.verdict.iter().any(|s| s.contains("Check the units")), "{:?}", estimation.verdict);
    assert!(!estimation.events.iter().any(|e| e.kind.word() == "adopted"), "{:?}", estimation.events);
    for parameter in estimation.parameters.iter().filter(|p| p.name != "Cm_V") {
        let error = parameter.value / reference[&parameter.name] - 1.0;
        assert!(error.abs() < 0.05, "{} is {:.1} % off", parameter.name, 100.0 * error);
    }
    // From 10 s on, every sample.
    let lift = estimation.history.parameters.iter().find(|p| p.name == "CL_alpha").unwrap();
    let worst = lift
        .value
        .iter()
        .zip(&estimation.history.time_s)
        .filter(|(_, t)| **t >= 10.0)
        .map(|(v, _)| (v / reference["CL_alpha"] - 1.0).abs())
        .fold(0.0, f64::max);
    println!("CL_alpha at most {:.2} % off from 10 s on", 100.0 * worst);
    assert!(worst < 0.08);
}

/// The joint extended Kalman filter, gate, detection and all: 4 % is what the filter of the book's kind was measured to be off
/// by, 16 % its `Cm_V`, which this flight hardly excites.
#[test]
fn the_joint_filter_ends_at_the_published_estimate() {
    let (Some(record), Some(reference)) = (flight(), reference()) else { return };
    let estimation = run_by(Method::Ekf, &record);
    for parameter in &estimation.parameters {
        let error = parameter.value / reference[&parameter.name] - 1.0;
        println!(
            "{:12} {:6.2} %, two sigma {:6.2} %",
            parameter.name,
            100.0 * error,
            200.0 * parameter.corrected_std_error / reference[&parameter.name].abs()
        );
        let allowed = if parameter.name == "Cm_V" { 0.16 } else { 0.04 };
        assert!(error.abs() < allowed, "{} is {:.1} % off", parameter.name, 100.0 * error);
    }
    assert!(!estimation.events.iter().any(|e| e.kind.word() == "adopted"), "{:?}", estimation.events);
}

#[test]
fn uses_no_future_sample() {
    let Some(record) = flight() else { return };
    let whole = run(&record);
    for length in [120, 333] {
        let mut cut = record.clone();
        cut.time.truncate(length);
        for channel in &mut cut.channels {
            channel.values.truncate(length);
        }
        let part = run(&cut);
        assert_eq!(part.history.time_s.len(), length);
        let bits = |values: &[f64]| -> Vec<u64> { values.iter().map(|v| v.to_bits()).collect() };
        for (a, b) in part.history.parameters.iter().zip(&whole.history.parameters) {
            assert_eq!(bits(&a.value), bits(&b.value[..length]), "{}", a.name);
            assert_eq!(bits(&a.std_error), bits(&b.std_error[..length]), "{}", a.name);
        }
        for (a, b) in part.history.residuals.iter().zip(&whole.history.residuals) {
            assert_eq!(bits(&a.values), bits(&b.values[..length]), "{}", a.name);
        }
    }
}

/// The flight flown again in simulation, with the real inputs, the published parameters, the published noise, and from
/// 30 s on CL_alpha x 0.8, Cm_alpha x 0.6, Cm_elevator x 0.7.
///
/// With `change` false nothing changes.
fn replay(record: &Record, reference: &BTreeMap<String, f64>, change: bool, seed: u64) -> Record {
    let file = model();
    let prepared = prepare::<LongitudinalModel, _, _>(record, &file).unwrap();
    let names: Vec<&str> = file.estimated().map(|p| p.name.as_str()).collect();
    let mut theta = [0.0; 24];
    for (slot, name) in theta.iter_mut().zip(&names) {
        *slot = reference[*name];
    }
    let mut damaged = theta;
    for (j, name) in names.iter().enumerate() {
        damaged[j] *= match *name {
            "CL_alpha" => 0.8,
            "Cm_alpha" => 0.6,
            "Cm_elevator" => 0.7,
            _ => 1.0,
        };
    }
    let mut normal = common::Normal::new(seed);
    let mut x = [prepared.outputs[0][0], prepared.outputs[0][1], prepared.outputs[0][2], prepared.outputs[0][3]];
    let mut simulated = vec![Vec::new(); OUTPUTS];
    let outputs = Axes::Longitudinal.outputs();
    for k in 0..prepared.time.len() {
        let now = if change && prepared.time[k] >= 30.0 { &damaged } else { &theta };
        let mut out = phugoid_estimators::LinearizedOutputs::<STATES, OUTPUTS, 24>::ZERO;
        phugoid_estimators::Model::linearized_outputs(&prepared.model, &x, now, &prepared.inputs[k], &mut out);
        for (i, channel) in simulated.iter_mut().enumerate() {
            channel.push(out.outputs[i] + file.noise[outputs[i].index()].unwrap() * normal.next());
        }
        if k + 1 < prepared.time.len() {
            let h = prepared.time[k + 1] - prepared.time[k];
            let input = IntervalInput {
                from: prepared.inputs[k],
                to: prepared.inputs[k + 1],
                hold: discretization::InputHold::Linear,
            };
            let (mut sensitivity, mut transition) = ([[0.0; 24]; STATES], [[0.0; STATES]; STATES]);
            x = discretization::step::<_, STATES, OUTPUTS, 24>(
                &prepared.model,
                &x,
                now,
                &input,
                h,
                Part { from: 0.0, to: 1.0 },
                0,
                &mut sensitivity,
                &mut transition,
            );
            for (state, output) in x.iter_mut().zip(outputs) {
                *state += (file.process_noise.density[output.index()] * h).sqrt() * normal.next();
            }
        }
    }
    let mut replayed = record.clone();
    replayed.source = "HFB-320 replayed in simulation".to_owned();
    for (output, values) in outputs.iter().zip(&simulated) {
        let channel = replayed.channels.iter_mut().find(|c| c.name == output.name()).unwrap();
        channel.values.clone_from(values);
    }
    replayed
}

#[test]
fn a_simulated_change_half_way_is_found_and_none_is_invented() {
    let (Some(record), Some(reference)) = (flight(), reference()) else { return };
    for seed in 1..=4 {
        let quiet = run(&replay(&record, &reference, false, seed));
        let events: Vec<_> = quiet.events.iter().map(|e| (e.time_s, e.kind.word())).collect();
        assert!(!quiet.events.iter().any(|e| e.kind.word() == "adopted"), "nothing changed, yet {events:?}");
        let changed = run(&replay(&record, &reference, true, seed));
        let events: Vec<_> = changed.events.iter().map(|e| (e.time_s, e.kind.word())).collect();
        println!("seed {seed}: {events:?}");
        let found = changed.events.iter().find(|e| e.kind.word() == "adopted").map(|e| e.time_s);
        assert!(found.is_some_and(|t| (30.0..36.0).contains(&t)), "change at 30 s found at {found:?}");
    }
}

/// Ten samples per second: a value that is away for one sample could be a pulse, so that none is taken out. Six of them, 2 degrees
/// far, made `Cm_elevator` -0.012 +- 0.054 in place of -1.5, called sound.
#[test]
fn wild_values_of_a_slow_recorder_are_not_taken_for_the_answer_to_them() {
    let Some(mut record) = flight() else { return };
    let elevator = record.channels.iter_mut().find(|channel| channel.name == "elevator").unwrap();
    for (number, k) in [70, 150, 233, 310, 402, 481].into_iter().enumerate() {
        elevator.values[k] += [0.035, -0.035][number % 2];
    }
    for method in [Method::Smpe, Method::EquationError] {
        let found = run_by(method, &record);
        let told = found.reasons.iter().any(|r| r.code == ReasonCode::InputNoise && r.concerns == ["elevator"]);
        assert!(told && found.status >= EstimationStatus::Doubtful, "{method:?}: {:?}", found.reasons);
    }
    // The flight as it was recorded has none.
    assert!(run(&flight().unwrap()).reasons.iter().all(|reason| reason.code != ReasonCode::InputNoise));
}
