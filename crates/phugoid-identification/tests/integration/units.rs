//! What an estimation makes of doubts about units: refused, said once, or none of its business.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::f16::{channel, fly, model};
use phugoid_flight_data::plausibility::{Certainty, check};
use phugoid_flight_data::quality::Finding;
use phugoid_flight_data::record::{Quantity, Record};
use phugoid_identification::estimate::{EstimateError, EstimateOptions, estimate};
use phugoid_identification::estimation::Estimation;

/// A record as the reader gives it, with the findings in it.
fn read(mut record: Record) -> Record {
    record.quality.findings = check(&record).into_iter().map(Finding::from).collect();
    record
}

fn run(record: &Record) -> Result<Estimation, EstimateError> {
    estimate(record, &model(), &EstimateOptions::default(), &mut |_| {})
}

#[test]
fn a_doubt_about_a_channel_that_is_used_is_said_once() {
    let mut record = fly(15.0, 0.026, 41);
    // The model takes the density of the air from the altitude.
    let altitude = record.channels.iter_mut().find(|c| c.name == "altitude").unwrap();
    altitude.values.iter_mut().for_each(|h| *h *= 5.0);
    let mut record = read(record);
    assert_eq!(record.quality.findings.len(), 1, "{}", record.quality);
    // Another number after a part was cut off, and yet the same doubt.
    record.time.truncate(600);
    for (k, c) in record.channels.iter_mut().enumerate() {
        c.values.truncate(600);
        if k == 1 {
            c.values.iter_mut().for_each(|h| *h += 7.0);
        }
    }
    let estimation = run(&record).unwrap();
    let told: Vec<&String> = estimation.verdict.iter().filter(|s| s.contains("`altitude`")).collect();
    println!("{told:?}");
    assert_eq!(told.len(), 1);
    assert!(told[0].starts_with("Check the units: channel `altitude`: is about 30487 m"));
    assert_eq!(estimation.quality.findings, []);
}

#[test]
fn channels_that_the_model_does_not_use_do_not_stop_it() {
    let mut record = fly(15.0, 0.026, 42);
    let samples = record.time.len();
    record.channels.push(channel("throttle", Quantity::Number, vec![80.0; samples]));
    record.channels.push(channel("dynamic_pressure", Quantity::Pressure, vec![100.0; samples]));
    record.channels.push(channel("beta", Quantity::Angle, vec![-3.0; samples]));
    let record = read(record);
    assert!(check(&record).iter().all(|doubt| doubt.certainty == Certainty::Certain));
    assert_eq!(record.quality.findings.len(), 3, "{}", record.quality);
    let estimation = run(&record).unwrap();
    // One of the two is wrong, and it may be the airspeed, which is used: said, not refused.
    let told: Vec<&String> = estimation.verdict.iter().filter(|s| s.contains("Check the units")).collect();
    assert!(told.len() == 1 && told[0].contains("`dynamic_pressure` and `true_airspeed`"), "{told:?}");
    let places: Vec<&str> = estimation.quality.findings.iter().map(|f| f.place.as_str()).collect();
    assert_eq!(places, ["beta", "throttle"]);
}
