//! Runs a causal method over a record, sample by sample: no estimate uses a later sample.

use phugoid_estimators::{ParameterStatus, Phase, Sample, Status};

use super::consistency::Consistency;
use super::declared_errors::LearntConstant;
use super::readiness::ColumnVerdict;
use super::stepper::CausalRun;
use super::task::{BySurfaces, ColumnRun, LearntNoise, Run, Task, log_density};
use crate::core::error::EstimateError;
use crate::core::systematic::LearntQuantity;
use crate::motion::Motion;

/// Takes a causal method that has been set up over the record of its task.
///
/// # Errors
/// [`EstimateError::TooShort`] for a record without samples; those of [`CausalRun::step`].
pub(super) fn run_causal<M: Motion<N, R>, const N: usize, const R: usize>(
    stepper: &mut dyn CausalRun<M::KnownInput, R>,
    task: &Task<M, N, R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    let prepared = task.prepared;
    let samples = prepared.time.len();
    let blank = ColumnRun {
        values: Vec::with_capacity(samples),
        std_errors: Vec::with_capacity(samples),
        learnt_shifts: Vec::with_capacity(samples),
        surfaces: Vec::with_capacity(samples),
        value: 0.0,
        std_error: 0.0,
        corrected_std_error: 0.0,
        systematic_std: 0.0,
        systematic_parts: Vec::new(),
        observability: 0.0,
        status: ParameterStatus::NotExcited,
        change_sensitivity: 0.0,
        verdict: ColumnVerdict::default(),
    };
    let mut run = Run {
        columns: vec![blank; stepper.shown().parameters.len()],
        predicted: Vec::with_capacity(samples),
        residuals: Vec::with_capacity(samples),
        log_density: Vec::with_capacity(samples),
        phases: Vec::with_capacity(samples),
        consistency: Vec::new(),
        events: Vec::new(),
        covariance: Vec::new(),
        status: Status::default(),
        detector: None,
        changes: Vec::new(),
        noise: None,
        excited: false,
        health: None,
        batch: None,
        second_answer: None,
        by_surfaces: BySurfaces::default(),
        third_answer: None,
        no_second_answer: None,
        disputed: None,
        begun_again: None,
        said_of_base: None,
        follows_constants: task.follows_constants(),
        learnt: Vec::new(),
    };
    let mut surfaces = vec![0.0; run.columns.len()];
    let mut consistency = Consistency::NONE;
    for k in 0..samples {
        let sample = Sample { time_s: prepared.time[k], input: prepared.inputs[k], outputs: prepared.outputs[k] };
        let mut positions = prepared.surfaces().map(|signal| signal.values[k]);
        stepper.step(&sample, &mut positions, &mut run.events)?;
        stepper.write_surfaces(&mut surfaces);
        let shown = stepper.shown();
        for (j, column) in run.columns.iter_mut().enumerate() {
            column.values.push(shown.parameters[j]);
            column.std_errors.push(shown.corrected_std_error[j]);
            column.learnt_shifts.push(shown.learnt_shift[j]);
            column.surfaces.push(surfaces[j]);
        }
        let phase = shown.status.phase;
        let innovations = stepper.innovations();
        let started = phase != Phase::Starting;
        run.predicted.push(if started { innovations.predicted } else { [f64::NAN; R] });
        run.residuals.push(innovations.normalised);
        run.log_density.push(if stepper.has_moved() { log_density(innovations) } else { [f64::NAN; R] });
        run.phases.push(phase);
        if started {
            consistency.note(sample.time_s, &sample.outputs, innovations, stepper.has_moved());
        }
        if k % 64 == 0 {
            progress(k as f64 / samples as f64);
        }
    }
    if samples == 0 {
        return Err(EstimateError::TooShort { samples });
    }
    run.consistency = consistency.outputs();
    run.excited = stepper.has_moved();
    run.covariance = stepper.covariance();
    let of_constant = |one: &LearntConstant| LearntQuantity {
        quantity: M::CONSTANTS[one.constant],
        of: M::LEARNABLE
            .iter()
            .position(|constant| *constant == one.constant)
            .and_then(|place| M::LEARNABLE_OF.get(place))
            .copied()
            .unwrap_or_default()
            .to_owned(),
        value: one.value,
        std_error: one.std_error,
    };
    run.learnt = stepper.told().iter().map(of_constant).collect();
    let (last, sensitivity) = (stepper.shown(), stepper.change_sensitivity());
    for (j, column) in run.columns.iter_mut().enumerate() {
        column.value = last.parameters[j];
        column.std_error = last.std_error[j];
        column.corrected_std_error = last.corrected_std_error[j];
        column.systematic_std = last.systematic_std[j];
        column.systematic_parts = stepper.systematic_parts(j);
        column.observability = last.observability[j];
        column.status = last.parameter_status[j];
        column.change_sensitivity = sensitivity[j];
    }
    run.status = last.status;
    if run.excited {
        for (column, verdict) in run.columns.iter_mut().zip(stepper.renewed_verdicts()) {
            column.verdict = *verdict;
        }
    }
    run.health = stepper.take_health();
    run.detector = stepper.detector();
    run.changes = stepper.take_changes();
    run.noise = stepper
        .noise()
        .filter(|report| report.learnt.is_some())
        .map(|report| LearntNoise { std: report.std, is_provisional: stepper.is_provisional() });
    progress(1.0);
    Ok(run)
}
