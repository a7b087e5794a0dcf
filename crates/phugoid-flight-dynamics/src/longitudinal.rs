//! The equations of motion in the plane of symmetry: what a longitudinal estimator integrates, and nothing more.

use crate::scalar::Scalar;

/// State of symmetric flight. Also used for the rates (each per second).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongitudinalState<T = f64> {
    /// Speed of the centre of gravity, m/s.
    pub speed: T,
    /// Angle of attack, rad, positive nose up.
    pub alpha: T,
    /// Pitch angle, rad, of body x above the horizon.
    pub theta: T,
    /// Pitch rate about body y, rad/s, positive nose up.
    pub q: T,
}

/// Aerodynamic and propulsive loads together, body axes, gravity left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongitudinalLoads<T = f64> {
    /// Force along body x (forward), N.
    pub force_x: T,
    /// Force along body z (down), N.
    pub force_z: T,
    /// Pitching moment about the centre of gravity, N m, positive nose up.
    pub pitching_moment: T,
}

/// What the longitudinal equations give at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongitudinalMotion<T = f64> {
    /// Rates of the four states, each in its own unit per second.
    pub rates: LongitudinalState<T>,
    /// Specific force along body x at the centre of gravity, m/s^2.
    pub specific_force_x: T,
    /// Specific force along body z (down) at the centre of gravity, m/s^2.
    pub specific_force_z: T,
}

/// The equations of [`motion`](crate::motion::motion) for wings level, no sideslip and no roll or yaw rate:
///
/// ```text
/// V'     = ax cos a + az sin a - g sin(theta - a)
/// alpha' = q + (az cos a - ax sin a + g cos(theta - a)) / V
/// theta' = q
/// q'     = M / Jy
/// ```
///
/// (Stevens & Lewis 2.5-33; thesis 2.20, 2.21 with sideslip zero.) The rotor's momentum acts on yaw only. Mass in kg,
/// pitch inertia in kg m^2, gravity in m/s^2.
#[inline]
pub fn longitudinal_motion<T: Scalar>(
    state: &LongitudinalState<T>,
    loads: &LongitudinalLoads<T>,
    mass: f64,
    pitch_inertia: f64,
    gravity: f64,
) -> LongitudinalMotion<T> {
    let &LongitudinalState { speed, alpha, theta, q } = state;
    let ax = loads.force_x / mass;
    let az = loads.force_z / mass;
    let (sin_alpha, cos_alpha) = alpha.sin_cos();
    let (sin_path, cos_path) = (theta - alpha).sin_cos();
    LongitudinalMotion {
        rates: LongitudinalState {
            speed: ax * cos_alpha + az * sin_alpha - sin_path * gravity,
            alpha: q + (az * cos_alpha - ax * sin_alpha + cos_path * gravity) / speed,
            theta: q,
            q: loads.pitching_moment / pitch_inertia,
        },
        specific_force_x: ax,
        specific_force_z: az,
    }
}
