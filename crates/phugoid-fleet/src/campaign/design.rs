//! Designs: which points of the unit cube are flown.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Deserialize;

use super::sobol;

/// The families of designs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Design {
    /// Every combination of the values of all factors. This is the default.
    #[default]
    Grid,
    /// Independent random numbers.
    Random,
    /// Latin hypercube: each factor takes each of `points` strata once.
    LatinHypercube,
    /// Sobol sequence, from its second point on (the first one is the corner). More points keep the earlier ones, so that a
    /// campaign can be made larger without flying anything twice; random designs have this too, Latin hypercubes do not.
    Sobol,
}

impl Design {
    /// Most factors of this design.
    pub const fn most_factors(self) -> usize {
        match self {
            Self::Sobol => sobol::DIMENSIONS,
            _ => 100,
        }
    }

    /// The design with this number of points in the unit cube of this number of dimensions.
    ///
    /// ```
    /// use phugoid_fleet::campaign::design::Design;
    /// let sobol = Design::Sobol.cube(2, 2, 1);
    /// assert_eq!([sobol.point(0), sobol.point(1)], [[0.5, 0.5], [0.75, 0.25]]);
    /// let cube = Design::LatinHypercube.cube(10, 1, 7);
    /// let mut strata: Vec<u32> = (0..10).map(|k| (10.0 * cube.point(k)[0]) as u32).collect();
    /// strata.sort();
    /// assert_eq!(strata, (0..10).collect::<Vec<u32>>());
    /// ```
    pub fn cube(self, points: u32, dimensions: usize, seed: u64) -> Cube {
        let mut generator = Pcg64Mcg::seed_from_u64(seed);
        let laid_out = match self {
            Self::LatinHypercube => {
                let column = |_| {
                    let mut strata: Vec<u32> = (0..points).collect();
                    strata.shuffle(&mut generator);
                    let mut within = |stratum| (f64::from(stratum) + generator.random::<f64>()) / f64::from(points);
                    strata.into_iter().map(&mut within).collect()
                };
                (0..dimensions).map(column).collect()
            }
            Self::Grid | Self::Random | Self::Sobol => Vec::new(),
        };
        Cube { design: self, dimensions, seed, laid_out }
    }
}

/// The points of a design. Each is computed when it is asked for, so that a million of them takes no memory; a Latin hypercube
/// alone, in which each point depends on all others, is kept whole.
#[derive(Clone, Debug)]
pub struct Cube {
    design: Design,
    dimensions: usize,
    seed: u64,
    /// Of a Latin hypercube the coordinates of all points, dimension by dimension.
    laid_out: Vec<Vec<f64>>,
}

impl Cube {
    /// The point of this number, from 0; each coordinate is 0 to 1 and 1 not included. A grid has none, since its points are
    /// made of its values, and a Latin hypercube has no more than it was made with: what is not there has no coordinates.
    pub fn point(&self, number: u32) -> Vec<f64> {
        match self.design {
            Design::Grid => Vec::new(),
            Design::Random => {
                // Each coordinate takes one step of the generator.
                let mut generator = Pcg64Mcg::seed_from_u64(self.seed);
                generator.advance(u128::from(number) * self.dimensions as u128);
                (0..self.dimensions).map(|_| generator.random()).collect()
            }
            Design::LatinHypercube => {
                self.laid_out.iter().filter_map(|column| column.get(number as usize).copied()).collect()
            }
            // Its first point is the corner, which is left out.
            Design::Sobol => {
                let number = number.saturating_add(1);
                (0..self.dimensions).map(|dimension| sobol::point(number, dimension)).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_designs_keep_the_points_of_smaller_ones() {
        for design in [Design::Random, Design::Sobol] {
            let (large, small) = (design.cube(40, 5, 3), design.cube(15, 5, 3));
            assert!((0..15).all(|k| large.point(k) == small.point(k)));
        }
        assert_ne!(Design::Random.cube(5, 2, 1).point(0), Design::Random.cube(5, 2, 2).point(0));
        assert!(Design::Grid.cube(4, 2, 1).point(0).is_empty());
    }

    /// A random point that is asked for by its number is the one that a generator comes to that draws all points before it.
    #[test]
    fn a_random_point_by_number_is_that_of_the_sequence() {
        let mut generator = Pcg64Mcg::seed_from_u64(7);
        let cube = Design::Random.cube(50, 3, 7);
        for k in 0..50 {
            let drawn: Vec<f64> = (0..3).map(|_| generator.random()).collect();
            assert_eq!(cube.point(k), drawn);
        }
    }
}
