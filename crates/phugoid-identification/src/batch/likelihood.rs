//! From residuals and sensitivities to cost, gradient and information.

use nalgebra::{DMatrix, DVector};

use super::layout::Place;
use super::response::Rows;

/// A cost with its derivatives at one point.
#[derive(Clone, Debug)]
pub(crate) struct Evaluation<T> {
    /// Negative logarithm of the likelihood and of the priors, without constants.
    pub(crate) cost: f64,
    /// Negative gradient of the cost: the direction in which it falls fastest.
    pub(crate) descent: DVector<f64>,
    /// Fisher information of the data and of the priors: the inverse of the covariance of the unknowns.
    pub(crate) information: DMatrix<f64>,
    /// What the cost was computed from.
    pub(crate) detail: T,
}

impl Evaluation<()> {
    /// No information on `n` unknowns.
    pub(crate) fn nothing(n: usize) -> Self {
        Self { cost: 0.0, descent: DVector::zeros(n), information: DMatrix::zeros(n, n), detail: () }
    }

    /// Starts from the priors alone.
    pub(crate) fn of_priors(places: &[Place], unknowns: &[f64]) -> Self {
        let mut this = Self::nothing(places.len());
        for (j, (place, value)) in places.iter().zip(unknowns).enumerate() {
            let weight = 1.0 / (place.prior_std * place.prior_std);
            let away = value - place.start;
            if weight > 0.0 {
                this.cost += 0.5 * weight * away * away;
                this.descent[j] -= weight * away;
                this.information[(j, j)] += weight;
            }
        }
        this
    }
}

impl<T> Evaluation<T> {
    /// With the cost of the data and what it was computed from.
    pub(crate) fn with<D>(self, cost: f64, detail: D) -> Evaluation<D> {
        Evaluation { cost: self.cost + cost, descent: self.descent, information: self.information, detail }
    }

    /// Adds the rows of one manoeuvre, already divided by one sigma: `sum w S^T nu` and `sum w S^T S` with the weights of
    /// their loss. The cost is left to the caller.
    pub(crate) fn add<const R: usize>(&mut self, rows: &Rows<R>) {
        self.add_of(rows, |_| true);
    }

    /// [`add`](Self::add) with the rows of the wanted outputs alone.
    pub(crate) fn add_of<const R: usize>(&mut self, rows: &Rows<R>, wanted: impl Fn(usize) -> bool) {
        let width = rows.columns.len();
        let mut information = DMatrix::<f64>::zeros(width, width);
        let mut descent = DVector::<f64>::zeros(width);
        for (k, residuals) in rows.residuals.iter().enumerate() {
            for (i, residual) in residuals.iter().enumerate().filter(|(i, e)| wanted(*i) && e.is_finite()) {
                let sensitivity = rows.sensitivity(k, i);
                let weight = rows.loss.weight(*residual);
                for b in 0..width {
                    let s = weight * sensitivity[b];
                    if s == 0.0 {
                        continue;
                    }
                    descent[b] += s * residual;
                    for a in 0..=b {
                        information[(a, b)] += sensitivity[a] * s;
                    }
                }
            }
        }
        for (b, &column) in rows.columns.iter().enumerate() {
            self.descent[column] += descent[b];
            for (a, &row) in rows.columns.iter().enumerate().take(b + 1) {
                self.information[(row, column)] += information[(a, b)];
                if a != b {
                    self.information[(column, row)] += information[(a, b)];
                }
            }
        }
    }
}
