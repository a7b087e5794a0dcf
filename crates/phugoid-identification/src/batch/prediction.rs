//! Prediction: the estimated parameters on a record that they have not seen.

use crate::core::options::CAPACITY;
use phugoid_estimators::{Input, Model};

use super::error::BatchError;
use super::optimise::OptimiserSettings;
use super::output_error::output_error;
use super::problem::{Manoeuvre, Structure};
use super::result::BatchFit;

/// Simulates other manoeuvres with `parameters` held (all of the model, in its order); only their initial states and
/// biases are fitted. The remaining residuals are what the model does not explain: [`super::OutputFit`] says how much
/// that is (Klein & Morelli, section 5.3; Jategaonkar, chapter 11).
///
/// # Errors
/// [`BatchError`], as [`output_error`].
pub fn predict<M, I, const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, M, I, N, R>],
    structure: &Structure<N, R>,
    parameters: &[f64],
    settings: &OptimiserSettings,
) -> Result<BatchFit, BatchError>
where
    M: Model<N, R, CAPACITY, Input = I>,
    I: Input,
{
    if parameters.len() != structure.parameters.len() {
        return Err(BatchError::BadInput(format!(
            "{} parameters were given for a prediction, the structure has {}",
            parameters.len(),
            structure.parameters.len()
        )));
    }
    let mut held = structure.clone();
    for (p, value) in held.parameters.iter_mut().zip(parameters) {
        (p.start, p.fixed) = (*value, true);
        (p.lower, p.upper) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    output_error(manoeuvres, &held, settings)
}
