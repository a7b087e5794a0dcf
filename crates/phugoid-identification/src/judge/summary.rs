//! From a run to the result that is printed, plotted and saved, with the verdict in words.

use phugoid_flight_data::plausibility::Doubt;
use phugoid_flight_data::quality::{Finding, QualityReport};
use phugoid_flight_data::record::Record;

use crate::core::axes::Axes;
use crate::core::correlation::correlation;
use crate::core::estimation::{
    AdoptedChange, ChangeOutcome, ChangedParameter, Estimation, FinalStatus, History, OutputConsistency,
    ParameterHistory, ParameterResult, Signal, status_of,
};
use crate::core::options::{EstimateOptions, Opens};
use crate::core::output::Output;
use crate::judge::effective::{effective, sentence};
use crate::judge::equations::Equations;
use crate::judge::offer::Missing;
use crate::judge::readiness::readiness;
use crate::judge::reasons::{demote, reasons};
use crate::judge::total::totals;
use crate::judge::verdict::verdict;
use crate::methods::{ColumnRun, EveryRoom, Run, RunChange, Task};
use crate::model_file::{ModelFile, Parameter};
use crate::motion::Motion;

/// The result of a run. `missing`: what is known of a term that the model lacks.
pub(crate) fn summarise<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    record: &Record,
    task: &Task<M, N, R>,
    run: &Run<R>,
    doubts: &[Doubt],
    missing: Option<Missing>,
) -> Estimation {
    let Task { prepared, file, options, noise, .. } = *task;
    let columns = columns(file);
    let start_s = options.start_s.or(record.time.first().copied()).unwrap_or_default();
    let mut parameters: Vec<ParameterResult> =
        columns.iter().map(|(p, column)| result(p, *column, &prepared.time, start_s, &run.columns, options)).collect();
    let estimated: Vec<&Parameter> = file.estimated().collect();
    for (result, (_, column)) in parameters.iter_mut().zip(&columns).filter(|_| run.batch.is_none()) {
        result.readiness = column.map(|j| readiness(j, &run.columns[j].verdict, &estimated, &file.extra_inputs));
    }
    let correlation = correlation_of(&columns, &run.covariance);
    let history = history(task, &columns, run);
    if run.batch.is_some() {
        // A batch method uses all samples at once: there is no time of convergence.
        parameters.iter_mut().for_each(|p| p.converged_at_s = None);
    }
    // The residuals of equation error are not the noise of sensors.
    let found = run.batch.as_ref().filter(|_| !task.method().is_equation_error()).map(|b| &b.noise_std);
    let learnt = run.noise.as_ref().map(|learnt| learnt.std[..].to_vec());
    let found = found.or(learnt.as_ref());
    let std = |row: usize| found.and_then(|std| std.get(row)).copied().unwrap_or(noise[row].std);
    let noise_signals = measured(file).map(|(row, o)| signal(o.name(), o.unit(), vec![std(row)])).collect();
    let effective = effective(&mut parameters, &correlation, file);
    let equations = if run.excited { Equations::of(task, run) } else { None };
    let mut reasons = reasons(task, record, &parameters, &correlation, run, doubts, &history, equations.as_ref());
    let mut changes = changes(&columns, run);
    if let Some(Missing { reason, explains, explains_changes }) = missing {
        let standing = changes.iter_mut().filter(|change| change.outcome.stands());
        for change in standing.filter(|change| explains_changes.contains(&change.time_s)) {
            change.outcome = ChangeOutcome::ExplainedByTerm;
        }
        reasons.retain(|reason| !explains.contains(&reason.code));
        reasons.push(reason);
    }
    reasons.sort_by_key(|reason| std::cmp::Reverse(reason.status));
    demote(&mut parameters, &reasons);
    let totals = totals(prepared, file, &parameters);
    let mut verdict = verdict(task, &parameters, &correlation, run, &reasons, &history, &changes);
    if run.excited {
        verdict.extend(effective.iter().map(sentence));
    }
    Estimation {
        source: record.source.clone(),
        model: file.source.clone(),
        method: task.method(),
        parameters,
        learnt: run.learnt.clone(),
        correlation,
        effective,
        totals,
        alpha_reference: prepared.reference.alpha,
        offer: None,
        status: status_of(&reasons),
        reasons,
        verdict,
        events: run.events.clone(),
        changes,
        quality: with_deletions_of_others(without(&record.quality, doubts), options),
        noise: noise_signals,
        consistency: consistency(file, run),
        history,
        batch: run.batch.clone(),
        second_answer: run.second_answer.clone(),
        third_answer: run.third_answer.clone(),
        by_surfaces: run.by_surfaces.values.clone(),
    }
}

