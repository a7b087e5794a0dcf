//! What the aircraft can still do: how far it glides, how slow it is known to fly, and with which speed it can be landed. Lift and drag at
//! the present angle of attack are those that the accelerometers measured in the last seconds ([`forces`](crate::forces)); the estimate says
//! how they change from there. Nothing is said of angles of attack that were not flown since the last change.
//!
//! Where the estimate does not explain the measured lift or drag, its slopes are not used: what follows from them is refused, and the
//! bounds of what is measured hold the difference, because what made it (a mass, say) may not be in what was measured either.
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
use phugoid_control::local::{AILERON, ALPHA, AXES, MAIN_AXIS, SURFACES};
use phugoid_control::margin::Margin;
use serde::Serialize;

use crate::controller::{AXIS_NAMES, NAMES};
use crate::forces::{Force, Forces, SIGMAS};
use crate::polar::Polar;

/// Part of the samples at either end of what was flown that do not count: noise of the vane.
const TAIL: f64 = 0.01;
/// Samples without which nothing is said of the angles of attack that were flown.
const FEWEST: usize = 100;
/// Angles of attack between the smallest and the largest.
const STEPS: usize = 40;
/// One standard deviation of the mass and of the scale of the airspeed, parts: those of the class `unstated` (docs/model-file.md), as for the
/// vane. They leave no trace in what is felt, and a model file that declares none of them is of a simulated flight.
const MASS: f64 = 0.03;
const AIRSPEED: f64 = 0.015;
/// Standard errors that a lift or drag has to be from zero for a ratio of them to have a standard error.
const RATIO_SIGMAS: f64 = 3.0;
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
    /// Lift and drag as they were measured, and what the estimate gives for them; none where they were not measured.
    pub forces: Option<Forces>,
    /// Lift coefficient at the present angle of attack, with the mass of the model file.
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

/// What the performance follows from.
pub(crate) struct Flown<'a> {
    /// Angles of attack measured since the last change, rad.
    pub(crate) alphas: &'a [f64],
    /// Mean of the last seconds, rad.
    pub(crate) alpha: f64,
    /// True airspeed, m/s, and altitude, m.
    pub(crate) speed: f64,
    pub(crate) altitude: f64,
    /// Lift and drag of the last seconds; none where they were not measured.
    pub(crate) forces: Option<&'a Forces>,
    /// Lift coefficient that the aircraft had at the present angle of attack before it was damaged; none where nothing is known of before.
    pub(crate) lift_before: Option<f64>,
    /// Whether the aircraft has departed from controlled flight, and whether the estimate explains how it turned.
    pub(crate) departed: bool,
    pub(crate) motion_explained: bool,
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
    let nothing = |why: &str| {
        let unknown = || Quantity::unknown(why);
        Performance {
            alpha: flown.alpha,
            alpha_flown: [least, most],
            forces: flown.forces.copied(),
            lift: unknown(),
            drag: unknown(),
            glide_ratio: unknown(),
            glide_range_m: unknown(),
            best_glide_ratio: unknown(),
            slowest_known_m_s: unknown(),
            load_factor_known: unknown(),
            control_speed_m_s: unknown(),
            approach_m_s: unknown(),
        }
    };
    if flown.departed {
        return Some(nothing(DEPARTED));
    }
    let Some(forces) = flown.forces else { return Some(nothing(UNMEASURED)) };
    let here = Here::new(forces, flown.lift_before, polar(flown.alpha), flown.covariance);
    let degrees = |alpha: f64| format!("{:.1} deg", alpha.to_degrees());
    let [lift, drag] = here.coefficients();
    let glide_ratio = here.ratio(None, format!("at the present {}", degrees(flown.alpha)));
    let glide_range_m = match (glide_ratio.value, glide_ratio.std_error) {
        (Some(value), Some(std_error)) => Quantity::known(
            flown.altitude * value,
            flown.altitude * std_error,
            "still air, no thrust, from the present altitude down to sea level".to_owned(),
        ),
        _ => Quantity::unknown(glide_ratio.note.clone()),
    };
    let best_glide_ratio = best(polar, [least, most], &here);
    let load_factor_known = here.load_factor(&polar(most), most);
    let slowest = slowest(flown.speed, &load_factor_known, most);
    let control_speed_m_s = control_speed(flown, polar, &here, &slowest, most);
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
        // Where the slowest speed is not known either, this says why, unless an axis is not controlled at all.
        _ => Quantity::unknown(format!("no approach speed: {}", control_speed_m_s.note)),
    };
    Some(Performance {
        lift,
        drag,
        glide_ratio,
        glide_range_m,
        best_glide_ratio,
        slowest_known_m_s: slowest,
        load_factor_known,
        control_speed_m_s,
        approach_m_s,
        ..nothing("")
    })
}

