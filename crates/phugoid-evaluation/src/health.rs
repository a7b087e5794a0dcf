//! Studies of the health monitor: how often it raises a false alarm, how many failures it finds, how soon, and how well
//! it tells when they began.
//!
//! Every run has its own pilot, sensor noise, noise *levels*, constant sensor errors, and its own place within the tolerances.

use phugoid_flight_dynamics::increments::Increments;
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::health::{Condition, HealthOptions, HealthReport};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::monitor::monitor;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

use crate::accuracy::StudyError;
use crate::ledger::{Ledger, recorded};
use crate::statistics::{clopper_pearson, quantile};
use phugoid_simulation::flight::fly;
use phugoid_simulation::manoeuvre::{Manoeuvre, Surface};
use phugoid_simulation::quantity::{Acceleration, Angle, AngularRate, Quantity, Speed, Time};
use phugoid_simulation::scenario::{Damage, Scenario, Sensor};

/// Noise levels lie within this factor of what the model file says, either way.
const NOISE_FACTOR: f64 = 1.25;
/// Rates for which one run of the healthy flights tells the false alarms, 1/h.
const RATES: [f64; 5] = [0.01, 0.1, 1.0, 6.0, 30.0];
/// The monitor begins this long after the first sample, s.
const SETTLE_S: f64 = 2.0;

/// False alarms at one accepted rate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FalseAlarms {
    /// Rate of false alarms that the monitor was set to accept, 1/h.
    pub accepted_per_hour: f64,
    /// Number of healthy flights in which the monitor raised at least one (false) alarm.
    pub flights: usize,
    /// Largest probability of a false alarm per flight that the accepted rate promises.
    pub promised: f64,
    /// 95 % interval (Clopper and Pearson) of the probability per flight.
    pub interval: [f64; 2],
}

/// Result of the study of healthy flights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HealthyStudy {
    /// Number of healthy flights.
    pub runs: usize,
    /// Hours of flight over all runs in which the monitor was watching.
    pub hours: f64,
    /// False alarms found, one element for each accepted rate.
    pub false_alarms: Vec<FalseAlarms>,
    /// Flights called healthy at their end (at 0.01 per hour).
    pub called_healthy: usize,
}

/// What moves the stick in the study of failures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stick {
    /// The random stick of the scenario's pilot, which moves all the time.
    Pilot,
    /// A 3-2-1-1 of 1.5 deg every ten seconds and no input between them. Without input a failure cannot be seen.
    Calm,
}

/// Result of the study of failures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FailureStudy {
    /// What moved the stick in these flights.
    pub stick: Stick,
    /// Flights, each with one failure of one to three coefficients.
    pub runs: usize,
    /// Number of flights in which the monitor raised its flag before the failure.
    pub false_alarms: usize,
    /// Number of flights in which the failure was not flagged before the end.
    pub missed: usize,
    /// Median time from the failure to the flag over the failures that were found, s.
    pub latency_median_s: f64,
    /// 90 % quantile of the same time, s.
    pub latency_90_percent_s: f64,
    /// Median of the absolute error of the onset, s.
    pub onset_error_median_s: f64,
    /// 90 % quantile of the absolute error of the onset, s.
    pub onset_error_90_percent_s: f64,
    /// Fraction of the found failures whose onset lies in the 95 % interval.
    pub onset_coverage: f64,
    /// Median width of that interval, s.
    pub onset_width_median_s: f64,
    /// Number of coefficients that failed, over all flights in which the failure was found.
    pub failed: usize,
    /// How many of the failed coefficients were named by the monitor.
    pub named: usize,
    /// Number of coefficients that the monitor named although they had not failed.
    pub wrongly_named: usize,
}

/// What a healthy flight says.
#[derive(Serialize, Deserialize)]
struct Watched {
    #[serde(with = "crate::exact")]
    evidence: f64,
    is_called_healthy: bool,
}

/// What a flight with a failure says.
#[derive(Serialize, Deserialize)]
struct Failing {
    onset_s: f64,
    /// The coefficients that failed.
    failed: Vec<String>,
    found: Option<Found>,
}

/// The failure as the monitor reports it.
#[derive(Serialize, Deserialize)]
struct Found {
    flagged_at_s: f64,
    onset_s: Option<f64>,
    onset_interval_s: Option<[f64; 2]>,
    parameters: Vec<String>,
}

