//! A quantity of an engine over throttle, speed and altitude.

use std::fmt;

use phugoid_flight_dynamics::scalar::Scalar;

use crate::daveml::{Axis, Gridded, Independent, Interpolation, Place};

/// What an axis of a [`Schedule`] counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Where the engine is between idle (0) and full throttle (1).
    Throttle,
    /// Mach number.
    Mach,
    /// True airspeed, m/s.
    Speed,
    /// Altitude above sea level, m.
    Altitude,
}

impl Along {
    /// All of them, in the order in which a table has its axes.
    pub const ALL: [Self; 4] = [Self::Throttle, Self::Mach, Self::Speed, Self::Altitude];

    /// Its word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Throttle => "throttle",
            Self::Mach => "mach",
            Self::Speed => "speed",
            Self::Altitude => "altitude",
        }
    }
}

impl fmt::Display for Along {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Why numbers make no [`Schedule`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScheduleError {
    /// An axis needs two points.
    #[error("the axis `{0}` has fewer than two points: leave it out if nothing changes along it")]
    TooShort(Along),
    /// A point is not above the one before it, or is no number.
    #[error("the axis `{along}` does not increase: {before} is followed by {after}")]
    NotIncreasing {
        /// The axis.
        along: Along,
        /// A point of it.
        before: f64,
        /// The next one.
        after: f64,
    },
    /// The throttle of a table has to begin at idle and to end at full throttle.
    #[error("the axis `throttle` goes from {0} to {1}: it has to go from 0 (idle) to 1 (full)")]
    Throttle(f64, f64),
    /// The same axis twice, or axes in another order than throttle, speed or Mach number, altitude.
    #[error("the axes have to be in the order throttle, mach or speed, altitude, each at most once")]
    Order,
    /// The table has another number of values than its axes have points.
    #[error("the table has {found} values and its axes {expected} points")]
    Size {
        /// Values that the axes ask for.
        expected: usize,
        /// Values that there are.
        found: usize,
    },
    /// A value is no number.
    #[error("a value of the table is not finite")]
    NotFinite,
    /// With more throttle there is not more of it, so that no throttle could be found for what is needed.
    #[error("full throttle gives {full}, not more than idle with {idle}")]
    NoGain {
        /// Value at throttle 1.
        full: f64,
        /// Value at throttle 0, at the same speed and altitude.
        idle: f64,
    },
}

/// A thrust (N) or a power (W) over throttle, speed or Mach number, and altitude: linear between the points, and beyond the ends of
/// an axis as at its end. [`ends`](Self::ends) says where the ends are. Without an axis of the throttle it is in proportion to the
/// throttle.
///
/// ```
/// use phugoid_aircraft::engine::{Along, Schedule};
///
/// let thrust = Schedule::new(
///     vec![(Along::Mach, vec![0.0, 0.8]), (Along::Altitude, vec![0.0, 10_000.0])],
///     vec![20_000.0, 8_000.0, 14_000.0, 6_000.0], // the last axis varies fastest
/// )?;
/// // Half throttle, Mach 0.4 at 5000 m: half of the mean of the four corners.
/// assert_eq!(thrust.value(0.5, 0.4, 130.0, 5000.0), 6_000.0);
/// # Ok::<(), phugoid_aircraft::engine::ScheduleError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Schedule {
    table: Gridded,
    along: Vec<Along>,
}

impl PartialEq for Schedule {
    fn eq(&self, other: &Self) -> bool {
        let points = |schedule: &Self| schedule.table.axes.iter().map(|axis| axis.points.clone()).collect::<Vec<_>>();
        self.along == other.along && self.table.values == other.table.values && points(self) == points(other)
    }
}

impl Schedule {
    /// In proportion to the throttle, with this value at full throttle at every speed and altitude.
    pub fn constant(full: f64) -> Self {
        Self { table: Gridded { axes: Vec::new(), values: [full].into() }, along: Vec::new() }
    }

