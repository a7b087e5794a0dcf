//! What one control surface did in a manoeuvre.

use serde::{Deserialize, Serialize};

use super::shape::Kind;

/// What one surface did in a manoeuvre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceInput {
    /// Canonical name of the surface's channel: `elevator`, `aileron` or `rudder`.
    pub surface: String,
    /// Time of the first motion, s.
    pub onset_s: f64,
    /// Time of the last motion, s.
    pub end_s: f64,
    /// Largest deflection from the position before the input, rad, with the sign of the channel.
    pub peak_rad: f64,
    /// The shape of the input.
    pub kind: Kind,
    /// Frequency at which the input has most power per octave, Hz; `None` where it is too short to have one.
    pub frequency_hz: Option<f64>,
}
