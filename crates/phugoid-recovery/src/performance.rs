//! What the aircraft can still do, from the estimated lift and drag: how far it glides, how slow it is known to fly, and with which
//! speed it can be landed. Nothing is said of angles of attack that were not flown since the last change.
//!
//! | quantity | equation | source |
//! |---|---|---|
//! | glide ratio, range | `R = h CL/CD`, still air, no thrust | J. D. Anderson, *Introduction to Flight*, section 6.9 |
//! | slowest speed that is known to carry | `V sqrt(CL/CL_reached)`, from `W = CL rho V^2 S/2` | the same, section 5.13 (stall speed) |
//! | load factor that is known | `CL_reached/CL` | the same, section 6.17 (lift limit of the V-n diagram) |
//! | approach speed | 1.3 times the slowest speed | 14 CFR 23.73 (before 2017): reference landing speed of at least 1.3 V_S |
//! | lowest speed that the surfaces hold | first speed at which one of them is at its limit | as 14 CFR 25.149 asks of straight flight, with what is damaged in place of an engine |

use phugoid_control::gains::Gains;
use phugoid_control::interval::Estimate;
use phugoid_control::local::{ALPHA, AXES, SURFACES};
use phugoid_control::margin::Margin;
use serde::Serialize;

use crate::controller::NAMES;

/// Part of the samples at either end of what was flown that do not count: noise of the vane.
const TAIL: f64 = 0.01;
/// Samples without which nothing is said of the angles of attack that were flown.
const FEWEST: usize = 100;
/// Angles of attack between the smallest and the largest.
const STEPS: usize = 40;
/// One standard deviation of the constant error of an accelerometer, g, which nothing tells from a force: that of the built-in model files.
const ACCELEROMETER: f64 = 0.005;
/// The same of the thrust, a part: that of the class `unstated` (docs/model-file.md). Without acceleration thrust is the drag.
const THRUST: f64 = 0.05;
/// Reference landing speed over the stall speed.
const APPROACH: f64 = 1.3;

/// A quantity with its bound, or why it is not known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// The value; none where it is not known.
    pub value: Option<f64>,
    /// One standard error.
    pub std_error: Option<f64>,
    /// What it is of, or why it is not known.
    pub note: String,
}

impl Quantity {
    fn known(value: f64, std_error: f64, note: impl Into<String>) -> Self {
        Self { value: Some(value), std_error: Some(std_error), note: note.into() }
    }

    fn unknown(why: impl Into<String>) -> Self {
        Self { value: None, std_error: None, note: why.into() }
    }
}

/// What the aircraft can still do. Speeds are true airspeeds at the present air density, of the aircraft that flies (of a dynamically
/// scaled model, not of the full size).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Performance {
    /// Angle of attack of the last seconds, rad.
    pub alpha: f64,
    /// Smallest and largest angle of attack that were flown since the last change of the aircraft, rad.
    pub alpha_flown: [f64; 2],
    /// Lift coefficient at the present angle of attack.
    pub lift: Quantity,
    /// Drag coefficient there.
    pub drag: Quantity,
    /// Lift over drag there, and so the distance of a glide without thrust over its height.
    pub glide_ratio: Quantity,
    /// Distance of that glide in still air from the present altitude down to sea level, m.
    pub glide_range_m: Quantity,
    /// The best glide ratio at angles of attack that were flown.
    pub best_glide_ratio: Quantity,
    /// Slowest speed of level flight that the lift is known to carry, m/s; the stall is not above it.
    pub slowest_known_m_s: Quantity,
    /// Load factor at the present speed that the lift is known to give, g; the stall is not below it.
    pub load_factor_known: Quantity,
    /// Lowest speed at which the surfaces hold straight flight, m/s; where that is not reached, the slowest known speed, which it is not
    /// above.
    pub control_speed_m_s: Quantity,
    /// Approach speed with the usual reserve over the slowest known speed, m/s, where the surfaces hold it.
    pub approach_m_s: Quantity,
}

