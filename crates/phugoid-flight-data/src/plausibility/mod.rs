//! Finds channels whose unit, sign or sensor is implausible. They are reported and never changed.
//!
//! The checks use only physics that holds for every aeroplane: the size of its angles, attitude as the integral of the
//! rate, the specific force of one g upwards in steady flight, climb from speed and path angle, flow angles that turn as
//! rates and accelerations say, dynamic pressure from speed and density. They use quantiles,
//! medians and regressions, so that single outliers raise no alarm.
//!
//! ```
//! use phugoid_flight_data::plausibility::{self, Certainty};
//! use phugoid_flight_data::record::Record;
//! // A pitch attitude of 4 deg and more that is declared as radians.
//! let time: Vec<f64> = (0..100).map(|k| 0.1 * f64::from(k)).collect();
//! let theta: Vec<f64> = time.iter().map(|t| 4.0 + t.sin()).collect();
//! let record = Record::from_columns("example", [("time_s", time), ("theta_rad", theta)])?;
//! let doubts = plausibility::check(&record);
//! assert_eq!(doubts[0].channels, ["theta"]);
//! assert_eq!(doubts[0].certainty, Certainty::Certain);
//! assert!(doubts[0].message.contains("degrees read as radians"));
//! # Ok::<(), phugoid_flight_data::table::TableError>(())
//! ```

mod accelerations;
mod air_data;
mod doubt;
mod flow_angles;
mod motion;
mod robust;
mod sensors;
mod sizes;
mod standing;
mod time;

use crate::record::Record;
use doubt::Doubts;
pub use doubt::{Cause, Certainty, Doubt};
use motion::Axis;
pub(crate) use time::unit_of_step;

/// Checks units and signs of a record, and returns one entry per probable cause; empty if everything is plausible.
///
/// Missing values (NaN) are left out. Channels that are missing or not as long as the time are not checked.
pub fn check(record: &Record) -> Vec<Doubt> {
    let mut doubts = Doubts::of(record);
    sizes::angles(&mut doubts);
    sizes::others(&mut doubts);
    motion::attitude_and_rate(&mut doubts, Axis::Roll);
    motion::attitude_and_rate(&mut doubts, Axis::Pitch);
    motion::angle_of_attack(&mut doubts);
    accelerations::vertical(&mut doubts);
    accelerations::load_factor(&mut doubts);
    accelerations::forward(&mut doubts);
    air_data::density(&mut doubts);
    air_data::climb(&mut doubts);
    air_data::turning(&mut doubts);
    air_data::turning_sideways(&mut doubts);
    air_data::ground_speed(&mut doubts);
    time::step(&mut doubts);
    flow_angles::alpha(&mut doubts);
    flow_angles::beta(&mut doubts);
    sensors::still(&mut doubts);
    sensors::stuck(&mut doubts);
    sensors::stuck_surfaces(&mut doubts);
    sensors::saturated(&mut doubts);
    doubts.found
}
