//! How the air moves: the smooth gust of the thesis, a 1-cosine ramp on a body axis.

use crate::scalar::Scalar;

/// Motion of the air around the aircraft, body axes. The default is air at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirMotion {
    /// Velocity at the centre of gravity, m/s.
    pub velocity: [f64; 3],
    /// Rotation of the air about the body axes, rad/s: what the aerodynamics see is `p`, `q`, `r` less these.
    pub rates: [f64; 3],
}

impl From<[f64; 3]> for AirMotion {
    /// Air that moves without turning.
    fn from(velocity: [f64; 3]) -> Self {
        Self { velocity, rates: [0.0; 3] }
    }
}

/// Air velocity along a body axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "std", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum BodyAxis {
    /// Body x, positive forward.
    X,
    /// Body y, positive to the right.
    Y,
    /// Body z, positive down.
    Z,
}

/// Gust of thesis equation 2.32: still until the delay `Td`, then, with `t` counted from there,
/// `U(t) = Um/2 [1 - cos(pi t / Ud)]` up to `t = Ud`, and `Um` ever after.
///
/// Thesis example: `Um` = 20 ft/s, `Ud` = 6 s, `Td` = 2 s along x.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "std", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gust {
    /// Body axis along which the air moves.
    pub axis: BodyAxis,
    /// Final velocity `Um` of the air along that axis, m/s. Positive along the axis: a positive x gust is a tail wind,
    /// a negative z gust an updraught.
    pub amplitude: f64,
    /// Duration `Ud` of the rise, s. Zero or negative: the full velocity at once.
    pub duration: f64,
    /// Delay `Td` before the rise, s.
    pub delay: f64,
}

impl Gust {
    /// Velocity of the air in body axes at a time (s), m/s: ready for [`Disturbance::gust`].
    ///
    /// [`Disturbance::gust`]: crate::motion::Disturbance::gust
    pub fn velocity(&self, time: f64) -> [f64; 3] {
        let t = time - self.delay;
        let speed = if t < 0.0 {
            0.0
        } else if t < self.duration {
            let (_, cosine) = Scalar::sin_cos(core::f64::consts::PI * t / self.duration);
            0.5 * self.amplitude * (1.0 - cosine)
        } else {
            self.amplitude
        };
        match self.axis {
            BodyAxis::X => [speed, 0.0, 0.0],
            BodyAxis::Y => [0.0, speed, 0.0],
            BodyAxis::Z => [0.0, 0.0, speed],
        }
    }
}

/// The sum of several gusts at a time (s), m/s in body axes.
pub fn total_velocity(gusts: &[Gust], time: f64) -> [f64; 3] {
    gusts.iter().fold([0.0; 3], |sum, gust| {
        let v = gust.velocity(time);
        [sum[0] + v[0], sum[1] + v[1], sum[2] + v[2]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thesis_example() {
        let um = 20.0 * 0.3048;
        let gust = Gust { axis: BodyAxis::X, amplitude: um, duration: 6.0, delay: 2.0 };
        assert_eq!(gust.velocity(1.999), [0.0; 3]);
        assert!((gust.velocity(5.0)[0] - 0.5 * um).abs() < 1e-12); // half way up, half the velocity
        assert!((gust.velocity(3.5)[0] - 0.5 * um * (1.0 - 0.5_f64.sqrt())).abs() < 1e-12);
        assert_eq!(gust.velocity(8.0), [um, 0.0, 0.0]);
        assert_eq!(gust.velocity(80.0), [um, 0.0, 0.0]);
        // Continuous in value and slope at both ends of the ramp.
        assert!(gust.velocity(2.0 + 1e-4)[0] < 1e-8 && um - gust.velocity(8.0 - 1e-4)[0] < 1e-8);
    }

    #[test]
    fn gusts_add_up_axis_by_axis() {
        let x = Gust { axis: BodyAxis::X, amplitude: 2.0, duration: 0.0, delay: 1.0 };
        let z = Gust { axis: BodyAxis::Z, amplitude: -3.0, duration: 0.0, delay: 2.0 };
        assert_eq!(total_velocity(&[x, z, x], 1.5), [4.0, 0.0, 0.0]);
        assert_eq!(total_velocity(&[x, z], 2.5), [2.0, 0.0, -3.0]);
    }
}
