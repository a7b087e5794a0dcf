//! Checks of airspeed, pressure and altitude against each other and against the motion.

use super::accelerations::{GRAVITY, bank, gravity_across_path, nose_rate};
use super::doubt::{Certainty, Doubts};
use super::robust::{Fit, fit, magnitude, median_of_finite, regress, windows};
use crate::wording::Short;

/// Checks that dynamic pressure and airspeed give an air density that occurs (below 20 km: 0.08 to 1.5 kg/m^3).
pub(super) fn density(doubts: &mut Doubts) {
    let (Some(pressure), Some(speed)) = (doubts.values("dynamic_pressure"), doubts.values("true_airspeed")) else {
        return;
    };
    let implied = pressure.iter().zip(speed).map(|(q, v)| 2.0 * q / (v * v));
    let Some(density) = median_of_finite(implied) else { return };
    if (0.08..1.5).contains(&density) {
        return against_altitude(doubts, density);
    }
    // Aircraft fly above 20 km, but not where the density is 1 % of that at sea level.
    let certainty = if (0.01..1.6).contains(&density) { Certainty::Doubtful } else { Certainty::Certain };
    let message = format!(
        "imply an air density of {} kg/m^3, outside 0.08 to 1.5: one of the two is probably in another unit than its \
         header says",
        Short(density)
    );
    doubts.replace(&["dynamic_pressure", "true_airspeed"], certainty, message);
}

/// Units in which an airspeed may have been recorded, and how many of them are one metre per second.
const SPEEDS: [(&str, f64); 3] = [("kt", 1.0 / 0.514_444), ("ft/s", 1.0 / 0.3048), ("km/h", 3.6)];
/// Ratio of the airspeed to what pressure and altitude say that needs a reason. Heat and cold change the density by a
/// tenth, and impact pressure taken for dynamic pressure at Mach 0.9 the speed by a tenth.
const SPEED_RATIO: f64 = 1.2;

/// Checks the density that pressure and airspeed imply against that of the recorded air, or of the standard atmosphere
/// at the altitude.
fn against_altitude(doubts: &mut Doubts, implied: f64) {
    let recorded = doubts.values("air_density").and_then(|values| median_of_finite(values.iter().copied()));
    let altitude = doubts.values("altitude").filter(|_| !doubts.any(&["altitude"]));
    let altitude = altitude.or_else(|| doubts.values("pressure_altitude"));
    let standard = altitude.and_then(|values| median_of_finite(values.iter().copied())).map(standard_density);
    let (Some(expected), source) = (match (recorded, standard) {
        (Some(recorded), _) => (Some(recorded), "the recorded air density"),
        (None, standard) => (standard, "the density at this altitude"),
    }) else {
        return;
    };
    let ratio = (expected / implied).sqrt();
    if !ratio.is_finite() || (1.0 / SPEED_RATIO..=SPEED_RATIO).contains(&ratio) {
        return;
    }
    let near = |factor: f64| (ratio / factor - 1.0).abs() < 0.1;
    let advice = SPEEDS.into_iter().find_map(|(unit, factor)| {
        let column = unit.replace('/', "_");
        if near(factor) {
            Some(format!("it looks like {unit} read as m/s: name the column `true_airspeed_{column}`"))
        } else if near(1.0 / factor) {
            Some(format!("it looks like m/s read as {unit}: name the column `true_airspeed_m_s`"))
        } else {
            None
        }
    });
    let message = format!(
        "do not fit {source}: the airspeed is {} times what it gives{}",
        Short(ratio),
        advice.map_or_else(
            || ". An indicated or equivalent airspeed may be called true, or one unit is wrong".to_owned(),
            |advice| format!("; {advice}")
        )
    );
    doubts.replace(&["true_airspeed", "dynamic_pressure"], Certainty::Doubtful, message);
}

/// Density of the standard atmosphere (ISO 2533) at a geometric altitude in m, kg/m^3; above 20 km as if the
/// temperature stayed constant, within 2 % up to 25 km.
fn standard_density(altitude: f64) -> f64 {
    const TROPOPAUSE: f64 = 11_000.0;
    let height = altitude.min(TROPOPAUSE);
    let below = 1.225 * (1.0 - 0.0065 * height / 288.15).powf(4.255_88);
    below * (-(altitude - height) / 6341.6).exp()
}

