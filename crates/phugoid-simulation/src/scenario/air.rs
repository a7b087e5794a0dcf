//! How the air of a scenario moves.

use phugoid_flight_dynamics::dryden::{DrydenField, Intensity};
use phugoid_flight_dynamics::von_karman;
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

/// How the strength of turbulence is shared among the frequencies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spectrum {
    /// Rational spectra that fall with the square of the frequency (MIL-F-8785C, 3.7.2), scale 1750 ft at altitude: exact.
    #[default]
    Dryden,
    /// The spectra of measured turbulence, which fall with the 5/3rd power (MIL-F-8785C, 3.7.1), scale 2500 ft at altitude:
    /// within 10 % up to 20 times the airspeed over the scale length, rad/s
    /// ([`von_karman`](phugoid_flight_dynamics::von_karman)).
    VonKarman,
}

/// Continuous turbulence (MIL-F-8785C), one random field per seed. Either an intensity of the standard or a root mean square.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turbulence {
    /// `light`, `moderate` or `severe`, as the standard has it at the altitude: 3.65 and 7.3 ft/s at 20,000 ft for the
    /// first two.
    pub intensity: Option<Intensity>,
    /// Spectra of the gusts: `dryden` where nothing is said, or `von-karman`.
    #[serde(default)]
    pub spectrum: Spectrum,
    /// Root mean square of the vertical gust; scale lengths and proportions stay those of the standard.
    pub sigma: Option<Speed>,
    /// Whether the air also turns: gusts of roll, pitch and yaw rate over the span and along the fuselage.
    #[serde(default)]
    pub rates: bool,
}

impl Turbulence {
    /// Scale lengths and intensities of the spectrum at an altitude (m), which is taken as the height above the ground.
    pub fn field(&self, altitude: f64) -> DrydenField {
        let intensity = self.intensity.unwrap_or(Intensity::Light);
        match (self.spectrum, self.sigma) {
            (Spectrum::Dryden, Some(sigma)) => DrydenField::of_sigma(sigma.si(), altitude),
            (Spectrum::Dryden, None) => DrydenField::standard(intensity, altitude),
            (Spectrum::VonKarman, Some(sigma)) => von_karman::field_of_sigma(sigma.si(), altitude),
            (Spectrum::VonKarman, None) => von_karman::standard_field(intensity, altitude),
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
