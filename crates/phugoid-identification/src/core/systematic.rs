//! The quantities whose errors leave no trace in residuals, and their parts in the systematic error of a parameter.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Room for the constants whose errors a method follows: those of the motion that has most, which is the whole one.
pub(crate) const ROOM_FOR_CONSTANTS: usize = 29;
/// The same of the longitudinal and the lateral-directional motion: a filter takes time for room that it does not use.
pub(crate) const ROOM_FOR_CONSTANTS_OF_A_PLANE: usize = 21;

/// A quantity with a declared uncertainty. Written as its key under `[uncertainty]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UncertainQuantity {
    /// Scale of the true airspeed.
    AirspeedScale,
    /// Error of the airspeed that grows with the angle of attack (position error), as a part of it per radian.
    AirspeedPerAlpha,
    /// Density of the air, and with it the static pressure and the temperature that it is worked out from.
    AirDensity,
    /// Scale of the angles of attack and sideslip: the vane and the flow about the fuselage (upwash).
    FlowAngleScale,
    /// Zero of the angles of attack and sideslip, rad: a vane that is not aligned with the body axes.
    FlowAngleZero,
    /// Lag of the angles of attack and sideslip, s.
    FlowAngleLag,
    /// Position of the vanes along body x, m ahead of where the model file says.
    FlowAnglePosition,
    /// Scale of the positions of the control surfaces.
    SurfaceScale,
    /// Time by which the record of the surfaces is late, s.
    SurfaceSkew,
    /// Play between what is recorded and each surface, rad from one end to the other.
    SurfacePlay,
    /// Scale of each accelerometer.
    AccelerationScale,
    /// Position of the accelerometers, m ahead of (body x) and below (body z) where the model file says, each by itself.
    AccelerationPosition,
    /// Mass of the aircraft.
    Mass,
    /// Moments of inertia.
    Inertia,
    /// Position of the centre of gravity along body x, mean chords.
    CentreOfGravity,
    /// Chord and span, all by the same part, and with them the wing area by twice as much.
    Geometry,
    /// Thrust.
    Thrust,
    /// Tables and numbers of the aircraft of a file that increments are estimated to (`base`). No constant of a motion: the estimate
    /// is made again with each of them moved.
    #[serde(rename = "base")]
    BaseTables,
}

impl UncertainQuantity {
    /// All of them, in the order of the keys of `[uncertainty]`.
    pub const ALL: [Self; 18] = [
        Self::AirspeedScale,
        Self::AirspeedPerAlpha,
        Self::AirDensity,
        Self::FlowAngleScale,
        Self::FlowAngleZero,
        Self::FlowAngleLag,
        Self::FlowAnglePosition,
        Self::SurfaceScale,
        Self::SurfaceSkew,
        Self::SurfacePlay,
        Self::AccelerationScale,
        Self::AccelerationPosition,
        Self::Mass,
        Self::Inertia,
        Self::CentreOfGravity,
        Self::Geometry,
        Self::Thrust,
        Self::BaseTables,
    ];

