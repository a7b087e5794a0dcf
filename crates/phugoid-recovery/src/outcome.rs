//! How a flight ended.

use phugoid_control::gains::Gains;
use phugoid_control::interval::{Estimate, Excess, excess, worst};
use phugoid_control::local::{ALPHA, BETA, SURFACES};
use phugoid_control::margin::{Margin, margins};
use phugoid_control::prediction::Steady;
use phugoid_control::qualities::{Category, Level, Qualities, qualities};
use phugoid_control::target::Targets;
use phugoid_flight_dynamics::trim::Trim;
use serde::Serialize;

use crate::history::History;
use crate::scale::Scale;

/// The end of the flight that is looked at, s.
const LAST_S: f64 = 10.0;
/// What counts as level flight: bank angle, sideslip, and rates at most, rad and rad/s; climb or descent, m/s. The stick of the
/// scenario and light turbulence stay within these on the undamaged aircraft.
const BANK: f64 = 0.35;
const SIDESLIP: f64 = 0.14;
const RATE: f64 = 0.35;
const CLIMB: f64 = 10.0;

/// What an estimate says is left of the aircraft with the last gains, for the pilot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Left {
    /// Flying qualities, category B.
    pub qualities: Qualities,
    /// The worst of them.
    pub level: Level,
    /// The worst motion within two standard errors, 1/s.
    pub worst: Excess,
    /// Angle of attack and sideslip that margins are of, the mean of the last seconds, rad: measured in what an estimate says, true in
    /// what is true.
    pub flow_angles: [f64; 2],
    /// What is left of elevator, aileron and rudder beside what straight flight takes at these angles.
    pub margins: [Margin; SURFACES],
}

/// What an estimate says with these gains after the last seconds; limits of the surfaces in rad, `scale` the standard deviation of the
/// scale of recorded positions.
pub fn left(estimate: &Estimate, gains: &Gains, steady: &Steady, limits: &[[f64; 2]; SURFACES], scale: f64) -> Left {
    let matrix = estimate.model.closed_loop(&gains.feedback());
    let found = qualities(&matrix, estimate.model.load_factor_per_alpha(), Category::B);
    let own = Gains::place_with(&estimate.model, &Targets::default(), gains.free).unwrap_or(*gains);
    Left {
        level: found.level(),
        qualities: found,
        worst: worst(estimate, gains),
        flow_angles: [steady.variables[ALPHA], steady.variables[BETA]],
        margins: margins(estimate, &own, steady, limits, scale),
    }
}

/// How a flight ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The motion left what the aircraft's data cover, or turned over.
    pub departed: bool,
    /// The last seconds were level flight, or a stabilised climb or descent of at most 10 m/s.
    pub level_flight: bool,
    /// Levels of flying qualities of the true aircraft with the last gains, category B.
    pub qualities: Qualities,
    /// The worst of them.
    pub level: Level,
    /// How far its roots are from the safe side of the damping line, 1/s.
    pub excess: Excess,
    /// Altitude lost since the start, m.
    pub altitude_lost_m: f64,
    /// Largest and smallest load factor of the flight, g.
    pub load_factor: [f64; 2],
}

impl Outcome {
    /// Level flight with level-1 or level-2 flying qualities.
    pub fn is_recovered(&self) -> bool {
        self.level_flight && self.level <= Level::Two
    }
}

pub(crate) fn judge(
    history: &History,
    departed: bool,
    trim: &Trim,
    truth: &Estimate,
    gains: &Gains,
    scale: Scale,
) -> Outcome {
    let end = history.time_s.last().copied().unwrap_or(0.0);
    let last = history.time_s.partition_point(|time| *time < end - LAST_S);
    let mean_size = |values: &[f64]| {
        let tail = &values[last.min(values.len())..];
        (tail.iter().map(|v| v * v).sum::<f64>() / tail.len().max(1) as f64).sqrt()
    };
    let (first, there) = (history.altitude.get(last), history.altitude.last());
    let climb = first.zip(there).map_or(f64::INFINITY, |(a, b)| (b - a).abs() / LAST_S);
    let level_flight = !departed
        && end > LAST_S
        && mean_size(&history.phi) < BANK
        && mean_size(&history.beta) < SIDESLIP
        && history.rates.iter().all(|rates| scale.rate(mean_size(rates)) < RATE)
        && scale.speed(climb) < CLIMB;
    let matrix = truth.model.closed_loop(&gains.feedback());
    let found = qualities(&matrix, truth.model.load_factor_per_alpha(), Category::B);
    let extreme = |pick: fn(f64, f64) -> f64| history.load_factor.iter().copied().reduce(pick).unwrap_or(f64::NAN);
    Outcome {
        departed,
        level_flight,
        level: if departed { Level::Worse } else { found.level() },
        qualities: found,
        excess: excess(&truth.model, gains),
        altitude_lost_m: trim.altitude_m - there.copied().unwrap_or(trim.altitude_m),
        load_factor: [extreme(f64::min), extreme(f64::max)],
    }
}
