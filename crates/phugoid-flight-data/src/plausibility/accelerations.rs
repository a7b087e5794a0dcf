//! Checks of accelerations: specific force and load factor in steady flight.

use super::doubt::{Certainty, Doubts};
use super::robust::{median_of_finite, windows};
use crate::wording::Short;

/// Largest bank angle of flight that counts as level, rad.
const BANKED: f64 = 0.5;

/// Standard gravity, m/s^2; gravity differs from it by less than 1 % wherever aircraft fly.
pub(super) const GRAVITY: f64 = 9.80665;

/// Median of a channel over the samples with level wings; over all samples if the bank angle is not known.
fn level_median(doubts: &Doubts, name: &str) -> Option<f64> {
    let values = doubts.values(name)?;
    let bank = doubts.values("phi").filter(|_| !doubts.any(&["phi"]));
    let level = |k: &usize| bank.is_none_or(|phi| phi[*k].abs() < BANKED);
    median_of_finite((0..values.len()).filter(level).map(|k| values[k]))
}

/// The part of gravity that turns the flight path, without sideslip: `g (cos a cos phi cos theta + sin a sin theta)`,
/// m/s^2.
pub(super) fn gravity_across_path(alpha: f64, theta: f64, phi: f64) -> f64 {
    GRAVITY * (alpha.cos() * phi.cos() * theta.cos() + alpha.sin() * theta.sin())
}

/// The bank angle by sample, rad; 0 if it is not known.
pub(super) fn bank<'a>(doubts: &Doubts<'a>) -> impl Fn(usize) -> f64 + use<'a> {
    let bank = doubts.values("phi").filter(|_| !doubts.any(&["phi"]));
    move |k| bank.map_or(0.0, |phi| phi[k])
}

/// The rate that changes the angle of attack where the flight path does not turn, `q - tan b (p cos a + r sin a)`, by
/// sample, rad/s; where the sideslip, or a rate beside q, has no value it counts as none.
pub(super) fn nose_rate<'a>(doubts: &Doubts<'a>, q: &'a [f64], alpha: &'a [f64]) -> impl Fn(usize) -> f64 + use<'a> {
    let known = |name| doubts.values(name).filter(|_| !doubts.any(&[name]));
    let (beta, p, r) = (known("beta"), known("p"), known("r"));
    move |k| {
        let at = |values: Option<&[f64]>| values.map(|values| values[k]).filter(|v| v.is_finite()).unwrap_or(0.0);
        let (sin, cos) = alpha[k].sin_cos();
        q[k] - at(beta).tan() * (at(p) * cos + at(r) * sin)
    }
}

/// True if the flight path turns as `az` says, in averages over a second: `V (alpha' - q + tan b (p cos a + r
/// sin a)) = az cos a - ax sin a + (gravity)`.
fn is_manoeuvre(doubts: &Doubts) -> bool {
    let names = ["true_airspeed", "alpha", "theta", "q", "az"];
    let [Some(speed), Some(alpha), Some(theta), Some(q), Some(az)] = names.map(|name| doubts.values(name)) else {
        return false;
    };
    let (ax, bank) = (doubts.values("ax"), bank(doubts));
    let rest = |k: usize| {
        let forward = ax.map_or(0.0, |ax| ax[k]);
        (forward * alpha[k].sin() - gravity_across_path(alpha[k], theta[k], bank(k))) / alpha[k].cos()
    };
    let Some(typical) = median_of_finite(speed.iter().map(|speed| speed.abs())) else { return false };
    let over = |rate: &dyn Fn(usize) -> f64| windows(doubts.time(), alpha, rate, 1.0);
    let nose = nose_rate(doubts, q, alpha);
    let (pitching, rest, measured, duration) = (over(&nose), over(&rest), over(&|k| az[k]), over(&|_| 1.0));
    let pairs: Vec<(f64, f64)> = (0..duration.len())
        .filter(|&i| duration[i].1 > 0.3)
        .map(|i| {
            let (change, pitch) = pitching[i];
            let expected = typical * (change - pitch) + rest[i].1;
            (expected / duration[i].1, measured[i].1 / duration[i].1)
        })
        .filter(|(expected, measured)| expected.is_finite() && measured.is_finite())
        .collect();
    let missing = median_of_finite(pairs.iter().map(|(expected, measured)| (measured - expected).abs()));
    let size = median_of_finite(pairs.iter().map(|(expected, _)| expected.abs()));
    // Noise of alpha, or a sensor away from the centre of gravity, causes differences of one or two m/s^2; a wrong unit
    // or sign causes nine.
    missing.zip(size).is_some_and(|(missing, size)| missing < 2.0_f64.max(0.25 * size))
}

/// Checks `az`, the specific force along body z (down): -9.8 m/s^2 in steady flight, and in a manoeuvre what turns the
/// path.
pub(super) fn vertical(doubts: &mut Doubts) {
    use Certainty::{Certain, Doubtful};
    let Some(az) = level_median(doubts, "az") else { return };
    // A short record may consist of a manoeuvre only, so that its median is not that of steady flight.
    if (-20.0..=-5.0).contains(&az) || is_manoeuvre(doubts) {
        return;
    }
    // A record without airspeed and attitude may hold deviations from trim, accelerations too.
    let whole = ["true_airspeed", "alpha", "theta"].iter().any(|name| doubts.values(name).is_some());
    let (certainty, advice) = match az {
        a if (5.0..=20.0).contains(&a) => {
            (Certain, "its sign is that of an upward axis: change the sign, map it with scale -1")
        }
        a if (-1.6..=-0.5).contains(&a) => (Certain, "it looks like g: name the column `az_g`"),
        a if (0.5..=1.6).contains(&a) => (
            Certain,
            "it looks like load factor in g, positive up: name the column `nz`, or `az_g` and map it with scale -1",
        ),
        // One g is 32.2 ft/s^2; values further away are more probably a turn than an error.
        a if (-36.0..=-28.0).contains(&a) => (Certain, "it looks like ft/s^2: name the column `az_ft_s2`"),
        a if (28.0..=36.0).contains(&a) => {
            (Certain, "it looks like ft/s^2, positive up: name the column `az_ft_s2` and map it with scale -1")
        }
        a if a.abs() < 0.5 && whole => {
            (Certain, "gravity seems to have been removed: give what an accelerometer measures, with gravity's share")
        }
        a if a.abs() < 0.5 => (Doubtful, "a deviation from trim, or gravity was taken out"),
        // Between the sizes of two units: more probably a manoeuvre than an error.
        a if a.abs() < 50.0 => return,
        _ => (Doubtful, "check its unit and sign"),
    };
    let message = format!(
        "is {} m/s^2 in the middle (median), expected is about -9.8, the specific force along body z, down, in steady \
         flight: {advice}",
        Short(az)
    );
    doubts.add(&["az"], certainty, message);
}