    /// The key of the section `[uncertainty]`, and the word in results.
    pub const fn key(self) -> &'static str {
        match self {
            Self::AirspeedScale => "airspeed_scale",
            Self::AirspeedPerAlpha => "airspeed_per_alpha",
            Self::AirDensity => "air_density",
            Self::FlowAngleScale => "flow_angle_scale",
            Self::FlowAngleZero => "flow_angle_zero",
            Self::FlowAngleLag => "flow_angle_lag",
            Self::FlowAnglePosition => "flow_angle_position",
            Self::SurfaceScale => "surface_scale",
            Self::SurfaceSkew => "surface_skew",
            Self::SurfacePlay => "surface_play",
            Self::AccelerationScale => "acceleration_scale",
            Self::AccelerationPosition => "acceleration_position",
            Self::Mass => "mass",
            Self::Inertia => "inertia",
            Self::CentreOfGravity => "centre_of_gravity",
            Self::Geometry => "geometry",
            Self::Thrust => "thrust",
            Self::BaseTables => "base",
        }
    }

    /// The name in a sentence.
    pub const fn name(self) -> &'static str {
        match self {
            Self::AirspeedScale => "airspeed",
            Self::AirspeedPerAlpha => "airspeed with alpha",
            Self::AirDensity => "air density",
            Self::FlowAngleScale => "flow angles",
            Self::FlowAngleZero => "zero of flow angles",
            Self::FlowAngleLag => "lag of flow angles",
            Self::FlowAnglePosition => "position of flow angles",
            Self::SurfaceScale => "surface positions",
            Self::SurfaceSkew => "timing of surfaces",
            Self::SurfacePlay => "play of surfaces",
            Self::AccelerationScale => "accelerometers",
            Self::AccelerationPosition => "position of accelerometers",
            Self::Mass => "mass",
            Self::Inertia => "inertia",
            Self::CentreOfGravity => "centre of gravity",
            Self::Geometry => "geometry",
            Self::Thrust => "thrust",
            Self::BaseTables => "tables of the base",
        }
    }

    /// The unit of its uncertainty, as it is shown.
    pub const fn unit(self) -> UncertaintyUnit {
        match self {
            Self::FlowAngleLag | Self::SurfaceSkew => UncertaintyUnit::Time,
            Self::AirspeedPerAlpha => UncertaintyUnit::PerAngle,
            Self::FlowAngleZero | Self::SurfacePlay => UncertaintyUnit::Angle,
            Self::FlowAnglePosition | Self::AccelerationPosition => UncertaintyUnit::Length,
            Self::CentreOfGravity => UncertaintyUnit::Chord,
            _ => UncertaintyUnit::Part,
        }
    }

    /// What the user can do to know it better.
    pub const fn remedy(self) -> &'static str {
        match self {
            Self::AirspeedScale => "a calibration of the airspeed",
            Self::AirspeedPerAlpha => "a calibration of the airspeed over the angles of attack",
            Self::AirDensity => "a measurement of static pressure and temperature",
            Self::FlowAngleScale => "a calibration of the vanes in flight",
            Self::FlowAngleZero => "an alignment of the vanes with the body axes",
            Self::FlowAngleLag => "a measurement of the lag of the vanes",
            Self::FlowAnglePosition => "a measurement of where the vanes are",
            Self::SurfaceScale => "a calibration of the surface positions",
            Self::SurfaceSkew => "one clock for surfaces and motion",
            Self::SurfacePlay => "a measurement of the play of the linkages",
            Self::AccelerationScale => "a calibration of the accelerometers",
            Self::AccelerationPosition => "a measurement of where the accelerometers are",
            Self::Mass => "weighing the aircraft with its fuel",
            Self::Inertia => "a measurement of the moments of inertia",
            Self::CentreOfGravity => "weighing the aircraft on its wheels for the centre of gravity",
            Self::Geometry => "a measurement of wing area, chord and span",
            Self::Thrust => "a measurement of the thrust",
            Self::BaseTables => "a better database (a wind tunnel, or increments for its other terms)",
        }
    }
}

/// What an uncertainty is a number of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UncertaintyUnit {
    /// Part of the quantity itself.
    Part,
    /// Part of the quantity itself per radian of the angle of attack.
    PerAngle,
    /// Radians, shown in degrees.
    Angle,
    /// Seconds.
    Time,
    /// Metres.
    Length,
    /// Mean aerodynamic chords.
    Chord,
}

