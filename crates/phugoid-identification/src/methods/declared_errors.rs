//! What errors of the declared constants have done to the estimate of a causal method, and what the flight itself says of them.

use phugoid_estimators::Inspect;
use phugoid_estimators::supervisor::learnt::{LearningRule, Learnt};

use crate::core::systematic::ROOM_FOR_CONSTANTS;

/// The errors of the declared constants after a sample.
#[derive(Debug)]
pub(super) struct DeclaredErrors {
    /// Declared standard uncertainty of each constant of the motion.
    declared: Vec<f64>,
    /// Whether values and bounds contain what the flight says of them.
    learns: bool,
    /// By column in use.
    columns: Vec<ColumnErrors>,
}

/// A constant of which the flight itself says what it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LearntConstant {
    /// Its place among the constants of the motion.
    pub(crate) constant: usize,
    /// Its value, in the unit of its quantity.
    pub(crate) value: f64,
    /// Its standard uncertainty after the flight.
    pub(crate) std_error: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct ColumnErrors {
    /// What one declared standard uncertainty of each constant does, estimate less truth; none where that is not followed, or is not a
    /// number.
    effects: Option<[f64; ROOM_FOR_CONSTANTS]>,
    /// What is learnt adds to the estimate, and to the variance of its random part.
    shift: f64,
    variance: f64,
}

impl DeclaredErrors {
    /// Of constants with these declared standard uncertainties.
    pub(super) fn new(declared: Vec<f64>, learns: bool) -> Self {
        Self { declared, learns, columns: Vec::new() }
    }

    /// What the flight says so far, whether it is used or not.
    fn said<'a, E, const R: usize, const P: usize>(&self, estimator: &'a E) -> Option<Learnt<'a>>
    where
        E: Inspect<R, P> + ?Sized,
    {
        estimator.evidence()?.learn(&self.declared, &LearningRule::default())
    }

    /// What is used of it.
    fn used<'a, E, const R: usize, const P: usize>(&self, estimator: &'a E) -> Option<Learnt<'a>>
    where
        E: Inspect<R, P> + ?Sized,
    {
        if self.learns { self.said(estimator) } else { None }
    }

    /// The constants of which the flight says what they are, whether that is used or not.
    pub(super) fn told<E, const R: usize, const P: usize>(&self, estimator: &E) -> Vec<LearntConstant>
    where
        E: Inspect<R, P> + ?Sized,
    {
        let of = |(constant, value, std_error)| LearntConstant { constant, value, std_error };
        self.said(estimator).map_or_else(Vec::new, |said| said.constants().map(of).collect())
    }

    /// Looks at the estimator after a sample, with so many columns in use.
    pub(super) fn look<E, const R: usize, const P: usize>(&mut self, estimator: &E, columns: usize)
    where
        E: Inspect<R, P> + ?Sized,
    {
        let learnt = self.used(estimator);
        self.columns.clear();
        for column in 0..columns {
            let mut followed = ColumnErrors::default();
            if let Some(errors) = estimator.error_by_constant(column) {
                let own = learnt.as_ref().map(|learnt| (learnt, learnt.column(errors)));
                let error = |constant: usize, error: f64| match &own {
                    Some((learnt, own)) => learnt.error(own, constant, error),
                    None => error,
                };
                let mut effects = [0.0; ROOM_FOR_CONSTANTS];
                for (k, (effect, std)) in effects.iter_mut().zip(&self.declared).enumerate() {
                    // The errors are those of the truth against the estimate.
                    *effect = -error(k, errors.get(k).copied().unwrap_or(0.0)) * std;
                }
                followed.effects = effects.iter().all(|effect| effect.is_finite()).then_some(effects);
                let own = own.map(|(_, own)| own).filter(|own| own.shift.is_finite() && own.variance.is_finite());
                if let (Some(own), Some(_)) = (own, &followed.effects) {
                    (followed.shift, followed.variance) = (own.shift, own.variance);
                }
            }
            self.columns.push(followed);
        }
    }

    /// What one declared standard uncertainty of each constant does to a column, estimate less truth; none where the errors are not
    /// followed, or are not numbers.
    pub(super) fn effects(&self, column: usize) -> Option<&[f64]> {
        self.columns.get(column)?.effects.as_ref()?.get(..self.declared.len())
    }

    /// What is learnt adds to the estimate of a column.
    pub(super) fn shift(&self, column: usize) -> f64 {
        self.columns.get(column).map_or(0.0, |column| column.shift)
    }

    /// What is learnt adds to the random part of the standard error of a column, as a standard deviation.
    pub(super) fn noise_std(&self, column: usize) -> f64 {
        self.columns.get(column).map_or(0.0, |column| column.variance.max(0.0).sqrt())
    }

    /// Adds what is learnt to the covariance of the columns in use.
    pub(super) fn widen<E, const R: usize, const P: usize>(&self, estimator: &E, covariance: &mut [Vec<f64>])
    where
        E: Inspect<R, P> + ?Sized,
    {
        let Some(learnt) = self.used(estimator) else { return };
        let columns: Vec<_> = (0..covariance.len())
            .map(|column| estimator.error_by_constant(column).map(|errors| learnt.column(errors)))
            .collect();
        for (row, own) in covariance.iter_mut().zip(&columns) {
            for (entry, other) in row.iter_mut().zip(&columns) {
                if let (Some(own), Some(other)) = (own, other) {
                    *entry += learnt.covariance(own, other);
                }
            }
        }
    }
}
