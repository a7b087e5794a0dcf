//! Checks of the time stamps.

use super::doubt::{Certainty, Doubts};
use crate::wording::Short;

/// Units of time that recorders use, and how many seconds each is.
const UNITS: [(&str, f64); 3] = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
/// Nobody records the motion of an aircraft at steps of more seconds than this.
const SLOWEST_S: f64 = 2.0;
/// At this step, s, and beyond not even a slow logger is left.
const IMPOSSIBLE_S: f64 = 60.0;
/// Nobody records the motion of an aircraft at shorter steps, s ...
const FASTEST_S: f64 = 5e-4;
/// ... and in a record that is shorter, s, no aircraft moves.
const SHORTEST_S: f64 = 1.0;
/// Fewest samples of a record that is asked.
const FEWEST: usize = 20;

/// The unit that makes a step between samples, given in seconds, one of a recorder of flights (0.5 ms to 0.6 s), with how
/// many seconds it is; `None` for a step of seconds, and where no unit makes one.
pub(crate) fn unit_of_step(step: f64) -> Option<(&'static str, f64)> {
    let of_recorder = |(_, seconds): &(&str, f64)| (5e-4..=0.6).contains(&(step * seconds));
    (step >= SLOWEST_S).then(|| UNITS.into_iter().find(of_recorder)).flatten()
}

/// Checks the step of the time: stamps in milliseconds, microseconds or nanoseconds that were read as seconds.
pub(super) fn step(doubts: &mut Doubts) {
    seconds(doubts);
    let time = doubts.time();
    // The rates and attitudes may have told it already.
    let told = doubts.found.iter().any(|doubt| doubt.message.contains("the time is probably"));
    let Some(step) = doubts.step().filter(|step| *step >= SLOWEST_S && time.len() >= FEWEST && !told) else {
        return;
    };
    let Some((unit, _)) = unit_of_step(step) else { return };
    let certainty = if step < IMPOSSIBLE_S { Certainty::Doubtful } else { Certainty::Certain };
    let message = format!(
        "stands {} s from sample to sample: the time is probably in {unit} and read as seconds. Name the column \
         `time_{unit}`",
        Short(step)
    );
    doubts.add(&["time"], certainty, message);
}

/// Checks for stamps in seconds that were read as milliseconds, microseconds or nanoseconds.
fn seconds(doubts: &mut Doubts) {
    let time = doubts.time();
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return };
    let Some(step) = doubts.step().filter(|step| *step < FASTEST_S && time.len() >= FEWEST) else { return };
    let length = last - first;
    let read = doubts.unit("time");
    let Some((unit, factor)) = UNITS.into_iter().find(|(unit, _)| Some(*unit) == read) else { return };
    if length < SHORTEST_S && (FASTEST_S..=SLOWEST_S).contains(&(step / factor)) {
        let message = format!(
            "stands {} s from sample to sample, and the whole record lasts {} s: the time is probably in seconds and read as \
             {unit}. Name the column `time_s`",
            Short(step),
            Short(length)
        );
        doubts.add(&["time"], Certainty::Certain, message);
    }
}
