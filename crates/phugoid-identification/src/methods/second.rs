//! A second answer: the same record by a method of another kind. Beside equation error, output error with measured air data and the
//! recursive regressions stands a filter, beside a filter equation error, and beside filter error and output error with simulated air
//! data both.
//!
//! Equation error and the regressions take the states as measured or smoothed, and solve each equation by itself. A filter weighs the measured states
//! against the motion that all equations make together. A sensor that is late, a term that the model lacks, or gusts bend the
//! two in different ways, and neither shows it in its own bounds.

use std::ops::Range;

use super::batch::{equations_of, surfaces_of};
use super::begin_again::{PartByEquations, begin_again};
use super::causal::run_causal;
use super::room::{EveryRoom, causal_run};
use super::task::{BySurfaces, ColumnRun, ModelError, Run, Task};
use crate::core::error::EstimateError;
use crate::core::estimation::{OtherValue, SecondAnswer, without_part};
use crate::core::method::Method;
use crate::core::options::{EstimateOptions, Opens};
use crate::model_file::{Parameter, Role};

/// The filter: it needs no settings, learns its noise, and takes a tenth of the time of filter error.
const FILTER: Method = Method::Smpe;

/// Nats by which a filter that found a change in flight has to predict the record better than one that takes the parameters for
/// constant, so that it is the one that stands beside a method. Of 55 flights of JSBSim with a damage or a trim shift in which the
/// filter adopts a change 54 gain 1,600 and more, of 19 without a change in which it adopts one six, which lack terms (docs/field.md).
const OF_A_CHANGE: f64 = 1000.0;

/// The parameters of the task's record by a filter that takes them for constant, as a method beside it does that looks for no change,
/// or those at the end by one that found a change in flight without which the record is predicted much worse: a change bends the first
/// as it bends the method.
///
/// # Errors
/// What the filter refuses the record or the model file for.
pub(super) fn by_filter<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
) -> Result<SecondAnswer, EstimateError> {
    let Task { prepared, file, noise, .. } = *task;
    let run = |looks: bool, model_error: ModelError| -> Result<Run<R>, EstimateError> {
        let options =
            EstimateOptions { method: Some(FILTER), change_detection: Some(looks), ..EstimateOptions::default() };
        let own = Task { model_error, ..Task::new(prepared, file, &options, noise) };
        let first = run_causal(&mut *causal_run(&own)?, &own, &mut |_| {})?;
        Ok(begin_again(&own, first).run)
    };
    let is_better = |changing: &Run<R>| {
        let stands = changing.changes.iter().any(|change| change.outcome.stands());
        // The levels of the two are learnt alike, so that the change alone is what they differ by.
        let same = stands.then(|| run(false, ModelError::Slow).ok()).flatten();
        same.is_some_and(|same| changing.evidence() - same.evidence() >= OF_A_CHANGE)
    };
    let looks = task.options.change_detection.unwrap_or(file.change_detection);
    let changing = looks.then(|| run(true, ModelError::Slow).ok()).flatten().filter(is_better);
    let run = match changing {
        Some(changing) => changing,
        None => run(false, ModelError::Free)?,
    };
    let is_derivative = |parameter: &&Parameter| !matches!(parameter.role, Role::Bias(_));
    let columns = file.estimated().zip(&run.columns).filter(|(parameter, _)| is_derivative(parameter));
    Ok(SecondAnswer { method: FILTER, values: columns.filter_map(|(p, column)| other(p, column)).collect() })
}

/// What stands beside the values of a causal method: equation error beside a filter, a filter beside a regression. `None` where
/// only what a live session would have had is asked for, where nothing moved, and beside a law without bounds. `known` is what equation
/// error has said of a part of the record already.
///
/// # Errors
/// Why the other method gives no answer.
pub(crate) fn beside_causal<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &Run<R>,
    known: Option<PartByEquations>,
) -> Option<Result<SecondAnswer, EstimateError>> {
    if task.options.causal_only || !run.excited {
        return None;
    }
    match task.method() {
        method if method.learns_noise() => Some(by_equations(task, run, known)),
        method if method.is_recursive_regression() => Some(by_filter(task)),
        _ => None,
    }
}

/// The parameters of the task's record by equation error, in the parts that the changes of the run make.
///
/// # Errors
/// Why the equations give no answer of the last part.
fn by_equations<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &Run<R>,
    mut known: Option<PartByEquations>,
) -> Result<SecondAnswer, EstimateError> {
    let values = over_parts(task, run, &mut |samples| match known.take_if(|known| known.samples == samples) {
        Some(known) => Ok(known.values),
        None => equations_of(task, samples),
    })?;
    Ok(SecondAnswer { method: Method::EquationError, values })
}

/// Standard errors of both from which what the surfaces made of the motion gives another derivative than a regression on all of it. By itself that
/// says little: it is asked beside the method's own difference (`judge::by_surfaces`).
const BENT: f64 = 2.0;