    /// A table over some axes, in the order of [`Along::ALL`]. The last axis varies fastest in the values.
    ///
    /// # Errors
    /// [`ScheduleError`]: axes that do not increase or are in another order, another number of values, values that are not
    /// finite or do not rise from idle to full throttle.
    pub fn new(axes: Vec<(Along, Vec<f64>)>, values: Vec<f64>) -> Result<Self, ScheduleError> {
        let place = |along: Along| Along::ALL.iter().position(|found| *found == along).unwrap_or(0);
        let both = |a: Along, b: Along| axes.iter().filter(|(along, _)| [a, b].contains(along)).count() > 1;
        if axes.windows(2).any(|pair| place(pair[0].0) >= place(pair[1].0)) || both(Along::Mach, Along::Speed) {
            return Err(ScheduleError::Order);
        }
        for (along, points) in &axes {
            let [first, .., last] = points.as_slice() else { return Err(ScheduleError::TooShort(*along)) };
            // What is not a number does not increase either.
            let increases = |pair: &[f64]| pair[0] < pair[1] && pair[0].is_finite() && pair[1].is_finite();
            if let Some(pair) = points.windows(2).find(|pair| !increases(pair)) {
                return Err(ScheduleError::NotIncreasing { along: *along, before: pair[0], after: pair[1] });
            }
            if *along == Along::Throttle && [*first, *last] != [0.0, 1.0] {
                return Err(ScheduleError::Throttle(*first, *last));
            }
        }
        // More points than any memory has do not multiply to a wrong number.
        let expected = axes.iter().fold(1_usize, |count, (_, points)| count.saturating_mul(points.len()));
        if expected != values.len() {
            return Err(ScheduleError::Size { expected, found: values.len() });
        }
        if values.iter().any(|value| !value.is_finite()) {
            return Err(ScheduleError::NotFinite);
        }
        if let Some((Along::Throttle, points)) = axes.first() {
            let row = values.len() / points.len();
            let idle = values.iter().take(row);
            let full = values.iter().skip(values.len() - row);
            if let Some((idle, full)) = idle.zip(full).find(|(idle, full)| full <= idle) {
                return Err(ScheduleError::NoGain { full: *full, idle: *idle });
            }
        } else if let Some(full) = values.iter().find(|full| **full <= 0.0) {
            return Err(ScheduleError::NoGain { full: *full, idle: 0.0 });
        }
        let mut stride = values.len();
        let along = axes.iter().map(|(along, _)| *along).collect();
        let axes = axes.into_iter().map(|(along, points)| {
            stride /= points.len();
            let independent = Independent {
                variable: place(along),
                interpolation: Interpolation::Linear,
                lower: f64::NEG_INFINITY,
                upper: f64::INFINITY,
                extrapolates: [false; 2],
            };
            Axis::new(points.into(), stride, independent)
        });
        Ok(Self { table: Gridded { axes: axes.collect(), values: values.into() }, along })
    }

    /// The value where the engine is at `throttle` (0 to 1), at a Mach number, a true airspeed (m/s) and an altitude (m); NaN where
    /// one of them is that the table reads.
    pub fn value<T: Scalar>(&self, throttle: T, mach: T, speed: T, altitude: T) -> T {
        let mut places = [Place { index: 0, fraction: T::from(0.0) }; Along::ALL.len()];
        let value = self.table.value(&[throttle, mach, speed, altitude], &mut places, &mut [0; Along::ALL.len()]);
        if self.along.first() == Some(&Along::Throttle) { value } else { value * throttle }
    }