/// The name of a run among those of a study.
fn seed_of(scenario: &Scenario, run: usize) -> String {
    format!("seed {}", scenario.seed.wrapping_add(run as u64))
}

/// Flies the healthy scenario `runs` times. `ledger` is told of each flight, from any thread, and may keep what the monitor says; it has
/// to know the scenario and the model.
///
/// # Errors
/// [`StudyError`]: the scenario cannot be flown, or the model does not fit it.
pub fn healthy(
    scenario: &Scenario,
    model: &ModelFile,
    runs: usize,
    ledger: &dyn Ledger,
) -> Result<HealthyStudy, StudyError> {
    let one = |run: usize| -> Result<Watched, StudyError> {
        let report = watch(&aircraft(scenario, model, run), model, RATES[0])?;
        Ok(Watched { evidence: report.evidence, is_called_healthy: report.condition == Condition::Healthy })
    };
    let results = recorded(runs, "health of healthy aircraft", |run| seed_of(scenario, run), one, ledger)?;
    let monitored_h = (scenario.duration.si() - SETTLE_S) / 3600.0;
    let false_alarms = RATES
        .iter()
        .map(|&rate| {
            let flights = results.iter().filter(|r| r.evidence >= -rate.ln()).count();
            FalseAlarms {
                accepted_per_hour: rate,
                flights,
                promised: (rate * monitored_h).min(1.0),
                interval: clopper_pearson(flights, runs),
            }
        })
        .collect();
    let called_healthy = results.iter().filter(|r| r.is_called_healthy).count();
    Ok(HealthyStudy { runs, hours: monitored_h * runs as f64, false_alarms, called_healthy })
}

/// Flies the scenario `runs` times with a failure of random time, coefficients, size and sign.
///
/// # Errors
/// As [`healthy`].
pub fn failures(
    scenario: &Scenario,
    model: &ModelFile,
    stick: Stick,
    runs: usize,
    ledger: &dyn Ledger,
) -> Result<FailureStudy, StudyError> {
    let one = |run: usize| -> Result<Failing, StudyError> {
        let (flight, onset_s, failed) = failing(scenario, model, stick, run);
        let found = watch(&flight, model, RATES[0])?.failure.map(|failure| Found {
            flagged_at_s: failure.flagged_at_s,
            onset_s: failure.onset_s,
            onset_interval_s: failure.onset_interval_s,
            parameters: failure.parameters,
        });
        Ok(Failing { onset_s, failed, found })
    };
    let inputs = format!("health of failing aircraft, {stick:?}");
    let results = recorded(runs, &inputs, |run| seed_of(scenario, run), one, ledger)?;
    let (mut latencies, mut errors, mut widths) = (Vec::new(), Vec::new(), Vec::new());
    let (mut false_alarms, mut missed, mut covered, mut all, mut named, mut wrongly) = (0, 0, 0, 0, 0, 0);
    for Failing { onset_s, failed, found } in &results {
        let Some(failure) = found else {
            missed += 1;
            continue;
        };
        if failure.flagged_at_s < *onset_s {
            false_alarms += 1;
            continue;
        }
        latencies.push(failure.flagged_at_s - onset_s);
        if let (Some(found), Some([low, high])) = (failure.onset_s, failure.onset_interval_s) {
            errors.push((found - onset_s).abs());
            widths.push(high - low);
            covered += usize::from((low..=high).contains(onset_s));
        }
        all += failed.len();
        named += failure.parameters.iter().filter(|name| failed.contains(name)).count();
        wrongly += failure.parameters.iter().filter(|name| !failed.contains(name)).count();
    }
    Ok(FailureStudy {
        stick,
        runs,
        false_alarms,
        missed,
        latency_median_s: quantile(latencies.clone(), 0.5),
        latency_90_percent_s: quantile(latencies, 0.9),
        onset_coverage: covered as f64 / errors.len().max(1) as f64,
        onset_width_median_s: quantile(widths, 0.5),
        onset_error_median_s: quantile(errors.clone(), 0.5),
        onset_error_90_percent_s: quantile(errors, 0.9),
        failed: all,
        named,
        wrongly_named: wrongly,
    })
}

