//! Whether the sensors agree with one another, whatever the aerodynamics.
//!
//! Kinematics ties flow angles and attitudes to the rate gyros and the accelerometers. Over windows of two seconds, from
//! which an offset and a drift of each side are taken out (biases), an angle is fitted by the integrals of what turns it
//! and by its own rate: the factors are one if the scales agree, and the one on the rate is minus the delay of the
//! sensor. (R. V. Jategaonkar, *Flight Vehicle System Identification*, ch. 10, on data compatibility; here as a test of
//! single sensors, by linear regression, and not as their calibration, which `phugoid compatibility` is for.)

mod air_data;
mod lateral;
mod longitudinal;
mod reactions;

use phugoid_flight_data::record::Record;

use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};
use crate::methods::Task;
use crate::motion::Motion;
use crate::preparation::reaction;
use crate::preparation::windows::channels::Channels;
use crate::preparation::windows::delay::{best_moved, moved};
use crate::preparation::windows::regression::{Factors, factors};
use crate::preparation::windows::{GUSTS, SIGNIFICANT};

/// Smallest departure of a scale that is reported: calibrations are rarely better.
const SCALE: f64 = 0.04;
/// Smallest delay that is reported, samples.
const DELAY_SAMPLES: f64 = 1.0;
/// One disagreement.
struct Finding {
    /// The channel that is probably wrong.
    channel: &'static str,
    what: What,
    sentence: String,
}

/// What kind of disagreement it is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    /// The channel is late by so much, s (negative: early), with one sigma.
    Late { late_s: f64, std_s: f64 },
    /// A channel follows what others make of it by a factor.
    Factor,
    /// Any other.
    Other,
}

/// Largest standard error of a factor that says anything of a scale; and of one below a half, which is what the noise of a flow angle
/// makes where nothing but gusts moves it.
const KNOWN: f64 = 0.1;
const KNOWN_OF_SMALL: f64 = 0.05;

/// Whether a factor that should be one is not.
fn is_off(value: f64, std: f64) -> bool {
    let is_known = std < if value < 0.5 { KNOWN_OF_SMALL } else { KNOWN };
    is_known && (value - 1.0).abs() > (SIGNIFICANT * std).max(SCALE)
}

/// What else is early by as much where a rate gyro is late: its rate, the angles that its integral is held against, and the surface
/// that it answers to.
const GYROS: [(&str, &[&str], &str); 3] =
    [("q", &["alpha", "theta"], "elevator"), ("p", &["phi"], "aileron"), ("r", &["beta"], "rudder")];
/// Part of its delay by which an angle and a surface may differ to be called early by as much, beside three standard errors.
const AS_MUCH: f64 = 0.25;

/// Puts a late rate gyro in the place of an angle and a surface that are early by as much: nothing is recorded before it happens, but
/// whatever is held against a gyro that is late seems to be. Factors by which angles follow that gyro are wrong with it.
fn blame_gyros(found: &mut Vec<Finding>) {
    for (gyro, angles, surface) in GYROS {
        let early = |finding: &Finding| match finding.what {
            What::Late { late_s, std_s } if late_s < 0.0 => Some((-late_s, std_s)),
            _ => None,
        };
        let of = |name: &str| found.iter().find(|f| f.channel == name).and_then(early);
        let Some((by_surface_s, surface_std_s)) = of(surface) else { continue };
        let agrees = |(s, std_s): (f64, f64)| {
            (s - by_surface_s).abs() < (3.0 * std_s.hypot(surface_std_s)).max(AS_MUCH * by_surface_s)
        };
        let Some(angle) = angles.iter().find(|name| of(name).is_some_and(agrees)) else { continue };
        let (by_angle_s, angle_std_s) = of(angle).unwrap_or_default();
        let sentence = format!(
            "{gyro} was recorded about {:.0} ms late: {angle} seems to be {:.0} ± {:.0} ms early, and the {surface} {:.0} ± {:.0} ms (two \
             sigma), and nothing is recorded before it happens. Check the delay and the filter of {gyro}",
            1e3 * by_surface_s,
            1e3 * by_angle_s,
            2e3 * angle_std_s,
            1e3 * by_surface_s,
            2e3 * surface_std_s
        );
        let is_explained = |f: &Finding| {
            let of_gyro = f.channel == gyro || f.channel == surface || angles.contains(&f.channel);
            of_gyro && (f.what == What::Factor || early(f).is_some())
        };
        found.retain(|f| !is_explained(f));
        found.insert(
            0,
            Finding { channel: gyro, what: What::Late { late_s: by_surface_s, std_s: surface_std_s }, sentence },
        );
    }
}

/// The delay of an angle against the gyros and accelerometers, if it is one; both in s.
fn delay(channel: &'static str, value: f64, std: f64, step_s: f64) -> Option<Finding> {
    (value.abs() > (SIGNIFICANT * std).max(DELAY_SAMPLES * step_s)).then(|| Finding {
        channel,
        what: What::Late { late_s: value, std_s: std },
        sentence: format!(
            "{channel} comes {:.0} ± {:.0} ms {} against the gyros and the accelerometers: check its delay and filter",
            1e3 * value.abs(),
            2e3 * std,
            if value > 0.0 { "late" } else { "early" }
        ),
    })
}

/// A delay of an angle against the gyros and accelerometers from which on it has to be confirmed by moving the angle, s. The factor on
/// the rate of an angle that follows gusts is 0.1 to 0.4 s in slow aircraft, with standard errors of a tenth of that, and whether
/// the air is calm cannot be told where the sensor's noise is as large as the motion.
const LONG_S: f64 = 0.1;
/// What is left of the motion with the angle moved by its delay, over what is left as it was recorded, at most. Of 90 flights of
/// another simulator with a vane in time the delay alone blamed one in gusts, by 0.91; of the same with the vane 0.23 s late all 18
/// that it named have 0.54 or less (measured with a prototype of this regression).
const CONFIRMED: f64 = 0.85;

