//! False adoptions under errors of the model.

use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::{Estimation, EventKind};
use phugoid_identification::model_file::{ModelFile, Source, Thrust};
use serde::{Deserialize, Serialize};

use super::conditions::{Air, Stick};
use super::draw::{Order, flown};
use super::lines::errors_at;
use crate::accuracy::StudyError;
use crate::ledger::{Ledger, recorded};
use crate::statistics::poisson;
use phugoid_simulation::quantity::Time;
use phugoid_simulation::scenario::{Scenario, TableFactors};

/// Length of a flight, s.
const FLIGHT_S: f64 = 60.0;
/// From this long after an adoption on it is asked whether it has done harm, s: until then everybody is still learning.
const SETTLED_S: f64 = 2.0;
/// Harm: an error larger than without change detection by more than this part of the half width of the bounds.
const HARM: f64 = 0.1;
/// ... and outside the claimed bounds: more than this many claimed standard errors.
const CLAIMED: f64 = 3.0;

/// One line of the table of false adoptions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelErrorLine {
    /// What the model does not know.
    pub error: String,
    /// Whether the model file has the term that the error asks for (`alpha^2` in `Cm`).
    pub term: bool,
    /// What disturbed the flights of this line.
    pub air: Air,
    /// Minutes flown, half with each stick.
    pub minutes: f64,
    /// Adoptions, none of them right.
    pub adoptions: usize,
    /// Adoptions per ten minutes of flight; every one of them is false.
    pub per_ten_minutes: f64,
    /// 95 % interval of the rate, for Poisson counts.
    pub interval: [f64; 2],
    /// Adoptions after which an estimate is worse than without change detection by more than 10 % of its half width.
    pub harmful: usize,
    /// Those of them in which it is also outside of three claimed standard errors.
    pub harmful_and_claimed: usize,
    /// Number of doubts (first suspicions of a change) raised over all flights.
    pub doubts: usize,
    /// Flights at whose end the detector called itself insensitive.
    pub insensitive: usize,
    /// Root mean square error at the end over flights and parameters, in half widths: with change detection and without.
    pub error_at_end: [f64; 2],
    /// Part of the true values within two claimed standard errors at the end: with change detection and without.
    pub coverage_at_end: [f64; 2],
    /// Seeds of the flights with an adoption.
    pub seeds: Vec<u64>,
}

/// A line to be flown.
pub(super) struct Line {
    name: &'static str,
    air: Air,
    alter: fn(&mut Scenario),
    term: bool,
}

impl Line {
    const fn new(name: &'static str, air: Air, alter: fn(&mut Scenario)) -> Self {
        Self { name, air, alter, term: false }
    }

    /// The same flights with the term in the model.
    const fn with_term(name: &'static str, air: Air, alter: fn(&mut Scenario)) -> Self {
        Self { name, air, alter, term: true }
    }
}

fn delay(scenario: &mut Scenario) {
    scenario.sensors.alpha.delay = Time::from_si(0.02);
}

/// Body-axis coefficients Cm, CZ, CX of the aircraft that flies, times these.
fn tables(scenario: &mut Scenario, [cm, cz, cx]: [f64; 3]) {
    scenario.model_error.tables = TableFactors { CX: cx, CZ: cz, Cm: cm, ..TableFactors::default() };
}

fn squared(scenario: &mut Scenario, per_rad_squared: f64) {
    scenario.model_error.Cm_alpha_squared = per_rad_squared;
}

fn all(scenario: &mut Scenario) {
    tables(scenario, [0.9, 1.1, 0.9]);
    squared(scenario, 1.0);
    delay(scenario);
    scenario.model_error.thrust = 0.1;
}

const ALL: &str = "all: tables, alpha^2 +1, delay, thrust";

pub(super) const LINES: &[Line] = &[
    Line::new("none", Air::Calm, |_| ()),
    Line::new("none", Air::Everything, |_| ()),
    Line::new("Cm CZ CX x .9 1.1 .9", Air::Calm, |s| tables(s, [0.9, 1.1, 0.9])),
    Line::new("Cm CZ CX x 1.1 .9 1.1", Air::Calm, |s| tables(s, [1.1, 0.9, 1.1])),
    Line::new("alpha 20 ms late", Air::Calm, delay),
    Line::new("alpha 20 ms late", Air::Everything, delay),
    Line::new("thrust told 10 % too high", Air::Calm, |s| s.model_error.thrust = 0.1),
    Line::new("Cm alpha^2, +0.5", Air::Calm, |s| squared(s, 0.5)),
    Line::new("Cm alpha^2, -0.5", Air::Calm, |s| squared(s, -0.5)),
    Line::new("Cm alpha^2, +2", Air::Calm, |s| squared(s, 2.0)),
    Line::new("Cm alpha^2, -2", Air::Calm, |s| squared(s, -2.0)),
    Line::new(ALL, Air::Everything, all),
    Line::with_term("none", Air::Everything, |_| ()),
    Line::with_term("Cm alpha^2, +0.5", Air::Calm, |s| squared(s, 0.5)),
    Line::with_term("Cm alpha^2, -0.5", Air::Calm, |s| squared(s, -0.5)),
    Line::with_term("Cm alpha^2, +2", Air::Calm, |s| squared(s, 2.0)),
    Line::with_term("Cm alpha^2, -2", Air::Calm, |s| squared(s, -2.0)),
    Line::with_term(ALL, Air::Everything, all),
];

#[derive(Serialize, Deserialize)]
struct Run {
    adoptions: usize,
    harmful: usize,
    harmful_and_claimed: usize,
    doubts: usize,
    insensitive: bool,
    #[serde(with = "crate::exact")]
    end: Vec<[f64; 2]>,
    #[serde(with = "crate::exact")]
    end_off: Vec<[f64; 2]>,
}

