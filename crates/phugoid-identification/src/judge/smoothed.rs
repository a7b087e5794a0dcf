//! Whether an accelerometer was smoothed before it was recorded, or is too slow for what acts on it, and whether the airspeed is.
//!
//! A filter that runs forwards and backwards over a record delays nothing, so that no check of times sees it, and it takes the
//! noise away by which a method weighs the channel. The channel is then believed far more than all others, while what acts on it at
//! once, above all the force of a surface, is missing in it: on flights of another simulator the lift of the elevator came out as
//! nothing, twenty of its claimed errors from the truth. White noise is the same in differences over one row and over two; what was
//! smoothed has sixth differences a tenth as large over one row. Attitudes and rates often come smoothed from an autopilot, and their
//! filters follow the motion; accelerations do not.

use phugoid_flight_data::statistics::{Rank, median, quantile};

use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};
use crate::core::output::Output;
use crate::methods::Task;
use crate::motion::Motion;
use crate::preparation::noise::OwnSamples;

/// Sixth differences over one row, over those over two rows, up to which a channel counts as smooth. Of 17 flights of another simulator
/// at 25 and 50 Hz accelerometers have 0.74 and more, those of the HFB-320 0.5 and more; channels that were smoothed at 1 and 2 Hz
/// have 0.11 to 0.13.
const SMOOTH: f64 = 0.3;
/// The same from which on a channel shows noise of its own. A record in which no channel does is one of a simulation without noise.
const NOISY: f64 = 0.5;
/// Fewer differences say nothing.
const FEWEST: usize = 100;
/// Longest time between the samples of an accelerometer, s, in a record that is faster. The colour of its residuals is allowed for over
/// half a second, which is a few samples then, and terms that the model lacks are hardly found. Of 36 flights of another simulator with one
/// every 0.2 s one gave the elevator three times its lift, seven of its claimed errors off; with one every 0.1 or 0.12 s one (0.12 s, a
/// term missing in its drag) gave it the wrong sign.
const SLOWEST_S: f64 = 0.11;

/// Names the accelerometers that are much slower than the record.
pub(super) fn too_slow<M: Motion<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>) -> Option<VerdictReason> {
    let channels = M::AXES.outputs().iter().enumerate();
    let slow: Vec<(&str, f64)> = channels
        .filter(|(_, output)| task.file.outputs[output.index()] && is_accelerometer(**output))
        .filter_map(|(row, output)| {
            let values: Vec<f64> = task.prepared.outputs.iter().map(|y| y[row]).collect();
            let step_s = OwnSamples::of(&values)?.step_s(&task.prepared.time)?;
            (step_s > SLOWEST_S).then_some((output.name(), step_s))
        })
        .collect();
    let list: Vec<String> = slow.iter().map(|(name, step_s)| format!("{name} every {:.0} ms", 1e3 * step_s)).collect();
    (!slow.is_empty()).then(|| VerdictReason {
        code: ReasonCode::Channel,
        status: EstimationStatus::Doubtful,
        concerns: slow.iter().map(|(name, _)| (*name).to_owned()).collect(),
        sentence: format!(
            "An accelerometer is much slower than the record ({}): what the surfaces do to the force at once is hardly in it, and the \
             bounds of their derivatives may be too small. Record it every 100 ms or faster.",
            list.join(", ")
        ),
    })
}

/// Time between values of the airspeed from which on it counts as slow, s.
const SLOW_AIRSPEED_S: f64 = 0.25;
/// Share of the dynamic pressure by which it may change from one value of a slow airspeed to the next, in nine of ten. About a quarter
/// of the change is what is not known between two values: 5 % of every coefficient, where a usual error of the airspeed makes 6 %.
const MOST_BETWEEN: f64 = 0.2;

/// Says that the airspeed comes so seldom that the dynamic pressure is another one from value to value: while it takes off, or in
/// a dive.
pub(super) fn airspeed_too_slow<M: Motion<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
) -> Option<VerdictReason> {
    let row = M::AXES.outputs().iter().position(|output| *output == Output::TrueAirspeed)?;
    if !task.file.outputs[Output::TrueAirspeed.index()] {
        return None;
    }
    let (time_s, outputs) = (&task.prepared.time, &task.prepared.outputs);
    // A slow channel is missing between its values, or repeats them.
    let mut own: Vec<(f64, f64)> = time_s.iter().zip(outputs).map(|(t, y)| (*t, y[row])).collect();
    own.retain(|(_, speed)| speed.is_finite());
    own.dedup_by(|(_, speed), (_, before)| speed.to_bits() == before.to_bits());
    of_airspeed(&own)
}

/// From the times (s) and values (m/s) of the airspeed.
fn of_airspeed(own: &[(f64, f64)]) -> Option<VerdictReason> {
    let mut steps: Vec<f64> = own.windows(2).map(|w| w[1].0 - w[0].0).collect();
    let step_s = median(&mut steps)?;
    let change = |w: &[(f64, f64)]| {
        let [before, after] = [w[0].1, w[1].1].map(|speed| speed * speed);
        (after - before).abs() / before.max(after)
    };
    let mut changes: Vec<f64> = own.windows(2).map(change).filter(|change| change.is_finite()).collect();
    let most = quantile(&mut changes, 0.9, Rank::Nearest)?;
    (step_s > SLOW_AIRSPEED_S && most > MOST_BETWEEN).then(|| VerdictReason {
        code: ReasonCode::Channel,
        status: EstimationStatus::Doubtful,
        concerns: vec![Output::TrueAirspeed.name().to_owned()],
        sentence: format!(
            "The airspeed comes every {step_s:.1} s, and the dynamic pressure, on which every coefficient rests, changes by up to \
             {:.0} % from one value to the next: what it is in between is not known well enough. Record the airspeed faster, or \
             take a part of the flight at a steadier speed (--from, --to).",
            100.0 * most
        ),
    })
}

