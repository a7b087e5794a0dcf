//! Units and signs that cannot be, or hardly: said, never changed.
//!
//! The checks use only physics that every aircraft shares: how large its angles are, that the attitude is the integral
//! of its rate, that an accelerometer in steady flight shows one g upwards, that speed and path angle give the climb.
//! They look at quantiles, medians and regressions, so that single wild values raise no alarm.

mod accelerations;
mod air_data;
mod doubt;
mod motion;
mod robust;
mod sizes;

use crate::record::Record;
use doubt::Doubts;
pub use doubt::{Certainty, Doubt};

/// Looks for units and signs that are wrong; one finding per cause.
///
/// Channels that are missing, or not as long as the time, are passed over.
pub fn check(record: &Record) -> Vec<Doubt> {
    let mut doubts = Doubts { record, found: Vec::new() };
    sizes::angles(&mut doubts);
    sizes::others(&mut doubts);
    motion::attitude_and_rate(&mut doubts, "phi", "p");
    motion::attitude_and_rate(&mut doubts, "theta", "q");
    motion::angle_of_attack(&mut doubts);
    accelerations::vertical(&mut doubts);
    accelerations::load_factor(&mut doubts);
    air_data::density(&mut doubts);
    air_data::climb(&mut doubts);
    air_data::turning(&mut doubts);
    doubts.found
}