/// The delay of an angle against what turns it, if there is one; none in gusts, which the factors of such an equation follow. `of`:
/// its factors on the `C` causes, of which the last is its own rate and the `D` before it are what turns it.
fn late_in_still_air<const C: usize, const D: usize>(
    channel: &'static str,
    [time_s, angle]: [&[f64]; 2],
    causes: &[Vec<f64>; C],
    of: &Factors<C>,
    step_s: f64,
) -> Option<Vec<Finding>> {
    if of.unexplained > GUSTS {
        return None;
    }
    let short = delay(channel, of.value[C - 1], of.std[C - 1], step_s);
    if short.is_none() || of.value[C - 1] < LONG_S {
        return Some(short.into_iter().collect());
    }
    let fitted = |late_s: f64, count: usize| {
        let causes: [Vec<f64>; D] = std::array::from_fn(|i| causes[i][..count].to_vec());
        factors(&time_s[..count], &moved(time_s, angle, late_s)[..count], &causes, step_s)
    };
    let best = best_moved(time_s, step_s, fitted).filter(|best| best.left < CONFIRMED)?;
    Some(vec![Finding {
        channel,
        what: What::Late { late_s: best.late_s, std_s: of.std[C - 1] },
        sentence: format!(
            "{channel} comes about {:.0} ms late against the gyros and the accelerometers: check its delay and filter",
            1e3 * best.late_s
        ),
    }])
}

/// Names the sensors that disagree.
pub(super) fn reason<M: Motion<N, R>, const N: usize, const R: usize>(
    record: &Record,
    task: &Task<M, N, R>,
) -> Option<VerdictReason> {
    let gravity = task.file.aircraft.gravity;
    let mut found: Vec<Finding> = air_data::findings(record).unwrap_or_default();
    let chord = task.file.aircraft.mean_chord;
    let channels = |names: &[&str]| Channels::of(task.prepared, task.file, names);
    let known = task.prepared.surface_times.clone();
    let surfaces = known.unwrap_or_else(|| reaction::surfaces(task.prepared, task.file));
    // With a bank angle the equations of the symmetric motion have further terms.
    let (by_kinematics, vane) = if M::AXES.has_lateral() {
        let vane = channels(&reactions::LATERAL).and_then(|c| reactions::lateral(&c, chord, &surfaces));
        (channels(&lateral::NAMES).and_then(|c| lateral::findings(&c, gravity)), vane)
    } else {
        let vane = channels(&reactions::LONGITUDINAL).and_then(|c| reactions::longitudinal(&c, chord, &surfaces));
        (channels(&longitudinal::NAMES).and_then(|c| longitudinal::findings(&c, gravity)), vane)
    };
    let is_contradicted = |finding: &Finding| vane.as_ref().is_some_and(|vane| vane.contradicts(finding));
    found.extend(by_kinematics.into_iter().flatten().filter(|finding| !is_contradicted(finding)));
    found.extend(vane.and_then(|vane| vane.finding));
    found.extend(surfaces.iter().filter_map(|surface| reactions::surface(surface, task.prepared.hold)));
    blame_gyros(&mut found);
    if found.is_empty() {
        return None;
    }
    let mut concerns: Vec<String> = found.iter().map(|finding| finding.channel.to_owned()).collect();
    concerns.dedup();
    let sentences: Vec<&str> = found.iter().map(|finding| finding.sentence.as_str()).collect();
    Some(VerdictReason {
        code: ReasonCode::SensorError,
        status: EstimationStatus::Doubtful,
        concerns,
        sentence: format!(
            "The sensors disagree with one another: {}. `phugoid compatibility` estimates such errors, and --correct \
             takes them out.",
            sentences.join("; ").trim_end_matches('.')
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late(channel: &'static str, late_s: f64, std_s: f64) -> Finding {
        Finding { channel, what: What::Late { late_s, std_s }, sentence: channel.to_owned() }
    }

    #[test]
    fn a_gyro_is_late_where_its_angle_and_its_surface_are_early_by_as_much() {
        let factor = || Finding { channel: "q", what: What::Factor, sentence: "a factor".to_owned() };
        let mut found = vec![factor(), late("alpha", -0.087, 0.003), late("elevator", -0.08, 0.0005)];
        blame_gyros(&mut found);
        let [Finding { channel: "q", what: What::Late { late_s, .. }, sentence }] = found.as_slice() else { panic!() };
        assert!((late_s - 0.08).abs() < 1e-12 && sentence.starts_with("q was recorded about 80 ms late"), "{sentence}");
        // Early by other times, one of them late, or one alone.
        for other in [late("elevator", -0.04, 0.0005), late("elevator", 0.08, 0.0005), late("aileron", -0.08, 0.0005)] {
            let mut found = vec![factor(), late("alpha", -0.087, 0.003), other];
            blame_gyros(&mut found);
            assert_eq!(found.len(), 3);
            assert!(found.iter().all(|f| !f.sentence.contains("about")));
        }
    }

    #[test]
    fn a_factor_that_is_hardly_known_is_no_scale() {
        assert!(is_off(0.9, 0.01) && is_off(1.3, 0.04) && is_off(0.3, 0.01));
        // Gusts that a noisy vane hardly shows.
        assert!(!is_off(0.29, 0.14) && !is_off(0.19, 0.055) && !is_off(1.02, 0.001));
    }
}