/// Lift and drag coefficient at an angle of attack, and what a unit of each parameter adds to them.
pub(crate) struct Polar {
    pub(crate) value: [f64; 2],
    pub(crate) by_parameter: Vec<[f64; 2]>,
}

impl Polar {
    /// Variance of `weights` times lift and drag less `other_weights` times those of another point.
    fn variance(&self, weights: [f64; 2], other: Option<(&Self, [f64; 2])>, covariance: &[Vec<f64>]) -> f64 {
        let row = |k: usize| {
            let of = |polar: &Self, w: [f64; 2]| polar.by_parameter.get(k).map_or(0.0, |g| w[0] * g[0] + w[1] * g[1]);
            of(self, weights) - other.map_or(0.0, |(polar, w)| of(polar, w))
        };
        let rows: Vec<f64> = (0..covariance.len()).map(row).collect();
        let product = |line: &Vec<f64>| line.iter().zip(&rows).map(|(c, g)| c * g).sum::<f64>();
        covariance.iter().zip(&rows).map(|(line, g)| g * product(line)).sum::<f64>().max(0.0)
    }
}

/// What the performance follows from.
pub(crate) struct Flown<'a> {
    /// Angles of attack measured since the last change, rad.
    pub(crate) alphas: &'a [f64],
    /// Mean of the last seconds, rad.
    pub(crate) alpha: f64,
    /// True airspeed, m/s, and altitude, m.
    pub(crate) speed: f64,
    pub(crate) altitude: f64,
    /// Covariance of the parameters.
    pub(crate) covariance: &'a [Vec<f64>],
    /// The local model (at full size: only angles come out of it), its own gains, the margins, the positions before the damage and the
    /// limits of the surfaces, rad.
    pub(crate) estimate: &'a Estimate,
    pub(crate) gains: &'a Gains,
    pub(crate) margins: &'a [Margin; SURFACES],
    pub(crate) before: [f64; SURFACES],
    pub(crate) limits: &'a [[f64; 2]; SURFACES],
}

/// The performance; none where too little was flown since the last change.
pub(crate) fn performance(flown: &Flown<'_>, polar: &dyn Fn(f64) -> Polar) -> Option<Performance> {
    let mut sorted: Vec<f64> = flown.alphas.iter().copied().filter(|alpha| alpha.is_finite()).collect();
    if sorted.len() < FEWEST || !(flown.alpha.is_finite() && flown.speed > 0.0) {
        return None;
    }
    sorted.sort_by(f64::total_cmp);
    let at = |part: f64| sorted[((sorted.len() - 1) as f64 * part).round() as usize];
    let [least, most] = [at(TAIL).min(flown.alpha), at(1.0 - TAIL).max(flown.alpha)];
    let (now, reached) = (polar(flown.alpha), polar(most));
    let [lift, drag] = now.value;
    let [lift_bias, drag_bias] = declared(&now);
    let error = |weights: [f64; 2], bias: f64| now.variance(weights, None, flown.covariance).sqrt().hypot(bias);
    let degrees = |alpha: f64| format!("{:.1} deg", alpha.to_degrees());
    let glide_ratio = ratio(&now, flown.covariance, format!("at the present {}", degrees(flown.alpha)));
    let glide_range_m = match (glide_ratio.value, glide_ratio.std_error) {
        (Some(value), Some(std_error)) => Quantity::known(
            flown.altitude * value,
            flown.altitude * std_error,
            "still air, no thrust, from the present altitude down to sea level".to_owned(),
        ),
        _ => Quantity::unknown(glide_ratio.note.clone()),
    };
    let best_glide_ratio = best(polar, [least, most], flown.covariance);
    let slowest = slowest(flown, &now, &reached, most);
    let load_factor_known = match lift > 0.0 && reached.value[0] > 0.0 {
        true => {
            let value = reached.value[0] / lift;
            let variance = reached.variance([1.0 / lift, 0.0], Some((&now, [value / lift, 0.0])), flown.covariance);
            let note = format!("at least: not known beyond the {} that were flown", degrees(most));
            Quantity::known(value, variance.sqrt(), note)
        }
        false => Quantity::unknown("the estimated lift does not carry the aircraft"),
    };
    let control_speed_m_s = control_speed(flown, polar, &slowest, most);
    let approach_m_s = match (slowest.value, slowest.std_error, control_speed_m_s.value) {
        (Some(value), Some(std_error), Some(control)) => {
            let (speed, held) = (APPROACH * value, APPROACH * control.max(value));
            let note = if held > speed * (1.0 + 1e-9) {
                "1.3 times the lowest speed that the surfaces hold".to_owned()
            } else {
                "1.3 times the slowest known speed; slower may be possible and is not known".to_owned()
            };
            Quantity::known(held, APPROACH * std_error, note)
        }
        _ => Quantity::unknown(if slowest.value.is_none() {
            slowest.note.clone()
        } else {
            control_speed_m_s.note.clone()
        }),
    };
    Some(Performance {
        alpha: flown.alpha,
        alpha_flown: [least, most],
        lift: Quantity::known(lift, error([1.0, 0.0], lift_bias), "at the present angle of attack"),
        drag: Quantity::known(drag, error([0.0, 1.0], drag_bias), "at the present angle of attack"),
        glide_ratio,
        glide_range_m,
        best_glide_ratio,
        slowest_known_m_s: slowest,
        load_factor_known,
        control_speed_m_s,
        approach_m_s,
    })
}

