//! Aircraft of other programs' files as vehicles that
//! [`globe::flight::fly`](phugoid_flight_dynamics::globe::flight::fly) flies over the Earth.

mod daveml;
mod error;
mod jsbsim;
pub(crate) mod named;

pub use daveml::DavemlVehicle;
pub use error::VehicleError;
pub use jsbsim::JsbsimVehicle;

/// A quantity that is linear in time between instants, and constant before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    instants: Vec<[f64; 2]>,
}

impl Schedule {
    /// From times (s) and values at them; none without an instant, or where the times do not rise or are NaN.
    ///
    /// ```
    /// use phugoid_aircraft::vehicle::Schedule;
    /// let ramp = Schedule::new(vec![[1.0, 0.0], [1.5, 2.0]]).unwrap();
    /// assert_eq!((ramp.at(0.0), ramp.at(1.25), ramp.at(9.0)), (0.0, 1.0, 2.0));
    /// ```
    pub fn new(instants: Vec<[f64; 2]>) -> Option<Self> {
        let rising = instants.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        let sound = instants.iter().all(|[time, _]| !time.is_nan());
        (rising && sound && !instants.is_empty()).then_some(Self { instants })
    }

    /// The value at a time, s; NaN at a time that is NaN.
    pub fn at(&self, time: f64) -> f64 {
        if time.is_nan() {
            return f64::NAN;
        }
        let after = self.instants.partition_point(|[instant, _]| *instant <= time);
        let value = |index: usize| self.instants.get(index).copied();
        match (after.checked_sub(1).and_then(value), value(after)) {
            (Some([t0, x0]), Some([t1, x1])) => x0 + (x1 - x0) * (time - t0) / (t1 - t0),
            (Some([_, x]), None) | (None, Some([_, x])) => x,
            (None, None) => f64::NAN,
        }
    }
}