/// Why nothing is said of an aircraft that is not flown any more.
const DEPARTED: &str = "the aircraft has departed from controlled flight";
/// Why nothing is said without accelerometers, or with a mass that is not known.
const UNMEASURED: &str = "lift and drag of the last seconds were not measured";
/// Why nothing is said that follows from how the estimate turns.
const UNTURNED: &str = "the estimate does not explain how the aircraft moved";
/// Why nothing is said that follows from slopes of lift and drag.
const UNEXPLAINED: [&str; 2] =
    ["the measured lift is not explained by the estimate", "the measured drag is not explained by the estimate"];

/// Lift and drag of the last seconds, and how the estimate changes from there.
struct Here<'a> {
    forces: [&'a Force; 2],
    now: Polar,
    covariance: &'a [Vec<f64>],
    /// One standard error of lift and drag coefficient: what is measured, mass and airspeed, what the estimate's own bound says, what the estimate does not explain, and what a changed mass would make of the lift.
    std_error: [f64; 2],
    /// Whether the lift is another one than before at this angle of attack: or the mass is.
    has_changed: bool,
}

impl<'a> Here<'a> {
    fn new(forces: &'a Forces, lift_before: Option<f64>, now: Polar, covariance: &'a [Vec<f64>]) -> Self {
        // Accelerometers do not tell a lift that has changed from a mass that has: then the lift is what it was before at this angle of attack.
        let lift = forces.lift;
        let changed = lift_before.map_or(0.0, |before| (lift.measured - before).abs());
        let changed = if changed > SIGMAS * lift.difference_error { changed } else { 0.0 };
        let forces = [&forces.lift, &forces.drag];
        let std_error = std::array::from_fn(|k| {
            let weights = if k == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
            let estimate = now.variance(weights, None, covariance).sqrt();
            let (changed, mass) = if k == 0 { (changed, MASS) } else { (0.0, 0.0) };
            // The dynamic pressure goes with the square of the airspeed. Drag in steady flight is the thrust, whatever the mass is.
            let scales = forces[k].measured * mass.hypot(2.0 * AIRSPEED);
            forces[k].std_error.hypot(estimate).hypot(scales).hypot(forces[k].disagreement().abs().max(changed))
        });
        Self { forces, now, covariance, std_error, has_changed: changed > 0.0 }
    }

    /// Lift and drag coefficient.
    fn coefficients(&self) -> [Quantity; 2] {
        std::array::from_fn(|k| {
            let (force, std_error) = (self.forces[k], self.std_error[k]);
            if force.explained && self.has_changed && k == 0 {
                let note = "as measured, with the mass of the model file; the bound holds that the mass has changed, and not the lift";
                return Quantity::known(force.measured, std_error, note);
            }
            if force.explained {
                let note = "as measured at the present angle of attack, with the mass of the model file";
                return Quantity::known(force.measured, std_error, note);
            }
            if force.measured.abs() <= RATIO_SIGMAS * std_error {
                return Quantity::unknown(UNEXPLAINED[k]);
            }
            let note = format!("as measured; {}, and the bound holds the difference", UNEXPLAINED[k]);
            Quantity::known(force.measured, std_error, note)
        })
    }