/// The parameters of the task's record from what the surfaces explain of the motion, in the parts that the changes of the run make; nothing
/// where that is not asked for, where nothing moved, beside further records, which these values do not know, and where it gives no answer.
pub(crate) fn by_surfaces<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &Run<R>,
) -> BySurfaces {
    if task.options.causal_only || !run.excited || !task.options.further.is_empty() {
        return BySurfaces::default();
    }
    let coefficient = |name: &str| {
        let parameter = task.file.estimated().find(|p| p.name == name)?;
        match &parameter.role {
            // Air that turns acts on the moments.
            Role::Term(coefficient, term) if coefficient.is_moment() && !term.is_constant() => Some(*coefficient),
            _ => None,
        }
    };
    let mut bent = Vec::new();
    let values = over_parts(task, run, &mut |samples| {
        let [values, regression] = surfaces_of(task, samples)?;
        let is_bent = |own: &OtherValue| {
            let whole = regression.iter().find(|whole| whole.name == own.name);
            whole.is_some_and(|whole| (own.value - whole.value).abs() > BENT * own.std_error.hypot(whole.std_error))
        };
        bent.extend(values.iter().filter(|own| is_bent(own)).filter_map(|own| coefficient(&own.name)));
        Ok(values)
    });
    // A check that the result can do without: of surfaces that do not tell the parameters apart it says nothing.
    values.map(|values| BySurfaces { values, bent }).unwrap_or_default()
}

/// What a method says of the task's record, from the samples since the last change of everything that stands in the
/// run: what it says is about the same aircraft as the estimates at the end. Where constants alone have changed since (a trim
/// shift), the flight is solved in parts between these times: derivatives are the means of the parts by their errors, as the filter
/// takes them to be the same, and constants those of the last part.
///
/// # Errors
/// Why the method gives no answer of the last part.
fn over_parts<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &Run<R>,
    solve: &mut dyn FnMut(Range<usize>) -> Result<Vec<OtherValue>, EstimateError>,
) -> Result<Vec<OtherValue>, EstimateError> {
    let prepared = task.prepared;
    let standing = || run.changes.iter().filter(|change| change.outcome.stands());
    let sample = |time_s: f64| prepared.time.partition_point(|t| *t < time_s);
    let everything = standing().filter(|change| change.opens == Opens::Everything).map(|change| change.time_s);
    let since_s = everything.reduce(f64::max).unwrap_or(f64::NEG_INFINITY);
    let mut ends: Vec<usize> = standing().map(|change| change.time_s).filter(|t| *t > since_s).map(sample).collect();
    ends.push(prepared.time.len());
    ends.sort_unstable();
    let mut first = sample(since_s);
    let mut before: Vec<Vec<OtherValue>> = Vec::with_capacity(ends.len());
    let mut last = Ok(Vec::new());
    for end in ends {
        before.extend(last.ok());
        last = solve(first..end);
        first = end;
    }
    let last = last?;
    let is_constant = |name: &str| task.file.estimated().any(|p| p.name == name && p.role.is_constant_term());
    let together = |value: OtherValue| if is_constant(&value.name) { value } else { mean(value, &before) };
    Ok(last.into_iter().map(together).collect())
}

/// Errors by which a value of an earlier part of the flight may differ from that of the last, so that both are taken for the same: what looking
/// back asks of a derivative that changed.
const SAME: f64 = 5.0;

/// The mean of a value and of those of the same name in other parts of the flight, by their errors; without parts in which it is another one.
fn mean(value: OtherValue, parts: &[Vec<OtherValue>]) -> OtherValue {
    let known = |v: &&OtherValue| v.value.is_finite() && v.std_error.is_finite() && v.std_error > 0.0;
    // Of no number nothing differs, and the others are left.
    let is_another = |v: &OtherValue| (v.value - value.value).abs() > SAME * v.std_error.hypot(value.std_error);
    let same = parts.iter().flatten().filter(|other| other.name == value.name && !is_another(other));
    let all: Vec<&OtherValue> = same.chain([&value]).filter(known).collect();
    let weight: f64 = all.iter().map(|v| v.std_error.powi(-2)).sum();
    let sum: f64 = all.iter().map(|v| v.value * v.std_error.powi(-2)).sum();
    if weight > 0.0 { OtherValue { value: sum / weight, std_error: weight.sqrt().recip(), ..value } } else { value }
}

/// A parameter without the part of its error that the model file declares: that is the same for both methods.
fn other(parameter: &Parameter, column: &ColumnRun) -> Option<OtherValue> {
    let random = without_part(column.corrected_std_error, column.systematic_std);
    let is_known = column.value.is_finite() && random.is_finite() && random > 0.0;
    is_known.then(|| OtherValue { name: parameter.name.clone(), value: column.value, std_error: random })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_flight_count_by_their_errors() {
        let of = |value: f64, std_error: f64| OtherValue { name: "Cm_q".to_owned(), value, std_error };
        let other = OtherValue { name: "Cm_alpha".to_owned(), value: 9.0, std_error: 0.01 };
        let found = mean(of(-10.0, 1.0), &[vec![of(-15.0, 0.5), other], vec![of(f64::NAN, 1.0)]]);
        assert!((found.value + 14.0).abs() < 1e-12 && (found.std_error - 0.2_f64.sqrt()).abs() < 1e-12, "{found:?}");
        assert_eq!(mean(of(-10.0, 1.0), &[]), of(-10.0, 1.0));
        // It is another one in the part before: eight errors.
        assert_eq!(mean(of(-10.0, 1.0), &[vec![of(-18.0, 0.1)]]), of(-10.0, 1.0));
        assert!(mean(of(f64::NAN, 1.0), &[]).value.is_nan());
    }
}
