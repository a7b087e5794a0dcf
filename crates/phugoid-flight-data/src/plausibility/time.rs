//! Checks of the time stamps.

use super::doubt::{Certainty, Doubts};
use crate::wording::Short;

/// Units of time that recorders use, and how many seconds each is.
const UNITS: [(&str, f64); 3] = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
/// Nobody records the motion of an aircraft at steps of more seconds than this.
const SLOWEST_S: f64 = 2.0;
/// At this step, s, and beyond not even a slow logger is left.
const IMPOSSIBLE_S: f64 = 60.0;
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
