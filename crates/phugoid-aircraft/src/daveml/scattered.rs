//! Ungridded tables of two independent variables: planes over the triangles between the points.

use std::sync::Arc;

use phugoid_flight_dynamics::scalar::Scalar;

use super::axis::Independent;
use super::delaunay::{OUTSIDE, Triangulation, area};

/// An ungridded table as one function uses it.
#[derive(Clone, Debug)]
pub(super) struct Scattered {
    pub(super) independents: [Independent; 2],
    pub(super) surface: Arc<Surface>,
}

/// Triangles between the points of a table, with their values.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub(super) points: Vec<[f64; 2]>,
    pub(super) values: Vec<f64>,
    mesh: Triangulation,
    /// Slopes of the plane over each triangle.
    slopes: Vec<[f64; 2]>,
    /// Edges of the hull: triangle and edge.
    hull: Vec<(u32, usize)>,
    /// Smallest and largest abscissa of each variable.
    bounds: [[f64; 2]; 2],
}

impl Scattered {
    /// The value at the given variables; NaN where one of them is. The search begins at the triangle `hint`.
    ///
    /// Outside the hull of the points the value is that at the nearest point of the hull, distances counted in ranges of
    /// the variables. Where a variable lies beyond all points on a side on which the function extrapolates, it is that of
    /// the plane at that nearest point instead.
    pub(super) fn value<T: Scalar>(&self, variables: &[T], hint: &mut u32) -> T {
        let surface = &*self.surface;
        let mut at = [0, 1].map(|k: usize| self.independents[k].limited(variables[self.independents[k].variable]));
        if at.iter().any(|x| x.real().is_nan()) {
            return T::from(f64::NAN);
        }
        let mut beyond = false;
        for k in 0..2 {
            let ([low, high], [below, above]) = (surface.bounds[k], self.independents[k].extrapolates);
            if at[k].real() < low {
                if below { beyond = true } else { at[k] = T::from(low) }
            } else if at[k].real() > high {
                if above { beyond = true } else { at[k] = T::from(high) }
            }
        }
        if let Some(triangle) = surface.find([at[0].real(), at[1].real()], *hint) {
            *hint = triangle;
            return surface.plane(triangle, at);
        }
        surface.outside(at, beyond)
    }
}

impl Surface {
    /// Most points: a triangulation may take a time that grows with their square.
    pub(super) const MAX_POINTS: usize = 20_000;

    /// A table of points with their values; none where the points span no triangle or two are the same.
    pub(super) fn new(points: Vec<[f64; 2]>, values: Vec<f64>) -> Option<Self> {
        let mesh = Triangulation::of(&points)?;
        let slopes = mesh.corners.iter().map(|corners| slopes(&points, &values, corners)).collect();
        let hull = mesh.across.iter().enumerate().flat_map(|(triangle, across)| {
            let open = across.iter().enumerate().filter(|(_, other)| **other == OUTSIDE);
            open.map(move |(edge, _)| (triangle as u32, edge))
        });
        let hull = hull.collect();
        let bounds = [0, 1].map(|k| {
            let start = [f64::INFINITY, f64::NEG_INFINITY];
            points.iter().fold(start, |[low, high], point| [low.min(point[k]), high.max(point[k])])
        });
        Some(Self { points, values, mesh, slopes, hull, bounds })
    }

    /// The plane over a triangle.
    fn plane<T: Scalar>(&self, triangle: u32, at: [T; 2]) -> T {
        let corner = self.mesh.corners[triangle as usize][0] as usize;
        let ([dx, dy], [x, y]) = (self.slopes[triangle as usize], self.points[corner]);
        (at[0] - x) * dx + (at[1] - y) * dy + self.values[corner]
    }

    /// The triangle that contains a point, walking from `hint`; none outside the hull.
    fn find(&self, at: [f64; 2], hint: u32) -> Option<u32> {
        let mut triangle = hint.min(self.mesh.corners.len() as u32 - 1);
        // The way through a Delaunay triangulation never returns to a triangle.
        for _ in 0..=self.mesh.corners.len() {
            let corners = self.mesh.corners[triangle as usize].map(|corner| self.points[corner as usize]);
            match (0..3).find(|&edge| area(corners[edge], corners[(edge + 1) % 3], at) < 0.0) {
                None => return Some(triangle),
                Some(edge) => triangle = self.mesh.across[triangle as usize][edge],
            }
            if triangle == OUTSIDE {
                return None;
            }
        }
        None
    }