    /// The first force that is not explained, in words.
    fn unexplained(&self) -> Option<&'static str> {
        (0..2).find(|k| !self.forces[*k].explained).map(|k| UNEXPLAINED[k])
    }

    /// Lift over drag with its standard error, here or where `other` is.
    fn ratio(&self, other: Option<&Polar>, note: String) -> Quantity {
        let mut values = [self.forces[0].measured, self.forces[1].measured];
        let mut errors = self.std_error;
        if let Some(other) = other {
            for k in 0..2 {
                let weights = if k == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
                values[k] += other.value[k] - self.now.value[k];
                errors[k] =
                    errors[k].hypot(other.variance(weights, Some((&self.now, weights)), self.covariance).sqrt());
            }
        }
        let ([lift, drag], [lift_error, drag_error]) = (values, errors);
        // What is no number is not known either.
        let is_known = |value: f64, error: f64| value > RATIO_SIGMAS * error;
        if !is_known(drag, drag_error) {
            let bound = 2.0 * drag_error;
            return Quantity::unknown(match self.forces[1].explained {
                true => format!("the drag is not known: its coefficient is {drag:.4} +- {bound:.4}"),
                false => UNEXPLAINED[1].to_owned(),
            });
        }
        if !is_known(lift, lift_error) {
            let bound = 2.0 * lift_error;
            return Quantity::unknown(match self.forces[0].explained {
                true => format!("the lift is not known: its coefficient is {lift:.4} +- {bound:.4}"),
                false => UNEXPLAINED[0].to_owned(),
            });
        }
        let value = lift / drag;
        let std_error = (lift_error / drag).hypot(value * drag_error / drag);
        let note = match self.unexplained() {
            Some(why) => format!("{note}; {why}, and the bound holds the difference"),
            None => note,
        };
        Quantity::known(value, std_error, note)
    }

    /// The load factor that the lift at the largest angle of attack that was flown (`most`, rad) gives at the present speed, g.
    fn load_factor(&self, reached: &Polar, most: f64) -> Quantity {
        if !self.forces[0].explained {
            return Quantity::unknown(UNEXPLAINED[0]);
        }
        let (lift, more) = (self.forces[0].measured, reached.value[0] - self.now.value[0]);
        if !(lift > RATIO_SIGMAS * self.std_error[0] && lift + more > 0.0) {
            return Quantity::unknown("the measured lift does not carry the aircraft");
        }
        // n = 1 + (CL_reached - CL)/CL: a slope that is off and a lift that is off.
        let variance = reached.variance([1.0, 0.0], Some((&self.now, [1.0, 0.0])), self.covariance);
        let std_error = (variance.sqrt() / lift).hypot(more / lift * self.std_error[0] / lift);
        let note = format!("at least: not known beyond the {:.1} deg that were flown", most.to_degrees());
        Quantity::known(1.0 + more / lift, std_error, note)
    }
}

/// The largest ratio of lift to drag between two angles of attack.
fn best(polar: &dyn Fn(f64) -> Polar, [least, most]: [f64; 2], here: &Here<'_>) -> Quantity {
    if let Some(why) = here.unexplained() {
        return Quantity::unknown(why);
    }
    let at = |k: usize| least + (most - least) * k as f64 / STEPS as f64;
    let of = |k: usize| {
        let value = polar(at(k)).value;
        [0, 1].map(|i| here.forces[i].measured + value[i] - here.now.value[i])
    };
    let ratio_of = |k: usize| Some(of(k)).filter(|[lift, drag]| *lift > 0.0 && *drag > 0.0).map_or(0.0, |[l, d]| l / d);
    let place = (0..=STEPS).max_by(|a, b| ratio_of(*a).total_cmp(&ratio_of(*b))).unwrap_or(0);
    let degrees = at(place).to_degrees();
    let edge = match place {
        0 => ", the smallest that was flown: smaller ones may be better",
        STEPS => ", the largest that was flown: larger ones may be better",
        _ => "",
    };
    here.ratio(Some(&polar(at(place))), format!("at {degrees:.1} deg{edge}"))
}