/// Wind that an airspeed may differ from the speed over ground by, m/s: at the ground, and what a jet stream adds up to
/// ten kilometres.
const WIND: [f64; 2] = [30.0, 60.0];

/// Checks the airspeed against the speed over ground.
pub(super) fn ground_speed(doubts: &mut Doubts) {
    let (Some(speed), Some(ground)) = (doubts.values("true_airspeed"), doubts.values("ground_speed")) else { return };
    if doubts.any(&["true_airspeed", "ground_speed"]) {
        return;
    }
    let middle = |values: &[f64]| median_of_finite(values.iter().copied());
    let (Some(speed), Some(ground)) = (middle(speed), middle(ground)) else { return };
    let altitude = doubts.values("altitude").filter(|_| !doubts.any(&["altitude"])).and_then(middle);
    // Without an altitude the strongest wind is possible.
    let height = altitude.map_or(1.0, |altitude| (altitude / 1e4).clamp(0.0, 1.0));
    let allowed = WIND[0] + WIND[1] * height;
    let difference = (speed - ground).abs();
    if difference > allowed {
        let message = format!(
            "differ by {} m/s in the middle (medians {} and {}), more than the wind of {} m/s that may blow there. Check \
             their units: knots read as m/s are 1.94 times too large, km/h 3.6 times",
            Short(difference),
            Short(speed),
            Short(ground),
            Short(allowed)
        );
        doubts.add(&["true_airspeed", "ground_speed"], Certainty::Doubtful, message);
    }
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
    let Some(Fit { slope, correlation, .. }) = fit(doubts.time(), altitude, rate, 2.0) else { return };
    if correlation > 0.95 && (2.6..4.2).contains(&slope) {
        let message = format!(
            "changes {} times as fast as airspeed and path angle say: it may be in feet (or the airspeed too small). Name \
             the column `altitude_ft` or give its unit in the model file",
            Short(slope)
        );
        doubts.add(&["altitude"], Certainty::Doubtful, message);
    } else if correlation > 0.95 && (0.24..0.38).contains(&slope) {
        let message = format!(
            "changes {} times as fast as airspeed and path angle say: it may be in metres and called feet (or the airspeed too \
             large). Name the column `altitude_m` or give its unit in the model file",
            Short(slope)
        );
        doubts.add(&["altitude"], Certainty::Doubtful, message);
    }
}

/// Rate of roll beyond which the sideslip has to be known, rad/s: three degrees of it then turn the nose by 0.01 rad/s, as
/// much as a gentle pull-up.
const ROLLING: f64 = 0.2;

/// Checks the airspeed by the turning of the flight path: `V (alpha' - q + tan b (p cos a + r sin a)) = az cos a - ax sin a +
/// (gravity across the path)`.
pub(super) fn turning(doubts: &mut Doubts) {
    let names = ["true_airspeed", "alpha", "theta", "q", "az", "ax"];
    let [Some(speed), Some(alpha), Some(theta), Some(q), Some(az), Some(ax)] = names.map(|name| doubts.values(name))
    else {
        return;
    };
    if doubts.any(&names) {
        return;
    }
    let size = |name| doubts.values(name).and_then(magnitude);
    let is_sideslip_known = size("beta").is_some() && !doubts.any(&["beta", "p", "r"]);
    if !is_sideslip_known && size("p").is_some_and(|rate| rate > ROLLING) {
        return;
    }
    let (bank, nose) = (bank(doubts), nose_rate(doubts, q, alpha));
    let force = |k: usize| {
        let (sin, cos) = alpha[k].sin_cos();
        az[k] * cos - ax[k] * sin + gravity_across_path(alpha[k], theta[k], bank(k))
    };
    let Some(typical) = median_of_finite(speed.iter().copied()) else { return };
    let forces = windows(doubts.time(), alpha, force, 1.0);
    let pitching = windows(doubts.time(), alpha, nose, 1.0);
    let pairs: Vec<(f64, f64)> = forces
        .iter()
        .zip(&pitching)
        .map(|((change, force), (_, pitch))| (*force, typical * (change - pitch)))
        .collect();
    let Some(Fit { slope, correlation, .. }) = regress(&pairs) else { return };
    if correlation > 0.9 {
        against_turning(doubts, slope, "the accelerations", "alpha and az");
    }
}

