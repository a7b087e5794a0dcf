//! How the air of a scenario moves.

use phugoid_flight_dynamics::dryden::{DrydenField, Intensity};
use serde::Deserialize;

use crate::quantity::{Speed, Time};

/// A gust of thesis equation 2.32: the air along a body axis rises as `1 - cos` and then stays.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GustSettings {
    /// Body axis: `x` forward, `y` right, `z` down.
    pub axis: phugoid_flight_dynamics::gust::BodyAxis,
    /// Final velocity of the air along the axis.
    pub amplitude: Speed,
    /// Time that the air takes to rise from rest to the final velocity.
    pub duration: Time,
    /// Time at which the rise begins, from the start of the flight.
    #[serde(default)]
    pub start: Time,
}

/// Dryden turbulence (MIL-F-8785C), one random field per seed. Either an intensity of the standard or a root mean square.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turbulence {
    /// `light`, `moderate` or `severe`, as the standard has it at the altitude: 3.65 and 7.3 ft/s at 20,000 ft for the
    /// first two.
    pub intensity: Option<Intensity>,
    /// Root mean square of the vertical gust; scale lengths and proportions stay those of the standard.
    pub sigma: Option<Speed>,
    /// Whether the air also turns: gusts of roll, pitch and yaw rate over the span and along the fuselage.
    #[serde(default)]
    pub rates: bool,
}

impl Turbulence {
    /// Scale lengths and intensities at an altitude (m), which is taken as the height above the ground.
    pub fn field(&self, altitude: f64) -> DrydenField {
        match (self.sigma, self.intensity) {
            (Some(sigma), _) => DrydenField::of_sigma(sigma.si(), altitude),
            (None, intensity) => DrydenField::standard(intensity.unwrap_or(Intensity::Light), altitude),
        }
    }

    pub(super) fn check(&self) -> Result<(), String> {
        match (self.intensity, self.sigma) {
            (Some(_), None) => Ok(()),
            (None, Some(sigma)) if sigma.si() >= 0.0 => Ok(()),
            (None, Some(_)) => Err("`turbulence.sigma` is a root mean square, not negative".to_owned()),
            _ => Err("`[turbulence]` takes one of `intensity` (light, moderate, severe) and `sigma` (\"3.65 ft/s\")"
                .to_owned()),
        }
    }
}
