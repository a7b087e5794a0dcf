//! By which powers of the scales of sensors, mass and inertia the regressor of a parameter goes.

use super::term::{Coefficient, Term, Variable};

/// The powers of one parameter: its regressor grows by `power * c` where a scale is `1 + c`, and the parameter that is
/// found shrinks by as much.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ScalingPowers {
    /// Of the airspeed that is shown.
    pub airspeed: f64,
    /// Of the angle of attack that is shown.
    pub alpha: f64,
    /// Of the sideslip that is shown.
    pub beta: f64,
    /// Of the recorded positions of elevator, aileron and rudder.
    pub surfaces: [f64; 3],
    /// Of the true mass over the one of the model file.
    pub mass: f64,
    /// Of the true moment of inertia over the one of the model file.
    pub inertia: f64,
    /// Of the density that is shown, or worked out from what is.
    pub density: f64,
    /// Of the true chord or span over the one of the model file, which is smaller in the regressor.
    pub length: f64,
}

impl ScalingPowers {
    /// Of a term in a coefficient; `rates_by_airspeed` is false where rates are made dimensionless with the reference
    /// speed of the model file. A reference point of the term counts as zero.
    pub(crate) fn of(coefficient: Coefficient, term: &Term, rates_by_airspeed: bool) -> Self {
        // Rates are divided by the airspeed.
        let by_rate = if rates_by_airspeed { 1.0 } else { 0.0 };
        // By dynamic pressure and wing area.
        let mut powers = Self { airspeed: 2.0, density: 1.0, length: -2.0, ..Self::default() };
        for (factor, power) in term.powers() {
            let power = f64::from(power);
            match Variable::ALL.get(factor) {
                Some(Variable::Alpha) => powers.alpha += power,
                Some(Variable::Beta) => powers.beta += power,
                Some(Variable::AlphaRate) => {
                    powers.alpha += power;
                    powers.airspeed -= by_rate * power;
                    powers.length -= power;
                }
                Some(Variable::RollRate | Variable::PitchRate | Variable::YawRate) => {
                    powers.airspeed -= by_rate * power;
                    powers.length -= power;
                }
                Some(Variable::Airspeed) => powers.airspeed += power,
                Some(Variable::Elevator) => powers.surfaces[0] += power,
                Some(Variable::Aileron) => powers.surfaces[1] += power,
                Some(Variable::Rudder) => powers.surfaces[2] += power,
                None => {}
            }
        }
        match coefficient {
            Coefficient::Lift | Coefficient::Drag | Coefficient::SideForce => powers.mass = 1.0,
            Coefficient::PitchingMoment | Coefficient::RollingMoment | Coefficient::YawingMoment => {
                powers.inertia = 1.0;
                powers.length -= 1.0;
            }
        }
        powers
    }
}
