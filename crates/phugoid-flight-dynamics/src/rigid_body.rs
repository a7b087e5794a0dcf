//! Force and attitude equations of a rigid body over a flat earth, for whoever already knows its specific force.

use crate::scalar::Scalar;

/// Sines and cosines of the angles that the equations need, worked out once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // the names say all: sine and cosine of an angle in radians
pub struct Angles<T = f64> {
    pub sin_alpha: T,
    pub cos_alpha: T,
    pub sin_beta: T,
    pub cos_beta: T,
    pub sin_phi: T,
    pub cos_phi: T,
    pub sin_theta: T,
    pub cos_theta: T,
}

impl<T: Scalar> Angles<T> {
    /// Of angle of attack, sideslip, roll and pitch angle, rad.
    #[inline]
    pub fn of(alpha: T, beta: T, phi: T, theta: T) -> Self {
        let (sin_alpha, cos_alpha) = alpha.sin_cos();
        let (sin_beta, cos_beta) = beta.sin_cos();
        let (sin_phi, cos_phi) = phi.sin_cos();
        let (sin_theta, cos_theta) = theta.sin_cos();
        Self { sin_alpha, cos_alpha, sin_beta, cos_beta, sin_phi, cos_phi, sin_theta, cos_theta }
    }

    /// Velocity in body axes, m/s, at this speed (Stevens & Lewis 2.3-6).
    #[inline]
    pub fn body_velocity(&self, speed: T) -> [T; 3] {
        [speed * self.cos_alpha * self.cos_beta, speed * self.sin_beta, speed * self.sin_alpha * self.cos_beta]
    }
}

/// Rates of speed (m/s^2), angle of attack and sideslip (rad/s) from the speed (m/s), the body velocity
/// [`Angles::body_velocity`], the body rates `[p, q, r]` (rad/s), the specific force at the centre of gravity (body axes,
/// m/s^2) and gravity (m/s^2).
///
/// Force equations of Stevens & Lewis table 2.5-1 with speed, angle of attack and sideslip as states (2.5-29; thesis 2.20
/// to 2.22). Singular at zero speed and at 90 deg of sideslip.
#[inline]
pub fn force_equations<T: Scalar>(
    speed: T,
    angles: &Angles<T>,
    [u, v, w]: [T; 3],
    [p, q, r]: [T; 3],
    specific_force: [T; 3],
    gravity: f64,
) -> [T; 3] {
    let &Angles { sin_alpha, cos_alpha, sin_beta, cos_beta, sin_phi, cos_phi, sin_theta, cos_theta } = angles;
    // Body axes.
    let g_cos_theta = cos_theta * gravity;
    let u_rate = r * v - q * w - sin_theta * gravity + specific_force[0];
    let v_rate = p * w - r * u + sin_phi * g_cos_theta + specific_force[1];
    let w_rate = q * u - p * v + cos_phi * g_cos_theta + specific_force[2];
    // The same in speed, angle of attack and sideslip. u = V cos a cos b and so on are put in, so that one division
    // serves all three.
    let in_plane = cos_alpha * u_rate + sin_alpha * w_rate;
    let speed_rate = in_plane * cos_beta + v_rate * sin_beta;
    let inverse_speed = speed.recip();
    let alpha_rate = (cos_alpha * w_rate - sin_alpha * u_rate) * inverse_speed / cos_beta;
    let beta_rate = (v_rate * cos_beta - in_plane * sin_beta) * inverse_speed;
    [speed_rate, alpha_rate, beta_rate]
}

/// Rates of roll, pitch and heading angle, rad/s, from the body rates `[p, q, r]`, rad/s (Stevens & Lewis table 2.5-1).
/// Singular at 90 deg of pitch.
#[inline]
pub fn attitude_equations<T: Scalar>(angles: &Angles<T>, [p, q, r]: [T; 3]) -> [T; 3] {
    let &Angles { sin_phi, cos_phi, sin_theta, cos_theta, .. } = angles;
    let inverse_cos_theta = cos_theta.recip();
    let psi_rate = (q * sin_phi + r * cos_phi) * inverse_cos_theta;
    let phi_rate = p + psi_rate * sin_theta;
    let theta_rate = q * cos_phi - r * sin_phi;
    [phi_rate, theta_rate, psi_rate]
}
