//! The motion out of the plane of symmetry: phi and beta against the gyros and the accelerometers.
//!
//! ```text
//! phi'  = p + tan theta (q sin phi + r cos phi)
//! beta' = p sin alpha - r cos alpha + (ay cos beta - (ax cos alpha + az sin alpha) sin beta)/V
//!         + g (cos theta sin phi cos beta + (cos alpha sin theta - sin alpha cos theta cos phi) sin beta)/V
//! ```
//!
//! without wind that changes (B. L. Stevens, F. L. Lewis, *Aircraft Control and Simulation*, chapter 2).

use super::{Finding, What, delay, is_off, late_in_still_air};
use crate::preparation::windows::GUSTS;
use crate::preparation::windows::channels::Channels;
use crate::preparation::windows::regression::{factors, integral};

/// Channels in the order in which they are used.
pub(super) const NAMES: [&str; 11] =
    ["true_airspeed", "alpha", "beta", "phi", "theta", "p", "q", "r", "ax", "ay", "az"];

/// What disagrees. `gravity` in m/s^2.
pub(super) fn findings(channels: &Channels, gravity: f64) -> Option<Vec<Finding>> {
    let [speed, alpha, beta, phi, theta, p, q, r, ax, ay, az] = channels.values::<11>()?;
    let time = &channels.time_s;
    let step_s = channels.step_s()?;
    let samples = || 0..time.len();
    let mut found = Vec::new();

    let coupled: Vec<f64> = samples().map(|k| theta[k].tan() * (q[k] * phi[k].sin() + r[k] * phi[k].cos())).collect();
    let rolled: Vec<f64> = phi.iter().zip(integral(time, &coupled)).map(|(phi, by)| phi - by).collect();
    let late: Vec<f64> = p.iter().map(|p| -p).collect();
    if let Some(of) = factors(time, &rolled, &[integral(time, p), late], step_s).filter(|of| of.unexplained <= GUSTS) {
        if is_off(of.value[0], of.std[0]) {
            let sentence = format!(
                "phi changes {:.3} ± {:.3} times as fast as the roll rate says (two sigma): check the scales of p and phi",
                of.value[0],
                2.0 * of.std[0]
            );
            found.push(Finding { channel: "p", what: What::Factor, sentence });
        }
        found.extend(delay("phi", of.value[1], of.std[1], step_s));
    }

    let turned: Vec<f64> = samples().map(|k| p[k] * alpha[k].sin() - r[k] * alpha[k].cos()).collect();
    let side: Vec<f64> = samples()
        .map(|k| {
            let along = ax[k] * alpha[k].cos() + az[k] * alpha[k].sin();
            (ay[k] * beta[k].cos() - along * beta[k].sin()) / speed[k]
        })
        .collect();
    let weight: Vec<f64> = samples()
        .map(|k| {
            let down = alpha[k].cos() * theta[k].sin() - alpha[k].sin() * theta[k].cos() * phi[k].cos();
            gravity * (theta[k].cos() * phi[k].sin() * beta[k].cos() + down * beta[k].sin()) / speed[k]
        })
        .collect();
    let late: Vec<f64> = samples().map(|k| -(turned[k] + side[k] + weight[k])).collect();
    let causes = [integral(time, &turned), integral(time, &side), integral(time, &weight), late];
    if let Some(of) = factors(time, beta, &causes, step_s)
        && let Some(late) = late_in_still_air::<4, 3>("beta", [time, beta], &causes, &of, step_s)
    {
        let off = |i: usize| is_off(of.value[i], of.std[i]);
        let text = |i: usize| format!("{:.3} ± {:.3}", of.value[i], 2.0 * of.std[i]);
        let near = |i: usize, j: usize| (of.value[i] - of.value[j]).abs() < 0.5 * (of.value[i] - 1.0).abs();
        let blamed = if off(0) && off(1) && near(0, 1) {
            Some(("beta", "scale of beta (vane, sidewash, unit)"))
        } else if off(1) && off(2) && near(1, 2) {
            Some(("true_airspeed", "scale of the airspeed"))
        } else if off(1) {
            Some(("ay", "unit and scale of ay"))
        } else if off(0) {
            Some(("r", "scale of r, or of beta"))
        } else if off(2) {
            Some(("true_airspeed", "scales of the airspeed and of phi"))
        } else {
            None
        };
        if let Some((name, what)) = blamed {
            let sentence = format!(
                "beta follows what the yaw rate makes of it by a factor of {}, what ay makes of it by {}, and what gravity \
                 makes of it by {} (two sigma), where all are one: check the {what}",
                text(0),
                text(1),
                text(2)
            );
            found.push(Finding { channel: name, what: What::Factor, sentence });
        }
        found.extend(late);
    }
    Some(found)
}
