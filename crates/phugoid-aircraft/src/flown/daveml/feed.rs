//! The names inside this program of what models in DAVE-ML may ask for.

/// A quantity of the flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feed {
    Speed,
    EquivalentAirspeed,
    Alpha,
    Beta,
    AlphaRate,
    BetaRate,
    RollRate,
    PitchRate,
    YawRate,
    PitchAngle,
    Mach,
    DynamicPressure,
    Pressure,
    Temperature,
    Density,
    SpeedOfSound,
    Altitude,
    Elevator,
    Aileron,
    Rudder,
    Throttle,
}

/// How many there are.
pub(super) const FEEDS: usize = Feed::Throttle as usize + 1;

/// A value for each [`Feed`], in SI.
pub(super) type Flow<T> = [T; FEEDS];
