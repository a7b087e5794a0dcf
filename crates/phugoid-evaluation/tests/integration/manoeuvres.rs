//! Manoeuvres are found in flights whose inputs are known, and none where there is none.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use crate::shared_data;

use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::record::Record;
use phugoid_identification::manoeuvres::{Found, Kind, Manoeuvre, Settings, Support, find};
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::{Scenario, built_in};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

fn scenario(name: &str) -> Scenario {
    built_in(name).unwrap().unwrap()
}

fn flown(scenario: &Scenario) -> Record {
    fly(scenario).unwrap().measured
}

fn search(record: &Record) -> Found {
    find(record, &Settings::default())
}

fn support(manoeuvre: &Manoeuvre, name: &str) -> Support {
    manoeuvre.coefficients.iter().find(|c| c.name == name).unwrap_or_else(|| panic!("{name}")).support
}

/// Every input of a record: surface, kind, onset and end within a tolerance (s).
fn check(name: &str, found: &Found, expected: &[(&str, Kind, f64, f64)], tolerance: f64) {
    let mut inputs: Vec<_> = found.manoeuvres.iter().flat_map(|m| &m.inputs).collect();
    inputs.sort_by(|a, b| a.onset_s.total_cmp(&b.onset_s));
    assert_eq!(inputs.len(), expected.len(), "{name}: {inputs:?}");
    for (input, (surface, kind, onset, end)) in inputs.iter().zip(expected) {
        assert_eq!((input.surface.as_str(), input.kind), (*surface, *kind), "{name}: {input:?}");
        assert!(
            (input.onset_s - onset).abs() <= tolerance && (input.end_s - end).abs() <= tolerance,
            "{name}: {input:?}"
        );
    }
    assert!(found.manoeuvres.iter().all(|m| m.useful), "{name}: {found:#?}");
}

/// Sampled at 100 Hz: an input is seen at the sample at which it acts; two samples of tolerance.
#[test]
fn every_input_of_the_built_in_flights_is_found_where_it_was_given() {
    use Kind::{Doublet, MultiStep, Other, Sine, ThreeTwoOneOne};
    let calm = [("elevator", ThreeTwoOneOne, 0.5, 4.7), ("elevator", ThreeTwoOneOne, 10.5, 14.7)];
    let lateral = [
        ("rudder", Doublet, 0.5, 2.5),
        ("aileron", Doublet, 5.0, 6.4),
        ("rudder", Doublet, 10.5, 12.5),
        ("aileron", Doublet, 15.0, 16.4),
    ];
    let six = [
        ("elevator", ThreeTwoOneOne, 0.5, 4.7),
        ("rudder", Doublet, 7.0, 9.0),
        ("aileron", Doublet, 11.0, 12.4),
        ("elevator", ThreeTwoOneOne, 16.0, 20.2),
        ("rudder", Doublet, 18.0, 20.0),
        ("aileron", Doublet, 23.0, 24.4),
    ];
    for (name, expected) in [
        ("f16-calm", &calm[..]),
        ("f16-lateral", &lateral),
        ("f16-six", &six),
        ("f16-thesis-doublet", &[("elevator", Doublet, 0.5, 2.5)]),
        ("f16-thesis-sine", &[("elevator", Sine, 0.5, 10.0)]),
    ] {
        check(name, &search(&flown(&scenario(name))), expected, 0.021);
    }
    // The surface lags its command by 0.05 s and its rate is limited.
    let actuators = [("elevator", ThreeTwoOneOne, 1.0, 5.5), ("elevator", MultiStep, 12.0, 14.75)];
    check("f16-gust-actuators", &search(&flown(&scenario("f16-gust-actuators"))), &actuators, 0.1);
    // A pilot's stick from the first sample to the last.
    for (name, seconds) in [("f16-damage", 20.0), ("f16-failure", 20.0), ("f16-healthy", 60.0)] {
        check(name, &search(&flown(&scenario(name))), &[("elevator", Other, 0.0, seconds)], 0.2);
    }
}

#[test]
fn what_a_manoeuvre_tells_is_that_of_its_axes() {
    let found = search(&flown(&scenario("f16-calm")));
    let first = &found.manoeuvres[0];
    for name in ["CL_alpha", "CL_q", "Cm_alpha", "Cm_q", "Cm_elevator"] {
        assert!(support(first, name) >= Support::Roughly, "{name}: {first:#?}");
    }
    // The rate of the angle of attack follows the pitch rate in every short-period motion.
    assert!(support(first, "Cm_alpha_dot") < Support::Roughly);
    // `phugoid linearize` with the increments of this flight gives 2.61 rad/s and 0.39.
    let short = first.short_period.unwrap();
    assert!((short.frequency_rad_s - 2.6).abs() < 0.15 && (short.damping - 0.39).abs() < 0.04, "{short:?}");
    assert_eq!((first.from_s, first.lead_s), (0.0, 0.5));
    let found = search(&flown(&scenario("f16-lateral")));
    assert!(found.manoeuvres.iter().all(|m| m.coefficients.iter().all(|c| !c.name.starts_with("Cm"))));
    assert!(support(&found.manoeuvres[0], "Cn_rudder") == Support::Told);
    assert!(support(&found.manoeuvres[1], "Cl_aileron") == Support::Told);
    // During the aileron doublet the rudder stood still.
    let still = found.manoeuvres[1].coefficients.iter().find(|c| c.name == "Cn_rudder").unwrap();
    assert!(still.support == Support::No && still.reason.contains("did not move"), "{still:?}");
}