/// The slowest speed that the lift at the largest angle of attack that was flown is known to carry: `V = V0/sqrt(n)`.
fn slowest(speed: f64, load_factor: &Quantity, most: f64) -> Quantity {
    let (Some(n), Some(error)) = (load_factor.value, load_factor.std_error) else {
        return Quantity::unknown(load_factor.note.clone());
    };
    let value = speed / n.sqrt();
    let note = format!(
        "the stall is at this speed or below it: not known beyond the {:.1} deg that were flown",
        most.to_degrees()
    );
    Quantity::known(value, 0.5 * value * error / n, note)
}

/// Which axis has no surface that moves the aircraft about it any more, in words; none where all have.
fn uncontrolled(margins: &[Margin; SURFACES], rolled_by_sideslip: bool) -> Option<String> {
    // Pitch first: without it nothing else matters.
    let lost = margins.iter().enumerate().find(|(_, margin)| !(margin.is_used && margin.has_effect));
    lost.map(|(j, margin)| {
        let why = if margin.is_used { "has no effect within its bound" } else { "is lost" };
        let what = match (j, rolled_by_sideslip) {
            (AILERON, true) => "rolled only by the rudder".to_owned(),
            _ => format!("not controllable in {}", AXIS_NAMES[MAIN_AXIS[j]]),
        };
        format!("{what}, because the {} {why}", NAMES[j])
    })
}

