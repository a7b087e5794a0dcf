//! What one control surface did in a manoeuvre.

use serde::{Deserialize, Serialize};

use super::shape::Kind;

/// What one surface did in a manoeuvre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceInput {
    /// Channel: `elevator`, `aileron`, `rudder`.
    pub surface: String,
    /// First motion, s.
    pub onset_s: f64,
    /// Last motion, s.
    pub end_s: f64,
    /// Largest departure from where it was before, rad, with its sign.
    pub peak_rad: f64,
    /// What it was.
    pub kind: Kind,
    /// Frequency at which it has most power per octave, Hz.
    pub frequency_hz: Option<f64>,
}