/// The airspeed is doubtful where forces turn the path `slope` times as fast as it allows, and no error of a sensor makes that.
fn against_turning(doubts: &mut Doubts, slope: f64, forces: &str, others: &str) {
    if (0.62..=1.6).contains(&slope) {
        return;
    }
    let message = format!(
        "does not fit {forces}, which turn the path {} times as fast as it allows: a speed in ft/s read as m/s gives 0.30, \
         one in knots 0.51. Check the units of true_airspeed, {others}",
        Short(slope)
    );
    doubts.add(&["true_airspeed"], Certainty::Doubtful, message);
}

/// Windows of the sideways turning, s: the shorter ones where the record has fewer than ten of the longer ones.
const LONG_S: f64 = 4.0;
const SHORT_S: f64 = 2.0;

/// Checks the airspeed by the sideways turning of the flight path: `V (beta' + r cos a - p sin a) = ay + g sin phi cos theta`, of a flight of which
/// the lateral motion alone may have been recorded; an attitude or an angle of attack that is missing counts as zero.
pub(super) fn turning_sideways(doubts: &mut Doubts) {
    let names = ["true_airspeed", "beta", "phi", "p", "r", "ay"];
    let [Some(speed), Some(beta), Some(phi), Some(p), Some(r), Some(ay)] = names.map(|name| doubts.values(name)) else {
        return;
    };
    if doubts.any(&names) {
        return;
    }
    let known = |name| doubts.values(name).filter(|_| !doubts.any(&[name]));
    let (alpha, theta) = (known("alpha"), known("theta"));
    let at = |values: Option<&[f64]>, k: usize| values.map(|v| v[k]).filter(|v| v.is_finite()).unwrap_or(0.0);
    let Some(typical) = median_of_finite(speed.iter().copied()) else { return };
    let force = |k: usize| ay[k] + GRAVITY * phi[k].sin() * at(theta, k).cos();
    let yawing = |k: usize| {
        let (sin, cos) = at(alpha, k).sin_cos();
        r[k] * cos - p[k] * sin
    };
    let over = |width: f64| {
        let forces = windows(doubts.time(), beta, force, width);
        let turning = windows(doubts.time(), beta, yawing, width);
        let pairs = forces.iter().zip(&turning).map(|((change, force), (_, yaw))| (*force, typical * (change + yaw)));
        regress(&pairs.collect::<Vec<_>>())
    };
    // Over a second the noise of the sideslip is as large as the turning.
    let Some(found) = over(LONG_S).or_else(|| over(SHORT_S)) else { return };
    if found.together(0.9) {
        against_turning(doubts, found.slope, "bank and side force", "beta, r and ay");
    }
}

#[cfg(test)]
mod tests {
    use crate::record::Record;

    /// Rolling to both sides without sideslip at 120 m/s: the gravity turns the path. The airspeed as it is read.
    fn rolling(read: f64) -> Vec<String> {
        let time: Vec<f64> = (0..800).map(|k| 0.05 * f64::from(k)).collect();
        let phi: Vec<f64> = time.iter().map(|t| 0.4 * (0.7 * t).sin()).collect();
        let p = time.iter().map(|t| 0.28 * (0.7 * t).cos()).collect();
        let r = phi.iter().map(|phi| 9.81 * phi.sin() / 120.0).collect();
        // Noise of a tenth of a degree, whose differences over a second are a third of the turning.
        let scatter = |t: f64| (7919.0 * t).sin() + (15331.0 * t).cos();
        let [beta, ay] = [2e-3, 0.05].map(|size| time.iter().map(|t| size * scatter(*t)).collect::<Vec<f64>>());
        let columns = [
            ("true_airspeed_m_s", vec![read; 800]),
            ("beta_rad", beta),
            ("phi_rad", phi),
            ("p_rad_s", p),
            ("r_rad_s", r),
            ("ay_m_s2", ay),
            ("time_s", time),
        ];
        let record = Record::from_columns("test", columns).unwrap();
        super::super::check(&record).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn knots_of_a_lateral_flight_are_noticed() {
        assert_eq!(rolling(120.0), [] as [&str; 0]);
        for read in [233.0, 394.0] {
            let found = rolling(read);
            let slope = found.first().and_then(|doubt| doubt.split_once("turn the path ")).map(|(_, rest)| rest);
            let slope: f64 = slope.and_then(|rest| rest.split(' ').next()).unwrap().parse().unwrap();
            // The noise takes some per cent of it.
            assert!(found.len() == 1 && (slope * read / 120.0 - 1.0).abs() < 0.05, "{found:?}");
        }
    }
}