/// Flies a scenario and monitors it, until the attitude leaves what a longitudinal flight is.
///
/// # Errors
/// As [`healthy`].
pub fn watch(scenario: &Scenario, model: &ModelFile, false_alarms_per_hour: f64) -> Result<HealthReport, StudyError> {
    let flight = fly(scenario)?;
    let held = flight.measured.between(f64::NEG_INFINITY, flight.held_until_s());
    let held = held.ok_or_else(|| StudyError::unsuitable("the flight begins with an attitude that nobody holds"))?;
    let options = HealthOptions { expected: model.expectations(), false_alarms_per_hour };
    let (_, report) = monitor(&held, model, &EstimateOptions::default(), &options, &mut |_| {})?;
    Ok(report)
}

/// The scenario as run `run` flies it: another healthy aircraft with other sensors.
fn aircraft(scenario: &Scenario, model: &ModelFile, run: usize) -> Scenario {
    let mut random = Pcg64Mcg::seed_from_u64(scenario.seed.wrapping_add(run as u64));
    let mut flown = Scenario { seed: scenario.seed.wrapping_add(run as u64), ..scenario.clone() };
    let mut uniform = || 2.0 * random.random::<f64>() - 1.0;
    for expectation in &model.expectations() {
        let value = expectation.value + expectation.tolerance * uniform();
        set(&mut flown.increments, &expectation.name, value);
    }
    let sensors = &mut flown.sensors;
    vary(&mut sensors.true_airspeed, Speed::from_si, &mut uniform);
    vary(&mut sensors.alpha, Angle::from_si, &mut uniform);
    vary(&mut sensors.theta, Angle::from_si, &mut uniform);
    vary(&mut sensors.q, AngularRate::from_si, &mut uniform);
    vary(&mut sensors.ax, Acceleration::from_si, &mut uniform);
    vary(&mut sensors.az, Acceleration::from_si, &mut uniform);
    flown
}

/// Another noise level, and another constant error of up to twice the scenario's, either sign.
fn vary<Q: Quantity>(sensor: &mut Sensor<Q>, of_si: fn(f64) -> Q, uniform: &mut impl FnMut() -> f64) {
    sensor.noise = of_si(sensor.noise.si() * NOISE_FACTOR.powf(uniform()));
    sensor.bias = of_si(sensor.bias.si() * 2.0 * uniform());
}

/// A healthy aircraft until a random time between 6 and 12 s; then one to three coefficients are two to six tolerances away from
/// what is expected. Gives the time and the names.
fn failing(scenario: &Scenario, model: &ModelFile, stick: Stick, run: usize) -> (Scenario, f64, Vec<String>) {
    let mut flown = aircraft(scenario, model, run);
    let mut random = Pcg64Mcg::seed_from_u64(scenario.seed.wrapping_add(0x6661_696c + run as u64));
    let onset_s = 6.0 + 6.0 * random.random::<f64>();
    let mut increments = flown.increments;
    let mut candidates = model.expectations();
    let mut failed = Vec::new();
    for _ in 0..random.random_range(1..=3_usize) {
        let expectation = candidates.remove(random.random_range(0..candidates.len()));
        let sign = if random.random::<f64>() < 0.5 { -1.0 } else { 1.0 };
        let beyond = 5.0_f64.powf(random.random::<f64>());
        set(&mut increments, &expectation.name, expectation.value + sign * expectation.tolerance * (1.0 + beyond));
        failed.push(expectation.name);
    }
    flown.damage = vec![Damage::sudden(Time::from_si(onset_s), increments)];
    if stick == Stick::Calm {
        flown.manoeuvre = [1.0, 11.0]
            .map(|start| Manoeuvre::ThreeTwoOneOne {
                surface: Surface::Elevator,
                start: Time::from_si(start),
                unit: Time::from_si(0.6),
                amplitude: Angle::from_si(1.5_f64.to_radians()),
            })
            .to_vec();
    }
    (flown, onset_s, failed)
}

/// Sets an increment; a parameter that is none (a sensor's constant error) is not of the aircraft.
fn set(increments: &mut Increments, name: &str, value: f64) {
    if let Some(increment) = increments.longitudinal_mut(name) {
        *increment = value;
    }
}
