//! Linear interpolation on uniform grids: direct indexing, several tables at a time.

use crate::scalar::Scalar;

/// A uniformly spaced axis with `N` points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformAxis<const N: usize> {
    first: f64,
    inverse_spacing: f64,
}

/// Where a value lies on an axis: the cell and the fraction of it (beyond the ends below 0 or above 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<T> {
    /// Index of the point below, at most `N - 2`.
    pub cell: usize,
    /// Distance from that point in units of the spacing.
    pub fraction: T,
}

impl<const N: usize> UniformAxis<N> {
    const CELLS: () = assert!(N >= 2 && N < i32::MAX as usize, "an axis needs two points");

    /// The axis `first, first + spacing, ...` (`N` points). A spacing that is not positive gives `None`.
    pub fn new(first: f64, spacing: f64) -> Option<Self> {
        let () = Self::CELLS;
        (spacing > 0.0 && spacing.is_finite() && first.is_finite())
            .then(|| Self { first, inverse_spacing: 1.0 / spacing })
    }

    /// The axis through these points, if they are evenly spaced to one part in 10^9.
    pub fn from_points(points: &[f64]) -> Option<Self> {
        if points.len() != N || N < 2 {
            return None;
        }
        let spacing = (points[N - 1] - points[0]) / (N - 1) as f64;
        let even = points.windows(2).all(|w| (w[1] - w[0] - spacing).abs() <= 1e-9 * spacing);
        if even { Self::new(points[0], spacing) } else { None }
    }

    /// The same axis in another unit: every point multiplied by a positive factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { first: self.first * factor, inverse_spacing: self.inverse_spacing / factor }
    }

    /// The cell that holds a value. Outside the axis it is the end cell, so that the end segment is extrapolated. A value
    /// that is not a number lies in the first cell at a fraction that is not a number.
    #[inline(always)]
    pub fn place<T: Scalar>(&self, value: T) -> Place<T> {
        let position = (value - self.first) * self.inverse_spacing;
        // The conversion saturates and takes what is not a number to zero.
        let cell = (position.real() as i32).clamp(0, N as i32 - 2);
        Place { cell: cell as usize, fraction: position - f64::from(cell) }
    }
}

/// `K` tables over one axis, interpolated together.
#[inline(always)]
pub fn interpolate<T: Scalar, const K: usize, const N: usize>(table: &[[f64; K]; N], at: Place<T>) -> [T; K] {
    let cell = at.cell.min(N - 2);
    let (below, above) = (&table[cell], &table[cell + 1]);
    core::array::from_fn(|k| at.fraction * (above[k] - below[k]) + below[k])
}

/// `K` tables over a row and a column axis, interpolated together (bilinear).
#[inline(always)]
pub fn interpolate_2d<T: Scalar, const K: usize, const C: usize, const R: usize>(
    table: &[[[f64; K]; C]; R],
    row: Place<T>,
    column: Place<T>,
) -> [T; K] {
    let cell = row.cell.min(R - 2);
    let below = interpolate(&table[cell], column);
    let above = interpolate(&table[cell + 1], column);
    core::array::from_fn(|k| row.fraction * (above[k] - below[k]) + below[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    #[test]
    fn a_bilinear_function_is_reproduced_inside_and_beyond_the_table() {
        let f = |x: f64, y: f64| 1.0 + 2.0 * x - 3.0 * y + 0.5 * x * y;
        let (ax, ay) = (UniformAxis::<4>::new(-1.0, 0.5).unwrap(), UniformAxis::<3>::new(2.0, 4.0).unwrap());
        let table: [[[f64; 1]; 4]; 3] =
            core::array::from_fn(|r| core::array::from_fn(|c| [f(-1.0 + 0.5 * c as f64, 2.0 + 4.0 * r as f64)]));
        for x in [-3.0, -1.0, -0.2, 0.0, 0.5, 2.0] {
            for y in [-5.0, 2.0, 3.3, 10.0, 20.0] {
                let at = |x: Dual<2>, y: Dual<2>| interpolate_2d(&table, ay.place(y), ax.place(x))[0];
                let value = at(Dual::variable(x, 0), Dual::variable(y, 1));
                assert!((value.value - f(x, y)).abs() < 1e-12, "{x} {y}");
                assert!((value.derivatives[0] - (2.0 + 0.5 * y)).abs() < 1e-12, "{x} {y}");
                assert!((value.derivatives[1] - (-3.0 + 0.5 * x)).abs() < 1e-12, "{x} {y}");
            }
        }
    }

    #[test]
    fn points_of_the_axis_return_the_entries() {
        let axis = UniformAxis::<4>::from_points(&[-10.0, -5.0, 0.0, 5.0]).unwrap();
        let table = [[1.0], [4.0], [-2.0], [7.0]];
        for (i, x) in [-10.0, -5.0, 0.0, 5.0].into_iter().enumerate() {
            assert_eq!(interpolate(&table, axis.place(x))[0], table[i][0]);
        }
        assert!(interpolate(&table, axis.place(f64::NAN))[0].is_nan());
        assert_eq!(axis.place(f64::INFINITY).cell, 2);
    }

    #[test]
    fn uneven_axes_are_refused() {
        assert!(UniformAxis::<3>::from_points(&[0.0, 1.0, 3.0]).is_none());
        assert!(UniformAxis::<3>::from_points(&[0.0, 1.0]).is_none());
        assert!(UniformAxis::<2>::from_points(&[1.0, 0.0]).is_none());
    }
}
