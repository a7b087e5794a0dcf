//! Checks that angles are the integrals of their rates.

use super::doubt::{Certainty, Doubts, write_degrees};
use super::robust::{Fit, fit, largest_size, span};
use crate::wording::Short;

/// Number of degrees in a radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// Largest bank angle at which `theta' = q` holds well enough for the check, rad.
const LEVEL: f64 = 0.35;

/// An axis about which an attitude is the integral of a rate.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Axis {
    Roll,
    Pitch,
}

impl Axis {
    /// Names of the channels of attitude and rate.
    fn channels(self) -> (&'static str, &'static str) {
        match self {
            Axis::Roll => ("phi", "p"),
            Axis::Pitch => ("theta", "q"),
        }
    }
}

fn near(value: f64, target: f64) -> bool {
    value > 0.6 * target && value < 1.6 * target
}

/// Checks `theta' = q` with level wings, and `phi' = p` with the nose not too high. A ratio near 57.3 or its reciprocal
/// comes from a wrong unit, not from a manoeuvre.
pub(super) fn attitude_and_rate(doubts: &mut Doubts, axis: Axis) {
    let (attitude, rate) = axis.channels();
    let (Some(angle), Some(turning)) = (doubts.values(attitude), doubts.values(rate)) else { return };
    // If the bank angle itself is in doubt, it cannot select level flight.
    let bank = (axis == Axis::Pitch && !doubts.any(&["phi"])).then(|| doubts.values("phi")).flatten();
    let level = |k: usize| bank.is_none_or(|phi| phi[k].abs() < LEVEL);
    let rate_at = |k: usize| if level(k) { turning[k] } else { f64::NAN };
    let step = doubts.step().unwrap_or(0.0);
    let Some(Fit { slope, correlation, .. }) = fit(doubts.time(), angle, rate_at, window(doubts.time(), step)) else {
        return;
    };
    let found = format!("{attitude} changes {} times as fast as {rate} says", Short(slope.abs()));
    let size = |values: &[f64]| span(values).map_or(0.0, largest_size);
    if correlation > 0.8 && near(slope, DEGREES) {
        // An attitude in degrees moves by more than 0.5; if this one does not, the rate is 57 times too small instead.
        let to_blame = size(angle) > 0.5 || doubts.is_certain(attitude);
        let message = if to_blame {
            format!(
                "{found}: {attitude} is probably in degrees, degrees read as radians (else {rate} is in rad/s and taken \
                 for deg/s). {}",
                write_degrees(attitude, "deg")
            )
        } else {
            format!(
                "{found}: {rate} is in rad/s and taken for deg/s, or {attitude} is in degrees, degrees read as radians. \
                 Correct the unit in the header or in the model file"
            )
        };
        blame(doubts, attitude, [attitude, rate], message);
    } else if correlation > 0.8 && near(slope, 1.0 / DEGREES) {
        let to_blame = size(turning) > if axis == Axis::Roll { 2.0 } else { 0.5 } || doubts.is_certain(rate);
        let message = if to_blame {
            format!(
                "{found}: {rate} is probably in deg/s, degrees read as radians (else {attitude} is in radians and taken \
                 for degrees). {}",
                write_degrees(rate, "deg/s")
            )
        } else {
            format!(
                "{found}: {attitude} is in radians and taken for degrees, or {rate} is in deg/s, degrees read as \
                 radians. Correct the unit in the header or in the model file"
            )
        };
        blame(doubts, rate, [attitude, rate], message);
    } else if correlation > 0.8 && (near(slope, 1e-3) || near(slope, 1e-6)) {
        let unit = if near(slope, 1e-3) { "ms" } else { "us" };
        let message = format!(
            "{found}: the time is probably in {unit} and read as seconds (a sample every {} s). Name the column \
             `time_{unit}`",
            Short(step)
        );
        doubts.add(&[attitude, rate], Certainty::Certain, message);
    } else if correlation < -0.8 {
        let message = format!(
            "{attitude} falls where {rate} is positive: one of them has the wrong sign; both are positive {}. Map that \
             one with scale -1",
            if axis == Axis::Pitch { "nose up" } else { "right wing down" }
        );
        doubts.add(&[attitude, rate], Certainty::Certain, message);
    } else if correlation > 0.9 && !near(slope, 1.0) && !doubts.any(&[attitude, rate]) {
        let message = format!("{found}: about 1 is expected with the wings level. Check the units of both");
        doubts.add(&[attitude, rate], Certainty::Doubtful, message);
    }
}

/// Length of the windows, s: half a second. For a slow record, or one whose milliseconds are read as seconds, up to
/// fifty samples, as long as about twenty windows remain.
fn window(time: &[f64], step: f64) -> f64 {
    let length = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first);
    if step < 0.25 { 0.5 } else { (50.0 * step).min(length / 20.0).max(1.01 * step) }
}

/// Reports the finding for one channel alone if its size is impossible too, else for the pair; it replaces what was
/// reported before.
fn blame(doubts: &mut Doubts, culprit: &str, pair: [&str; 2], message: String) {
    if doubts.is_certain(culprit) {
        doubts.replace(&[culprit], Certainty::Certain, message);
    } else {
        doubts.replace(&pair, Certainty::Certain, message);
    }
}

/// Checks that alpha follows a quick pitch motion: it changes by at most about as much as the pitch angle.
pub(super) fn angle_of_attack(doubts: &mut Doubts) {
    let (Some(alpha), Some(q)) = (doubts.values("alpha"), doubts.values("q")) else { return };
    if doubts.any(&["alpha", "q"]) {
        return;
    }
    let Some(found) = fit(doubts.time(), alpha, |k| q[k], 0.5) else { return };
    let Fit { slope, correlation, .. } = found;
    if found.together(0.5) && slope > 8.0 {
        let message = format!(
            "alpha changes {} times as fast as the pitch rate turns the nose: alpha looks like degrees read as radians \
             (else q is in rad/s and taken for deg/s). {}",
            Short(slope),
            write_degrees("alpha", "deg")
        );
        doubts.add(&["alpha", "q"], Certainty::Certain, message);
    } else if found.together(0.5) && slope < 1.0 / 30.0 {
        let message = format!(
            "alpha changes only {} times as fast as the pitch rate turns the nose: 0.2 to 1.5 is expected in a quick \
             pitch motion. Check the units of both",
            Short(slope)
        );
        doubts.add(&["alpha", "q"], Certainty::Doubtful, message);
    } else if correlation < -0.7 {
        let message = "falls when the nose rises: it is positive with the air from below. Check its sign".to_owned();
        doubts.add(&["alpha"], Certainty::Doubtful, message);
    }
}