/// Ten flights without input in calm air, with noise of 0.05 degrees on the surfaces; twenty with gusts.
#[test]
fn there_is_no_manoeuvre_without_an_input() {
    for (name, turbulent) in [("f16-six", false), ("f16-gust-actuators", true), ("f16-thesis-gust", true)] {
        for seed in 1..=10 {
            let mut scenario = scenario(name);
            scenario.manoeuvre.clear();
            scenario.seed = seed;
            let record = noisy(flown(&scenario), seed);
            let found = search(&record);
            assert_eq!(found.manoeuvres, [], "{name} {seed}");
            assert!(found.reasons.iter().any(|r| r.contains("no surface moved")), "{name}: {:?}", found.reasons);
            assert!(turbulent || found.unforced.is_empty(), "{name} {seed}: {:?}", found.unforced);
        }
    }
    // Turbulence is said, not taken for a manoeuvre.
    let found = search(&flown(&scenario("f16-thesis-gust")));
    assert!(found.unforced.len() == 1 && found.unforced[0].words.contains("turbulence"), "{found:?}");
}

fn noisy(mut record: Record, seed: u64) -> Record {
    let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
    for channel in record.channels.iter_mut().filter(|c| ["elevator", "aileron", "rudder"].contains(&c.name.as_str())) {
        for value in &mut channel.values {
            let sample: f64 = StandardNormal.sample(&mut random);
            *value += 0.05_f64.to_radians() * sample;
        }
    }
    record
}

/// Noise of 0.05 degrees on the surface, every fourth value of it recorded, a wild value: the same manoeuvres. A surface recorded at
/// 25 Hz moves at one of its own samples, 0.04 s apart.
#[test]
fn noise_missing_values_and_a_wild_one_change_nothing() {
    let mut record = noisy(flown(&scenario("f16-calm")), 3);
    let elevator = record.channels.iter_mut().find(|c| c.name == "elevator").unwrap();
    for (k, value) in elevator.values.iter_mut().enumerate().filter(|(k, _)| k % 4 != 0) {
        let _ = k;
        *value = f64::NAN;
    }
    elevator.values[800] = 0.5;
    let expected = [("elevator", Kind::ThreeTwoOneOne, 0.5, 4.7), ("elevator", Kind::ThreeTwoOneOne, 10.5, 14.7)];
    check("noisy", &search(&record), &expected, 0.081);
}

#[test]
fn on_the_ground_and_without_airspeed_nothing_is_useful() {
    let mut record = flown(&scenario("f16-calm"));
    let speed = record.channels.iter().position(|c| c.name == "true_airspeed").unwrap();
    record.channels[speed].values.iter_mut().for_each(|v| *v *= 0.01);
    let found = search(&record);
    assert_eq!(found.manoeuvres.len(), 2);
    assert!(found.manoeuvres.iter().all(|m| !m.useful && m.remarks[0].contains("not in flight")), "{found:?}");
    record.channels.remove(speed);
    let found = search(&record);
    assert!(found.reasons[0].contains("no airspeed") && found.manoeuvres.iter().all(|m| !m.useful), "{found:?}");
    record.channels.retain(|c| c.name != "elevator" && c.name != "aileron" && c.name != "rudder");
    let found = search(&record);
    assert!(found.manoeuvres.is_empty() && found.reasons[0].contains("no control surface"), "{found:?}");
}

#[test]
fn without_accelerations_there_is_no_lift() {
    let mut record = flown(&scenario("f16-calm"));
    record.channels.retain(|c| c.name != "az");
    let found = search(&record);
    let first = &found.manoeuvres[0];
    let lift = first.coefficients.iter().find(|c| c.name == "CL_alpha").unwrap();
    assert!(lift.support == Support::No && lift.reason.contains("no acceleration along z"), "{lift:?}");
    assert_eq!(support(first, "Cm_elevator"), Support::Told);
}

/// The HFB-320: a 3-2-1-1 from 4.5 s and a pulse of 16 s from 25.4 s, sampled at 10 Hz.
#[test]
fn the_real_flight_is_a_3211_and_a_pulse() {
    let Some(path) = shared_data::shared_file("flight/hfb320.csv") else { return };
    let record = csv::read_path(&path, &CsvOptions::default()).unwrap();
    let found = search(&record);
    let expected = [("elevator", Kind::ThreeTwoOneOne, 4.5, 11.9), ("elevator", Kind::Pulse, 25.4, 41.4)];
    check("hfb320", &found, &expected, 0.35);
    for name in ["CL_alpha", "CD_alpha", "Cm_alpha", "Cm_q", "Cm_elevator"] {
        assert_eq!(support(&found.manoeuvres[0], name), Support::Told, "{name}: {found:#?}");
    }
}
