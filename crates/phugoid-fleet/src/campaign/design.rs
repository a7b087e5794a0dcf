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

    /// `points` points in the unit cube of this number of dimensions, each coordinate 0 to 1 and 1 not included; none for a
    /// grid, whose points are made of its values.
    ///
    /// ```
    /// use phugoid_fleet::campaign::design::Design;
    /// assert_eq!(Design::Sobol.points(2, 2, 1), [[0.5, 0.5], [0.75, 0.25]]);
    /// let cube = Design::LatinHypercube.points(10, 1, 7);
    /// let mut strata: Vec<u32> = cube.iter().map(|point| (10.0 * point[0]) as u32).collect();
    /// strata.sort();
    /// assert_eq!(strata, (0..10).collect::<Vec<u32>>());
    /// ```
    pub fn points(self, points: u32, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut generator = Pcg64Mcg::seed_from_u64(seed);
        let count = points as usize;
        match self {
            Self::Grid => Vec::new(),
            Self::Random => (0..count).map(|_| (0..dimensions).map(|_| generator.random()).collect()).collect(),
            Self::LatinHypercube => {
                let mut cube = vec![vec![0.0; dimensions]; count];
                for dimension in 0..dimensions {
                    let mut strata: Vec<u32> = (0..points).collect();
                    strata.shuffle(&mut generator);
                    for (point, stratum) in cube.iter_mut().zip(strata) {
                        let within: f64 = generator.random();
                        point[dimension] = (f64::from(stratum) + within) / f64::from(points);
                    }
                }
                cube
            }
            Self::Sobol => (1..=points).map(|k| (0..dimensions).map(|d| sobol::point(k, d)).collect()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_designs_keep_the_points_of_smaller_ones() {
        for design in [Design::Random, Design::Sobol] {
            assert_eq!(design.points(40, 5, 3)[..15], design.points(15, 5, 3));
        }
        assert_ne!(Design::Random.points(5, 2, 1), Design::Random.points(5, 2, 2));
        assert!(Design::Grid.points(4, 2, 1).is_empty());
    }
}
