//! An input that is large enough for real sensors and small enough for the aircraft, by a rule.

use crate::units::STANDARD_GRAVITY;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_flight_dynamics::f16::ALPHA_RANGE_DEG;
use phugoid_simulation::flight::Flight;
use phugoid_simulation::manoeuvre::{Manoeuvre, Surface};
use phugoid_simulation::quantity::{Angle, Frequency, Time};
use phugoid_simulation::scenario::Scenario;

use super::information::hardest;
use crate::studies::trim::SHORT_PERIOD_S;

/// One cycle of the short period at the condition of the cases, s.
pub(super) const CYCLE_S: f64 = SHORT_PERIOD_S;
/// When the inputs start, s.
pub(super) const START_S: f64 = 0.5;
/// What the bound of the hardest coefficient must come down to in one cycle, percent: 5 % are then three standard errors.
pub(super) const GOAL_PERCENT: f64 = 5.0 / 3.0;
/// Largest change of the load factor, g.
pub(super) const LOAD_LIMIT: f64 = 3.0;
/// Largest elevator, deg: where the tables and the actuator end.
pub(super) const ELEVATOR_LIMIT_DEG: f64 = 25.0;

/// Shapes that are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// A 3-2-1-1 that fills the cycle.
    ThreeTwoOneOne,
    /// A doublet that fills the cycle.
    Doublet,
    /// A sine with this frequency, Hz.
    Sine(f64),
}

/// All of them: the short period itself (0.24 Hz), twice as fast, and the thesis's 1 Hz.
pub(super) const SHAPES: [Shape; 5] =
    [Shape::ThreeTwoOneOne, Shape::Doublet, Shape::Sine(0.24), Shape::Sine(0.5), Shape::Sine(1.0)];

impl Shape {
    /// The elevator manoeuvre with an amplitude in deg.
    pub(super) fn manoeuvre(self, amplitude_deg: f64) -> Manoeuvre {
        let (surface, start) = (Surface::Elevator, Time::from_si(START_S));
        let amplitude = Angle::from_si(amplitude_deg.to_radians());
        match self {
            // Seven units of 0.59 s are 4.13 s.
            Self::ThreeTwoOneOne => Manoeuvre::ThreeTwoOneOne { surface, start, unit: Time::from_si(0.59), amplitude },
            Self::Doublet => Manoeuvre::Doublet { surface, start, width: Time::from_si(2.0), amplitude },
            Self::Sine(hertz) => {
                Manoeuvre::Sine { surface, start, frequency: Frequency::from_si(hertz), amplitude, duration: None }
            }
        }
    }

    /// In words.
    pub(super) fn words(self) -> String {
        match self {
            Self::ThreeTwoOneOne => "3-2-1-1 of 0.59 s".to_owned(),
            Self::Doublet => "doublet of 2 + 2 s".to_owned(),
            Self::Sine(hertz) => format!("{hertz} Hz sine"),
        }
    }
}

/// An input with what it does to the aircraft and what it can tell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sized {
    /// Shape.
    pub(super) shape: Shape,
    /// Amplitude, deg.
    pub(super) amplitude_deg: f64,
    /// Bound of the hardest coefficient after one cycle, percent of the truth.
    pub(super) percent: f64,
    /// Largest change of the load factor, g.
    pub(super) load: f64,
    /// Whether the goal is reached within the limits.
    pub(super) reaches_goal: bool,
}

/// The input for a scenario's increments `unknown`.
///
/// Of each shape the smallest amplitude whose Cramer-Rao bound after one short-period cycle is [`GOAL_PERCENT`] for the
/// hardest coefficient; of those the one that loads the aircraft least. Where no shape comes down to the goal within the
/// limits (load factor, elevator, angle of attack within the tables), the one that comes nearest, at its limit.
pub(super) fn sized(scenario: &Scenario, unknown: &[&str]) -> Result<Sized, StudyError> {
    let mut best: Option<Sized> = None;
    for shape in SHAPES {
        let candidate = sized_shape(scenario, unknown, shape)?;
        let better = |b: &Sized| match (candidate.reaches_goal, b.reaches_goal) {
            (true, true) => candidate.load < b.load,
            (false, false) => candidate.percent < b.percent,
            (reaches, _) => reaches,
        };
        if best.as_ref().is_none_or(better) {
            best = Some(candidate);
        }
    }
    best.ok_or_else(|| StudyError::Unsuitable("no shape of input to try".to_owned()))
}

fn sized_shape(scenario: &Scenario, unknown: &[&str], shape: Shape) -> Result<Sized, StudyError> {
    let at = |amplitude_deg: f64| -> Result<(Sized, f64), StudyError> {
        let mut scenario = scenario.clone();
        scenario.duration = Time::from_si(START_S + CYCLE_S);
        scenario.manoeuvre = vec![shape.manoeuvre(amplitude_deg)];
        let (percent, flight) = hardest(&scenario, unknown, START_S + CYCLE_S)?;
        let (load, strain) = strain(&flight);
        let reaches_goal = percent <= GOAL_PERCENT && strain <= 1.0;
        Ok((Sized { shape, amplitude_deg, percent, load, reaches_goal }, strain))
    };
    // Bound and load are all but proportional to the amplitude and its inverse: few steps suffice, and 1 % to spare
    // makes them meet.
    let mut amplitude_deg = 1.0;
    let (mut last, mut strain) = at(amplitude_deg)?;
    for _ in 0..6 {
        let to_goal = last.percent / (0.99 * GOAL_PERCENT);
        let to_limit = 0.99 / strain;
        let factor = to_goal.min(to_limit);
        if (0.985..=1.0).contains(&factor) || (factor - 1.0).abs() < 1e-3 {
            break;
        }
        amplitude_deg *= factor;
        (last, strain) = at(amplitude_deg)?;
    }
    Ok(last)
}

/// Largest change of the load factor (g), and how far the flight goes towards its limits: 1 is at one of them.
fn strain(flight: &Flight) -> (f64, f64) {
    let channel = |name: &str| flight.truth.channel(name).map(|c| c.values.as_slice()).unwrap_or_default();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |m: f64, v| m.max(v.abs()));
    let load = largest(&mut channel("az").iter().map(|az| -az / STANDARD_GRAVITY - 1.0));
    let elevator = largest(&mut channel("elevator").iter().copied()).to_degrees();
    let [lowest, highest] = ALPHA_RANGE_DEG;
    let alpha = channel("alpha").iter().map(|a| a.to_degrees());
    let beyond = alpha.fold(0.0, |m: f64, a| m.max(a / highest).max(a / lowest));
    (load, (load / LOAD_LIMIT).max(elevator / ELEVATOR_LIMIT_DEG).max(beyond))
}