/// One standard deviation of lift and drag coefficient from what leaves no trace in residuals. In level flight the lift is the weight.
fn declared(polar: &Polar) -> [f64; 2] {
    let [lift, drag] = polar.value;
    [ACCELEROMETER * lift, (ACCELEROMETER * lift).hypot(THRUST * drag)]
}

/// Lift over drag with its standard error.
fn ratio(polar: &Polar, covariance: &[Vec<f64>], note: String) -> Quantity {
    let [lift, drag] = polar.value;
    let [lift_bias, drag_bias] = declared(polar);
    let drag_error = polar.variance([0.0, 1.0], None, covariance).sqrt().hypot(drag_bias);
    // Beyond that a ratio has no standard error.
    if !(lift > 0.0 && drag > 3.0 * drag_error) {
        return Quantity::unknown(format!(
            "the drag is not known: its coefficient is {drag:.4} +- {:.4}",
            2.0 * drag_error
        ));
    }
    let value = lift / drag;
    let std_error = polar.variance([1.0 / drag, -value / drag], None, covariance).sqrt();
    Quantity::known(value, std_error.hypot((lift_bias / drag).hypot(value * drag_bias / drag)), note)
}

/// The largest ratio of lift to drag between two angles of attack.
fn best(polar: &dyn Fn(f64) -> Polar, [least, most]: [f64; 2], covariance: &[Vec<f64>]) -> Quantity {
    let at = |k: usize| least + (most - least) * k as f64 / STEPS as f64;
    let of = |k: usize| polar(at(k)).value;
    let ratio_of = |k: usize| Some(of(k)).filter(|[lift, drag]| *lift > 0.0 && *drag > 0.0).map_or(0.0, |[l, d]| l / d);
    let place = (0..=STEPS).max_by(|a, b| ratio_of(*a).total_cmp(&ratio_of(*b))).unwrap_or(0);
    let degrees = at(place).to_degrees();
    let edge = match place {
        0 => ", the smallest that was flown: smaller ones may be better",
        STEPS => ", the largest that was flown: larger ones may be better",
        _ => "",
    };
    ratio(&polar(at(place)), covariance, format!("at {degrees:.1} deg{edge}"))
}

