//! What is chosen of an aircraft before it flies.

use super::damage::Damage;
use super::error::TransportError;
use super::tables::Tables;

/// How body rates of the undamaged aircraft become forces. Damage was measured in forced oscillation alone, so that the
/// damaged aircraft always has that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RateModel {
    /// A steady rotation about the velocity from the rotary balance, the rests of p, q, r from forced oscillation, as in the
    /// simulation of NASA. Roll and yaw rates that have no common rotation, one of which is zero above all, are all from forced
    /// oscillation; linear models about a flight without rates are therefore those of forced oscillation.
    #[default]
    Hybrid,
    /// Forced oscillation alone. The difference between this aircraft and a damaged one is then the damage and nothing else.
    ForcedOscillation,
}

/// Damage, settings that stay as they are in flight, and numbers that the data do not give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransportOptions {
    /// The damage; none by default.
    pub damage: Damage,
    /// Setting of the stabiliser, rad, positive with its trailing edge down (nose down); -12 to 4 deg, 0 by default. With the
    /// left half of the stabiliser gone the setting has no effect, as in the simulation of NASA.
    pub stabiliser: f64,
    /// Angle of all flaps, rad, positive down; 0 to 30 deg, 0 by default.
    pub flaps: f64,
    /// Whether the landing gear is down; up by default.
    pub gear_down: bool,
    /// Angle of the left and the right spoiler, rad; 0 to 65 deg, 0 by default.
    pub spoilers: [f64; 2],
    /// Share of the fuel that is left, 0 to 1; 1 by default.
    pub fuel: f64,
    /// Distance of the inboard and the outboard segments of the elevator from the plane of symmetry, in spans: half an elevator
    /// rolls and yaws. Not negative; 0.03 and 0.07 by default, the estimate of the simulation of NASA.
    pub elevator_arms: [f64; 2],
    /// How body rates of the undamaged aircraft become forces.
    pub rates: RateModel,
    /// Whether all derivatives by rates that damage adds are used, the rolling moment by pitch rate of a one-sided tail above
    /// all; by default the side force alone, as in the simulation of NASA.
    pub all_rate_increments: bool,
    /// Time constant of the engines behind the lever, s; 2 by default. The simulation of NASA has a lag of second order (0.86 rad/s,
    /// damping 0.78), whose answer to a step misses the same area as one of first order with 2.03 s.
    pub engine_lag: f64,
    /// Time constant of the actuators of all surfaces, s; 1/(2 pi 5 Hz) by default, an assumption.
    pub actuator_lag: f64,
    /// Largest rate of all surfaces, rad/s; 300 deg/s by default, an assumption.
    pub surface_rate: f64,
    /// Acceleration of gravity, m/s^2, the same at every altitude; 9.80665 by default.
    pub gravity: f64,
}

impl Default for TransportOptions {
    fn default() -> Self {
        Self {
            damage: Damage::None,
            stabiliser: 0.0,
            flaps: 0.0,
            gear_down: false,
            spoilers: [0.0; 2],
            fuel: 1.0,
            elevator_arms: [0.03, 0.07],
            rates: RateModel::Hybrid,
            all_rate_increments: false,
            engine_lag: 2.0,
            actuator_lag: 1.0 / (10.0 * std::f64::consts::PI),
            surface_rate: 300.0_f64.to_radians(),
            gravity: 9.80665,
        }
    }
}

/// Largest angle of the flaps, rad.
const FLAPS: f64 = std::f64::consts::PI / 6.0;

impl TransportOptions {
    /// Checks that every option is in its range.
    pub(super) fn check(&self, tables: &Tables) -> Result<(), TransportError> {
        let within = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
        let (stabiliser, spoiler) = (tables.stabiliser.ends(), tables.spoiler.ends());
        let ([left, right], [inboard, outboard]) = (self.spoilers, self.elevator_arms);
        for (option, value, valid, expected) in [
            (
                "stabiliser",
                self.stabiliser,
                within(self.stabiliser, stabiliser),
                "within its table, -12 to 4 deg, in rad",
            ),
            ("flaps", self.flaps, within(self.flaps, [0.0, FLAPS]), "0 to 30 deg, in rad"),
            ("spoilers[0]", left, within(left, spoiler), "within its table, 0 to 65 deg, in rad"),
            ("spoilers[1]", right, within(right, spoiler), "within its table, 0 to 65 deg, in rad"),
            ("fuel", self.fuel, within(self.fuel, [0.0, 1.0]), "0 to 1"),
            ("elevator_arms[0]", inboard, inboard >= 0.0, "0 or more, spans"),
            ("elevator_arms[1]", outboard, outboard >= 0.0, "0 or more, spans"),
            ("engine_lag", self.engine_lag, self.engine_lag > 0.0, "positive, s"),
            ("actuator_lag", self.actuator_lag, self.actuator_lag > 0.0, "positive, s"),
            ("surface_rate", self.surface_rate, self.surface_rate > 0.0, "positive, rad/s"),
            ("gravity", self.gravity, self.gravity > 0.0, "positive, m/s^2"),
        ] {
            if !(valid && value.is_finite()) {
                return Err(TransportError::Option { option, value, expected });
            }
        }
        Ok(())
    }
}