/// How the measured outputs agreed with their predictions, by name; empty for a batch method.
fn consistency<const R: usize>(file: &ModelFile, run: &Run<R>) -> Vec<OutputConsistency> {
    let of = |(row, output): (usize, Output)| {
        let found = run.consistency.get(row)?;
        Some(OutputConsistency {
            name: output.name().to_owned(),
            mean_square: found.mean_square.is_finite().then_some(found.mean_square),
            longest_rejected_s: found.longest_rejected_s,
        })
    };
    measured(file).filter_map(of).collect()
}

/// The adopted changes, by name of the parameters.
fn changes<const R: usize>(columns: &[(&Parameter, Option<usize>)], run: &Run<R>) -> Vec<AdoptedChange> {
    let of = |change: &RunChange| AdoptedChange {
        time_s: change.time_s,
        interval_s: change.interval_s,
        opens: change.opens,
        outcome: change.outcome,
        parameters: columns
            .iter()
            .filter_map(|(parameter, column)| {
                let j = (*column)?;
                if change.opens == Opens::Constants && !parameter.role.is_constant_term() {
                    return None;
                }
                Some(ChangedParameter {
                    name: parameter.name.clone(),
                    before: change.before.value(j)?,
                    before_std: change.before.std(j)?,
                    after: change.after.value(j)?,
                    after_std: change.after.std(j)?,
                    difference_std: change.before.difference_std(&change.after, j)?,
                    random_std: change.before.random_std(&change.after, j)?,
                })
            })
            .collect(),
    };
    run.changes.iter().map(of).collect()
}

/// The findings, with what was deleted of the other flights that the result is made of.
fn with_deletions_of_others(mut quality: QualityReport, options: &EstimateOptions) -> QualityReport {
    let own = quality.deletions.clone();
    for other in options.further.iter().chain(&options.predict) {
        // Another manoeuvre of the same flight has its deletions too.
        for deleted in other.quality.deletions.iter().filter(|deleted| !own.contains(deleted)) {
            for sentence in deleted.sentences() {
                quality.warn(other.source.as_str(), sentence);
            }
        }
    }
    quality
}

/// The findings of the reader without those that the verdict, or a list of doubts, repeats.
pub(crate) fn without(quality: &QualityReport, doubts: &[Doubt]) -> QualityReport {
    // The reader saw the whole flight, the estimation perhaps a part of it: the same finding with other numbers.
    let words = |text: &str| -> String { text.chars().filter(|c| c.is_alphabetic()).collect() };
    let is_told = |f: &Finding| doubts.iter().any(|d| d.place() == f.place && words(&d.message) == words(&f.message));
    let mut quality = quality.clone();
    quality.findings.retain(|finding| !is_told(finding));
    quality
}

/// Parameters of the file, nuisance columns last, each with its column in the estimator; none for a fixed one.
fn columns(file: &ModelFile) -> Vec<(&Parameter, Option<usize>)> {
    let mut next = 0;
    let mut columns: Vec<(&Parameter, Option<usize>)> = Vec::new();
    for parameter in &file.parameters {
        let column = (!parameter.fixed).then(|| {
            next += 1;
            next - 1
        });
        columns.push((parameter, column));
    }
    columns.sort_by_key(|(p, _)| p.is_nuisance());
    columns
}

/// Measured outputs with their positions in the output vector.
fn measured(file: &ModelFile) -> impl Iterator<Item = (usize, Output)> {
    file.axes.outputs().iter().copied().enumerate().filter(|(_, o)| file.outputs[o.index()])
}

fn signal(name: &str, unit: &str, values: Vec<f64>) -> Signal {
    Signal { name: name.to_owned(), unit: unit.to_owned(), values }
}

