//! Delaunay triangulation of points in the plane, by a sweep from left to right and flips of edges.
//!
//! The signs of all determinants are exact (crate `robust`), so the result is a triangulation whatever the points.

use core::cmp::Ordering;

use robust::{Coord, incircle, orient2d};

/// Marks a missing neighbour: outside the hull.
pub(super) const OUTSIDE: u32 = u32::MAX;

/// A triangulation of the convex hull of points.
#[derive(Clone, Debug, Default)]
pub(super) struct Triangulation {
    /// Corners, counter-clockwise.
    pub(super) corners: Vec<[u32; 3]>,
    /// The triangle across the edge from corner `k` to the next.
    pub(super) across: Vec<[u32; 3]>,
}

fn coordinate(point: [f64; 2]) -> Coord<f64> {
    Coord { x: point[0], y: point[1] }
}

/// Twice the area of the triangle, positive where it turns to the left; its sign is exact.
pub(super) fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    orient2d(coordinate(a), coordinate(b), coordinate(c))
}

impl Triangulation {
    /// Triangulates points; none where all lie on one line, two are the same, or coordinates are so large or so close
    /// together that determinants of them overflow or vanish.
    pub(super) fn of(points: &[[f64; 2]]) -> Option<Self> {
        let at = |index: u32| points[index as usize];
        let mut order: Vec<u32> = (0..u32::try_from(points.len()).ok()?).collect();
        order.sort_by(|a, b| at(*a)[0].total_cmp(&at(*b)[0]).then(at(*a)[1].total_cmp(&at(*b)[1])));
        if order.windows(2).any(|pair| at(pair[0]) == at(pair[1])) {
            return None;
        }
        // The points before `apex` lie on a line.
        let apex = (2..order.len()).find(|&k| area(at(order[0]), at(order[1]), at(order[k])) != 0.0)?;
        let left = area(at(order[0]), at(order[1]), at(order[apex])) > 0.0;
        let mut mesh = Self::default();
        // For each point on the hull the next one counter-clockwise, and the triangle at the edge between them.
        let mut hull = Hull {
            next: vec![OUTSIDE; points.len()],
            previous: vec![OUTSIDE; points.len()],
            edge: vec![(OUTSIDE, 0); points.len()],
        };
        let line = &order[..apex];
        let top = order[apex];
        for pair in line.windows(2) {
            let (from, to) = if left { (pair[0], pair[1]) } else { (pair[1], pair[0]) };
            let triangle = mesh.add([from, to, top]);
            hull.join(from, to, (triangle, 0));
            // Neighbours in the fan share an edge to the top.
            if triangle > 0 {
                let (own, other) = if left { (2, 1) } else { (1, 2) };
                mesh.link(triangle, own, triangle - 1, other);
            }
        }
        let (begin, end) = (line[0], line[apex - 1]);
        let last = mesh.corners.len() as u32 - 1;
        if left {
            hull.join(end, top, (last, 1));
            hull.join(top, begin, (0, 2));
        } else {
            hull.join(begin, top, (0, 1));
            hull.join(top, end, (last, 2));
        }
        let mut pending = Vec::new();
        for triangle in 0..=last {
            pending.extend((0..3).map(|edge| (triangle, edge)));
        }
        mesh.flip(points, &mut pending, &mut hull);
        let mut newest = top;
        for &point in &order[apex + 1..] {
            if !mesh.attach(points, point, newest, &mut hull, &mut pending) {
                return None;
            }
            mesh.flip(points, &mut pending, &mut hull);
            newest = point;
        }
        Some(mesh)
    }

    fn add(&mut self, corners: [u32; 3]) -> u32 {
        self.corners.push(corners);
        self.across.push([OUTSIDE; 3]);
        self.corners.len() as u32 - 1
    }

    fn link(&mut self, a: u32, edge_a: usize, b: u32, edge_b: usize) {
        self.across[a as usize][edge_a] = b;
        self.across[b as usize][edge_b] = a;
    }

