//! Checks for sensors that stand still, or at the end of their range, while the aircraft moves.

use super::doubt::{Cause, Certainty, Doubts};
use super::robust::span;
use crate::statistics::{constant, median};
use crate::wording::Short;

/// Channels of sensors that follow the motion of the aircraft; surfaces may well rest at a stop.
const MOVING: [&str; 10] = ["alpha", "beta", "theta", "phi", "p", "q", "r", "ax", "ay", "az"];
/// Control surfaces.
const SURFACES: [&str; 3] = ["elevator", "aileron", "rudder"];
/// A channel is noisy where the median of its second differences is more than this many steps of the recorder: of noise
/// of one sigma it is 1.65 sigma, and of noise that large one sample in three or fewer repeats the one before.
const NOISY: f64 = 3.0;
/// A channel is stuck where it repeats one value for so long, s ...
const STUCK_S: f64 = 2.0;
/// ... which is at least this part of the record ...
const STUCK_PART: f64 = 0.1;
/// ... while another sensor moves over this part of its range.
const OTHERS_MOVE: f64 = 0.5;
/// A channel whose smallest step is more than this part of its range is coarse: its extremes repeat anyway.
const COARSE: f64 = 0.01;
/// A channel enters and leaves the end of its range with at least this part of it per sample: a gentle turn of the
/// motion, or a trim before the first input, does not.
const ABRUPT: f64 = 0.004;
/// Fewest samples of a record that is asked for a sensor that stands still throughout.
const FEWEST: usize = 20;
/// Least total time at one end, s.
const SATURATED_S: f64 = 0.3;

/// Checks for sensors that stand still.
pub(super) fn stuck(doubts: &mut Doubts) {
    let time = doubts.time();
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return };
    let least = STUCK_S.max(STUCK_PART * (last - first));
    let range = |values: &[f64]| span(values).map_or(0.0, |(low, high)| high - low);
    let moving = || MOVING.into_iter().filter_map(|name| Some((name, doubts.values(name)?)));
    let mut found = Vec::new();
    for (name, values) in moving().filter(|(name, _)| !doubts.any(&[name])) {
        // A stretch from the start on is a trim of a simulation.
        let stretch = runs(values).filter(|(from, _)| *from > 0).find(|(from, to)| time[*to] - time[*from] >= least);
        let Some((from, to)) = stretch else { continue };
        let whole = range(values);
        if whole <= 0.0 || is_coarse(values, whole) {
            continue;
        }
        let moves = |(other, values): &(&str, &[f64])| {
            let whole = range(values);
            *other != name && whole > 0.0 && range(&values[from..=to]) > OTHERS_MOVE * whole
        };
        if let Some((other, _)) = moving().find(moves) {
            found.push((name, time[from], time[to], other));
        }
    }
    for (name, from, to, other) in found {
        let message = format!(
            "repeats one value from {} s to {} s, in which {other} moves: the sensor was stuck, or the recorder lost it. \
             Leave the stretch out (--from, --to), or leave the channel out of `outputs`",
            Short(from),
            Short(to)
        );
        doubts.add_since(name, from, message);
    }
}

/// Channels of which none stands still while two others are measured with noise, in the longitudinal and in the lateral motion.
const TOGETHER: [&[&str]; 2] = [&["true_airspeed", "alpha", "theta", "q", "az"], &["beta", "phi", "p", "r", "ay"]];

/// Second differences are as large as this part of the first ones where there is noise: of white noise 1.7 times, of a motion that is recorded
/// without noise a tenth and less.
const ROUGH: f64 = 0.3;

