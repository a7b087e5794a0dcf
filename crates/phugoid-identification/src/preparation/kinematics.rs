//! How airspeed, flow angles and attitude change in still air, from rate gyros and accelerometers, without any aerodynamics.
//!
//! ```text
//! u' = r v - q w - g sin theta + ax             V'     = (u u' + v v' + w w')/V
//! v' = p w - r u + g cos theta sin phi + ay     alpha' = (u w' - w u')/(u^2 + w^2)
//! w' = q u - p v + g cos theta cos phi + az     beta'  = (V v' - v V')/(V sqrt(u^2 + w^2))
//! phi' = p + (q sin phi + r cos phi) tan theta  theta' = q cos phi - r sin phi
//! ```
//!
//! (Stevens & Lewis, table 2.5-1).

use crate::core::output::{CHANNELS, Output};

/// The states that kinematics integrates.
pub(crate) const INTEGRATED: [Output; 5] =
    [Output::TrueAirspeed, Output::Alpha, Output::Beta, Output::Phi, Output::Theta];

/// Rates of the states of [`INTEGRATED`], m/s^2 and rad/s, from the channels by [`Output::index`], SI; `gravity` in m/s^2. The
/// angular accelerations are not used. Not finite where one of the others is not, or the airspeed is zero.
pub(crate) fn rates(c: &[f64; CHANNELS], gravity: f64) -> [f64; 5] {
    let at = |channel: Output| c[channel.index()];
    let (speed, [p, q, r]) = (at(Output::TrueAirspeed), [Output::RollRate, Output::PitchRate, Output::YawRate].map(at));
    let (sin_alpha, cos_alpha) = at(Output::Alpha).sin_cos();
    let (sin_beta, cos_beta) = at(Output::Beta).sin_cos();
    let (sin_phi, cos_phi) = at(Output::Phi).sin_cos();
    let (sin_theta, cos_theta) = at(Output::Theta).sin_cos();
    let (u, v, w) = (speed * cos_alpha * cos_beta, speed * sin_beta, speed * sin_alpha * cos_beta);
    let u_rate = r * v - q * w - gravity * sin_theta + at(Output::Ax);
    let v_rate = p * w - r * u + gravity * sin_phi * cos_theta + at(Output::Ay);
    let w_rate = q * u - p * v + gravity * cos_phi * cos_theta + at(Output::Az);
    let in_plane = cos_alpha * u_rate + sin_alpha * w_rate;
    [
        in_plane * cos_beta + v_rate * sin_beta,
        (cos_alpha * w_rate - sin_alpha * u_rate) / (speed * cos_beta),
        (v_rate * cos_beta - in_plane * sin_beta) / speed,
        p + (q * sin_phi + r * cos_phi) * sin_theta / cos_theta,
        q * cos_phi - r * sin_phi,
    ]
}
