//! Tables over a grid of breakpoints, in any number of dimensions.

use std::sync::Arc;

use phugoid_flight_dynamics::scalar::Scalar;

use super::axis::{Axis, Interpolation, Place};

/// A gridded table as one function uses it.
#[derive(Clone, Debug)]
pub(crate) struct Gridded {
    /// One for each independent variable; the last varies fastest in the values.
    pub(crate) axes: Vec<Axis>,
    pub(crate) values: Arc<[f64]>,
}

impl Gridded {
    /// Most dimensions: the evaluation calls itself once for each.
    pub(super) const MAX_DIMENSIONS: usize = 24;

    /// The value at the given variables; NaN where one of them is. `places` and `hints` have room for every axis.
    pub(crate) fn value<T: Scalar>(&self, variables: &[T], places: &mut [Place<T>], hints: &mut [u32]) -> T {
        for ((axis, place), hint) in self.axes.iter().zip(places.iter_mut()).zip(hints.iter_mut()) {
            let x = variables[axis.independent.variable];
            if x.real().is_nan() {
                return T::from(f64::NAN);
            }
            *place = axis.locate(x, *hint as usize);
            *hint = place.index as u32;
        }
        self.inner(0, 0, places)
    }

    /// The value of the axes from `dimension` on, for the part of the table that begins at `offset`.
    fn inner<T: Scalar>(&self, dimension: usize, offset: usize, places: &[Place<T>]) -> T {
        let Some(axis) = self.axes.get(dimension) else { return T::from(self.values[offset]) };
        let place = places[dimension];
        let at = |point: usize| self.inner(dimension + 1, offset + point * axis.stride, places);
        if axis.points.len() == 1 {
            return at(0);
        }
        match axis.independent.interpolation {
            Interpolation::Discrete | Interpolation::Floor | Interpolation::Ceiling => at(place.index),
            Interpolation::CubicSpline if !axis.bending.is_empty() => {
                let mut sum = T::from(0.0);
                for point in 0..axis.points.len() {
                    sum = sum + axis.spline_weight(place, point) * at(point);
                }
                sum
            }
            Interpolation::Linear | Interpolation::CubicSpline => {
                let (low, high) = (at(place.index), at(place.index + 1));
                if place.fraction.real() == 1.0 {
                    high + (high - low) * (place.fraction - 1.0)
                } else {
                    low + (high - low) * place.fraction
                }
            }
        }
    }
}
