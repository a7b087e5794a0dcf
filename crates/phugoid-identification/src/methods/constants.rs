//! The systematic part of the result of a batch method: what it makes of errors of the declared constants.

use super::task::Task;
use crate::batch::{
    BatchFit, ByConstant, EquationErrorSettings, Manoeuvre, Structure, equation_error_constants,
    equation_error_frequency_constants, filter_error_constants, output_error_constants,
    output_error_frequency_constants,
};
use crate::core::method::Method;
use crate::core::options::{Band, CAPACITY};
use crate::core::systematic::{ByQuantity, ROOM_FOR_CONSTANTS, SystematicPart};
use crate::motion::{MotionModel, declared};

/// The systematic errors of the parameters of a structure, one entry per parameter.
#[derive(Clone, Debug)]
pub(super) struct Systematic(Vec<ByQuantity>);

impl Systematic {
    /// One sigma of the systematic part of a parameter, and what makes it.
    pub(super) fn of(&self, position: usize) -> Option<(f64, Vec<SystematicPart>)> {
        let all = self.0.get(position)?;
        Some((all.std(), all.parts()))
    }
}

/// Follows the constants of the motion through a batch method, over the manoeuvres that were fitted; `band`: of the methods that have one.
/// For a task that [follows constants](Task::follows_constants). None where it does not work out: a simulation or a filter with a constant
/// off by one sigma diverges, or the equations of a step are singular.
pub(super) fn systematic<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    (regression, band): (&EquationErrorSettings, Option<Band>),
    fit: &BatchFit,
) -> Option<Systematic> {
    let mut sigmas: ByConstant = [0.0; ROOM_FOR_CONSTANTS];
    for (sigma, declared) in sigmas.iter_mut().zip(declared::<M, N, R>(task.file)) {
        *sigma = declared;
    }
    let by_parameter = match (task.method(), band) {
        (Method::OutputError, _) => output_error_constants(manoeuvres, structure, fit, &sigmas)?,
        (Method::OutputErrorFrequency, Some(band)) => {
            output_error_frequency_constants(manoeuvres, structure, band, fit, &sigmas)?
        }
        (Method::FilterError, _) => filter_error_constants(manoeuvres, structure, fit, &sigmas)?,
        (Method::EquationErrorFrequency, Some(band)) => {
            equation_error_frequency_constants(manoeuvres, structure, (band, regression), fit, &sigmas)?
        }
        _ => equation_error_constants(manoeuvres, structure, regression, fit, &sigmas)?,
    };
    let by_quantity = |errors: &ByConstant| {
        let mut all = ByQuantity::default();
        for ((error, sigma), quantity) in errors.iter().zip(&sigmas).zip(M::CONSTANTS) {
            // The errors are those of the truth against what was found.
            all.add(*quantity, -error * sigma);
        }
        all
    };
    let all: Vec<_> = by_parameter.iter().map(by_quantity).collect();
    all.iter().all(|of_one| of_one.std().is_finite()).then_some(Systematic(all))
}
