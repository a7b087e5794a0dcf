//! What was flown.

use serde::Serialize;

/// What was flown, one entry per sample. SI and radians.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct History {
    /// Time, s.
    pub time_s: Vec<f64>,
    /// True angle of attack, rad.
    pub alpha: Vec<f64>,
    /// True sideslip, rad.
    pub beta: Vec<f64>,
    /// True bank angle, rad.
    pub phi: Vec<f64>,
    /// True pitch angle, rad.
    pub theta: Vec<f64>,
    /// True body rates, rad/s.
    pub rates: [Vec<f64>; 3],
    /// Altitude, m.
    pub altitude: Vec<f64>,
    /// True airspeed, m/s.
    pub speed: Vec<f64>,
    /// Normal load factor, g.
    pub load_factor: Vec<f64>,
    /// True lift and drag coefficients.
    pub lift_drag: [Vec<f64>; 2],
    /// Commands to elevator, aileron and rudder, rad.
    pub commands: [Vec<f64>; 3],
    /// True positions, rad.
    pub surfaces: [Vec<f64>; 3],
    /// Size of the excitation of each surface, 0 to 1.
    pub excitation: [Vec<f64>; 3],
}
