//! Sums of products of the regressors of an equation of motion over some blocks of a flight: what they tell of its terms.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::judge::equations::{ByBlock, OWN};

/// Added to the diagonal of regressors of unit length, so that one that does not move has no value in place of any.
const RIDGE: f64 = 1e-9;

/// Sums of products of one group of blocks: of the regressors, and of them with the left side.
#[derive(Clone)]
pub(crate) struct Normal {
    gram: DMatrix<f64>,
    right: DVector<f64>,
    samples: f64,
}

impl Normal {
    /// The sums of an equation, so many blocks together.
    pub(crate) fn groups(equation: &ByBlock, together: usize) -> Vec<Self> {
        let u = equation.used.len();
        let of = |block: &DMatrix<f64>, samples: f64| {
            let gram = block.view((0, 0), (u, u)).into_owned();
            // The left side is what the values explain and the residual.
            let right = &gram * DVector::from_row_slice(&equation.values) + block.view((0, u), (u, 1)).column(0);
            Self { gram, right, samples }
        };
        let blocks: Vec<Self> =
            equation.sums.iter().zip(&equation.samples).map(|(block, samples)| of(block, *samples)).collect();
        blocks.chunks(together).map(|blocks| Self::sum(u, blocks)).collect()
    }

    /// The sums of all parts, of `u` regressors.
    pub(crate) fn sum(u: usize, parts: &[Self]) -> Self {
        let zeros = Self { gram: DMatrix::zeros(u, u), right: DVector::zeros(u), samples: 0.0 };
        parts.iter().fold(zeros, |sum, part| sum.plus(part, 1.0))
    }

    /// With another one added, or taken away (`sign` -1).
    pub(crate) fn plus(&self, other: &Self, sign: f64) -> Self {
        Self {
            gram: &self.gram + &other.gram * sign,
            right: &self.right + &other.right * sign,
            samples: self.samples + sign * other.samples,
        }
    }

    /// One over the length of each regressor, and the Cholesky factors of the sums with regressors of unit length; `None`
    /// where they cannot be told apart.
    fn factors(&self) -> Option<(DVector<f64>, Cholesky<f64, Dyn>)> {
        let u = self.right.len();
        let length = |a: usize| self.gram[(a, a)].sqrt();
        let scale = DVector::from_fn(u, |a, _| if length(a) > 0.0 { length(a).recip() } else { 0.0 });
        let ridge = |a: usize, b: usize| if a == b { RIDGE } else { 0.0 };
        let scaled = DMatrix::from_fn(u, u, |a, b| scale[a] * self.gram[(a, b)] * scale[b] + ridge(a, b));
        Some((scale, scaled.cholesky()?))
    }

    /// The values of the terms by least squares; `None` where they cannot be told apart.
    pub(crate) fn solve(&self) -> Option<DVector<f64>> {
        let (scale, factors) = self.factors()?;
        let solved = factors.solve(&self.right.component_mul(&scale)).component_mul(&scale);
        solved.iter().all(|v| v.is_finite()).then_some(solved)
    }

    /// The mean square of each regressor that the others do not share.
    pub(crate) fn motion(&self) -> Option<DVector<f64>> {
        let (scale, factors) = self.factors()?;
        let inverse = factors.inverse();
        let own = |a: usize| 1.0 / (inverse[(a, a)] * scale[a] * scale[a] * self.samples);
        let told = |a: usize| scale[a] > 0.0 && inverse[(a, a)] * OWN < 1.0;
        Some(DVector::from_fn(self.right.len(), |a, _| if told(a) { own(a) } else { 0.0 }))
    }
}