    fn outside<T: Scalar>(&self, at: [T; 2], beyond: bool) -> T {
        let range = self.bounds.map(|[low, high]| high - low);
        let mut nearest = (f64::INFINITY, 0, T::from(f64::NAN));
        for &(triangle, edge) in &self.hull {
            let corners = self.mesh.corners[triangle as usize];
            let (from, to) = (corners[edge] as usize, corners[(edge + 1) % 3] as usize);
            let along = [0, 1].map(|k: usize| (self.points[to][k] - self.points[from][k]) / range[k]);
            let here = [0, 1].map(|k: usize| (at[k] - self.points[from][k]) / range[k]);
            let length = along[0] * along[0] + along[1] * along[1];
            let mut part = (here[0] * along[0] + here[1] * along[1]) / length;
            if part.real() < 0.0 {
                part = T::from(0.0);
            } else if part.real() > 1.0 {
                part = T::from(1.0);
            }
            let distance = [0, 1].map(|k: usize| here[k].real() - part.real() * along[k]);
            let distance = distance[0] * distance[0] + distance[1] * distance[1];
            if distance < nearest.0 {
                let value = part * (self.values[to] - self.values[from]) + self.values[from];
                nearest = (distance, triangle, value);
            }
        }
        if beyond { self.plane(nearest.1, at) } else { nearest.2 }
    }
}

fn slopes(points: &[[f64; 2]], values: &[f64], corners: &[u32; 3]) -> [f64; 2] {
    let [a, b, c] = corners.map(|corner| points[corner as usize]);
    let [za, zb, zc] = corners.map(|corner| values[corner as usize]);
    let twice = area(a, b, c);
    [
        ((zb - za) * (c[1] - a[1]) - (zc - za) * (b[1] - a[1])) / twice,
        ((zc - za) * (b[0] - a[0]) - (zb - za) * (c[0] - a[0])) / twice,
    ]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::daveml::axis::Interpolation;

    fn table(extrapolates: [bool; 2]) -> Scattered {
        let independent = |variable| Independent {
            variable,
            interpolation: Interpolation::Linear,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            extrapolates,
        };
        // A plane, whatever the triangles.
        let points = vec![[0.0, 0.0], [10.0, 0.0], [0.0, 2.0], [10.0, 2.0], [3.0, 1.0], [4.0, 0.5]];
        let values = points.iter().map(|[x, y]| 1.0 + 2.0 * x - 3.0 * y).collect();
        Scattered {
            independents: [independent(0), independent(1)],
            surface: Arc::new(Surface::new(points, values).unwrap()),
        }
    }

    #[test]
    fn a_plane_is_reproduced_inside_and_held_or_continued_outside() {
        for (extrapolates, beyond) in [([false; 2], [4.0, 1.0]), ([true; 2], [4.0, 3.0])] {
            let (table, mut hint) = (table(extrapolates), 0);
            for x in 0..=20 {
                for y in 0..=8 {
                    let at = [0.5 * f64::from(x), 0.25 * f64::from(y)];
                    let found = table.value(&at, &mut hint);
                    assert!((found - (1.0 + 2.0 * at[0] - 3.0 * at[1])).abs() < 1e-12, "{at:?}: {found}");
                }
            }
            let found = table.value(&[4.0, 3.0], &mut hint);
            let expected = if extrapolates[0] { 1.0 + 2.0 * beyond[0] - 3.0 * beyond[1] } else { 9.0 - 6.0 };
            assert!((found - expected).abs() < 1e-12, "{found}");
            assert!(table.value(&[f64::NAN, 1.0], &mut hint).is_nan());
        }
    }

    #[test]
    fn a_one_sided_limit_holds_on_that_side() {
        let (table, mut hint) = (table([false, true]), 0);
        assert!((table.value(&[-5.0, 1.0], &mut hint) - (1.0 - 3.0)).abs() < 1e-12);
        assert!((table.value(&[15.0, 1.0], &mut hint) - (1.0 + 30.0 - 3.0)).abs() < 1e-12);
    }
}