/// Checks for sensors that show one value from the first sample to the last, while others are noisy. A simulation without noise may well
/// hold a speed, or fly without sideslip.
pub(super) fn still(doubts: &mut Doubts) {
    if doubts.time().len() < FEWEST {
        return;
    }
    let mut found = Vec::new();
    for together in TOGETHER {
        let of = |name: &&'static str| Some((*name, doubts.values(name).and_then(constant)?));
        let still: Vec<(&str, f64)> = together.iter().filter(|name| !doubts.any(&[name])).filter_map(of).collect();
        // Of nearly all records nothing stands still, and the noise of the others need not be known.
        if still.is_empty() {
            continue;
        }
        let mut moving = together.iter().filter(|name| doubts.values(name).is_some_and(is_rough)).copied();
        let (Some(first), Some(second)) = (moving.next(), moving.next()) else { continue };
        found.extend(still.into_iter().map(|(name, value)| (name, value, first, second)));
    }
    for (name, value, first, second) in found {
        let message = format!(
            "is {} in the whole record, in which {first} and {second} move: the sensor was stuck, or the recorder wrote a value \
             of its own. Leave the channel out of `outputs`; where the model needs it, this record cannot be used",
            Short(value)
        );
        doubts.add_cause(&[name], Certainty::Doubtful, Cause::Sensor, message);
    }
}

/// Whether the samples of a channel scatter from one to the next, as those of a sensor do.
fn is_rough(values: &[f64]) -> bool {
    let middle = |differences: &mut dyn Iterator<Item = f64>| {
        median(&mut differences.map(f64::abs).filter(|d| d.is_finite() && *d > 0.0).collect::<Vec<f64>>())
    };
    let first = middle(&mut values.windows(2).map(|v| v[1] - v[0]));
    let second = middle(&mut values.windows(3).map(|v| v[2] - 2.0 * v[1] + v[0]));
    first.zip(second).is_some_and(|(first, second)| second > ROUGH * first)
}

/// Checks for positions of control surfaces that stand still between noisy ones. A surface may rest for long, but a noisy
/// recording of one that rests does not repeat a value; a recording without noise, such as of a command, is not judged.
pub(super) fn stuck_surfaces(doubts: &mut Doubts) {
    let time = doubts.time();
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return };
    let least = STUCK_S.max(STUCK_PART * (last - first));
    let mut found = Vec::new();
    for name in SURFACES {
        let Some(values) = doubts.values(name).filter(|_| !doubts.any(&[name])) else { continue };
        let long = |(from, to): &(usize, usize)| *from > 0 && time[*to] - time[*from] >= least;
        let Some((from, to)) = runs(values).find(long) else { continue };
        // Outside of the stretch: how often neighbours are equal, and how rough the channel is, in steps of the recorder.
        let outside = || values.windows(3).enumerate().filter(|(k, _)| *k > to || k + 2 < from).map(|(_, three)| three);
        let differences = || outside().map(|three| (three[1] - three[0]).abs()).filter(|d| d.is_finite());
        let quantum = differences().filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        let equal = differences().filter(|d| *d == 0.0).count();
        let roughness = median(&mut outside().map(|v| (v[2] - 2.0 * v[1] + v[0]).abs()).collect::<Vec<f64>>());
        let is_noisy = roughness.is_some_and(|roughness| roughness > NOISY * quantum);
        if is_noisy && 20 * equal < differences().count() {
            found.push((name, time[from], time[to]));
        }
    }
    for (name, from, to) in found {
        let message = format!(
            "repeats one value from {} s to {} s, and is noisy before or after: the sensor was stuck, or the recorder lost \
             it. Leave the stretch out (--from, --to)",
            Short(from),
            Short(to)
        );
        doubts.add_since(name, from, message);
    }
}

/// Checks for sensors whose range, or the range of whose recorder, was too small.
pub(super) fn saturated(doubts: &mut Doubts) {
    let time = doubts.time();
    let mut found = Vec::new();
    for name in MOVING {
        let Some(values) = doubts.values(name).filter(|_| !doubts.any(&[name])) else { continue };
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let range = high - low;
        // Attitudes and headings end where they are wrapped.
        if !range.is_finite() || range <= 0.0 || is_coarse(values, range) || (name == "phi" && range > 6.0) {
            continue;
        }
        for (end, word) in [(high, "largest"), (low, "smallest")] {
            let at_end: Vec<(usize, usize)> = runs(values)
                .filter(|(from, to)| values[*from] == end && to - from >= 2)
                .filter(|(from, to)| {
                    let step = |a: usize, b: usize| (values[a] - values[b]).abs() >= ABRUPT * range;
                    *from > 0 && to + 1 < values.len() && step(from - 1, *from) && step(*to, to + 1)
                })
                .collect();
            let total: f64 = at_end.iter().map(|(from, to)| time[*to] - time[*from]).sum();
            if total >= SATURATED_S {
                found.push((name, word, end, total, at_end.len()));
                break;
            }
        }
    }
    for (name, word, end, total, times) in found {
        let message = format!(
            "stands exactly at its {word} value, {}, for {} s in {times} stretches: the range of the sensor or of its \
             recorder ended there. Leave these stretches out (--from, --to), or fly smaller amplitudes",
            Short(end),
            Short(total)
        );
        doubts.add_cause(&[name], Certainty::Doubtful, Cause::Sensor, message);
    }
}

