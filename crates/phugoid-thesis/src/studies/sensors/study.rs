//! Two sizes of increments, two inputs, one case: what could be known, and what is found.

use super::information::{INCREMENTS, Information};
use super::input::{CYCLE_S, GOAL_PERCENT, START_S, Sized, sized};
use super::seeds::{Seeds, scaled};
use crate::aircraft_case::AircraftCase;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::manoeuvre::Manoeuvre;

/// Increments of the published sizes, in the order of [`INCREMENTS`]. Their signs are lost: damage moves the coefficients this
/// way.
pub(super) const PUBLISHED: [f64; 4] = [-0.0015, -0.01, 0.01, 0.001];

/// Instants at which the bound is drawn, per second.
const INSTANTS_PER_S: usize = 10;

/// One size of increments with one input.
#[derive(Clone, Debug)]
pub(super) struct Arm {
    /// Size of the increments, in words.
    pub(super) increments: &'static str,
    /// Input, in words.
    pub(super) input: String,
    /// Amplitude of the input, deg.
    pub(super) amplitude_deg: f64,
    /// Bound over time with each increment looked for alone, one history per increment.
    pub(super) alone: Information,
    /// Bound over time with all four increments looked for together.
    pub(super) together: Information,
    /// What the flagship finds.
    pub(super) seeds: Seeds,
}

impl Arm {
    fn of(case: &AircraftCase, increments: &'static str, input: (String, f64, Manoeuvre)) -> Result<Self, StudyError> {
        let (words, amplitude_deg, manoeuvre) = input;
        let mut case = case.clone();
        case.scenario.manoeuvre = vec![manoeuvre];
        let flight = fly(&case.scenario)?;
        let names: Vec<&str> = case.unknowns().into_iter().map(|(name, _)| name).collect();
        let at = instants(&flight);
        let mut alone = Information { time_s: Vec::new(), percent: Vec::new() };
        for name in &names {
            let one = Information::of(&flight, &[name], &[name], &at)?;
            alone.time_s = one.time_s;
            alone.percent.extend(one.percent);
        }
        Ok(Self {
            increments,
            input: words,
            amplitude_deg,
            alone,
            together: Information::of(&flight, &INCREMENTS, &names, &at)?,
            seeds: Seeds::of(&case, &flight)?,
        })
    }
}

/// Evenly spaced instants from the start of the input on, and the end of the first cycle.
fn instants(flight: &Flight) -> Vec<f64> {
    let end = flight.truth.time.last().copied().unwrap_or(0.0);
    let count = (end * INSTANTS_PER_S as f64) as usize;
    let even = (0..=count).map(|k| k as f64 / INSTANTS_PER_S as f64).filter(|t| *t > START_S);
    let mut instants: Vec<f64> = even.chain([START_S + CYCLE_S]).collect();
    instants.sort_by(f64::total_cmp);
    instants
}

/// The study of a case: published increments and those of the case, thesis input and the sized one.
#[derive(Clone, Debug)]
pub(super) struct Study {
    /// The increments looked for.
    pub(super) names: Vec<&'static str>,
    /// Published increments with the thesis input and with the largest permitted one, then the case's with the thesis input
    /// and with the one sized for them.
    pub(super) arms: [Arm; 4],
    /// The input sized for the published increments, and that for the case's.
    pub(super) sized: [Sized; 2],
}

impl Study {
    /// Of a case; `thesis` is the published input: words, amplitude in deg, manoeuvre.
    pub(super) fn of(
        case: &AircraftCase,
        thesis: &(String, f64, Manoeuvre),
        progress: &dyn Fn(f64),
    ) -> Result<Self, StudyError> {
        let names: Vec<&'static str> = case.unknowns().into_iter().map(|(name, _)| name).collect();
        let published = scaled(case, PUBLISHED);
        let of_published = sized(&published.scenario, &names)?;
        let of_case = sized(&case.scenario, &names)?;
        progress(0.5);
        let own = |s: &Sized| (s.shape.words(), s.amplitude_deg, s.shape.manoeuvre(s.amplitude_deg));
        let arms = [
            Arm::of(&published, "published", thesis.clone())?,
            Arm::of(&published, "published", own(&of_published))?,
            Arm::of(case, "of damage", thesis.clone())?,
            Arm::of(case, "of damage", own(&of_case))?,
        ];
        progress(1.0);
        Ok(Self { names, arms, sized: [of_published, of_case] })
    }
}

/// How many such records one after the other bring a bound down to the goal: information adds up. The same by a larger
/// amplitude takes the square root of it.
pub(super) fn records_needed(percent: f64) -> f64 {
    (percent / GOAL_PERCENT).powi(2).max(1.0)
}
