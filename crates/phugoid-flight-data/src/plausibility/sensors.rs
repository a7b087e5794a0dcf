//! Checks for sensors that stand still, or at the end of their range, while the aircraft moves.

use super::doubt::{Cause, Certainty, Doubts};
use super::robust::span;
use crate::wording::Short;

/// Channels of sensors that follow the motion of the aircraft; surfaces may well rest at a stop.
const MOVING: [&str; 10] = ["alpha", "beta", "theta", "phi", "p", "q", "r", "ax", "ay", "az"];
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
/// Least total time at one end, s.
const SATURATED_S: f64 = 0.3;

/// Checks for sensors that stand still.
pub(super) fn stuck(doubts: &mut Doubts) {
    let time = doubts.time();
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return };
    let least = STUCK_S.max(STUCK_PART * (last - first));
    let ranges: Vec<(&str, &[f64], f64)> = MOVING
        .into_iter()
        .filter_map(|name| {
            let values = doubts.values(name)?;
            let (low, high) = span(values)?;
            Some((name, values, high - low))
        })
        .collect();
    let mut found = Vec::new();
    for (name, values, range) in ranges.iter().filter(|(_, _, range)| *range > 0.0) {
        if doubts.any(&[name]) || is_coarse(values, *range) {
            continue;
        }
        // A stretch from the start on is a trim of a simulation.
        let stretch = runs(values).filter(|(from, _)| *from > 0).find(|(from, to)| time[*to] - time[*from] >= least);
        let Some((from, to)) = stretch else { continue };
        let moves = |(other, values, range): &&(&str, &[f64], f64)| {
            let part = span(&values[from..=to]).map_or(0.0, |(low, high)| high - low);
            *other != *name && *range > 0.0 && part > OTHERS_MOVE * range
        };
        if let Some((other, _, _)) = ranges.iter().find(moves) {
            found.push((*name, time[from], time[to], *other));
        }
    }
    for (name, from, to, other) in found {
        let message = format!(
            "repeats one value from {} s to {} s, in which {other} moves: the sensor was stuck, or the recorder lost it. \
             Leave the stretch out (--from, --to), or leave the channel out of `outputs`",
            Short(from),
            Short(to)
        );
        doubts.add_cause(&[name], Certainty::Doubtful, Cause::Sensor, message);
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