fn result(
    parameter: &Parameter,
    column: Option<usize>,
    time: &[f64],
    start_s: f64,
    columns: &[ColumnRun],
    options: &EstimateOptions,
) -> ParameterResult {
    let truth = options.truth.get(&parameter.name).copied();
    let mut result = ParameterResult {
        name: parameter.name.clone(),
        unit: parameter.unit(),
        value: parameter.start,
        std_error: 0.0,
        corrected_std_error: 0.0,
        systematic_std: 0.0,
        systematic_parts: Vec::new(),
        learnt_shift: 0.0,
        correction_std: 0.0,
        lower: parameter.start,
        upper: parameter.start,
        status: FinalStatus::Fixed,
        converged_at_s: None,
        observability: 0.0,
        initial: parameter.start,
        prior_std: parameter.prior_std,
        bounds: parameter.bounds,
        truth,
        nuisance: parameter.is_nuisance(),
        readiness: None,
    };
    let Some(j) = column else { return result };
    let last = &columns[j];
    result.learnt_shift = last.learnt_shifts.last().copied().unwrap_or(0.0);
    result.value = last.value + result.learnt_shift;
    result.std_error = last.std_error;
    result.corrected_std_error = last.corrected_std_error;
    result.systematic_std = last.systematic_std;
    result.systematic_parts.clone_from(&last.systematic_parts);
    result.lower = result.value - 2.0 * result.corrected_std_error;
    result.upper = result.value + 2.0 * result.corrected_std_error;
    result.status = last.status.into();
    result.observability = last.observability;
    if result.status != FinalStatus::NotExcited {
        result.converged_at_s = converged_at(time, start_s, &last.shown_values(), truth.unwrap_or(result.value));
    }
    result
}

/// First time after which the estimate stays within 5 % of `goal`, s from `start_s`.
fn converged_at(time: &[f64], start_s: f64, values: &[f64], goal: f64) -> Option<f64> {
    let outside = values.iter().rposition(|v| (v - goal).abs() > 0.05 * goal.abs());
    let first = outside.map_or(0, |k| k + 1);
    Some(time.get(first)? - start_s)
}

/// The correlation of all parameters; one that is fixed goes with nothing.
fn correlation_of(columns: &[(&Parameter, Option<usize>)], covariance: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let estimated = correlation(covariance);
    let entry = |a: Option<usize>, b: Option<usize>, same: bool| match (a, b) {
        _ if same => 1.0,
        (Some(a), Some(b)) => estimated[a][b],
        _ => 0.0,
    };
    let row = |i: usize| columns.iter().enumerate().map(|(j, c)| entry(columns[i].1, c.1, i == j)).collect();
    (0..columns.len()).map(row).collect()
}

fn history<M: Motion<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    columns: &[(&Parameter, Option<usize>)],
    run: &Run<R>,
) -> History {
    let Task { prepared, file, .. } = *task;
    // Surfaces and extra inputs always, the others where they change.
    let changes = |s: &Signal| s.values.iter().any(|v| *v != s.values[0]);
    let always = |s: &Signal| Axes::SURFACES.contains(&s.name.as_str()) || file.extra_inputs.contains(&s.name);
    let inputs = prepared.known.iter().filter(|s| always(s) || changes(s)).cloned().collect();
    let outputs = |rows: &[[f64; R]], whitened: bool| -> Vec<Signal> {
        measured(file)
            .map(|(row, o)| {
                let unit = if whitened { "-" } else { o.unit() };
                signal(o.name(), unit, rows.iter().map(|r| r[row]).collect())
            })
            .collect()
    };
    let samples = prepared.time.len();
    let parameter = |(p, column): &(&Parameter, Option<usize>)| {
        let name = p.name.clone();
        match column.map(|j| &run.columns[j]) {
            Some(column) => ParameterHistory {
                name,
                value: column.shown_values(),
                std_error: column.std_errors.clone(),
                surface: column.surfaces.clone(),
            },
            None => ParameterHistory {
                name,
                value: vec![p.start; samples],
                std_error: vec![0.0; samples],
                surface: vec![0.0; samples],
            },
        }
    };
    History {
        time_s: prepared.time.clone(),
        inputs,
        measured: outputs(&prepared.outputs, false),
        predicted: outputs(&run.predicted, false),
        residuals: outputs(&run.residuals, true),
        parameters: columns.iter().map(parameter).collect(),
        phase: run.phases.clone(),
    }
}
