//! Checks of the scale of the flow angles: they turn as rates and accelerations say, whatever the aircraft.
//!
//! ```text
//! alpha' = q - tan b (p cos a + r sin a) + (az cos a - ax sin a + g (cos a cos phi cos theta + sin a sin theta)) / (V cos b)
//! beta'  = p sin a - r cos a + (ay + g cos theta sin phi) / V                       small b
//! ```
//!
//! (R. V. Jategaonkar, *Flight Vehicle System Identification*, 2nd ed., AIAA 2015, chapter 10, on data
//! compatibility.) A vane ahead of the wing or the fuselage shows up to half more than the angle far away; nothing in
//! a model of the aircraft tells that from another lift slope.

use super::accelerations::{bank, gravity_across_path, nose_rate};
use super::doubt::{Cause, Certainty, Doubts};
use super::robust::{magnitude, windows};
use crate::wording::Short;

/// Length of the windows, s: short against the modes, so that gusts and noise of the path stay small beside the motion.
const WINDOW_S: f64 = 0.5;
/// Windows count in which the angle should change by this part of the largest change. The choice rests on what should
/// cause the change, so that noise of the vane does not bias the slope.
const LARGE: f64 = 0.3;
/// Fewest such windows.
const FEWEST: usize = 8;
/// Correlation below which turbulence or noise decides.
const CORRELATED: f64 = 0.85;
/// Distance of the slope from one that is more than an ordinary position error ...
const WRONG: f64 = 0.12;
/// ... and how many of its standard errors it has to be. Of 290 sound flights of eight aircraft, half of them in
/// turbulence, none came to three.
const SIGNIFICANT: f64 = 4.0;

/// Checks the scale of the angle of attack.
pub(super) fn alpha(doubts: &mut Doubts) {
    let names = ["true_airspeed", "alpha", "theta", "q", "az"];
    let [Some(speed), Some(alpha), Some(theta), Some(q), Some(az)] = names.map(|name| doubts.values(name)) else {
        return;
    };
    if doubts.any(&names) || doubts.any(&["ax", "beta", "p", "r", "phi"]) {
        return;
    }
    let bank = bank(doubts);
    let [ax, beta] = ["ax", "beta"].map(|name| doubts.values(name));
    let at = |values: Option<&[f64]>, k: usize| values.map_or(0.0, |values| values[k]);
    let nose = nose_rate(doubts, q, alpha);
    let rate = |k: usize| {
        let (sin, cos) = alpha[k].sin_cos();
        let force = az[k] * cos - at(ax, k) * sin + gravity_across_path(alpha[k], theta[k], bank(k));
        nose(k) + force / (speed[k] * at(beta, k).cos())
    };
    scale(doubts, "alpha", alpha, rate);
}

/// Checks the scale of the sideslip.
pub(super) fn beta(doubts: &mut Doubts) {
    let names = ["true_airspeed", "beta", "phi", "p", "r", "ay"];
    let [Some(speed), Some(beta), Some(phi), Some(p), Some(r), Some(ay)] = names.map(|name| doubts.values(name)) else {
        return;
    };
    if doubts.any(&names) || doubts.any(&["alpha", "theta"]) {
        return;
    }
    let [alpha, theta] = ["alpha", "theta"].map(|name| doubts.values(name));
    let at = |values: Option<&[f64]>, k: usize| values.map_or(0.0, |values| values[k]);
    let rate = |k: usize| {
        let (sin, cos) = at(alpha, k).sin_cos();
        let gravity = super::accelerations::GRAVITY * at(theta, k).cos() * phi[k].sin();
        p[k] * sin - r[k] * cos + (ay[k] + gravity) / speed[k]
    };
    scale(doubts, "beta", beta, rate);
}

/// Compares the changes of an angle over short windows with those that its kinematics give.
fn scale(doubts: &mut Doubts, name: &str, angle: &[f64], rate: impl Fn(usize) -> f64) {
    let time = doubts.time();
    let Some(step) = doubts.step().filter(|step| *step > 0.0 && *step <= 0.5 * WINDOW_S) else { return };
    // Windows that begin in the middle of others use the samples better.
    let half = ((0.5 * WINDOW_S / step).round() as usize).min(time.len());
    let rates: Vec<f64> = (0..time.len()).map(rate).collect();
    let mut pairs = windows(time, angle, |k| rates[k], WINDOW_S);
    pairs.extend(windows(&time[half..], &angle[half..], |k| rates[k + half], WINDOW_S));
    pairs.retain(|(change, expected)| (change - expected).is_finite());
    let expected: Vec<f64> = pairs.iter().map(|(_, expected)| *expected).collect();
    let Some(large) = magnitude(&expected).map(|size| LARGE * size) else { return };
    pairs.retain(|(_, expected)| expected.abs() >= large);
    if pairs.len() < FEWEST {
        return;
    }
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let (cc, ee, ce) = (sum(&|p| p.0 * p.0), sum(&|p| p.1 * p.1), sum(&|p| p.0 * p.1));
    if ee <= 0.0 || cc <= 0.0 {
        return;
    }
    let (slope, correlation) = (ce / ee, ce / (ee * cc).sqrt());
    // Half of the windows overlap the others: there are half as many independent ones.
    let left = (cc - slope * ce).max(0.0);
    let error = (2.0 * left / (pairs.len() - 1) as f64 / ee).sqrt();
    let off = (slope - 1.0).abs();
    if correlation.abs() > CORRELATED && off > WRONG && off > SIGNIFICANT * error {
        let message = format!(
            "moves {} times as fast as rates and accelerations say: the vane has a scale factor (its place on the \
             aircraft), or airspeed or accelerations are not what they are called. `phugoid compatibility` estimates it; \
             give it in the model file: [channels] {name} = {{ header = \"...\", scale = {} }}",
            Short(slope),
            Short(1.0 / slope)
        );
        doubts.add_cause(&[name], Certainty::Doubtful, Cause::Sensor, message);
    }
}
