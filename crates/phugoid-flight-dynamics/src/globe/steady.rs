//! Trim for straight flight over the Earth: what is left of the accelerations, and Newton's method to remove it.

use core::fmt;

use super::condition::{Launch, World};
use super::flight::motion;
use super::loads::Loads;
use super::vector::{Vector, apply, cross, subtract};

/// What straight flight at constant speed leaves over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unsteadiness {
    /// Rate of the velocity relative to the ground as seen from the local axes, m/s^2, north, east and down.
    pub acceleration: Vector,
    /// The same along the horizontal direction of the body's x axis, to its right, and down, m/s^2.
    pub along_right_down: Vector,
    /// Rates of the body rates, rad/s^2, body axes.
    pub angular_acceleration: Vector,
}

/// Accelerations relative to the local north-east-down axes of a vehicle that starts so at time zero, with these own
/// states.
///
/// Zero means that it holds its velocity towards north, east and down, and (if [`Launch::rates`] are zero relative to the
/// local axes) its attitude against them, as long as those turn steadily. Not finite at a pole.
pub fn unsteadiness<const X: usize, L: Loads<X> + ?Sized>(
    world: &World,
    vehicle: &mut L,
    launch: &Launch,
    internal: [f64; X],
) -> Unsteadiness {
    let planet = &world.planet;
    let motion = motion(world, vehicle, 0.0, &launch.state(planet, 0.0, internal));
    let condition = &motion.condition;
    let spin = [0.0, 0.0, planet.rotation_rate()];
    let relative = subtract(motion.acceleration, cross(spin, condition.state.velocity));
    let turning = planet.ned_rotation(&condition.place, condition.ground_velocity);
    let acceleration =
        subtract(apply(&condition.ned_from_inertial, relative), cross(turning, condition.ground_velocity));
    let (s, c) = super::vector::sin_cos(launch.euler.yaw);
    let [north, east, down] = acceleration;
    Unsteadiness {
        acceleration,
        along_right_down: [c * north + s * east, c * east - s * north, down],
        angular_acceleration: motion.angular_acceleration,
    }
}

/// No trim was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoTrim {
    /// Largest residual that was left, in its unit.
    pub residual: f64,
}

impl fmt::Display for NoTrim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no trim was found: an acceleration of {:e} (SI units) is left", self.residual)
    }
}

impl core::error::Error for NoTrim {}

/// Values of `N` unknowns at which `N` residuals vanish, by Newton's method with differences from a guess.
///
/// `steps` are the steps of the differences in the units of the unknowns. A step that does not lessen the largest residual
/// is halved, up to ten times: residuals made of tables have kinks.
///
/// # Errors
///
/// [`NoTrim`] if after fifty iterations a residual is still larger than `tolerance`, or the residuals do not depend on the
/// unknowns, or are not finite.
pub fn solve<const N: usize>(
    mut residuals: impl FnMut(&[f64; N]) -> [f64; N],
    guess: [f64; N],
    steps: [f64; N],
    tolerance: f64,
) -> Result<[f64; N], NoTrim> {
    let mut x = guess;
    let mut left = residuals(&x);
    for _ in 0..50 {
        if largest(&left) <= tolerance {
            return Ok(x);
        }
        let mut slopes = [[0.0; N]; N];
        for c in 0..N {
            let mut moved = x;
            moved[c] += steps[c];
            let changed = residuals(&moved);
            for r in 0..N {
                slopes[r][c] = (changed[r] - left[r]) / steps[c];
            }
        }
        let Some(step) = linear_solution(slopes, left) else { break };
        let mut share = 1.0;
        for halving in 0..=10 {
            let candidate = core::array::from_fn(|i| x[i] - share * step[i]);
            let there = residuals(&candidate);
            if largest(&there) < largest(&left) || halving == 10 {
                (x, left) = (candidate, there);
                break;
            }
            share *= 0.5;
        }
    }
    let residual = largest(&left);
    if residual <= tolerance { Ok(x) } else { Err(NoTrim { residual }) }
}

/// Largest absolute value; infinite if one is NaN.
fn largest<const N: usize>(values: &[f64; N]) -> f64 {
    values.iter().fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x.abs()) })
}

/// Solution of `a x = b` by elimination with row pivots; none for a singular matrix.
fn linear_solution<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    for c in 0..N {
        let mut pivot = c;
        for r in c..N {
            if a[r][c].abs() > a[pivot][c].abs() {
                pivot = r;
            }
        }
        a.swap(c, pivot);
        b.swap(c, pivot);
        if a[c][c] == 0.0 || a[c][c].is_nan() {
            return None;
        }
        for r in c + 1..N {
            let factor = a[r][c] / a[c][c];
            for k in c..N {
                a[r][k] -= factor * a[c][k];
            }
            b[r] -= factor * b[c];
        }
    }
    let mut x = [0.0; N];
    for r in (0..N).rev() {
        let known: f64 = (r + 1..N).map(|k| a[r][k] * x[k]).sum();
        x[r] = (b[r] - known) / a[r][r];
    }
    Some(x)
}