    /// First and last point of an axis; none without it: nothing changes along it.
    pub fn ends(&self, along: Along) -> Option<[f64; 2]> {
        let axis = self.along.iter().position(|found| *found == along)?;
        let points = &self.table.axes.get(axis)?.points;
        Some([*points.first()?, *points.last()?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_flight_dynamics::scalar::Dual;

    fn turbofan() -> Schedule {
        let axes = vec![
            (Along::Throttle, vec![0.0, 0.5, 1.0]),
            (Along::Speed, vec![0.0, 200.0]),
            (Along::Altitude, vec![0.0, 5000.0, 11_000.0]),
        ];
        let mut values = Vec::new();
        for throttle in [0.0, 0.5, 1.0] {
            for speed in [0.0, 200.0] {
                for altitude in [0.0, 5000.0, 11_000.0] {
                    values.push(-500.0 + 20_000.0 * throttle * throttle - 20.0 * speed - throttle * altitude);
                }
            }
        }
        Schedule::new(axes, values).unwrap()
    }

    /// Interpolation by hand, with its slopes, and the ends.
    #[test]
    fn it_is_linear_between_points_and_constant_beyond_them() {
        let thrust = turbofan();
        let at = |t: f64, v: f64, h: f64| thrust.value(t, 0.0, v, h);
        assert_eq!(at(1.0, 200.0, 11_000.0), -500.0 + 20_000.0 - 4000.0 - 11_000.0);
        // Throttle 0.75 lies between 5000 and 20000 N, the altitude takes 0.75 of itself.
        assert!((at(0.75, 100.0, 2500.0) - (-500.0 + 12_500.0 - 2000.0 - 1875.0)).abs() < 1e-9);
        assert_eq!(at(1.0, 300.0, 20_000.0), at(1.0, 200.0, 11_000.0));
        assert_eq!(at(-1.0, -5.0, -5.0), at(0.0, 0.0, 0.0));
        assert!(at(f64::NAN, 100.0, 0.0).is_nan() && at(0.5, 100.0, f64::NAN).is_nan());
        let dual = |value: f64, i: usize| Dual::<3>::variable(value, i);
        let slope = thrust.value(dual(0.75, 0), Dual::from(0.0), dual(100.0, 1), dual(2500.0, 2)).derivatives;
        for (found, expected) in slope.into_iter().zip([30_000.0 - 2500.0, -20.0, -0.75]) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
        assert_eq!(thrust.ends(Along::Altitude), Some([0.0, 11_000.0]));
        assert_eq!(thrust.ends(Along::Mach), None);
    }

    #[test]
    fn numbers_that_make_no_table_are_refused() {
        use Along::{Altitude, Mach, Speed, Throttle};
        let refused = |axes: &[(Along, &[f64])], values: &[f64]| {
            let axes = axes.iter().map(|(along, points)| (*along, points.to_vec())).collect();
            Schedule::new(axes, values.to_vec()).unwrap_err().to_string()
        };
        assert!(refused(&[(Mach, &[0.0, 0.5, 0.5])], &[3.0; 3]).contains("0.5 is followed by 0.5"));
        assert!(refused(&[(Mach, &[0.0, f64::NAN])], &[3.0; 2]).contains("does not increase"));
        assert!(refused(&[(Mach, &[0.0])], &[3.0]).contains("fewer than two"));
        assert!(refused(&[(Mach, &[0.0, 1.0])], &[3.0; 3]).contains("3 values and its axes 2"));
        assert!(refused(&[(Mach, &[0.0, 1.0])], &[3.0, f64::INFINITY]).contains("not finite"));
        assert!(refused(&[(Altitude, &[0.0, 1.0]), (Mach, &[0.0, 1.0])], &[3.0; 4]).contains("order"));
        assert!(refused(&[(Mach, &[0.0, 1.0]), (Speed, &[0.0, 1.0])], &[3.0; 4]).contains("order"));
        assert!(refused(&[(Throttle, &[0.0, 0.9])], &[3.0, 4.0]).contains("from 0 (idle) to 1"));
        assert!(refused(&[(Throttle, &[0.0, 1.0])], &[3.0, 3.0]).contains("not more than idle"));
        assert!(refused(&[(Mach, &[0.0, 1.0])], &[3.0, -3.0]).contains("not more than idle"));
    }
}