    /// Joins a point right of all others to the edges of the hull that it sees. The newest point before it is the
    /// rightmost, so it is at one of them. Answers whether it sees any.
    fn attach(
        &mut self,
        points: &[[f64; 2]],
        point: u32,
        newest: u32,
        hull: &mut Hull,
        pending: &mut Vec<(u32, u8)>,
    ) -> bool {
        let at = |index: u32| points[index as usize];
        let sees = |from: u32, to: u32| area(at(from), at(to), at(point)) < 0.0;
        let (mut first, mut last) = (newest, newest);
        while sees(last, hull.next[last as usize]) {
            last = hull.next[last as usize];
            if last == newest {
                return false;
            }
        }
        while sees(hull.previous[first as usize], first) {
            first = hull.previous[first as usize];
            if first == newest {
                return false;
            }
        }
        let mut before: Option<u32> = None;
        let mut begin = None;
        let mut from = first;
        while from != last {
            let to = hull.next[from as usize];
            let (inside, edge) = hull.edge[from as usize];
            let triangle = self.add([to, from, point]);
            self.link(triangle, 0, inside, edge as usize);
            if let Some(before) = before {
                self.link(triangle, 1, before, 2);
            }
            pending.push((triangle, 0));
            begin.get_or_insert(triangle);
            before = Some(triangle);
            from = to;
        }
        if let (Some(begin), Some(end)) = (begin, before) {
            hull.join(first, point, (begin, 1));
            hull.join(point, last, (end, 2));
        }
        before.is_some()
    }

    /// Flips edges until no circle around a triangle contains the point across an edge.
    fn flip(&mut self, points: &[[f64; 2]], pending: &mut Vec<(u32, u8)>, hull: &mut Hull) {
        let at = |index: u32| coordinate(points[index as usize]);
        while let Some((triangle, edge)) = pending.pop() {
            let (t, e) = (triangle as usize, edge as usize);
            let other = self.across[t][e];
            if other == OUTSIDE {
                continue;
            }
            let o = other as usize;
            let Some(back) = self.across[o].iter().position(|back| *back == triangle) else { continue };
            let [a, b, c] = [0, 1, 2].map(|k| self.corners[t][(e + k) % 3]);
            let d = self.corners[o][(back + 2) % 3];
            // Of four points on a circle the first from the left keeps its edge, so that the order does not matter.
            let lies_inside = match incircle(at(a), at(b), at(c), at(d)).partial_cmp(&0.0) {
                Some(Ordering::Greater) => true,
                Some(Ordering::Equal) => leftmost(c, d, points) < leftmost(a, b, points),
                _ => false,
            };
            if !lies_inside {
                continue;
            }
            // Edge a-b becomes c-d: the triangles are c d b and d c a.
            let (bc, ca) = (self.across[t][(e + 1) % 3], self.across[t][(e + 2) % 3]);
            let (ad, db) = (self.across[o][(back + 1) % 3], self.across[o][(back + 2) % 3]);
            self.corners[t] = [c, d, b];
            self.across[t] = [other, db, bc];
            self.corners[o] = [d, c, a];
            self.across[o] = [triangle, ca, ad];
            for (neighbour, old, new) in [(db, other, triangle), (ca, triangle, other)] {
                if neighbour != OUTSIDE
                    && let Some(place) = self.across[neighbour as usize].iter_mut().find(|place| **place == old)
                {
                    *place = new;
                }
            }
            for (triangle, edge) in [(triangle, 1), (triangle, 2), (other, 1), (other, 2)] {
                if self.across[triangle as usize][edge as usize] == OUTSIDE {
                    hull.edge[self.corners[triangle as usize][edge as usize] as usize] = (triangle, edge);
                }
                pending.push((triangle, edge));
            }
        }
    }
}

/// Abscissas of the point further left of two, for a comparison.
fn leftmost(a: u32, b: u32, points: &[[f64; 2]]) -> [f64; 2] {
    let (a, b) = (points[a as usize], points[b as usize]);
    if a < b { a } else { b }
}

