//! States and outputs of the longitudinal motion: names, units, order.

use phugoid_flight_data::quantity::Dimension;

/// States of the longitudinal motion: true airspeed, angle of attack, pitch angle, pitch rate.
pub const STATES: usize = 4;
/// Outputs: the states, the specific forces along body x and z at the centre of gravity, and the pitch acceleration.
pub const OUTPUTS: usize = 7;

/// A measured output, in the order of the model's output vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(usize)]
pub enum Output {
    /// True airspeed, m/s.
    TrueAirspeed,
    /// Angle of attack, rad.
    Alpha,
    /// Pitch angle, rad.
    Theta,
    /// Pitch rate, rad/s.
    PitchRate,
    /// Specific force along body x (forward), m/s^2.
    Ax,
    /// Specific force along body z (down), m/s^2: about -g in level flight.
    Az,
    /// Pitch acceleration, rad/s^2.
    PitchAcceleration,
}

impl Output {
    /// All, in order.
    pub const ALL: [Self; OUTPUTS] =
        [Self::TrueAirspeed, Self::Alpha, Self::Theta, Self::PitchRate, Self::Ax, Self::Az, Self::PitchAcceleration];
    /// Channel names, in order.
    pub const NAMES: [&'static str; OUTPUTS] = ["true_airspeed", "alpha", "theta", "q", "ax", "az", "qdot"];

    /// Position in the output vector.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Canonical channel name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self.index()]
    }

    /// SI unit as printed.
    pub fn unit(self) -> &'static str {
        self.dimension().si_unit()
    }

    /// The output with this channel name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().position(|n| *n == name).map(|i| Self::ALL[i])
    }

    /// Its dimension.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::TrueAirspeed => Dimension::SPEED,
            Self::Alpha | Self::Theta => Dimension::ANGLE,
            Self::PitchRate => Dimension::ANGULAR_RATE,
            Self::Ax | Self::Az => Dimension::ACCELERATION,
            Self::PitchAcceleration => Dimension::ANGULAR_ACCELERATION,
        }
    }
}
