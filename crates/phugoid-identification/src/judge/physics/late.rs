//! Forces that follow the pitch rate or the yaw rate as they do on no aeroplane: what a force sensor and a vane that are not of one
//! time make of a build-up.
//!
//! An accelerometer that comes late by `tau` shows `az(t - tau)`, about `az - tau az'`. Since `alpha'` is about `q`, and `beta'` about
//! `-r`, the estimates hold
//!
//! ```text
//! CL_q + tau_alpha_z CL_alpha 2V/cbar        CY_r - tau_beta_y CY_beta 2V/b
//! ```
//!
//! in the place of `CL_q` and `CY_r`, with the time by which the vane is later than the accelerometer (negative where the
//! accelerometer is the later one). A tenth of a second makes 60 in `CL_q` of a regional turboprop at 131 m/s, whose tail makes 7. This shows in gusts too, which hide a
//! delay of the accelerometer from the kinematics ([`crate::judge::integrity`]): there the flow angle moves the force at once.

use super::aircraft::Body;
use super::derivatives::{Derivative, Derivatives};
use super::finding::reason;
use super::flown::Flown;
use crate::core::estimation::VerdictReason;
use crate::core::term::{Coefficient, Variable};

/// Smallest and largest `CL_q`. Textbooks have 2 to 17 (J. Roskam, *Airplane Flight Dynamics and Automatic Flight Controls*, part I,
/// appendix B), and the true values of 27 aircraft of another simulator are -1.2 to 17.
const LIFT_BY_PITCHING: [f64; 2] = [-8.0, 35.0];
/// Smallest and largest `CY_r` over the size of `CY_beta`. A fin `l` behind makes `2 l / b`, at most 1.4 ([`super::derivatives`] has the
/// arm), and bodies take from it; the true values of the same aircraft are -0.03 to 0.99.
const SIDE_FORCE_BY_YAWING: [f64; 2] = [-0.3, 1.8];

/// What is beyond the limits, as the time between vane and accelerometer.
pub(super) fn reasons(derivatives: &Derivatives, flown: &Flown, body: &Body) -> Vec<VerdictReason> {
    let Some(speed) = flown.speed.filter(|speed| *speed > 0.0) else { return Vec::new() };
    let mut found = Vec::new();
    let of = |coefficient, variable| derivatives.find(coefficient, variable);
    if let (Some(by_rate), Some(by_angle)) =
        (of(Coefficient::Lift, Variable::PitchRate), of(Coefficient::Lift, Variable::Alpha))
    {
        let [least, most] = LIFT_BY_PITCHING;
        if by_rate.surely_below(least) || by_rate.surely_above(most) {
            let late_s = by_rate.value * body.mean_chord / (2.0 * speed * by_angle.value);
            found.push(told(by_rate, LIFT_BY_PITCHING.map(|limit| format!("{limit}")), late_s, ["alpha", "az"]));
        }
    }
    if let (Some(by_rate), Some(by_angle), Some(span)) =
        (of(Coefficient::SideForce, Variable::YawRate), of(Coefficient::SideForce, Variable::Beta), body.wing_span)
    {
        let size = by_angle.value.abs();
        let beyond = |part: f64, side: f64| {
            // Both have their errors.
            let std_error = by_rate.std_error.hypot(part * by_angle.std_error);
            Derivative { value: side * (by_rate.value - part * size), std_error, ..by_rate.clone() }.surely_above(0.0)
        };
        let [least, most] = SIDE_FORCE_BY_YAWING;
        if beyond(least, -1.0) || beyond(most, 1.0) {
            let late_s = by_rate.value * span / (2.0 * speed * size);
            let limits = SIDE_FORCE_BY_YAWING.map(|part| format!("{:.2}", part * size));
            found.push(told(by_rate, limits, late_s, ["beta", "ay"]));
        }
    }
    found
}

/// The sentence. `late_s` is the time by which the vane is later than the accelerometer, s, negative where it is earlier.
fn told(by_rate: &Derivative, limits: [String; 2], late_s: f64, [vane, force]: [&str; 2]) -> VerdictReason {
    let [least, most] = limits;
    let (late, early) = if late_s > 0.0 { (vane, force) } else { (force, vane) };
    let time = if late_s.is_finite() { format!(" by about {:.0} ms", 1e3 * late_s.abs()) } else { String::new() };
    reason(
        false,
        &by_rate.concerns(&[vane, force]),
        format!(
            "{} is {}, and {least} to {most} is what aeroplanes have: the force follows the rate of turn as if {late} came later \
             than {early}{time}. Check the delays and filters of {force} and {vane}, and their scales.",
            by_rate.words(),
            by_rate.number()
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(all: [(Coefficient, Variable, f64, f64); 2], speed: Option<f64>) -> Vec<(String, Vec<String>)> {
        let one = |(coefficient, variable, value, std_error)| Derivative {
            coefficient,
            variable: Some(variable),
            names: vec!["the_rate".to_owned()],
            value,
            std_error,
            random_std: std_error,
            bounds: None,
        };
        let body = Body { mean_chord: 2.5, wing_span: Some(29.0), ..Body::default() };
        let flown = Flown { speed, ..Flown::default() };
        let out = reasons(&Derivatives(all.map(one).to_vec()), &flown, &body);
        out.into_iter().map(|reason| (reason.sentence, reason.concerns)).collect()
    }

    /// The numbers of a regional turboprop at 131 m/s in light turbulence: `CL_alpha` 5.9, `CY_beta` -0.46.
    #[test]
    fn the_later_one_is_named_with_its_time() {
        let lift = |q: f64, std_error: f64| {
            [(Coefficient::Lift, Variable::Alpha, 5.9, 0.3), (Coefficient::Lift, Variable::PitchRate, q, std_error)]
        };
        let side = |r: f64, std_error: f64| {
            [
                (Coefficient::SideForce, Variable::Beta, -0.46, 0.04),
                (Coefficient::SideForce, Variable::YawRate, r, std_error),
            ]
        };
        let speed = Some(131.0);
        for sound in
            [lift(6.5, 1.0), lift(17.0, 2.0), lift(0.0, 5.0), side(0.36, 0.1), side(0.0, 0.02), side(-0.1, 0.01)]
        {
            assert_eq!(found(sound, speed), []);
        }
        // 0.3 s are 2 * 131 * 5.9 / 2.5 * 0.3 = 185.
        let late_force = found(lift(-180.0, 12.0), speed);
        assert!(late_force[0].0.contains("as if az came later than alpha by about 291 ms"), "{late_force:?}");
        assert_eq!(late_force[0].1, ["the_rate", "alpha", "az"]);
        assert!(found(lift(120.0, 12.0), speed)[0].0.contains("as if alpha came later than az by about 194 ms"));
        // 2 * 131 * 0.46 / 29 * 0.3 = 1.25.
        assert!(found(side(1.6, 0.11), speed)[0].0.contains("as if beta came later than ay by about 385 ms"));
        assert!(found(side(-1.2, 0.15), speed)[0].0.contains("as if ay came later than beta by about 289 ms"));
        // Not known well enough, and a flight without a speed.
        assert_eq!(found(lift(-180.0, 80.0), speed), []);
        assert_eq!(found(lift(-180.0, 12.0), None), []);
    }
}