/// The lowest speed between now and the slowest known one at which no surface is beyond its limit by two standard errors, whether what the
/// surfaces make up for grows with the dynamic pressure (a wing that is damaged) or not (thrust).
fn control_speed(
    flown: &Flown<'_>,
    polar: &dyn Fn(f64) -> Polar,
    here: &Here<'_>,
    slowest: &Quantity,
    most: f64,
) -> Quantity {
    if let Some(why) = uncontrolled(flown.margins, flown.gains.roll_by_sideslip.is_some()) {
        return Quantity::unknown(why);
    }
    if !flown.motion_explained {
        return Quantity::unknown(UNTURNED);
    }
    let Some(least_speed) = slowest.value else { return Quantity::unknown(slowest.note.clone()) };
    let lift = here.forces[0].measured;
    let (model, error) = (&flown.estimate.model, &flown.estimate.std_error);
    let mut last = flown.speed;
    for k in 0..=STEPS {
        let alpha = flown.alpha + (most - flown.alpha) * k as f64 / STEPS as f64;
        let there = lift + polar(alpha).value[0] - here.now.value[0];
        if there <= 0.0 {
            continue;
        }
        let square = lift / there;
        for (j, margin) in flown.margins.iter().enumerate() {
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
        let margin = Margin { trim, std_error: 0.01, is_used: true, has_effect: true, ..Margin::default() };
        found_with(alphas, covariance, &forces([0.0, 0.0]), [margin; SURFACES])
    }

    /// Measured lift and drag of 0.4 and 0.038, with a standard error of 0.002 and of what they are off from the estimate by.
    fn forces(off: [f64; 2]) -> Forces {
        let one = |measured: f64, off: f64| Force {
            measured,
            std_error: 0.002,
            predicted: measured - off,
            difference_error: 0.01,
            explained: off.abs() <= 0.03,
        };
        Forces { lift: one(0.4, off[0]), drag: one(0.038, off[1]) }
    }

    fn found_with(
        alphas: &[f64],
        covariance: &[Vec<f64>],
        forces: &Forces,
        margins: [Margin; SURFACES],
    ) -> Option<Performance> {
        let estimate = Estimate { model: LocalModel::default(), std_error: LocalModel::default() };
        let gains = Gains { free: [true; 3], ..Gains::default() };
        let flown = Flown {
            forces: Some(forces),
            lift_before: Some(0.4),
            departed: false,
            motion_explained: true,
            alphas,
            alpha: 0.0,
            speed: 100.0,
            altitude: 1000.0,
            covariance,
            estimate: &estimate,
            gains: &gains,
            margins: &margins,
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
        // Lift: 0.002 measured and 0.01 of the estimate; drag: 0.002 and 0.04 times 0.01 with 0.002. Mass 3 %, dynamic pressure 3 %.
        let lift = 0.002_f64.hypot(0.01).hypot(0.4 * 0.03_f64.hypot(0.03));
        let drag = 0.002_f64.hypot(0.0004).hypot(0.002).hypot(0.038 * 0.03);
        let expected = (lift / 0.038).hypot(0.4 / 0.038 * drag / 0.038);
        assert!((ratio.std_error.unwrap() - expected).abs() < 1e-9, "{ratio:?} {expected}");
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

    /// An estimate that gives three quarters of the measured lift: what follows from its slopes is refused, with the reason, and what is
    /// measured has the difference in its bound.
    #[test]
    fn what_a_lift_that_is_not_explained_leaves_is_refused_or_wide() {
        let margin = Margin { trim: 0.0, std_error: 0.01, is_used: true, has_effect: true, ..Margin::default() };
        let with = |off: [f64; 2]| found_with(&flown(-0.05, 0.05), &[], &forces(off), [margin; SURFACES]).unwrap();
        let found = with([0.1, 0.0]);
        assert!(
            (found.lift.std_error.unwrap() - 0.1_f64.hypot(0.002).hypot(0.4 * 0.03_f64.hypot(0.03))).abs() < 1e-12,
            "{found:?}"
        );
        assert!(found.glide_ratio.std_error.unwrap() > 0.1 / 0.038, "{found:?}");
        for quantity in
            [&found.best_glide_ratio, &found.slowest_known_m_s, &found.load_factor_known, &found.control_speed_m_s]
        {
            assert!(quantity.value.is_none() && quantity.note.contains("measured lift is not explained"), "{found:?}");
        }
        assert!(found.approach_m_s.value.is_none() && found.drag.value.is_some());
        // Twice the lift, and a drag that is all another one: no ratio has a bound.
        let found = with([0.2, 0.0]);
        assert!(found.lift.value.is_none() && found.glide_range_m.value.is_none(), "{found:?}");
        let found = with([0.0, 0.035]);
        assert!(found.drag.value.is_none() && found.glide_ratio.note.contains("measured drag"), "{found:?}");
        assert!(found.slowest_known_m_s.value.is_some(), "the lift says it: {found:?}");
    }

    /// Without an elevator, or with a rudder that does nothing, there is no speed at which the surfaces hold the flight.
    #[test]
    fn without_a_surface_there_is_no_approach_speed() {
        let margin = Margin { trim: 0.0, std_error: 0.01, is_used: true, has_effect: true, ..Margin::default() };
        for (j, words) in [(0, "not controllable in pitch"), (1, "not controllable in roll"), (2, "in yaw")] {
            for (is_used, has_effect) in [(false, true), (true, false)] {
                let mut margins = [margin; SURFACES];
                margins[j] = Margin { is_used, has_effect, ..margin };
                let found = found_with(&flown(-0.05, 0.05), &[], &forces([0.0; 2]), margins).unwrap();
                for quantity in [&found.control_speed_m_s, &found.approach_m_s] {
                    assert!(quantity.value.is_none() && quantity.note.contains(words), "{found:?}");
                }
                assert!(found.glide_ratio.value.is_some());
            }
        }
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
