//! Wind: the air moves over the ground, steadily and level, with another speed and direction at another altitude.
//!
//! The state of an aircraft is its motion relative to the air that moves with the wind. Where the wind is the same everywhere
//! nothing changes but the path over the ground. An aircraft that climbs through a shear comes into air that moves
//! differently, which its inertia does not follow: relative to the air it is accelerated by `-dW/dt = -W'(h) h'`
//! (W. Frost and R. L. Bowles, Wind shear terms in the equations of aircraft motion, Journal of Aircraft 21, 1984).
//! How much the wind differs between the parts of the aircraft is left out: with level wings a shear of 0.1/s turns the air over an
//! aircraft that climbs at 5 degrees by less than 0.01 rad/s.

use crate::scalar::Scalar;

/// The wind around one altitude, linear in the altitude. The default is calm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LocalWind {
    /// Altitude above sea level at which the velocity holds, m.
    pub altitude: f64,
    /// Velocity of the air over the ground, towards north and towards east, m/s: a west wind has a positive east component.
    pub velocity: [f64; 2],
    /// Change of the velocity with the altitude, m/s per m upwards.
    pub shear: [f64; 2],
}

impl LocalWind {
    /// Velocity of the air at an altitude (m) near that of this wind, towards north and east, m/s.
    #[inline]
    pub fn at<T: Scalar>(&self, altitude: T) -> [T; 2] {
        let above = altitude - self.altitude;
        core::array::from_fn(|i| above * self.shear[i] + self.velocity[i])
    }

    /// Whether the air moves differently at another altitude.
    #[inline]
    pub(crate) fn is_sheared(&self) -> bool {
        self.shear != [0.0; 2]
    }
}

/// Wind at one altitude of a [`WindProfile`].
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindLevel {
    /// Altitude above sea level, m.
    pub altitude: f64,
    /// Velocity of the air, towards north and towards east, m/s.
    pub velocity: [f64; 2],
}

/// Why levels make no profile.
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WindError {
    /// A level has a number that is not finite.
    #[error("wind: level {level} has a number that is not finite")]
    NotFinite {
        /// Number of the level, counted from 1.
        level: usize,
    },
    /// A level is not above the one before it.
    #[error(
        "wind: level {level} is at {altitude} m, not above the one before it at {before} m: name the levels from the \
         lowest to the highest, each once"
    )]
    Order {
        /// Number of the level, counted from 1.
        level: usize,
        /// Its altitude, m.
        altitude: f64,
        /// Altitude of the level before it, m.
        before: f64,
    },
}

/// The wind at every altitude: its components are linear between levels, and constant below the lowest and above the
/// highest. The default is calm.
///
/// ```
/// use phugoid_flight_dynamics::wind::{WindLevel, WindProfile};
///
/// // Calm on the ground, 20 m/s from the west at 1000 m and above.
/// let wind = WindProfile::new(vec![
///     WindLevel { altitude: 0.0, velocity: [0.0, 0.0] },
///     WindLevel { altitude: 1000.0, velocity: [0.0, 20.0] },
/// ])?;
/// assert_eq!((wind.at(250.0).velocity, wind.at(250.0).shear), ([0.0, 5.0], [0.0, 0.02]));
/// assert_eq!((wind.at(3000.0).velocity, wind.at(3000.0).shear), ([0.0, 20.0], [0.0, 0.0]));
/// # Ok::<(), phugoid_flight_dynamics::wind::WindError>(())
/// ```
#[cfg(feature = "std")]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WindProfile {
    levels: Vec<WindLevel>,
}

#[cfg(feature = "std")]
impl WindProfile {
    /// The profile through these levels; one level is the same wind at all altitudes, none is calm.
    ///
    /// # Errors
    /// [`WindError`]: levels that do not rise, or numbers that are not finite.
    pub fn new(levels: Vec<WindLevel>) -> Result<Self, WindError> {
        for (i, level) in levels.iter().enumerate() {
            if !(level.altitude.is_finite() && level.velocity.iter().all(|v| v.is_finite())) {
                return Err(WindError::NotFinite { level: i + 1 });
            }
        }
        for (i, pair) in levels.windows(2).enumerate() {
            let (before, altitude) = (pair[0].altitude, pair[1].altitude);
            if altitude <= before {
                return Err(WindError::Order { level: i + 2, altitude, before });
            }
        }
        Ok(Self { levels })
    }

    /// The wind at an altitude (m). At a level the shear is that of the layer above it; an altitude that is NaN has the
    /// wind of the lowest level.
    pub fn at(&self, altitude: f64) -> LocalWind {
        let above = self.levels.partition_point(|level| level.altitude <= altitude);
        let level = |index: usize| self.levels.get(index);
        match (above.checked_sub(1).and_then(level), level(above)) {
            (None, None) => LocalWind::default(),
            (Some(only), None) | (None, Some(only)) => LocalWind { altitude, velocity: only.velocity, shear: [0.0; 2] },
            (Some(low), Some(high)) => {
                let depth = high.altitude - low.altitude;
                let shear = core::array::from_fn(|i| (high.velocity[i] - low.velocity[i]) / depth);
                let at_level = LocalWind { altitude: low.altitude, velocity: low.velocity, shear };
                LocalWind { altitude, velocity: at_level.at(altitude), shear }
            }
        }
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    fn level(altitude: f64, north: f64, east: f64) -> WindLevel {
        WindLevel { altitude, velocity: [north, east] }
    }

    #[test]
    fn linear_between_levels_and_constant_beyond() {
        let wind =
            WindProfile::new(vec![level(100.0, 4.0, 0.0), level(300.0, 0.0, 8.0), level(700.0, 0.0, 0.0)]).unwrap();
        for (altitude, velocity, shear) in [
            (-50.0, [4.0, 0.0], [0.0, 0.0]),
            (100.0, [4.0, 0.0], [-0.02, 0.04]),
            (150.0, [3.0, 2.0], [-0.02, 0.04]),
            (300.0, [0.0, 8.0], [0.0, -0.02]),
            (600.0, [0.0, 2.0], [0.0, -0.02]),
            (700.0, [0.0, 0.0], [0.0, 0.0]),
            (9e9, [0.0, 0.0], [0.0, 0.0]),
        ] {
            let here = wind.at(altitude);
            let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12;
            assert!(near(here.velocity, velocity) && near(here.shear, shear), "{altitude}: {here:?}");
            assert_eq!(here.at(altitude), here.velocity);
        }
        assert_eq!(WindProfile::default().at(100.0), LocalWind::default());
        assert_eq!(wind.at(f64::NAN).velocity, [4.0, 0.0]);
    }

    #[test]
    fn levels_that_make_no_profile_are_refused() {
        let order = WindProfile::new(vec![level(100.0, 4.0, 0.0), level(100.0, 0.0, 8.0)]).unwrap_err();
        assert!(order.to_string().contains("level 2 is at 100 m, not above"), "{order}");
        for bad in [level(f64::NAN, 0.0, 0.0), level(0.0, f64::INFINITY, 0.0), level(0.0, 0.0, f64::NAN)] {
            assert_eq!(WindProfile::new(vec![level(-10.0, 0.0, 0.0), bad]), Err(WindError::NotFinite { level: 2 }));
        }
    }
}