/// The slowest speed that the lift at the largest angle of attack that was flown is known to carry.
fn slowest(flown: &Flown<'_>, now: &Polar, reached: &Polar, most: f64) -> Quantity {
    let (lift, there) = (now.value[0], reached.value[0]);
    if !(lift > 0.0 && there > 0.0) {
        return Quantity::unknown("the estimated lift does not carry the aircraft");
    }
    let value = flown.speed * (lift / there).sqrt();
    // V = V0 sqrt(CL/CL_r): dV/V = (dCL/CL - dCL_r/CL_r)/2.
    let variance = now.variance([0.5 / lift, 0.0], Some((reached, [0.5 / there, 0.0])), flown.covariance);
    let note = format!(
        "the stall is at this speed or below it: not known beyond the {:.1} deg that were flown",
        most.to_degrees()
    );
    Quantity::known(value, value * variance.sqrt(), note)
}

/// The lowest speed between now and the slowest known one at which no surface is beyond its limit by two standard errors, whether what the
/// surfaces make up for grows with the dynamic pressure (a wing that is damaged) or not (thrust).
fn control_speed(flown: &Flown<'_>, polar: &dyn Fn(f64) -> Polar, slowest: &Quantity, most: f64) -> Quantity {
    let Some(least_speed) = slowest.value else { return Quantity::unknown(slowest.note.clone()) };
    let lift = polar(flown.alpha).value[0];
    let (model, error) = (&flown.estimate.model, &flown.estimate.std_error);
    let mut last = flown.speed;
    for k in 0..=STEPS {
        let alpha = flown.alpha + (most - flown.alpha) * k as f64 / STEPS as f64;
        let there = polar(alpha).value[0];
        if there <= 0.0 {
            continue;
        }
        let square = lift / there;
        for (j, margin) in flown.margins.iter().enumerate().filter(|(_, margin)| margin.is_used) {
            // With the angle of attack another pitching, rolling and yawing moment has to be held.
            let by_alpha =
                |of: &dyn Fn(usize) -> f64| (0..AXES).map(|i| flown.gains.inverse[j][i] * of(i)).sum::<f64>();
            let change = (alpha - flown.alpha) * by_alpha(&|i| model.rates[i][ALPHA]);
            let change_error: f64 = (0..AXES)
                .map(|i| ((alpha - flown.alpha) * flown.gains.inverse[j][i] * error.rates[i][ALPHA]).powi(2))
                .sum();
            let [lowest, highest] = flown.limits[j];
            for share in [1.0, 1.0 / square] {
                let position = flown.before[j] + (margin.trim - flown.before[j]) * share - change;
                let bound = 2.0 * ((margin.std_error * share).powi(2) + change_error).sqrt();
                if position - bound < lowest || position + bound > highest {
                    let note = format!("below it the {} may be at its limit", NAMES[j]);
                    return Quantity::known(last, 0.0, note);
                }
            }
        }
        last = flown.speed * square.sqrt();
    }
    Quantity {
        note: format!(
            "the surfaces hold all speeds down to it: not known beyond the {:.1} deg that were flown",
            most.to_degrees()
        ),
        ..Quantity::known(least_speed, slowest.std_error.unwrap_or(f64::NAN), "")
    }
}

#[cfg(test)]
mod tests {
    use phugoid_control::local::LocalModel;

    use super::*;

    /// CL = 0.4 + 5 a, CD = 0.03 + 0.05 CL^2 by a parameter each for the constants.
    fn polar(alpha: f64) -> Polar {
        let lift = 0.4 + 5.0 * alpha;
        Polar { value: [lift, 0.03 + 0.05 * lift * lift], by_parameter: vec![[1.0, 0.1 * lift], [0.0, 1.0]] }
    }

    fn found(alphas: &[f64], covariance: &[Vec<f64>], trim: f64) -> Option<Performance> {
        let estimate = Estimate { model: LocalModel::default(), std_error: LocalModel::default() };
        let gains = Gains { free: [true; 3], ..Gains::default() };
        let margin = Margin { trim, std_error: 0.01, is_used: true, left: 0.0, at_least: 0.0 };
        let flown = Flown {
            alphas,
            alpha: 0.0,
            speed: 100.0,
            altitude: 1000.0,
            covariance,
            estimate: &estimate,
            gains: &gains,
            margins: &[margin; SURFACES],
            before: [0.0; SURFACES],
            limits: &[[-0.4, 0.4]; SURFACES],
        };
        performance(&flown, &polar)
    }

