//! What a sample of a flight holds, under the canonical names of records.

use phugoid_flight_data::record::Quantity;
use phugoid_flight_dynamics::simulate::TrajectorySample;

/// Reads the true value of a channel off a sample, SI.
pub type Signal = fn(&TrajectorySample) -> f64;

/// The signals of a flight that a record holds: canonical name, quantity, and the value of one sample, SI.
pub(crate) const SIGNALS: &[(&str, Quantity, Signal)] = &[
    ("true_airspeed", Quantity::Speed, |s| s.air.speed),
    ("alpha", Quantity::Angle, |s| s.air.alpha),
    ("beta", Quantity::Angle, |s| s.air.beta),
    ("phi", Quantity::Angle, |s| s.state.phi),
    ("theta", Quantity::Angle, |s| s.state.theta),
    ("psi", Quantity::Angle, |s| s.state.psi),
    ("p", Quantity::AngularRate, |s| s.state.p),
    ("q", Quantity::AngularRate, |s| s.state.q),
    ("r", Quantity::AngularRate, |s| s.state.r),
    ("pdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[0]),
    ("qdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[1]),
    ("rdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[2]),
    ("ax", Quantity::Acceleration, |s| s.specific_force[0]),
    ("ay", Quantity::Acceleration, |s| s.specific_force[1]),
    ("az", Quantity::Acceleration, |s| s.specific_force[2]),
    ("elevator", Quantity::Angle, |s| s.surfaces.elevator),
    ("aileron", Quantity::Angle, |s| s.surfaces.aileron),
    ("rudder", Quantity::Angle, |s| s.surfaces.rudder),
    ("throttle", Quantity::Number, |s| s.commands.throttle),
    ("altitude", Quantity::Length, |s| s.state.altitude),
    ("north", Quantity::Length, |s| s.state.north),
    ("east", Quantity::Length, |s| s.state.east),
    ("air_density", Quantity::Density, |s| s.air.density),
    ("dynamic_pressure", Quantity::Pressure, |s| s.air.dynamic_pressure),
    ("mach", Quantity::Number, |s| s.air.mach),
];

/// The speeds of a flight that has wind, m/s: that of the aircraft over the ground, and those of the air towards north and
/// east, without gusts.
pub(crate) const OVER_THE_GROUND: &[(&str, Signal)] = &[
    ("ground_speed", |s| s.ground_velocity[0].hypot(s.ground_velocity[1])),
    ("wind_north", |s| s.wind[0]),
    ("wind_east", |s| s.wind[1]),
];

/// Where a flight over a planet is: latitude and longitude, rad; NaN over a plane.
pub(crate) const PLACE: &[(&str, Signal)] = &[
    ("latitude", |s| s.place.map_or(f64::NAN, |place| place.latitude)),
    ("longitude", |s| s.place.map_or(f64::NAN, |place| place.longitude)),
];

/// How to read the true value of a channel off a sample, SI; `None` for a name that no sample has.
///
/// ```
/// use phugoid_simulation::signals::signal;
/// assert!(signal("alpha").is_some() && signal("thrust").is_some() && signal("alfa").is_none());
/// ```
pub fn signal(name: &str) -> Option<Signal> {
    match name {
        "thrust" => return Some(TrajectorySample::thrust),
        "mass" => return Some(|sample| sample.mass),
        _ => {}
    }
    let over_the_ground =
        || OVER_THE_GROUND.iter().chain(PLACE).find(|(known, _)| *known == name).map(|(_, value)| *value);
    SIGNALS.iter().find(|(known, ..)| *known == name).map(|(_, _, value)| *value).or_else(over_the_ground)
}
