//! Linear interpolation on axes of uneven spacing. A place on an axis is found once and serves every table with that axis.

use phugoid_flight_dynamics::scalar::Scalar;

/// Points in increasing order, at least two.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    points: Vec<f64>,
}

/// The points next to a value and their weights.
///
/// Two points as a rule. On an inner point the derivative of a piecewise linear function jumps; derivatives (of dual
/// numbers) are there the mean of those on both sides, which takes three points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<T> {
    first: usize,
    count: usize,
    weights: [T; 3],
}

impl Axis {
    /// The axis through these points; `None` if they are fewer than two, not finite, or do not increase.
    pub(crate) fn new(points: Vec<f64>) -> Option<Self> {
        let increasing = points.windows(2).all(|pair| pair[0] < pair[1]);
        (points.len() >= 2 && increasing && points.iter().all(|x| x.is_finite())).then_some(Self { points })
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// A point by its index, which has to be below the length.
    pub(crate) fn point(&self, index: usize) -> f64 {
        self.points[index]
    }

    /// Lowest and highest point.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.points[0], self.points[self.points.len() - 1]]
    }

    /// The place of a value. Beyond the ends the outermost segment is extrapolated. A value that is no number has weights
    /// that are none.
    #[inline]
    pub(crate) fn place<T: Scalar>(&self, value: T) -> Place<T> {
        let points = &self.points[..];
        let real = value.real();
        let last = points.len() - 2;
        let cell = points[1..=last].partition_point(|point| *point <= real);
        let (below, above) = (points[cell], points[cell + 1]);
        if !T::IS_REAL && real == below && cell > 0 {
            let before = points[cell - 1];
            let (left, right) = (0.5 / (below - before), 0.5 / (above - below));
            let off = value - below;
            return Place {
                first: cell - 1,
                count: 3,
                weights: [off * -left, off * (left - right) + 1.0, off * right],
            };
        }
        let fraction = (value - below) / (above - below);
        Place { first: cell, count: 2, weights: [-fraction + 1.0, fraction, T::from(0.0)] }
    }

    /// The place of a value, or of the nearest end if the value lies beyond it.
    #[inline]
    pub(crate) fn place_within<T: Scalar>(&self, value: T) -> Place<T> {
        let [low, high] = self.ends();
        let real = value.real();
        self.place(if real < low {
            T::from(low)
        } else if real > high {
            T::from(high)
        } else {
            value
        })
    }
}

impl<T: Scalar> Place<T> {
    /// Indices of the points with their weights.
    #[inline(always)]
    fn points(&self) -> impl Iterator<Item = (usize, T)> + '_ {
        let count = self.count.min(3);
        self.weights[..count].iter().enumerate().map(|(i, weight)| (self.first + i, *weight))
    }
}

#[inline(always)]
fn add<T: Scalar, const K: usize>(sum: &mut [T; K], row: &[f64; K], weight: T) {
    for k in 0..K {
        sum[k] = sum[k] + weight * row[k];
    }
}

/// A table of `K` components over one axis.
#[inline]
pub(crate) fn blend_1<T: Scalar, const K: usize>(data: &[[f64; K]], a: &Place<T>) -> [T; K] {
    let mut sum = [T::from(0.0); K];
    for (i, weight) in a.points() {
        add(&mut sum, &data[i], weight);
    }
    sum
}

/// Over two axes; `columns` is the length of the second.
#[inline]
pub(crate) fn blend_2<T: Scalar, const K: usize>(
    data: &[[f64; K]],
    columns: usize,
    a: &Place<T>,
    b: &Place<T>,
) -> [T; K] {
    let mut sum = [T::from(0.0); K];
    for (i, outer) in a.points() {
        for (j, inner) in b.points() {
            add(&mut sum, &data[i * columns + j], outer * inner);
        }
    }
    sum
}

/// Over three axes; `columns` and `layers` are the lengths of the second and the third.
#[inline]
pub(crate) fn blend_3<T: Scalar, const K: usize>(
    data: &[[f64; K]],
    [columns, layers]: [usize; 2],
    a: &Place<T>,
    b: &Place<T>,
    c: &Place<T>,
) -> [T; K] {
    let mut sum = [T::from(0.0); K];
    for (i, outer) in a.points() {
        for (j, middle) in b.points() {
            let both = outer * middle;
            for (k, inner) in c.points() {
                add(&mut sum, &data[(i * columns + j) * layers + k], both * inner);
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_flight_dynamics::scalar::Dual;

    #[test]
    fn values_are_linear_between_points_and_beyond_them() {
        let axis = Axis::new(vec![-1.0, 0.0, 2.0]).unwrap();
        let data = [[3.0], [1.0], [5.0]];
        for (x, expected) in [(-2.0, 5.0), (-1.0, 3.0), (-0.5, 2.0), (0.0, 1.0), (1.0, 3.0), (2.0, 5.0), (3.0, 7.0)] {
            assert_eq!(blend_1(&data, &axis.place(x)), [expected], "{x}");
        }
        assert_eq!(blend_1(&data, &axis.place_within(3.0)), [5.0]);
        assert_eq!(blend_1(&data, &axis.place_within(-9.0)), [3.0]);
        assert!(blend_1(&data, &axis.place(f64::NAN))[0].is_nan());
    }

    #[test]
    fn derivatives_on_a_point_are_the_mean_of_both_sides() {
        let axis = Axis::new(vec![-1.0, 0.0, 2.0]).unwrap();
        let data = [[3.0], [1.0], [5.0]];
        let slope = |x: f64| {
            let [y] = blend_1(&data, &axis.place(Dual::<1>::variable(x, 0)));
            (y.value, y.derivatives[0])
        };
        assert_eq!(slope(-0.5), (2.0, -2.0));
        assert_eq!(slope(0.0), (1.0, 0.0));
        assert_eq!(slope(1.0), (3.0, 2.0));
        assert_eq!(slope(-1.0), (3.0, -2.0));
        assert_eq!(slope(2.0), (5.0, 2.0));
    }

    #[test]
    fn a_trilinear_function_is_reproduced_with_its_derivatives() {
        let f = |x: f64, y: f64, z: f64| 1.0 + x - 2.0 * y + 0.5 * z + x * y * z;
        let axes = [vec![0.0, 1.0, 3.0], vec![-1.0, 2.0], vec![0.0, 0.5, 2.0, 4.0]];
        let mut data = Vec::new();
        for x in &axes[0] {
            for y in &axes[1] {
                data.extend(axes[2].iter().map(|z| [f(*x, *y, *z)]));
            }
        }
        let [a, b, c] = axes.map(|points| Axis::new(points).unwrap());
        for (x, y, z) in [(0.3, 0.7, 3.1), (1.0, 2.5, 0.5), (-1.0, 0.0, 5.0)] {
            let [u, v, w] = [0, 1, 2].map(|i| Dual::<3>::variable([x, y, z][i], i));
            let [value] = blend_3(&data, [2, 4], &a.place(u), &b.place(v), &c.place(w));
            assert!((value.value - f(x, y, z)).abs() < 1e-12);
            for (found, expected) in value.derivatives.iter().zip([1.0 + y * z, -2.0 + x * z, 0.5 + x * y]) {
                assert!((found - expected).abs() < 1e-12, "{x} {y} {z}");
            }
        }
    }

    #[test]
    fn axes_that_do_not_increase_are_refused() {
        for points in [vec![], vec![1.0], vec![1.0, 1.0], vec![2.0, 1.0], vec![0.0, f64::NAN], vec![0.0, f64::INFINITY]]
        {
            assert!(Axis::new(points).is_none());
        }
    }
}