    fn flown(from: f64, to: f64) -> Vec<f64> {
        (0..1001).map(|k| from + (to - from) * f64::from(k) / 1000.0).collect()
    }

    #[test]
    fn glide_stall_and_landing_follow_from_lift_and_drag() {
        let covariance = [vec![0.0001, 0.0], vec![0.0, 4e-6]];
        let found = found(&flown(-0.05, 0.051), &covariance, 0.1).unwrap();
        // CL 0.4, CD 0.038.
        let ratio = &found.glide_ratio;
        assert!((ratio.value.unwrap() - 0.4 / 0.038).abs() < 1e-9);
        // d(CL/CD) = 0.01 (1/CD - CL/CD^2 0.04) and 0.002 CL/CD^2.
        let (by_lift, by_drag): (f64, f64) = (0.01 / 0.038 * (1.0 - 0.4 / 0.038 * 0.04), 0.002 * 0.4 / 0.038 / 0.038);
        // Accelerometers: 0.002 of either; thrust: 5 % of the drag.
        let declared = (0.002_f64 / 0.038).hypot(0.4 / 0.038 / 0.038 * 0.002_f64.hypot(0.0019));
        assert!((ratio.std_error.unwrap() - by_lift.hypot(by_drag).hypot(declared)).abs() < 1e-9, "{ratio:?}");
        assert!((found.glide_range_m.value.unwrap() - 10_526.3).abs() < 0.1);
        // The best is at CL = sqrt(0.03/0.05) = 0.775, beyond what was flown.
        assert!(found.best_glide_ratio.note.contains("largest that was flown"), "{found:?}");
        // 99 % of the samples are below 0.05: CL 0.65.
        let slowest = found.slowest_known_m_s.value.unwrap();
        assert!((slowest - 100.0 * (0.4_f64 / 0.65).sqrt()).abs() < 0.1, "{slowest}");
        assert!((found.load_factor_known.value.unwrap() - 0.65 / 0.4).abs() < 0.01);
        assert!((found.approach_m_s.value.unwrap() - 1.3 * slowest).abs() < 1e-9, "{found:?}");
        assert!(found.slowest_known_m_s.note.contains("not known beyond"));
    }

    /// A surface at 0.3 of 0.4 rad against thrust is at its limit where the dynamic pressure is three quarters; slower is not controlled.
    #[test]
    fn the_lowest_speed_that_surfaces_hold_is_named() {
        let found = found(&flown(-0.05, 0.1), &[], 0.3).unwrap();
        let speed = found.control_speed_m_s.value.unwrap();
        // With two standard errors of 0.01: (0.3 + 0.02)/s^2 = 0.4.
        assert!((speed - 100.0 * 0.8_f64.sqrt()).abs() < 0.5 && speed >= 100.0 * 0.8_f64.sqrt(), "{speed}");
        assert!(found.control_speed_m_s.note.contains("elevator"), "{found:?}");
        assert!((found.approach_m_s.value.unwrap() - 1.3 * speed).abs() < 1e-9);
    }

    #[test]
    fn what_was_not_flown_or_is_not_known_is_refused() {
        assert!(found(&[0.0; 50], &[], 0.0).is_none());
        assert!(found(&[f64::NAN; 500], &[], 0.0).is_none());
        let covariance = [vec![0.0, 0.0], vec![0.0, 0.0004]];
        let found = found(&flown(-0.05, 0.05), &covariance, 0.0).unwrap();
        assert!(
            found.glide_ratio.value.is_none() && found.glide_range_m.note.contains("drag is not known"),
            "{found:?}"
        );
    }
}