/// Length of the windows over which the airspeed is compared with the accelerations, s: many samples of an airspeed that is
/// recorded once a second would not fit into a shorter one.
const AIRSPEED_WINDOW_S: f64 = 2.0;
/// An acceleration along the path that is missing, m/s^2: three times the bias of the accelerometers of small autopilots.
const MISSING: f64 = 0.3;
/// Part of it that is left with the other sign of `ax`, at most.
const LEFT: f64 = 0.5;
/// Standard errors by which the other sign has to explain more in the mean of the windows: in gusts a median of a dozen windows is
/// less than half of another one by chance.
const AGREED: f64 = 2.5;

/// Checks the sign of `ax`, the specific force along body x, forward. The airspeed changes as the accelerations along the path say,
///
/// ```text
/// V' = (ax - g sin theta) cos a cos b + (ay + g cos theta sin phi) sin b + (az + g cos theta cos phi) sin a cos b
/// ```
///
/// (R. V. Jategaonkar, *Flight Vehicle System Identification*, 2nd ed., AIAA 2015, chapter 10), in averages over two seconds. The
/// sign is in doubt where the other one explains them at least twice as well, and the windows agree on it.
pub(super) fn forward(doubts: &mut Doubts) {
    let names = ["true_airspeed", "alpha", "theta", "ax", "az"];
    let [Some(speed), Some(alpha), Some(theta), Some(ax), Some(az)] = names.map(|name| doubts.values(name)) else {
        return;
    };
    if doubts.any(&names) || doubts.any(&["phi"]) {
        return;
    }
    let bank = bank(doubts);
    let [beta, ay] = ["beta", "ay"].map(|name| doubts.values(name).filter(|_| !doubts.any(&[name])));
    let known = |values: Option<&[f64]>, k: usize| values.map(|v| v[k]).filter(|v| v.is_finite()).unwrap_or(0.0);
    let (bank, known) = (&bank, &known);
    let along = |sign: f64| {
        move |k: usize| {
            let [(sin_a, cos_a), (sin_b, cos_b)] = [alpha[k], known(beta, k)].map(f64::sin_cos);
            let down = az[k] + GRAVITY * theta[k].cos() * bank(k).cos();
            // The accelerometer to the side may be missing where there is a sideslip.
            let aside = ay.map_or(0.0, |ay| ay[k] + GRAVITY * theta[k].cos() * bank(k).sin());
            (sign * ax[k] - GRAVITY * theta[k].sin()) * cos_a * cos_b + aside * sin_b + down * sin_a * cos_b
        }
    };
    let over = |rate: &dyn Fn(usize) -> f64| windows(doubts.time(), speed, rate, AIRSPEED_WINDOW_S);
    let durations = over(&|_| 1.0);
    let missing = |rate: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let of = |((change, expected), (_, duration)): (&(f64, f64), &(f64, f64))| {
            (*duration > 0.5 * AIRSPEED_WINDOW_S).then(|| (change - expected).abs() / duration)
        };
        over(rate).iter().zip(&durations).filter_map(of).collect()
    };
    let (recorded, other) = (missing(&along(1.0)), missing(&along(-1.0)));
    let gains = recorded.iter().zip(&other).map(|(recorded, other)| recorded - other);
    let gains: Vec<f64> = gains.filter(|gain| gain.is_finite()).collect();
    let n = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / n;
    let std_error = (gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
    // Of one window no more can be asked.
    if gains.len() > 1 && mean < AGREED * std_error {
        return;
    }
    let (Some(as_recorded), Some(reversed)) =
        (median_of_finite(recorded.into_iter()), median_of_finite(other.into_iter()))
    else {
        return;
    };
    if as_recorded > MISSING && reversed < LEFT * as_recorded {
        let message = format!(
            "has probably the wrong sign: with it, the airspeed should change by {} m/s^2 more than it does, with the other sign by \
             {} m/s^2 (medians). It is positive forward: map it with scale -1",
            Short(as_recorded),
            Short(reversed)
        );
        doubts.add(&["ax"], Certainty::Doubtful, message);
    }
}

/// Checks `nz`, the load factor, positive up: +1 in steady flight.
pub(super) fn load_factor(doubts: &mut Doubts) {
    let Some(nz) = level_median(doubts, "nz") else { return };
    let advice = match nz {
        n if (-2.0..-0.5).contains(&n) => "nz is positive up, +1 in level flight; map it with scale -1",
        n if n.abs() > 7.0 => "probably m/s^2 or ft/s^2, not g: name the column `az` with its unit",
        _ => return,
    };
    doubts.add(&["nz"], Certainty::Certain, format!("is {} in the middle (median): {advice}", Short(nz)));
}
