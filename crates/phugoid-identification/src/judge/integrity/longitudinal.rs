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

use super::{Finding, What, is_off, late_in_still_air};
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
    if let Some(of) = factors(time, alpha, &causes, step_s)
        && let Some(late) = late_in_still_air::<3, 2>("alpha", [time, alpha], &causes, &of, step_s)
    {
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
            found.push(Finding { channel: name, what: What::Factor, sentence });
        }
        found.extend(late);
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
        found.push(Finding { channel: "q", what: What::Factor, sentence });
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
        found.push(Finding { channel: "az", what: What::Other, sentence });
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

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.04;
    const SPEED: f64 = 60.0;
    const GRAVITY: f64 = 9.80665;

    /// A short period (per s: Z_alpha, M_alpha, M_q) under 3-2-1-1s, in still air or in gusts that alpha shows and the aircraft
    /// follows. Alpha is recorded late by so many samples; all with a scatter of sensors.
    fn flight([z_alpha, m_alpha, m_q]: [f64; 3], late: usize, gusts: f64, scatter: f64, seed: u64) -> Channels {
        let count = 750_usize;
        let fine = 20;
        let dt = STEP_S / fine as f64;
        let (mut along, mut theta, mut q, mut gust) = (0.0, 0.0, 0.0, 0.0);
        let mut random = seed;
        let mut white = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut rows: Vec<[f64; 4]> = Vec::new();
        for k in 0..count * fine {
            let elevator = match (k as f64 * dt % 10.0) as i32 {
                1..=3 => 0.03,
                4 | 5 => -0.03,
                6 => 0.03,
                7 => -0.03,
                _ => 0.0,
            };
            gust += dt * (-gust) + gusts * dt.sqrt() * white();
            let alpha: f64 = along + gust;
            let path = z_alpha * alpha;
            if k % fine == 0 {
                let az = (SPEED * path - GRAVITY * (theta - alpha).cos()) / alpha.cos();
                rows.push([alpha, theta, q, az]);
            }
            along += dt * (q + path);
            theta += dt * q;
            q += dt * (m_alpha * alpha + m_q * q - 5.0 * elevator);
        }
        let mut of = |i: usize, by: usize, noise: f64| -> Vec<f64> {
            (0..count).map(|k| rows[k.saturating_sub(by)][i] + noise * white()).collect()
        };
        let columns = vec![
            vec![SPEED; count],
            of(0, late, scatter),
            of(1, 0, scatter),
            of(2, 0, scatter),
            vec![0.0; count],
            of(3, 0, 0.01),
        ];
        Channels::for_tests((0..count).map(|k| k as f64 * STEP_S).collect(), columns)
    }

    /// A light aircraft, and a slow one that is nearly neutral.
    const LIGHT: [f64; 3] = [-1.5, -20.0, -3.0];
    const SLOW: [f64; 3] = [-0.7, -0.5, -2.0];

    fn late(channels: &Channels) -> Option<String> {
        let found = findings(channels, GRAVITY).unwrap();
        found.into_iter().find(|finding| finding.sentence.contains("ms late")).map(|finding| finding.sentence)
    }

    #[test]
    fn a_vane_that_is_late_by_many_samples_is_named_in_still_air() {
        assert_eq!(late(&flight(LIGHT, 0, 0.0, 1e-3, 1)), None);
        for samples in [2, 6] {
            let sentence = late(&flight(LIGHT, samples, 0.0, 1e-3, 1)).unwrap_or_else(|| panic!("{samples}"));
            let shown: usize = sentence.split(' ').find_map(|word| word.parse().ok()).unwrap();
            assert!(sentence.starts_with("alpha") && shown.abs_diff(40 * samples) <= 45, "{samples}: {sentence}");
        }
    }

    #[test]
    fn gusts_are_not_taken_for_a_late_vane() {
        // With the second and the fourth the factor on the rate of alpha is 126 +- 24 and 121 +- 23 ms (one sigma), with so
        // much noise of the vane that the gusts do not show.
        for seed in 1..=8 {
            assert_eq!(late(&flight(LIGHT, 0, 0.02, 0.01, seed)), None, "{seed}");
            assert_eq!(late(&flight(SLOW, 0, 0.02, 0.01, seed)), None, "{seed}");
        }
    }
}
