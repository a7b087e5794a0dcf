//! The systematic part of the result of a batch method: what it makes of errors of the declared constants.

use super::gate::{Gated, GatedInput, SurfaceRates};
use super::task::Task;
use crate::batch::{
    BatchFit, ByConstant, EquationErrorSettings, Manoeuvre, Structure, equation_error_constants, output_error_constants,
};
use crate::core::method::Method;
use crate::core::options::CAPACITY;
use crate::core::systematic::{ROOM_FOR_CONSTANTS, SystematicPart, UncertainQuantity, shares};
use crate::motion::MotionModel;
use crate::preparation::excitation::Moved;
use crate::preparation::prepared::Prepared;

/// Variances by quantity of each parameter of a structure.
#[derive(Clone, Debug)]
pub(super) struct Systematic {
    /// One entry per parameter of the structure, in the order of [`UncertainQuantity::ALL`].
    variances: Vec<[f64; UncertainQuantity::ALL.len()]>,
}

impl Systematic {
    /// One sigma of the systematic part of a parameter, and what makes it.
    pub(super) fn of(&self, position: usize) -> Option<(f64, Vec<SystematicPart>)> {
        let variances = self.variances.get(position)?;
        Some((variances.iter().sum::<f64>().sqrt(), shares(variances)))
    }
}

/// A record as the methods that follow constants take it: the input knows how fast the surfaces move.
struct Flight<M, I> {
    model: Gated<M>,
    inputs: Vec<GatedInput<I>>,
}

/// Follows the constants of the motion through output error or equation error, one record after the other as they were fitted.
/// For a task that [follows constants](Task::follows_constants). None where it does not work out: a simulation with a constant
/// off by one sigma diverges, or the equations of a step are singular.
pub(super) fn systematic<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    records: &[&Prepared<M, N, R>],
    manoeuvres: &[Manoeuvre<'_, M, M::KnownInput, N, R>],
    structure: &Structure<N, R>,
    regression: &EquationErrorSettings,
    fit: &BatchFit,
) -> Option<Systematic> {
    let (file, method) = (task.file, task.method());
    let flight = |prepared: &&Prepared<M, N, R>| -> Flight<M, M::KnownInput> {
        let mut rates = SurfaceRates::default();
        let rated = |(time_s, input): (&f64, &M::KnownInput)| GatedInput {
            input: *input,
            open: Moved::ALL,
            surface_rates: rates.at(*time_s, M::deflections(input)),
        };
        let inputs = prepared.time.iter().zip(&prepared.inputs).map(rated).collect();
        Flight { model: Gated::new(prepared.model.clone(), file), inputs }
    };
    let flights: Vec<Flight<M, M::KnownInput>> = records.iter().map(flight).collect();
    let rated: Vec<Manoeuvre<'_, Gated<M>, GatedInput<M::KnownInput>, N, R>> = manoeuvres
        .iter()
        .zip(&flights)
        .map(|(m, flight)| Manoeuvre {
            name: m.name,
            model: &flight.model,
            time_s: m.time_s,
            inputs: &flight.inputs,
            hold: m.hold,
            outputs: m.outputs,
            initial_state: m.initial_state,
        })
        .collect();
    let mut sigmas: ByConstant = [0.0; ROOM_FOR_CONSTANTS];
    for (sigma, quantity) in sigmas.iter_mut().zip(M::CONSTANTS) {
        *sigma = file.uncertainty.of_quantity(*quantity);
    }
    let by_parameter = match method {
        Method::OutputError => output_error_constants(&rated, structure, fit, &sigmas)?,
        _ => equation_error_constants(&rated, structure, regression, fit, &sigmas)?,
    };
    let variances = |errors: &ByConstant| {
        let mut variances = [0.0; UncertainQuantity::ALL.len()];
        for ((error, sigma), quantity) in errors.iter().zip(&sigmas).zip(M::CONSTANTS) {
            variances[*quantity as usize] += (error * sigma).powi(2);
        }
        variances
    };
    let variances: Vec<_> = by_parameter.iter().map(variances).collect();
    variances.iter().flatten().all(|variance| variance.is_finite()).then_some(Systematic { variances })
}
