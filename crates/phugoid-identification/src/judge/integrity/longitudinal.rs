//! The symmetric motion: alpha and theta against the gyro and the accelerometers.
//!
//! ```text
//! alpha' = q + (az cos alpha - ax sin alpha + g cos(theta - alpha))/V
//! theta' = q
//! ```
//!
//! with the wings level. The mean of the accelerations along the vertical has to agree with the change of the vertical
//! speed.

use phugoid_flight_data::statistics::{median, robust_std};

use super::{Finding, delay, is_off};
use crate::preparation::windows::GUSTS;
use crate::preparation::windows::channels::Channels;
use crate::preparation::windows::regression::{factors, integral};

/// Channels in the order in which they are used.
pub(super) const NAMES: [&str; 6] = ["true_airspeed", "alpha", "theta", "q", "ax", "az"];
/// Smallest mean acceleration that is reported, m/s^2: biases of 10 mg are usual.
const ACCELERATION: f64 = 0.25;
/// Smallest departure of the scale between theta and q: a bank of 20 deg, which these records do not show, makes 6 %.
const PITCH_SCALE: f64 = 0.07;
/// Standard errors from which an acceleration counts.
const SIGNIFICANT: f64 = 5.0;

/// The part of the rate of alpha that the accelerometers and gravity make, rad/s.
fn path_rate([speed, alpha, theta, _, ax, az]: [&[f64]; 6], gravity: f64) -> Vec<f64> {
    let at = |k: usize| {
        let (sine, cosine) = alpha[k].sin_cos();
        (az[k] * cosine - ax[k] * sine + gravity * (theta[k] - alpha[k]).cos()) / speed[k]
    };
    (0..alpha.len()).map(at).collect()
}

/// What disagrees. `gravity` in m/s^2.
pub(super) fn findings(channels: &Channels, gravity: f64) -> Option<Vec<Finding>> {
    let all = channels.values::<6>()?;
    let [_, alpha, theta, q, ..] = all;
    let time = &channels.time_s;
    let step_s = channels.step_s()?;
    let mut found = Vec::new();
    let path = path_rate(all, gravity);
    let late: Vec<f64> = q.iter().zip(&path).map(|(q, r)| -(q + r)).collect();
    let causes = [integral(time, q), integral(time, &path), late];
    if let Some(of) = factors(time, alpha, &causes, step_s).filter(|of| of.unexplained <= GUSTS) {
        let off = |i: usize| is_off(of.value[i], of.std[i]);
        let text = |i: usize| format!("{:.3} ± {:.3}", of.value[i], 2.0 * of.std[i]);
        if off(0) || off(1) {
            let both = off(0) && off(1) && (of.value[0] - of.value[1]).abs() < 0.5 * (of.value[0] - 1.0).abs();
            let (name, what) = if both {
                ("alpha", "scale of alpha (vane, upwash, unit)")
            } else if off(0) {
                ("q", "scale of q, or of alpha")
            } else {
                ("az", "scale of az, or of the airspeed")
            };
            let sentence = format!(
                "alpha follows what the pitch rate makes of it by a factor of {}, and what az makes of it by a factor of {} \
                 (two sigma), where both are one: check the {what}",
                text(0),
                text(1)
            );
            found.push(Finding { channel: name, sentence });
        }
        found.extend(delay("alpha", of.value[2], of.std[2], step_s));
    }
    if let Some(of) = factors(time, theta, &[integral(time, q)], step_s).filter(|of| of.unexplained <= GUSTS)
        && is_off(of.value[0], of.std[0])
        && (of.value[0] - 1.0).abs() > PITCH_SCALE
    {
        let sentence = format!(
            "theta changes {:.3} ± {:.3} times as fast as the pitch rate says (two sigma): check the scales of q and \
             theta",
            of.value[0],
            2.0 * of.std[0]
        );
        found.push(Finding { channel: "q", sentence });
    }
    if let Some((excess, std)) = vertical_excess(channels, gravity)
        && excess.abs() > (SIGNIFICANT * std).max(ACCELERATION)
    {
        let banked = if excess > 0.0 {
            format!(
                " A bank of {:.0} deg, of which a longitudinal record knows nothing, does the same.",
                (gravity / (gravity + excess)).clamp(-1.0, 1.0).acos().to_degrees()
            )
        } else {
            String::new()
        };
        let sentence = format!(
            "the accelerometers claim a mean vertical acceleration of {excess:+.2} m/s^2 that the flight path does not \
             show: check scale, bias and mounting of az.{banked}"
        );
        found.push(Finding { channel: "az", sentence });
    }
    Some(found)
}

/// Mean acceleration along the vertical that the accelerometers claim beyond what the change of the vertical speed
/// shows, m/s^2 up, and one sigma of it.
fn vertical_excess(channels: &Channels, gravity: f64) -> Option<(f64, f64)> {
    let [speed, alpha, theta, _, ax, az] = channels.values::<6>()?;
    let time = &channels.time_s;
    let n = time.len();
    if n < 20 {
        return None;
    }
    let up: Vec<f64> = (0..n).map(|k| ax[k] * theta[k].sin() - az[k] * theta[k].cos() - gravity).collect();
    let claimed = integral(time, &up).last().copied()?;
    let climbs: Vec<f64> = (0..n).map(|k| speed[k] * (theta[k] - alpha[k]).sin()).collect();
    let middle = |values: &[f64]| median(&mut values.to_vec());
    let ends = 10.min(n / 2);
    let shown = middle(&climbs[n - ends..])? - middle(&climbs[..ends])?;
    // Vertical gusts and the noise of the flow angle at both ends.
    let centre = middle(&climbs)?;
    let spread = robust_std(climbs.iter().map(|c| c - centre))?;
    let duration = time[n - 1] - time[0];
    Some(((claimed - shown) / duration, spread.max(0.5) / duration))
}
