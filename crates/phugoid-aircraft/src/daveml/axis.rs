//! One independent variable of a table: where its value lies among the breakpoints, and what is done outside them.

use std::sync::Arc;

use phugoid_flight_dynamics::scalar::Scalar;

/// How values between breakpoints are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interpolation {
    /// The value at the nearest breakpoint; half way that of the upper one.
    Discrete,
    /// The value at the breakpoint below.
    Floor,
    /// The value at the breakpoint above.
    Ceiling,
    Linear,
    CubicSpline,
}

/// An independent variable of a function (`independentVarRef`, `independentVarPts`).
#[derive(Clone, Debug)]
pub(crate) struct Independent {
    /// Position of the variable.
    pub(crate) variable: usize,
    pub(crate) interpolation: Interpolation,
    /// What the value is limited to. A side on which the function may extrapolate has no limit.
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// Whether values below the first breakpoint, and above the last, continue the table.
    pub(crate) extrapolates: [bool; 2],
}

impl Independent {
    /// The value within the limits; a limit has the derivative zero.
    pub(super) fn limited<T: Scalar>(&self, x: T) -> T {
        if x.real() < self.lower {
            T::from(self.lower)
        } else if x.real() > self.upper {
            T::from(self.upper)
        } else {
            x
        }
    }
}

/// Where a value lies: the breakpoint before it and the fraction of the way to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<T> {
    pub(crate) index: usize,
    pub(crate) fraction: T,
}

/// Breakpoints of one dimension with all that can be computed beforehand.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) points: Arc<[f64]>,
    /// Distance to the next point in the table's values.
    pub(crate) stride: usize,
    pub(crate) independent: Independent,
    /// For a spline: the matrix, row by row, that turns the values at the breakpoints into second derivatives there.
    pub(super) bending: Vec<f64>,
}

impl Axis {
    /// Most breakpoints of a spline, whose matrix is dense; all matrices of a model together have as many places as
    /// one of this size.
    pub(super) const MAX_SPLINE: usize = 2000;

    pub(crate) fn new(points: Arc<[f64]>, stride: usize, independent: Independent) -> Self {
        let bending = match independent.interpolation {
            Interpolation::CubicSpline if points.len() > 2 => bending(&points, independent.extrapolates),
            _ => Vec::new(),
        };
        Self { points, stride, independent, bending }
    }

    /// Where a value lies, beginning the search at `hint`. The fraction is outside zero to one only where the axis
    /// extrapolates, and zero for all ways of interpolating in steps.
    pub(super) fn locate<T: Scalar>(&self, x: T, hint: usize) -> Place<T> {
        let [first, .., last] = &*self.points else { return Place { index: 0, fraction: T::from(0.0) } };
        let x = self.independent.limited(x);
        let real = x.real();
        let index = interval(&self.points, real, hint);
        let (before, after) = (self.points[index], self.points[index + 1]);
        let step = |upper: bool| Place { index: index + usize::from(upper), fraction: T::from(0.0) };
        match self.independent.interpolation {
            Interpolation::Discrete => step(real - before >= after - real),
            Interpolation::Floor => step(real >= after),
            Interpolation::Ceiling => step(real > before),
            Interpolation::Linear | Interpolation::CubicSpline => {
                let [below, above] = self.independent.extrapolates;
                let fraction = if real < *first && !below {
                    T::from(0.0)
                } else if real > *last && !above {
                    T::from(1.0)
                } else {
                    (x - before) / (after - before)
                };
                Place { index, fraction }
            }
        }
    }

    /// Weight of the value at breakpoint `point` in a spline.
    pub(super) fn spline_weight<T: Scalar>(&self, place: Place<T>, point: usize) -> T {
        let (index, b) = (place.index, place.fraction);
        let a = -b + 1.0;
        let mut weight = if point == index {
            a
        } else if point == index + 1 {
            b
        } else {
            T::from(0.0)
        };
        // Outside the breakpoints a straight line through the last two goes on.
        if (0.0..=1.0).contains(&b.real()) {
            let count = self.points.len();
            let width = self.points[index + 1] - self.points[index];
            let sixth = width * width / 6.0;
            weight = weight + (a * a * a - a) * (sixth * self.bending[index * count + point]);
            weight = weight + (b * b * b - b) * (sixth * self.bending[(index + 1) * count + point]);
        }
        weight
    }
}

/// Position of the breakpoint before `x`, so that one follows it; `points` has at least two.
pub(super) fn interval(points: &[f64], x: f64, hint: usize) -> usize {
    let most = points.len() - 2;
    let mut index = hint.min(most);
    // Mostly it is where it was, or beside it.
    for _ in 0..2 {
        if x < points[index] && index > 0 {
            index -= 1;
        } else if x >= points[index + 1] && index < most {
            index += 1;
        } else {
            return index;
        }
    }
    points.partition_point(|point| *point <= x).saturating_sub(1).min(most)
}

