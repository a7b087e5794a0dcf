//! The quantities whose errors leave no trace in residuals, and their parts in the systematic error of a parameter.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A quantity with a declared uncertainty of its scale. Written as its key under `[uncertainty]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UncertainQuantity {
    /// Scale of the true airspeed.
    AirspeedScale,
    /// Scale of the angles of attack and sideslip: vane and upwash.
    FlowAngleScale,
    /// Scale of the positions of the control surfaces.
    SurfaceScale,
    /// Mass of the aircraft.
    Mass,
    /// Moments of inertia.
    Inertia,
}

impl UncertainQuantity {
    /// All of them, in the order of the keys of `[uncertainty]`.
    pub const ALL: [Self; 5] =
        [Self::AirspeedScale, Self::FlowAngleScale, Self::SurfaceScale, Self::Mass, Self::Inertia];

    /// The key of the section `[uncertainty]`, and the word in results.
    pub const fn key(self) -> &'static str {
        match self {
            Self::AirspeedScale => "airspeed_scale",
            Self::FlowAngleScale => "flow_angle_scale",
            Self::SurfaceScale => "surface_scale",
            Self::Mass => "mass",
            Self::Inertia => "inertia",
        }
    }

    /// The name in a sentence.
    pub const fn name(self) -> &'static str {
        match self {
            Self::AirspeedScale => "airspeed",
            Self::FlowAngleScale => "flow angles",
            Self::SurfaceScale => "surface positions",
            Self::Mass => "mass",
            Self::Inertia => "inertia",
        }
    }

    /// What the user can do to know it better.
    pub const fn remedy(self) -> &'static str {
        match self {
            Self::AirspeedScale => "a calibration of the airspeed",
            Self::FlowAngleScale => "a calibration of the vanes in flight",
            Self::SurfaceScale => "a calibration of the surface positions",
            Self::Mass => "weighing the aircraft with its fuel",
            Self::Inertia => "a measurement of the moments of inertia",
        }
    }
}

impl fmt::Display for UncertainQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The part of one quantity in the systematic error of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SystematicPart {
    /// The quantity.
    pub quantity: UncertainQuantity,
    /// Its share of the systematic variance, 0 to 1. The shares of a parameter add up to one.
    pub share: f64,
}
