//! How a flight ended.

use phugoid_control::gains::Gains;
use phugoid_control::interval::{Estimate, Excess, excess, worst, worst_levels};
use phugoid_control::local::{ALPHA, BETA, LocalModel, MAIN_AXIS, SURFACES};
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
    /// Flying qualities at the estimate, category B.
    pub qualities: Qualities,
    /// The worst of them on the axes that the estimate tells; worse than level 3 where an axis is not controlled. None where the estimate
    /// tells of no axis.
    pub level: Option<Level>,
    /// The same at the worst that two standard errors leave possible: never better than `level`.
    pub level_within_bounds: Option<Level>,
    /// The level of the motion at the estimate alone, whether it is controlled or not; none where the estimate does not tell all axes.
    pub motion: Option<Level>,
    /// Whether the estimate tells what flying qualities depend on in pitch, and in roll and yaw: the model has the derivatives.
    pub told: [bool; 2],
    /// Whether elevator, aileron and rudder still move the aircraft about pitch, roll and yaw: they are used and have an effect.
    pub controlled: [bool; SURFACES],
    /// Whether the rudder rolls the aircraft, by a sideslip, because its ailerons do not.
    pub rolled_by_sideslip: bool,
    /// The worst motion within two standard errors, 1/s.
    pub worst: Excess,
    /// Angle of attack and sideslip that margins are of, the mean of the last seconds, rad: measured in what an estimate says, true in
    /// what is true.
    pub flow_angles: [f64; 2],
    /// What is left of elevator, aileron and rudder beside what straight flight takes at these angles.
    pub margins: [Margin; SURFACES],
}

/// What `left` is asked about.
pub(crate) struct Asked<'a> {
    pub(crate) estimate: &'a Estimate,
    pub(crate) gains: &'a Gains,
    /// Of the last seconds.
    pub(crate) steady: &'a Steady,
    /// Of the surfaces, rad.
    pub(crate) limits: &'a [[f64; 2]; SURFACES],
    /// Standard deviation of the scale of recorded positions, a part.
    pub(crate) scale: f64,
    /// The aircraft before anything was damaged, at the present speed and air density, where it is known.
    pub(crate) before: Option<&'a LocalModel>,
    /// As [`Left::told`].
    pub(crate) told: [bool; 2],
}

/// What an estimate says with these gains after the last seconds.
pub(crate) fn left(asked: &Asked<'_>) -> Left {
    let Asked { estimate, gains, steady, .. } = *asked;
    let matrix = estimate.model.closed_loop(&gains.feedback());
    let found = qualities(&matrix, estimate.model.load_factor_per_alpha(), Category::B);
    let within = worst_levels(estimate, gains, Category::B);
    let own = Gains::place_with(&estimate.model, &Targets::default(), gains.free).unwrap_or(*gains);
    let margins = margins(estimate, &own, steady, asked.limits, asked.scale, asked.before);
    let controlled = margins.map(|margin| margin.is_used && margin.has_effect);
    let level = |pitch: Level, lateral: Level| {
        let told = asked.told.into_iter().zip([pitch, lateral]).filter_map(|(told, level)| told.then_some(level));
        // What cannot be controlled is not "safely controlled", which level 3 asks for.
        told.max().map(|level| if controlled == [true; SURFACES] { level } else { Level::Worse })
    };
    Left {
        level: level(found.pitch_level(), found.lateral_level()),
        level_within_bounds: level(within.pitch, within.lateral),
        motion: (asked.told == [true; 2]).then(|| found.level()),
        told: asked.told,
        controlled,
        rolled_by_sideslip: gains.roll_by_sideslip.is_some(),
        qualities: found,
        worst: worst(estimate, gains),
        flow_angles: [steady.variables[ALPHA], steady.variables[BETA]],
        margins,
    }
}

/// How a flight ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The motion left what the aircraft's data cover, or turned over.
    pub departed: bool,
    /// The last seconds were level flight, or a stabilised climb or descent of at most 10 m/s. Whether the speed stays is
    /// [`holds_energy`](Self::holds_energy).
    pub level_flight: bool,
    /// Change of the airspeed over the last seconds, m/s each second: the slope of a straight line.
    pub speed_change_m_s2: f64,
    /// Whether that is worth less than 10 m/s of climb or descent, `V V'/g`: an aircraft that holds its altitude with its speed will not
    /// hold it for long.
    pub holds_energy: bool,
    /// Whether elevator, aileron and rudder truly still move the aircraft about pitch, roll and yaw. The levels are of the motion, whether
    /// it can be controlled or not.
    pub controlled: [bool; SURFACES],
    /// Whether the last gains roll the aircraft with the rudder, by a sideslip, because its ailerons do not.
    pub rolled_by_sideslip: bool,
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
    gravity: f64,
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
    let speed_change = slope(history.time_s.get(last..).unwrap_or(&[]), history.speed.get(last..).unwrap_or(&[]));
    let speed = history.speed.last().copied().unwrap_or(f64::NAN);
    let matrix = truth.model.closed_loop(&gains.feedback());
    let found = qualities(&matrix, truth.model.load_factor_per_alpha(), Category::B);
    let extreme = |pick: fn(f64, f64) -> f64| history.load_factor.iter().copied().reduce(pick).unwrap_or(f64::NAN);
    Outcome {
        departed,
        level_flight,
        speed_change_m_s2: speed_change,
        holds_energy: scale.speed(speed * speed_change / gravity).abs() < CLIMB,
        controlled: std::array::from_fn(|j| gains.free[j] && truth.model.surfaces[MAIN_AXIS[j]][j] != 0.0),
        rolled_by_sideslip: gains.roll_by_sideslip.is_some(),
        level: if departed { Level::Worse } else { found.level() },
        qualities: found,
        excess: excess(&truth.model, gains),
        altitude_lost_m: trim.altitude_m - there.copied().unwrap_or(trim.altitude_m),
        load_factor: [extreme(f64::min), extreme(f64::max)],
    }
}

/// Slope of the straight line through values at times, least squares; zero for fewer than two.
fn slope(times: &[f64], values: &[f64]) -> f64 {
    let count = times.len().min(values.len());
    let mean = |of: &[f64]| of.iter().take(count).sum::<f64>() / count as f64;
    let (time, value) = (mean(times), mean(values));
    let (mut product, mut square) = (0.0, 0.0);
    for (t, v) in times.iter().zip(values) {
        product += (t - time) * (v - value);
        square += (t - time) * (t - time);
    }
    if square > 0.0 { product / square } else { 0.0 }
}
