//! The systematic part of the result of a batch method, and of a recursive regression over a record: what it makes of errors of the
//! declared constants. The filters follow them in flight ([`super::declared_errors`]).

use super::batch::manoeuvre;
use super::causal::run_causal;
use super::gate::DisplacedConstant;
use super::room::{EveryRoom, causal_run};
use super::task::{Run, Task};
use crate::batch::{
    BatchFit, ByConstant, EquationErrorSettings, Manoeuvre, Structure, cleared, equation_error_constants,
    equation_error_frequency_constants, filter_error_constants, output_error_constants,
    output_error_frequency_constants,
};
use crate::core::estimation::without_part;
use crate::core::method::Method;
use crate::core::options::{Band, CAPACITY};
use crate::core::systematic::{ByQuantity, ROOM_FOR_CONSTANTS, SystematicPart};
use crate::model_file::Role;
use crate::motion::{MotionModel, declared};
use crate::preparation::prepared::Prepared;

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

/// Follows the constants through a recursive regression over its whole record, and puts what they do in the place of the powers of the
/// scales, which it carried in flight: at the end, and by sample since something has moved. The regression is run again for every
/// declared constant, with the constant off by one sigma in the equations, and taken out of what is shown of the states.
/// Where a run fails, where nothing is declared, and of another method, the bounds stay as they are; the verdict says which of the two
/// they hold.
pub(crate) fn follow_regression<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &mut Run<R>,
    progress: &mut dyn FnMut(f64),
) {
    if !is_run_again(task) || !run.excited {
        return;
    }
    let Some(followed) = by_runs(task, run, progress) else { return };
    let moved = run.first_moved();
    let by_powers = task.prepared.by_powers(task.file);
    for ((column, by_powers), followed) in run.columns.iter_mut().zip(by_powers).zip(&followed) {
        let std = followed.std();
        for (whole, value) in column.std_errors.iter_mut().zip(&column.values).skip(moved) {
            *whole = without_part(*whole, by_powers.std(*value)).hypot(std);
        }
        column.corrected_std_error = without_part(column.corrected_std_error, column.systematic_std).hypot(std);
        (column.systematic_std, column.systematic_parts) = (std, followed.parts());
    }
    run.follows_constants = true;
}

/// Whether the method of a task is run again for each constant: what a live session would have had has the powers.
pub(crate) fn is_run_again<M: EveryRoom<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>) -> bool {
    task.method().is_recursive_regression() && task.declares_constants() && !task.options.causal_only
}

/// What the constants do to each column of a run by runs in which one of them is off; none where one of these fails.
fn by_runs<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &Run<R>,
    progress: &mut dyn FnMut(f64),
) -> Option<Vec<ByQuantity>> {
    let Task { prepared, file, options, noise, .. } = *task;
    let mut theta = [0.0; CAPACITY];
    let own = file.estimated().zip(&run.columns).filter(|(parameter, _)| !matches!(parameter.role, Role::Bias(_)));
    theta.iter_mut().zip(own).for_each(|(value, (_, column))| *value = column.value);
    let mut all = vec![ByQuantity::default(); run.columns.len()];
    for (constant, (size, quantity)) in declared::<M, N, R>(file).into_iter().zip(M::CONSTANTS).enumerate() {
        progress(constant as f64 / M::CONSTANTS.len() as f64);
        if size == 0.0 {
            continue;
        }
        let outputs = cleared(&manoeuvre::<M, N, R>("the record", prepared), (constant, size), &theta);
        let shown = Prepared { outputs, ..prepared.clone() };
        let displaced = DisplacedConstant { constant, size, theta };
        let own = Task { displaced: Some(&displaced), ..Task::new(&shown, file, options, noise) };
        let with = run_causal(&mut *causal_run(&own).ok()?, &own, &mut |_| {}).ok()?;
        for ((all, with), without) in all.iter_mut().zip(&with.columns).zip(&run.columns) {
            all.add(*quantity, without.value - with.value);
        }
    }
    all.iter().all(|of_one| of_one.std().is_finite()).then_some(all)
}