impl UncertaintyUnit {
    /// A value in words: `2.0 %`, `30 ms`, `0.05 m`, `0.15 %/deg`, `0.5 deg`, `0.2 % of the chord`.
    pub fn in_words(self, value: f64) -> String {
        match self {
            Self::Part => format!("{:.1} %", 100.0 * value),
            Self::PerAngle => format!("{:.2} %/deg", 100.0 * value.to_radians()),
            Self::Angle => format!("{:.2} deg", value.to_degrees()),
            Self::Time => format!("{:.0} ms", 1000.0 * value),
            Self::Length => format!("{value:.2} m"),
            Self::Chord => format!("{:.1} % of the chord", 100.0 * value),
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
    /// What a positive error of one declared standard uncertainty does to the estimate: estimate less truth, in the unit of the
    /// parameter. Positive is a sensor that shows too much or too late, or that is farther ahead or below, a mass, an inertia, a thrust or an aircraft
    /// that is larger than the model file says, play of a linkage, a centre of gravity behind the one that it says, and tables of the base that are really moved in the positive
    /// direction, so that the effects of one quantity on several parameters
    /// can be compared. Where a quantity stands for several constants with errors of their own (alpha and beta, each surface, each
    /// accelerometer, each table), the root of the sum of their squares with the sign of the largest one.
    pub effect: f64,
}

/// What the flight itself says of a declared quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LearntQuantity {
    /// The quantity.
    pub quantity: UncertainQuantity,
    /// The sensor or the surfaces that it is about: `alpha`, `elevator`, `aileron and rudder`.
    pub of: String,
    /// Its value, in the unit of the quantity ([`UncertainQuantity::unit`], SI); positive as in [`SystematicPart::effect`]. The model file
    /// declares that it is zero.
    pub value: f64,
    /// Standard uncertainty that the flight leaves of it.
    pub std_error: f64,
}

impl LearntQuantity {
    /// Value and two standard uncertainties in words: `lag of flow angles (alpha) 2.9 +- 8.1 ms`.
    pub(crate) fn in_words(&self) -> String {
        let (unit, scale) = match self.quantity.unit() {
            UncertaintyUnit::Time => ("ms", 1000.0),
            UncertaintyUnit::Angle => ("deg", 1.0_f64.to_degrees()),
            UncertaintyUnit::PerAngle => ("%/deg", 100.0 * 1.0_f64.to_radians()),
            UncertaintyUnit::Length => ("cm", 100.0),
            UncertaintyUnit::Part | UncertaintyUnit::Chord => ("%", 100.0),
        };
        let bound = 2.0 * scale * self.std_error;
        let digits = if bound < 0.1 {
            3
        } else if bound < 1.0 {
            2
        } else {
            1
        };
        format!("{} ({}) {:.digits$} +- {bound:.digits$} {unit}", self.quantity, self.of, scale * self.value)
    }
}

/// The systematic error of one parameter, sorted by quantity.
#[derive(Clone, Debug, Default)]
pub(crate) struct ByQuantity {
    /// In the order of [`UncertainQuantity::ALL`].
    variances: [f64; UncertainQuantity::ALL.len()],
    /// The largest effect of a constant of each quantity.
    largest: [f64; UncertainQuantity::ALL.len()],
}

impl ByQuantity {
    /// Adds what one standard uncertainty of a constant of this quantity does: estimate less truth.
    pub(crate) fn add(&mut self, quantity: UncertainQuantity, effect: f64) {
        let (variance, largest) = (&mut self.variances[quantity as usize], &mut self.largest[quantity as usize]);
        *variance += effect * effect;
        if effect.abs() > largest.abs() {
            *largest = effect;
        }
    }

    /// One sigma of all together, in the unit of the parameter.
    pub(crate) fn std(&self) -> f64 {
        self.variances.iter().sum::<f64>().sqrt()
    }

    /// Those that have these parts.
    pub(crate) fn of_parts(parts: &[SystematicPart]) -> Self {
        let mut all = Self::default();
        for part in parts {
            all.add(part.quantity, part.effect);
        }
        all
    }

    /// The parts, the largest share first; quantities without any are left out.
    pub(crate) fn parts(&self) -> Vec<SystematicPart> {
        let whole: f64 = self.variances.iter().sum();
        let of_each = UncertainQuantity::ALL.into_iter().zip(self.variances.iter().zip(&self.largest));
        let mut parts: Vec<SystematicPart> = of_each
            .filter(|(_, (variance, _))| **variance > 0.0)
            .map(|(quantity, (variance, largest))| SystematicPart {
                quantity,
                share: variance / whole,
                effect: variance.sqrt().copysign(*largest),
            })
            .collect();
        parts.sort_by(|a, b| b.share.total_cmp(&a.share));
        parts
    }
}

/// Share of a systematic variance from which on a quantity is named: less is 0 % when it is rounded.
const LEAST_SHARE: f64 = 0.005;

/// The largest of some parts, at most `most` of them and none below half a percent of the variance, and what is left for the
/// others: `airspeed 34 %, inertia 33 %, others 33 %`. Empty where there are none. `parts` come with the largest first.
pub(crate) fn in_words(parts: &[SystematicPart], most: usize) -> String {
    let words_of = |name: &str, share: f64| format!("{name} {:.0} %", 100.0 * share);
    let named: Vec<&SystematicPart> = parts.iter().filter(|part| part.share >= LEAST_SHARE).take(most).collect();
    let mut words: Vec<String> = named.iter().map(|part| words_of(part.quantity.name(), part.share)).collect();
    let rest = 1.0 - named.iter().map(|part| part.share).sum::<f64>();
    if !words.is_empty() && rest >= LEAST_SHARE {
        words.push(words_of("others", rest));
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::UncertainQuantity;

    /// The order of the list is that of the variants, by which sums are kept, and results have the words of the model file.
    #[test]
    fn a_quantity_is_written_as_its_key() {
        for (place, quantity) in UncertainQuantity::ALL.into_iter().enumerate() {
            assert_eq!(place, quantity as usize);
            assert_eq!(serde_json::to_string(&quantity).unwrap(), format!("\"{}\"", quantity.key()));
        }
    }
}