/// The matrix that turns values at the breakpoints into the second derivatives of a cubic spline there. Its ends are
/// free, but where the table is extrapolated they have the slope of the line through the last two values, as the
/// reference manual of DAVE-ML recommends.
fn bending(x: &[f64], extrapolates: [bool; 2]) -> Vec<f64> {
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // Each row: below, on and above the diagonal, and the right-hand side as a row over the values.
    let mut diagonal = vec![1.0; n];
    let mut above = vec![0.0; n];
    let mut below = vec![0.0; n];
    let mut right = vec![0.0; n * n];
    for i in 1..n - 1 {
        below[i] = h[i - 1] / 6.0;
        diagonal[i] = (h[i - 1] + h[i]) / 3.0;
        above[i] = h[i] / 6.0;
        right[i * n + i - 1] = 1.0 / h[i - 1];
        right[i * n + i] = -1.0 / h[i - 1] - 1.0 / h[i];
        right[i * n + i + 1] = 1.0 / h[i];
    }
    // The end slope equals the secant of the last interval: 2 M0 + M1 = 0 there.
    if extrapolates[0] {
        (diagonal[0], above[0]) = (2.0, 1.0);
    }
    if extrapolates[1] {
        (diagonal[n - 1], below[n - 1]) = (2.0, 1.0);
    }
    // Elimination of the tridiagonal system for all right-hand sides.
    for i in 1..n {
        let ratio = below[i] / diagonal[i - 1];
        diagonal[i] -= ratio * above[i - 1];
        for j in 0..n {
            right[i * n + j] -= ratio * right[(i - 1) * n + j];
        }
    }
    for i in (0..n).rev() {
        for j in 0..n {
            let after = if i + 1 < n { above[i] * right[(i + 1) * n + j] } else { 0.0 };
            right[i * n + j] = (right[i * n + j] - after) / diagonal[i];
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(points: &[f64], interpolation: Interpolation, extrapolates: [bool; 2]) -> Axis {
        let independent =
            Independent { variable: 0, interpolation, lower: f64::NEG_INFINITY, upper: f64::INFINITY, extrapolates };
        Axis::new(points.into(), 1, independent)
    }

    #[test]
    fn intervals_are_found_from_every_hint() {
        let points = [1.0, 3.0, 4.0, 6.0, 7.5, 9.0];
        for hint in 0..9 {
            for (x, index) in [(0.0, 0), (1.0, 0), (2.9, 0), (3.0, 1), (6.5, 3), (7.5, 4), (9.0, 4), (99.0, 4)] {
                assert_eq!(interval(&points, x, hint), index, "{x} from {hint}");
            }
        }
    }

    #[test]
    fn steps_change_where_the_standard_says() {
        let points = [1.0, 3.0, 4.0];
        let at = |interpolation, x: f64| axis(&points, interpolation, [false; 2]).locate(x, 0).index;
        for (x, discrete, floor, ceiling) in
            [(0.0, 0, 0, 0), (1.0, 0, 0, 0), (1.1, 0, 0, 1), (2.0, 1, 0, 1), (3.0, 1, 1, 1)]
        {
            assert_eq!(at(Interpolation::Discrete, x), discrete, "{x}");
            assert_eq!(at(Interpolation::Floor, x), floor, "{x}");
            assert_eq!(at(Interpolation::Ceiling, x), ceiling, "{x}");
        }
        for (x, discrete, floor, ceiling) in [(3.2, 1, 1, 2), (3.5, 2, 1, 2), (4.0, 2, 2, 2), (9.0, 2, 2, 2)] {
            assert_eq!(at(Interpolation::Discrete, x), discrete, "{x}");
            assert_eq!(at(Interpolation::Floor, x), floor, "{x}");
            assert_eq!(at(Interpolation::Ceiling, x), ceiling, "{x}");
        }
    }

    #[test]
    fn splines_are_smooth_and_end_as_recommended() {
        let (points, values) = ([1.0, 3.0, 4.0, 6.0, 7.5], [2.0, 6.0, 5.0, 7.0, 1.5]);
        for extrapolates in [[false, false], [true, true], [false, true]] {
            let axis = axis(&points, Interpolation::CubicSpline, extrapolates);
            let at = |x: f64| {
                let place = axis.locate(x, 2);
                (0..5).map(|point| axis.spline_weight(place, point) * values[point]).sum::<f64>()
            };
            let step = 1e-4;
            let slope = |x: f64| (at(x + step) - at(x - step)) / (2.0 * step);
            let curve = |x: f64| (at(x + step) - 2.0 * at(x) + at(x - step)) / (step * step);
            for (x, y) in points.iter().zip(values) {
                assert!((at(*x) - y).abs() < 1e-12);
            }
            for x in [3.0, 4.0, 6.0] {
                assert!((slope(x - 2.0 * step) - slope(x + 2.0 * step)).abs() < 1e-2);
                assert!((curve(x - 2.0 * step) - curve(x + 2.0 * step)).abs() < 1e-2);
            }
            if extrapolates[0] {
                assert!((slope(1.0 + step) - 2.0).abs() < 1e-2 && (at(0.0) - 0.0).abs() < 1e-12);
            } else {
                assert!(curve(1.0 + step).abs() < 1e-2 && (at(0.0) - 2.0).abs() < 1e-12);
            }
            if extrapolates[1] {
                assert!((slope(7.5 - step) + 5.5 / 1.5).abs() < 1e-2 && (at(9.0) + 4.0).abs() < 1e-12);
            } else {
                assert!(curve(7.5 - step).abs() < 1e-2 && (at(9.0) - 1.5).abs() < 1e-12);
            }
        }
    }
}
