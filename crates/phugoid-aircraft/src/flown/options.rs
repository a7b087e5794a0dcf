//! What is to be known of an aircraft beside its files.

use std::path::PathBuf;

use super::error::FlownError;
use crate::transport::Damage;

/// What makes the thrust.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Thrust {
    /// The engines of the files, with their places and, of propellers, their torque. Where one of them has no model here, or
    /// there is none, a force along body x through the centre of gravity, of half the weight at full throttle.
    #[default]
    Engines,
    /// A force along body x through the centre of gravity, in proportion to the throttle.
    AlongBodyX {
        /// The force at full throttle, N; a positive number.
        largest_n: f64,
    },
}

/// What is not in the files, or is to be another.
#[derive(Clone, Debug, PartialEq)]
pub struct FlownOptions {
    /// Acceleration of gravity, m/s2, the same at every altitude; a positive number, 9.80665 by default.
    pub gravity: f64,
    /// What makes the thrust: the engines by default.
    pub thrust: Thrust,
    /// What the thrust and its moments are multiplied by; not negative, 1 by default.
    pub thrust_scale: f64,
    /// Properties by name with their values in the units of JSBSim, set once: contents of tanks, flaps, gear. By default the
    /// gear is up (`gear/gear-pos-norm` is 0). One that would change nothing is refused. Of an aircraft in DAVE-ML: variables by name or identifier, in the unit of the
    /// file; sizes, mass and inertia that no file has by their standard names, in SI ([`FlownDaveml`](super::FlownDaveml)).
    pub properties: Vec<(String, f64)>,
    /// Further files of an aircraft in DAVE-ML, in any order: models of mass and inertia or of the engine; none by default.
    pub with: Vec<PathBuf>,
    /// Damage, which the Generic Transport Model alone has; none by default.
    pub damage: Damage,
    /// Whether the flight control system of the files can fly the aircraft ([`FlightControl`](super::FlightControl)), which
    /// aircraft of JSBSim alone have; it does not by default. `properties` may then also hold what its channels read, such as the
    /// switches and set points of an autopilot, which are set when the flight begins.
    pub flight_control: bool,
}

impl Default for FlownOptions {
    fn default() -> Self {
        Self {
            gravity: 9.80665,
            thrust: Thrust::Engines,
            thrust_scale: 1.0,
            properties: Vec::new(),
            with: Vec::new(),
            damage: Damage::None,
            flight_control: false,
        }
    }
}

/// Refuses options that make no sense.
pub(super) fn check(options: &FlownOptions) -> Result<(), FlownError> {
    let largest = match options.thrust {
        Thrust::Engines => 1.0,
        Thrust::AlongBodyX { largest_n } => largest_n,
    };
    for (what, value, sound, expected) in [
        ("the acceleration of gravity, m/s2,", options.gravity, options.gravity > 0.0, "positive"),
        ("the scale of thrust", options.thrust_scale, options.thrust_scale >= 0.0, "0 or more"),
        ("the largest thrust, N,", largest, largest > 0.0, "positive"),
    ] {
        if !(sound && value.is_finite()) {
            return Err(FlownError::Number { what, value, expected });
        }
    }
    Ok(())
}
