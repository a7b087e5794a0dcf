//! What was flown at an instant, where the estimate is asked for lift and drag, and what it answers.

use phugoid_control::local::SURFACES;

/// What was measured at one instant: angle of attack, sideslip, roll, pitch and yaw rate, airspeed, elevator, aileron and rudder; SI.
pub type Instant = [f64; 9];

/// Where the estimate is asked for lift and drag.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Condition {
    /// True airspeed, m/s, and altitude, m.
    pub(crate) flown: [f64; 2],
    /// Angle of attack and sideslip, rad.
    pub(crate) angles: [f64; 2],
    /// Roll, pitch and yaw rate, rad/s.
    pub(crate) rates: [f64; 3],
    /// Elevator, aileron and rudder, rad.
    pub(crate) positions: [f64; SURFACES],
}

/// Lift and drag coefficient at an angle of attack, and what a unit of each parameter adds to them.
pub(crate) struct Polar {
    pub(crate) value: [f64; 2],
    pub(crate) by_parameter: Vec<[f64; 2]>,
}

impl Polar {
    /// Variance of `weights` times lift and drag less `other_weights` times those of another point.
    pub(crate) fn variance(&self, weights: [f64; 2], other: Option<(&Self, [f64; 2])>, covariance: &[Vec<f64>]) -> f64 {
        let row = |k: usize| {
            let of = |polar: &Self, w: [f64; 2]| polar.by_parameter.get(k).map_or(0.0, |g| w[0] * g[0] + w[1] * g[1]);
            of(self, weights) - other.map_or(0.0, |(polar, w)| of(polar, w))
        };
        let rows: Vec<f64> = (0..covariance.len()).map(row).collect();
        let product = |line: &Vec<f64>| line.iter().zip(&rows).map(|(c, g)| c * g).sum::<f64>();
        covariance.iter().zip(&rows).map(|(line, g)| g * product(line)).sum::<f64>().max(0.0)
    }
}
