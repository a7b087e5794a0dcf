//! By how much a value is moved that its file calls uncertain.

use phugoid_flight_dynamics::scalar::Scalar;

use super::document::Effect;

/// A value that is moved whenever it has been set, calculated or looked up.
#[derive(Clone, Debug)]
pub(super) struct Move {
    pub(super) variable: u32,
    pub(super) effect: Effect,
    /// How many standard deviations the bound of a normal distribution stands for; none of a uniform one.
    pub(super) sigmas: Option<f64>,
    pub(super) bounds: Vec<Size>,
    /// By how many standard uncertainties.
    pub(super) by: f64,
}

/// A bound of a [`Move`].
#[derive(Clone, Copy, Debug)]
pub(super) enum Size {
    Number(f64),
    /// The value that this variable has where nothing is moved.
    Variable(u32),
}

/// What one standard uncertainty adds to a value: the root of the mean square of its distance from the value as it is written, in
/// the direction of the value where the bounds are parts of it. Of two bounds that are not equally far away the mean is another value
/// than the one that is written, and this contains how far it is off (GUM, F.2.4.5: a correction that is not made belongs to the
/// uncertainty).
pub(super) fn deviation<T: Scalar>(effect: Effect, sigmas: Option<f64>, value: T, bounds: &[T]) -> T {
    let magnitude = |x: T| if x.real() < 0.0 { -x } else { x };
    let distance = |bound: T| magnitude(if effect == Effect::Absolute { bound - value } else { bound });
    let size = match (sigmas, bounds) {
        (Some(sigmas), [bound, ..]) => distance(*bound) / sigmas,
        (None, [bound]) => distance(*bound) / 3.0_f64.sqrt(),
        (None, [one, other, ..]) => {
            // The mean square of a uniform distribution between `low` and `high` about zero.
            let (low, high) = match effect {
                Effect::Absolute => (*one - value, *other - value),
                // One bound on either side, whichever signs are written.
                _ => (-magnitude(*one), magnitude(*other)),
            };
            let square = (low * low + low * high + high * high) / 3.0;
            // The root has no slope at zero.
            if square.real() > 0.0 { square.sqrt() } else { square }
        }
        (_, []) => T::from(f64::NAN),
    };
    match effect {
        Effect::Additive | Effect::Absolute => size,
        Effect::Multiplicative => value * size,
        Effect::Percentage => value * size * 0.01,
    }
}

impl Move {
    /// A value as it is moved, with the values of the bounds.
    pub(super) fn applied<T: Scalar>(&self, value: T, bounds: &[T]) -> T {
        value + deviation(self.effect, self.sigmas, value, bounds) * self.by
    }
}
