//! The channels that can be measured outputs of a motion: names, units, order.

use phugoid_flight_data::quantity::Dimension;

/// Channels that can be outputs, of all motions together.
pub const CHANNELS: usize = 14;
/// Those among them, the first, that are states of the motion of all axes.
pub const STATE_CHANNELS: usize = 8;

/// A channel that can be measured. The output vector of a motion is a subset in this order, its states first
/// ([`crate::core::axes::Axes::outputs`]); with all axes it is the whole of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(usize)]
pub enum Output {
    /// True airspeed: the speed relative to the air, m/s.
    TrueAirspeed,
    /// Angle of attack, rad, positive with the air from below.
    Alpha,
    /// Angle of sideslip, rad, positive with the air from the right.
    Beta,
    /// Bank angle, rad, positive right wing down.
    Phi,
    /// Pitch angle, rad, positive nose up.
    Theta,
    /// Roll rate about body x, rad/s.
    RollRate,
    /// Pitch rate about body y, rad/s.
    PitchRate,
    /// Yaw rate about body z, rad/s.
    YawRate,
    /// Specific force along body x (forward), m/s^2.
    Ax,
    /// Specific force along body y (right), m/s^2.
    Ay,
    /// Specific force along body z (down), m/s^2: about -g in level flight.
    Az,
    /// Roll acceleration `p'` about body x, rad/s^2, positive right wing down.
    RollAcceleration,
    /// Pitch acceleration `q'` about body y, rad/s^2, positive nose up.
    PitchAcceleration,
    /// Yaw acceleration `r'` about body z, rad/s^2, positive nose right.
    YawAcceleration,
}

impl Output {
    /// All outputs, in the order of the output vector of the motion of all axes.
    pub const ALL: [Self; CHANNELS] = [
        Self::TrueAirspeed,
        Self::Alpha,
        Self::Beta,
        Self::Phi,
        Self::Theta,
        Self::RollRate,
        Self::PitchRate,
        Self::YawRate,
        Self::Ax,
        Self::Ay,
        Self::Az,
        Self::RollAcceleration,
        Self::PitchAcceleration,
        Self::YawAcceleration,
    ];
    /// Canonical channel names, in the order of [`Output::ALL`].
    pub const NAMES: [&'static str; CHANNELS] =
        ["true_airspeed", "alpha", "beta", "phi", "theta", "p", "q", "r", "ax", "ay", "az", "pdot", "qdot", "rdot"];

    /// Position among all channels, as in [`crate::model_file::ModelFile::noise`]; the position in the output vector of
    /// a motion is [`crate::core::axes::Axes::row`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The canonical name of its channel, e.g. `alpha`.
    pub fn name(self) -> &'static str {
        Self::NAMES[self.index()]
    }

    /// The SI unit as printed, e.g. `rad`, `m/s^2`.
    pub fn unit(self) -> &'static str {
        self.dimension().si_unit()
    }

    /// The physical dimension of the spectral density of its rate, where it is a state with process noise.
    pub(crate) fn density_dimension(self) -> Dimension {
        match self {
            Self::TrueAirspeed => Dimension::SPEED_NOISE,
            Self::RollRate | Self::PitchRate | Self::YawRate => Dimension::ANGULAR_RATE_NOISE,
            _ => Dimension::ANGLE_NOISE,
        }
    }

    /// The output with this channel name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().position(|n| *n == name).map(|i| Self::ALL[i])
    }

    /// The physical dimension, for reading numbers with units.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::TrueAirspeed => Dimension::SPEED,
            Self::Alpha | Self::Beta | Self::Phi | Self::Theta => Dimension::ANGLE,
            Self::RollRate | Self::PitchRate | Self::YawRate => Dimension::ANGULAR_RATE,
            Self::Ax | Self::Ay | Self::Az => Dimension::ACCELERATION,
            Self::RollAcceleration | Self::PitchAcceleration | Self::YawAcceleration => Dimension::ANGULAR_ACCELERATION,
        }
    }

    /// True for the angular accelerations, which few recorders have: outputs on request only.
    pub fn is_angular_acceleration(self) -> bool {
        matches!(self, Self::RollAcceleration | Self::PitchAcceleration | Self::YawAcceleration)
    }
}