fn is_accelerometer(output: Output) -> bool {
    matches!(output, Output::Ax | Output::Ay | Output::Az)
}

/// Names the accelerometers that have no noise while other channels of the record have.
pub(super) fn reason<M: Motion<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>) -> Option<VerdictReason> {
    let channels = M::AXES.outputs().iter().enumerate().filter(|(_, output)| task.file.outputs[output.index()]);
    let ratios: Vec<(Output, f64)> = channels
        .filter_map(|(row, output)| {
            let values: Vec<f64> = task.prepared.outputs.iter().map(|y| y[row]).collect();
            Some((*output, roughness(&values)?))
        })
        .collect();
    of(&ratios)
}

fn of(ratios: &[(Output, f64)]) -> Option<VerdictReason> {
    let smooth: Vec<&str> =
        ratios.iter().filter(|(o, ratio)| is_accelerometer(*o) && *ratio < SMOOTH).map(|(o, _)| o.name()).collect();
    let noisy: Vec<&str> = ratios.iter().filter(|(_, ratio)| *ratio > NOISY).map(|(o, _)| o.name()).collect();
    (!smooth.is_empty() && !noisy.is_empty()).then(|| VerdictReason {
        code: ReasonCode::Channel,
        status: EstimationStatus::Doubtful,
        concerns: smooth.iter().map(|name| (*name).to_owned()).collect(),
        sentence: format!(
            "No noise of its own is in {}, while other channels have some ({}): it was smoothed before it was recorded. It is then \
             believed too much, and what acts on it at once is missing in it: the effects of the surfaces on the force that it \
             measures come out too small. Record it as the sensor gives it.",
            smooth.join(" and "),
            noisy.join(", ")
        ),
    })
}

/// Part of the rows that may repeat the value before: more are the steps of a coarse recorder, whose differences say nothing.
const REPEATED: f64 = 0.1;

/// Median of the sixth differences over neighbouring rows, over that of those over every second row; one for white noise.
/// `None` where too few rows in a row have values, the channel stands still, or the recorder is coarse.
fn roughness(values: &[f64]) -> Option<f64> {
    let repeated = values.windows(2).filter(|w| w[0] == w[1]).count();
    if repeated as f64 > REPEATED * values.len() as f64 {
        return None;
    }
    const BINOMIAL: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
    let over = |stride: usize| {
        let sum = |w: &[f64]| BINOMIAL.iter().enumerate().map(|(i, c)| c * w[i * stride]).sum::<f64>().abs();
        let mut differences: Vec<f64> = values.windows(6 * stride + 1).map(sum).filter(|d| d.is_finite()).collect();
        (differences.len() >= FEWEST).then(|| median(&mut differences)).flatten()
    };
    let (one, two) = (over(1)?, over(2)?);
    (two > 0.0).then(|| one / two)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_airspeed_once_a_second_does_in_cruise_and_not_in_a_take_off() {
        let flown = |step_s: f64, of: &dyn Fn(f64) -> f64| -> Option<VerdictReason> {
            of_airspeed(&(0..20).map(|k| (step_s * f64::from(k), of(step_s * f64::from(k)))).collect::<Vec<_>>())
        };
        // A short period and a phugoid about 20 m/s; 2 m/s^2 from rest.
        let cruise = |t: f64| 20.0 + 1.5 * (0.6 * t).sin();
        let take_off = |t: f64| 1.0 + 2.0 * t;
        assert_eq!(flown(1.0, &cruise), None);
        assert_eq!(flown(0.1, &take_off), None);
        let found = flown(1.0, &take_off).unwrap();
        assert_eq!((found.code, found.status), (ReasonCode::Channel, EstimationStatus::Doubtful));
        assert!(found.sentence.starts_with("The airspeed comes every 1.0 s"), "{}", found.sentence);
        assert_eq!(of_airspeed(&[]), None);
    }

    #[test]
    fn a_channel_is_smooth_where_differences_fall_with_the_step() {
        let mut seed = 11_u64;
        let mut white = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let motion = |k: usize| (0.12 * k as f64).sin();
        let raw: Vec<f64> = (0..1500).map(|k| motion(k) + 0.01 * white()).collect();
        // A moving mean about each value, four times: nothing comes later.
        let mut smoothed = raw.clone();
        for _ in 0..4 {
            smoothed = smoothed.windows(13).map(|w| w.iter().sum::<f64>() / 13.0).collect();
        }
        let [rough, smooth] = [&raw, &smoothed].map(|values| roughness(values).unwrap());
        assert!(rough > 0.8 && smooth < SMOOTH, "{rough} {smooth}");
        assert_eq!(roughness(&[1.0; 500]), None);
        let coarse: Vec<f64> = raw.iter().map(|v| (v * 20.0).round() / 20.0).collect();
        assert_eq!(roughness(&coarse), None, "a recorder with steps");
        assert_eq!(roughness(&raw[..60]), None);
    }

    #[test]
    fn accelerometers_are_named_beside_channels_with_noise_alone() {
        let found = of(&[(Output::Alpha, 1.0), (Output::Az, 0.1)]).unwrap();
        assert!(
            found.sentence.starts_with("No noise of its own is in az, while other channels have some (alpha)"),
            "{}",
            found.sentence
        );
        assert_eq!((found.concerns, found.status), (vec!["az".to_owned()], EstimationStatus::Doubtful));
        // A simulation without noise, and attitudes of an autopilot.
        assert!(of(&[(Output::Alpha, 0.1), (Output::Az, 0.1)]).is_none());
        assert!(of(&[(Output::Theta, 0.1), (Output::Az, 0.9)]).is_none());
    }
}
