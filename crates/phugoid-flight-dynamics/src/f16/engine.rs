//! Throttle gearing, power lag and thrust (appendix A.5 of the book).

use crate::scalar::Scalar;
use crate::table::{UniformAxis, interpolate_2d};

/// Points of the altitude and the Mach axis.
const POINTS: usize = 6;

/// Thrust at idle, military and maximum power.
#[derive(Clone, Debug, PartialEq)]
pub struct ThrustTables {
    /// Mach number: 0 to 1 in steps of 0.2.
    pub mach: UniformAxis<POINTS>,
    /// Altitude, m: 0 to 50,000 ft in steps of 10,000.
    pub altitude: UniformAxis<POINTS>,
    /// `[idle, military, maximum]`, N, by Mach number and altitude.
    pub thrust: [[[f64; 3]; POINTS]; POINTS],
}

/// The engine: thrust by power level, altitude and Mach number, and how the power level follows the throttle.
#[derive(Clone, Debug, PartialEq)]
pub struct Engine {
    /// Tables of thrust at idle, military and full power.
    pub thrust: ThrustTables,
}

impl ThrustTables {
    /// Thrust, N, from the power level (percent), altitude (m) and Mach number: bilinear in the last two, linear in
    /// power between idle (0), military (50) and maximum (100).
    #[inline]
    pub fn at<T: Scalar>(&self, power: T, altitude: T, mach: T) -> T {
        let [idle, military, maximum] =
            interpolate_2d(&self.thrust, self.mach.place(mach), self.altitude.place(altitude));
        if power.real() < 50.0 {
            idle + (military - idle) * power * 0.02
        } else {
            military + (maximum - military) * (power - 50.0) * 0.02
        }
    }
}

/// Commanded power level, percent, from the throttle lever (0 to 1): the gearing TGEAR.
#[inline]
pub(super) fn commanded_power<T: Scalar>(throttle: T) -> T {
    if throttle.real() <= 0.77 { throttle * 64.94 } else { throttle * 217.38 - 117.38 }
}

/// Rate of the power level, percent per second, from the commanded and the actual power level: the lag PDOT, which
/// treats the afterburner (above 50 percent) apart.
#[inline]
pub(super) fn power_rate<T: Scalar>(commanded: T, actual: T) -> T {
    if commanded.real() >= 50.0 {
        if actual.real() >= 50.0 {
            (commanded - actual) * 5.0
        } else {
            let gap = -actual + 60.0;
            reciprocal_time_constant(gap) * gap
        }
    } else if actual.real() >= 50.0 {
        (-actual + 40.0) * 5.0
    } else {
        let gap = commanded - actual;
        reciprocal_time_constant(gap) * gap
    }
}

/// RTAU: 1/s.
#[inline]
fn reciprocal_time_constant<T: Scalar>(gap: T) -> T {
    if gap.real() <= 25.0 {
        T::from(1.0)
    } else if gap.real() >= 50.0 {
        T::from(0.1)
    } else {
        gap * -0.036 + 1.9
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gearing_meets_at_its_knee_and_ends_at_full_power() {
        assert!((commanded_power(0.77) - 50.0).abs() < 5e-3);
        assert!((commanded_power(0.77 + 1e-12) - 50.0).abs() < 5e-3);
        assert!((commanded_power(1.0) - 100.0).abs() < 1e-9);
    }

    #[test]
    fn power_lag_by_its_four_rules() {
        assert!((power_rate(80.0, 90.0) - -50.0).abs() < 1e-12); // both in afterburner: 5 (80 - 90)
        assert!((power_rate(80.0, 10.0) - 5.0).abs() < 1e-12); // target 60, gap 50: 0.1 * 50
        assert!((power_rate(20.0, 90.0) - -250.0).abs() < 1e-12); // target 40: 5 (40 - 90)
        assert!((power_rate(45.0, 10.0) - (1.9 - 0.036 * 35.0) * 35.0).abs() < 1e-12);
        assert_eq!(power_rate(30.0, 30.0), 0.0);
    }
}
