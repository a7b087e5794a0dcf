//! Checks of airspeed, pressure and altitude against each other and against the motion.

use super::accelerations::{bank, gravity_across_path};
use super::doubt::{Certainty, Doubts};
use super::robust::{Fit, fit, median_of_finite, regress, windows};
use crate::wording::Short;

/// Checks that dynamic pressure and airspeed give an air density that occurs (below 20 km: 0.08 to 1.5 kg/m^3).
pub(super) fn density(doubts: &mut Doubts) {
    let (Some(pressure), Some(speed)) = (doubts.values("dynamic_pressure"), doubts.values("true_airspeed")) else {
        return;
    };
    let implied = pressure.iter().zip(speed).map(|(q, v)| 2.0 * q / (v * v));
    let Some(density) = median_of_finite(implied).filter(|density| !(0.08..1.5).contains(density)) else { return };
    // Aircraft fly above 20 km, but not where the density is 1 % of that at sea level.
    let certainty = if (0.01..1.6).contains(&density) { Certainty::Doubtful } else { Certainty::Certain };
    let message = format!(
        "imply an air density of {} kg/m^3, outside 0.08 to 1.5: one of the two is probably in another unit than its \
         header says",
        Short(density)
    );
    doubts.replace(&["dynamic_pressure", "true_airspeed"], certainty, message);
}

/// Checks the rate of climb, without sideslip: `h' = V (cos a sin theta - sin a cos phi cos theta)`.
pub(super) fn climb(doubts: &mut Doubts) {
    let names = ["altitude", "true_airspeed", "theta", "alpha"];
    let [Some(altitude), Some(speed), Some(theta), Some(alpha)] = names.map(|name| doubts.values(name)) else { return };
    if doubts.any(&names) {
        return;
    }
    let bank = bank(doubts);
    let rate =
        |k: usize| speed[k] * (alpha[k].cos() * theta[k].sin() - alpha[k].sin() * bank(k).cos() * theta[k].cos());
    let Some(Fit { slope, correlation }) = fit(doubts.time(), altitude, rate, 2.0) else { return };
    if correlation > 0.95 && (2.6..4.2).contains(&slope) {
        let message = format!(
            "changes {} times as fast as airspeed and path angle say: it may be in feet (or the airspeed too small). Name \
             the column `altitude_ft` or give its unit in the model file",
            Short(slope)
        );
        doubts.add(&["altitude"], Certainty::Doubtful, message);
    }
}

/// Checks the airspeed by the turning of the flight path: `V (alpha' - q) = az cos a - ax sin a + (gravity across the
/// path)`.
pub(super) fn turning(doubts: &mut Doubts) {
    let names = ["true_airspeed", "alpha", "theta", "q", "az", "ax"];
    let [Some(speed), Some(alpha), Some(theta), Some(q), Some(az), Some(ax)] = names.map(|name| doubts.values(name))
    else {
        return;
    };
    if doubts.any(&names) {
        return;
    }
    let bank = bank(doubts);
    let force = |k: usize| {
        let (sin, cos) = alpha[k].sin_cos();
        az[k] * cos - ax[k] * sin + gravity_across_path(alpha[k], theta[k], bank(k))
    };
    let Some(typical) = median_of_finite(speed.iter().copied()) else { return };
    let forces = windows(doubts.time(), alpha, force, 1.0);
    let pitching = windows(doubts.time(), alpha, |k| q[k], 1.0);
    let pairs: Vec<(f64, f64)> = forces
        .iter()
        .zip(&pitching)
        .map(|((change, force), (_, pitch))| (*force, typical * (change - pitch)))
        .collect();
    let Some(Fit { slope, correlation }) = regress(&pairs) else { return };
    if correlation > 0.9 && !(0.62..=1.6).contains(&slope) {
        let message = format!(
            "does not fit the accelerations, which turn the path {} times as fast as it allows: a speed in ft/s read as \
             m/s gives 0.30, one in knots 0.51. Check the units of true_airspeed, alpha and az",
            Short(slope)
        );
        doubts.add(&["true_airspeed"], Certainty::Doubtful, message);
    }
}
