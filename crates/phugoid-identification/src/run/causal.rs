//! A causal method over a record: sample by sample, no estimate uses a later sample.

use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::{Estimate, Inspect, ParameterStatus, Phase, Sample, Status};

use super::readiness::ColumnVerdict;
use super::stepper::Stepper;
use super::{ColumnRun, Run, Task, log_density};
use crate::error::EstimateError;
use crate::model_file::ModelFile;
use crate::monitor::Monitoring;
use crate::motion::MotionModel;

/// A causal method: how its estimator is set up. Implementations are empty types, one file per kind.
pub(crate) trait Causal {
    /// The estimator.
    type Estimator<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>: Inspect<R, P, Input = M::KnownInput>
        + Send;

    /// The estimator for a model with the settings that all methods share: priors, noise, biases, sample time, process
    /// noise. Called again when the estimation of increments starts anew with the first visible motion.
    ///
    /// # Errors
    /// [`EstimateError::Model`] if the settings are refused.
    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &EstimatorSettings<N, R, P>,
        file: &ModelFile,
    ) -> Result<Self::Estimator<M, N, R, P>, EstimateError>;
}

/// Runs a causal method with room for `P` columns.
#[inline(never)] // one room's estimator on the stack at a time
pub(super) fn run_causal<C: Causal, M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    task: &Task<M, N, R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    let prepared = task.prepared;
    let mut stepper = Stepper::<C, M, N, R, P>::new(task)?;
    let samples = prepared.time.len();
    let blank = ColumnRun {
        values: Vec::with_capacity(samples),
        std_errors: Vec::with_capacity(samples),
        surfaces: Vec::with_capacity(samples),
        value: 0.0,
        std_error: 0.0,
        corrected_std_error: 0.0,
        observability: 0.0,
        status: ParameterStatus::NotExcited,
        change_sensitivity: 0.0,
        verdict: ColumnVerdict::default(),
    };
    let mut run = Run {
        columns: vec![blank; stepper.estimator().column_count()],
        predicted: Vec::with_capacity(samples),
        residuals: Vec::with_capacity(samples),
        log_density: Vec::with_capacity(samples),
        phases: Vec::with_capacity(samples),
        events: Vec::new(),
        covariance: Vec::new(),
        status: Status::default(),
        detector: None,
        excited: false,
        health: None,
        batch: None,
    };
    let mut last: Option<Estimate<P>> = None;
    for k in 0..samples {
        let sample = Sample { time_s: prepared.time[k], input: prepared.inputs[k], outputs: prepared.outputs[k] };
        let surfaces = prepared.surfaces().map(|signal| signal.values[k]);
        let estimate = stepper.step(&sample, surfaces, &mut run.events)?;
        let estimator = stepper.estimator();
        let surfaces = estimator.surfaces();
        for (j, column) in run.columns.iter_mut().enumerate() {
            column.values.push(estimate.parameters[j]);
            column.std_errors.push(estimate.corrected_std_error[j]);
            column.surfaces.push(surfaces[j]);
        }
        let innovations = estimator.innovations();
        let started = estimate.status.phase != Phase::Starting;
        run.predicted.push(if started { innovations.predicted } else { [f64::NAN; R] });
        run.residuals.push(innovations.normalised);
        run.log_density.push(if stepper.has_moved() { log_density(innovations) } else { [f64::NAN; R] });
        run.phases.push(estimate.status.phase);
        last = Some(estimate);
        if k % 64 == 0 {
            progress(k as f64 / samples as f64);
        }
    }
    let Some(last) = last else { return Err(EstimateError::TooShort { samples }) };
    run.excited = stepper.has_moved();
    run.covariance = stepper.covariance();
    let sensitivity = stepper.estimator().change_sensitivity();
    for (j, column) in run.columns.iter_mut().enumerate() {
        column.value = last.parameters[j];
        column.std_error = last.std_error[j];
        column.corrected_std_error = last.corrected_std_error[j];
        column.observability = last.observability[j];
        column.status = last.parameter_status[j];
        column.change_sensitivity = sensitivity[j];
    }
    if run.excited {
        for (column, verdict) in run.columns.iter_mut().zip(stepper.verdicts(&last)) {
            column.verdict = *verdict;
        }
    }
    run.status = last.status;
    run.health = stepper.take_monitoring().map(Monitoring::finish);
    run.detector = stepper.estimator().detector();
    progress(1.0);
    Ok(run)
}