/// The boundary of a triangulation.
struct Hull {
    next: Vec<u32>,
    previous: Vec<u32>,
    /// Triangle and edge from a point to the next.
    edge: Vec<(u32, u8)>,
}

impl Hull {
    fn join(&mut self, from: u32, to: u32, edge: (u32, u8)) {
        self.next[from as usize] = to;
        self.previous[to as usize] = from;
        self.edge[from as usize] = edge;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// Every property that a Delaunay triangulation has.
    fn inspect(points: &[[f64; 2]]) {
        let mesh = Triangulation::of(points).unwrap();
        let at = |index: u32| points[index as usize];
        let mut boundary = 0;
        for (t, corners) in mesh.corners.iter().enumerate() {
            assert!(area(at(corners[0]), at(corners[1]), at(corners[2])) > 0.0);
            for point in points {
                let inside = incircle(
                    coordinate(at(corners[0])),
                    coordinate(at(corners[1])),
                    coordinate(at(corners[2])),
                    coordinate(*point),
                );
                assert!(inside <= 0.0, "triangle {t} has {point:?} in its circle");
            }
            for edge in 0..3 {
                let other = mesh.across[t][edge];
                if other == OUTSIDE {
                    boundary += 1;
                    let (from, to) = (at(corners[edge]), at(corners[(edge + 1) % 3]));
                    assert!(points.iter().all(|point| area(from, to, *point) >= 0.0), "the hull is convex");
                } else {
                    let back = mesh.across[other as usize].iter().position(|b| *b as usize == t).unwrap();
                    assert_eq!(mesh.corners[other as usize][back], corners[(edge + 1) % 3]);
                }
            }
        }
        // Euler's formula.
        assert_eq!(mesh.corners.len(), 2 * points.len() - 2 - boundary);
    }

    #[test]
    fn grids_and_scattered_points() {
        for (nx, ny) in [(2, 2), (2, 7), (7, 2), (9, 9)] {
            inspect(&(0..nx * ny).map(|k| [f64::from(k / ny), f64::from(k % ny)]).collect::<Vec<_>>());
            inspect(&(0..nx * ny).map(|k| [f64::from(k / ny), -f64::from(k % ny * k)]).collect::<Vec<_>>());
        }
        let mut state = 12345_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / 2_f64.powi(31)
        };
        for count in [3, 4, 5, 10, 50, 200] {
            inspect(&(0..count).map(|_| [random(), 100.0 * random()]).collect::<Vec<_>>());
            // First points on a line, and many on common circles.
            let mut points: Vec<[f64; 2]> = (0..count).map(|k| [0.0, f64::from(k)]).collect();
            points.extend((0..count).map(|k| [1.0 + f64::from(k % 3), -f64::from(k)]));
            inspect(&points);
        }
    }

    #[test]
    fn the_order_of_points_does_not_matter() {
        let points: Vec<[f64; 2]> = (0..30).map(|k| [f64::from(k / 6), f64::from(k % 6)]).collect();
        let edges = |points: &[[f64; 2]]| {
            let mesh = Triangulation::of(points).unwrap();
            let corners = mesh.corners.iter().map(|corners| {
                let mut corners = corners.map(|corner| points[corner as usize].map(|x| x as i32));
                corners.sort_unstable();
                corners
            });
            let mut corners: Vec<_> = corners.collect();
            corners.sort_unstable();
            corners
        };
        let mut turned = points.clone();
        turned.reverse();
        turned.swap(3, 17);
        assert_eq!(edges(&points), edges(&turned));
    }

    #[test]
    fn lines_and_repetitions_have_none() {
        assert!(Triangulation::of(&[]).is_none());
        assert!(Triangulation::of(&[[0.0, 0.0], [1.0, 1.0]]).is_none());
        assert!(Triangulation::of(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).is_none());
        assert!(Triangulation::of(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [1.0, 1.0]]).is_none());
    }
}