/// Flies every line for so many minutes with the first model, or with the second one, which has the term `alpha^2` in `Cm`.
///
/// # Errors
/// As [`super::damage_lines`].
pub fn model_error_lines(
    base: &Scenario,
    models: [&ModelFile; 2],
    minutes: usize,
    seed: u64,
    ledger: &dyn Ledger,
) -> Result<Vec<ModelErrorLine>, StudyError> {
    LINES.iter().map(|line| fly_line(base, models, line, minutes, seed, ledger)).collect()
}

/// Truth, bounds and judgement are those of the first model, without the term.
fn fly_line(
    base: &Scenario,
    [model, with_term]: [&ModelFile; 2],
    line: &Line,
    minutes: usize,
    seed: u64,
    ledger: &dyn Ledger,
) -> Result<ModelErrorLine, StudyError> {
    let one = |run: usize| -> Result<Run, StudyError> {
        let order = Order {
            stick: if run.is_multiple_of(2) { Stick::Pilot } else { Stick::ThreeTwoOneOne },
            air: line.air,
            biases: true,
            duration_s: FLIGHT_S,
            damage_at_s: None,
        };
        let drawn = flown(base, model, &order, seed.wrapping_add(run as u64), &line.alter)?;
        let mut told = if line.term { with_term.clone() } else { model.clone() };
        if drawn.scenario.model_error.thrust != 0.0 {
            // The thrust from the trim is right; the recorded one is not.
            told.aircraft.thrust = Thrust::Known(Source::Channel("thrust".to_owned()));
        }
        let with = |change_detection: bool| {
            let options = EstimateOptions { change_detection: Some(change_detection), ..EstimateOptions::causal() };
            estimate(&drawn.flight.measured, &told, &options, &mut |_| {})
        };
        Ok(judge(&with(true)?, &with(false)?, model, &drawn.truth(model, 0.0)))
    };
    let term = if line.term { ", with the term" } else { "" };
    let inputs = format!("detection with an error of the model: {}{term}, {:?}", line.name, line.air);
    let name = |run: usize| format!("flight {run} of those from seed {seed}");
    let results = recorded(minutes, &inputs, name, one, ledger)?;
    let sum = |of: &dyn Fn(&Run) -> usize| results.iter().map(of).sum::<usize>();
    let adoptions = sum(&|r| r.adoptions);
    let per_ten_minutes = 10.0 / (results.len().max(1) as f64 * FLIGHT_S / 60.0);
    let all = |of: &dyn Fn(&Run) -> &Vec<[f64; 2]>| -> Vec<[f64; 2]> {
        results.iter().flat_map(|r| of(r).iter().copied()).collect()
    };
    let (on, off) = (all(&|r| &r.end), all(&|r| &r.end_off));
    let rms = |e: &[[f64; 2]]| (e.iter().map(|e| e[0] * e[0]).sum::<f64>() / e.len().max(1) as f64).sqrt();
    let coverage = |e: &[[f64; 2]]| e.iter().filter(|e| e[1] <= 2.0).count() as f64 / e.len().max(1) as f64;
    Ok(ModelErrorLine {
        error: line.name.to_owned(),
        term: line.term,
        air: line.air,
        minutes: results.len() as f64 * FLIGHT_S / 60.0,
        adoptions,
        per_ten_minutes: adoptions as f64 * per_ten_minutes,
        interval: poisson(adoptions).map(|n| n * per_ten_minutes),
        harmful: sum(&|r| r.harmful),
        harmful_and_claimed: sum(&|r| r.harmful_and_claimed),
        doubts: sum(&|r| r.doubts),
        insensitive: sum(&|r| usize::from(r.insensitive)),
        error_at_end: [rms(&on), rms(&off)],
        coverage_at_end: [coverage(&on), coverage(&off)],
        seeds: (seed..).zip(&results).filter(|(_, r)| r.adoptions > 0).map(|(seed, _)| seed).collect(),
    })
}

/// What the adoptions of a flight have done to it.
fn judge(on: &Estimation, off: &Estimation, model: &ModelFile, truth: &[f64]) -> Run {
    let times: Vec<f64> = on.events.iter().filter(|e| e.kind == EventKind::Adopted).map(|e| e.time_s).collect();
    let end_s = on.history.time_s.last().copied().unwrap_or(0.0);
    let (mut harmful, mut harmful_and_claimed) = (0, 0);
    for (i, adopted_s) in times.iter().enumerate() {
        let until = times.get(i + 1).copied().unwrap_or(end_s);
        let (mut harm, mut claimed) = (false, false);
        let mut t = adopted_s + SETTLED_S;
        while t <= until {
            let (a, b) = (errors_at(on, model, truth, t), errors_at(off, model, truth, t));
            for (with, without) in a.iter().zip(&b) {
                let worse = with[0] > without[0] + HARM || with[0].is_nan();
                harm |= worse;
                claimed |= worse && (with[1] > CLAIMED || with[1].is_nan());
            }
            t += 1.0;
        }
        harmful += usize::from(harm);
        harmful_and_claimed += usize::from(claimed);
    }
    let count = |kind: EventKind| on.events.iter().filter(|e| e.kind == kind).count();
    Run {
        adoptions: times.len(),
        harmful,
        harmful_and_claimed,
        doubts: count(EventKind::InDoubt),
        insensitive: count(EventKind::Insensitive) > 0,
        end: errors_at(on, model, truth, end_s),
        end_off: errors_at(off, model, truth, end_s),
    }
}