/// First and last row of every stretch of at least two equal values.
fn runs(values: &[f64]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let mut start = 0;
    (1..=values.len()).filter_map(move |row| {
        if row < values.len() && values[row] == values[start] {
            return None;
        }
        let run = (start, row - 1);
        start = row;
        (run.1 > run.0).then_some(run)
    })
}

/// Whether the recorder's step is a large part of the range.
fn is_coarse(values: &[f64], range: f64) -> bool {
    let steps = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0);
    steps.fold(f64::INFINITY, f64::min) > COARSE * range
}

#[cfg(test)]
mod tests {
    use crate::record::Record;

    /// An elevator that is moved and rests, with so much noise (a sum of sines that never repeats), in steps of the
    /// recorder of 1e-4; stuck over a part if so.
    fn sticks(noise: f64, stuck: bool) -> bool {
        let time: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
        let mut elevator: Vec<f64> = time
            .iter()
            .map(|t| {
                let input = if (t % 5.0) < 1.0 { 0.05 * (6.0 * t).sin() } else { 0.0 };
                let scatter = (7919.0 * t).sin() + (15331.0 * t).cos() + (31337.7 * t).sin();
                ((input + noise * scatter) / 1e-4).round() * 1e-4
            })
            .collect();
        if stuck {
            let held = elevator[400];
            elevator[400..700].fill(held);
        }
        let record = Record::from_columns("test", [("time_s", time), ("elevator_rad", elevator)]).unwrap();
        super::super::check(&record).iter().any(|doubt| doubt.message.contains("repeats one value"))
    }

    #[test]
    fn a_sensor_that_shows_one_value_throughout_is_named_where_the_motion_is_seen_by_others() {
        let time: Vec<f64> = (0..400).map(|k| 0.05 * f64::from(k)).collect();
        let found = |noise: f64, alpha: f64, theta: f64, q: f64| {
            let scatter = |t: f64| noise * ((7919.0 * t).sin() + (15331.0 * t).cos() + (31337.7 * t).sin());
            let wave =
                |size: f64| time.iter().map(|t| 0.1 + size * ((2.0 * t).sin() + scatter(*t))).collect::<Vec<f64>>();
            let columns = [
                ("time_s", time.clone()),
                ("alpha_rad", wave(alpha)),
                ("theta_rad", wave(theta)),
                ("q_rad_s", wave(q)),
            ];
            let record = Record::from_columns("test", columns).unwrap();
            let doubts = super::super::check(&record);
            doubts
                .iter()
                .filter(|d| d.message.contains("in the whole record"))
                .map(|d| d.channels[0].clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(found(0.05, 0.02, 0.03, 0.0), ["q"]);
        assert_eq!(found(0.05, 0.0, 0.03, 0.06), ["alpha"]);
        assert_eq!(found(0.05, 0.02, 0.03, 0.06), [] as [&str; 0]);
        // One of the three moves by itself, and a simulation without noise.
        assert_eq!(found(0.05, 0.0, 0.0, 0.06), [] as [&str; 0]);
        assert_eq!(found(0.0, 0.02, 0.03, 0.0), [] as [&str; 0]);
    }

    #[test]
    fn a_noisy_surface_that_repeats_a_value_is_stuck_and_a_command_at_rest_is_not() {
        assert!(sticks(1e-3, true) && !sticks(1e-3, false));
        assert!(!sticks(0.0, true) && !sticks(0.0, false));
    }
}
