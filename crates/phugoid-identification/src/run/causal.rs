//! A causal method over a record: sample by sample, no estimate uses a later sample.

use phugoid_estimators::smpe::SmpeSettings;
use phugoid_estimators::{ChangeState, Estimate, Estimator, Inspect, ParameterStatus, Phase, Sample, Status};

use super::gate::{Gated, GatedInput, open};
use super::readiness::{ColumnVerdict, ReadinessWatch};
use super::settings::shared_settings;
use super::watch::Watch;
use super::{ColumnRun, Run, Task, log_density};
use crate::error::EstimateError;
use crate::excitation::{Excitation, Moved};
use crate::model_file::{Base, ModelFile};
use crate::monitor::Monitoring;
use crate::motion::{Motion, MotionModel};
use crate::prepare::Prepared;

/// A causal method: how its estimator is set up. Implementations are empty types, one file per kind.
pub(crate) trait Causal {
    /// The estimator for a model with the settings that all methods share: priors, noise, biases, sample time, process
    /// noise. Called again when the estimation of increments starts anew with the first visible motion.
    ///
    /// # Errors
    /// [`EstimateError::Model`] if the settings are refused.
    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &SmpeSettings<N, R, P>,
        file: &ModelFile,
    ) -> Result<impl Inspect<R, P, Input = M::KnownInput>, EstimateError>;
}

/// Runs a causal method with room for `P` columns.
#[inline(never)] // one room's estimator on the stack at a time
pub(super) fn run_causal<C: Causal, M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    task: &Task<M, N, R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    let Task { prepared, file, options, noise, health } = *task;
    let settings = shared_settings::<M, N, R, P>(prepared, file, options, noise)?;
    // On the heap: with room for 48 columns an estimator is too large for the stack of a thread.
    let gated = Gated::new(prepared.model.clone(), file);
    let mut estimator = Box::new(C::set_up(gated.clone(), &settings, file)?);
    let samples = prepared.time.len();
    let mut monitoring: Option<Monitoring<M, N, R, P>> = match health {
        Some(health) => Some(Monitoring::new(&prepared.model, file, &settings, health)?),
        None => None,
    };
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
        columns: vec![blank; estimator.column_count()],
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
    // Until something has moved the prior is all that is known of single parameters: steady flight tells sums of terms.
    let mut waiting = true;
    let mut moved = Moved::default();
    let mut excitation = Excitation::of(prepared, noise);
    let mut readiness = ReadinessWatch::new();
    let mut watch = Watch::new(settings.maximum_step_s.max(3.5 * settings.sample_time_s));
    let mut known_changes = options.known_changes_s.iter().peekable();
    for k in 0..samples {
        let sample = sample_at(prepared, k);
        let surfaces = prepared.surfaces().map(|signal| signal.values[k]);
        moved = excitation.update(sample.time_s, surfaces, &sample.outputs);
        let open = open(M::AXES, file.base, moved);
        while known_changes.next_if(|time_s| **time_s <= sample.time_s + 1e-9).is_some() {
            estimator.reopen_now();
        }
        let mut estimate = estimator.update(&gate(&sample, open));
        run.excited |= moved.any();
        if waiting && moved.any() {
            waiting = false;
            run.events.retain(|e| !e.is_of_detector());
            let from = prepared.time.partition_point(|t| *t < sample.time_s - LEAD_S - 1e-9);
            // In absolute form the sums that steady flight tells are worth keeping.
            if from > 0 && file.base != Base::None {
                // Forget what was taken for excitation before there was any.
                *estimator = C::set_up(gated.clone(), &settings, file)?;
                for i in from..=k {
                    estimate = estimator.update(&gate(&sample_at(prepared, i), open));
                }
                watch.restarts = estimator.restarts();
            }
        }
        if waiting {
            estimate = unmoved(estimate, &settings, estimator.column_count(), estimator.prior_sd());
        } else {
            still(&mut estimate, &settings, &gated, moved, estimator.prior_sd());
            readiness.look(&estimate, &*estimator);
        }
        if let Some(monitoring) = &mut monitoring {
            monitoring.update(&sample, &estimate, &*estimator);
        }
        watch.look(&estimate, sample.time_s, estimator.restarts(), &mut run.events);
        let surfaces = estimator.surfaces();
        for (j, column) in run.columns.iter_mut().enumerate() {
            column.values.push(estimate.parameters[j]);
            column.std_errors.push(estimate.corrected_std_error[j]);
            column.surfaces.push(surfaces[j]);
        }
        let started = estimate.status.phase != Phase::Starting;
        run.predicted.push(if started { estimator.innovations().predicted } else { [f64::NAN; R] });
        run.residuals.push(estimator.innovations().normalised);
        run.log_density.push(if waiting { [f64::NAN; R] } else { log_density(estimator.innovations()) });
        run.phases.push(estimate.status.phase);
        last = Some(estimate);
        if k % 64 == 0 {
            progress(k as f64 / samples as f64);
        }
    }
    let mut covariance = [[0.0; P]; P];
    if waiting {
        run.events.retain(|e| !e.is_of_detector());
        for (j, sd) in estimator.prior_sd().iter().enumerate().take(estimator.column_count()) {
            covariance[j][j] = sd * sd;
        }
    } else {
        estimator.covariance(&mut covariance);
    }
    for j in gated.closed(moved) {
        // What steady flight tells of the sums is not shown of single ones.
        covariance[j] = [0.0; P];
        covariance.iter_mut().for_each(|row| row[j] = 0.0);
        covariance[j][j] = estimator.prior_sd()[j].powi(2);
    }
    let columns = run.columns.len();
    run.covariance = covariance[..columns].iter().map(|row| row[..columns].to_vec()).collect();
    let sensitivity = estimator.change_sensitivity();
    let Some(last) = last else { return Err(EstimateError::TooShort { samples }) };
    for (j, column) in run.columns.iter_mut().enumerate() {
        column.value = last.parameters[j];
        column.std_error = last.std_error[j];
        column.corrected_std_error = last.corrected_std_error[j];
        column.observability = last.observability[j];
        column.status = last.parameter_status[j];
        column.change_sensitivity = sensitivity[j];
    }
    if !waiting {
        for (column, verdict) in run.columns.iter_mut().zip(readiness.finish(&last, &*estimator)) {
            column.verdict = verdict;
        }
    }
    run.status = last.status;
    run.health = monitoring.map(Monitoring::finish);
    run.detector = estimator.detector();
    progress(1.0);
    Ok(run)
}

/// How far before the first visible motion the estimation of increments starts, s.
const LEAD_S: f64 = 1.0;

fn sample_at<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    k: usize,
) -> Sample<M::KnownInput, R> {
    Sample { time_s: prepared.time[k], input: prepared.inputs[k], outputs: prepared.outputs[k] }
}

/// The sample with word of what may be learnt from it.
fn gate<I: Copy, const R: usize>(sample: &Sample<I, R>, open: Moved) -> Sample<GatedInput<I>, R> {
    Sample { time_s: sample.time_s, input: GatedInput { input: sample.input, open }, outputs: sample.outputs }
}

/// Shows the prior of the parameters of a group on which nothing has moved yet.
fn still<M, const N: usize, const R: usize, const P: usize>(
    estimate: &mut Estimate<P>,
    settings: &SmpeSettings<N, R, P>,
    gated: &Gated<M>,
    moved: Moved,
    prior_sd: &[f64; P],
) {
    for j in gated.closed(moved) {
        estimate.parameters[j] = settings.priors[j].initial;
        estimate.std_error[j] = prior_sd[j];
        estimate.corrected_std_error[j] = prior_sd[j];
        estimate.observability[j] = 0.0;
        estimate.parameter_status[j] = ParameterStatus::NotExcited;
    }
}

/// The estimate before anything has moved: the prior.
fn unmoved<const N: usize, const R: usize, const P: usize>(
    estimate: Estimate<P>,
    settings: &SmpeSettings<N, R, P>,
    columns: usize,
    prior_sd: &[f64; P],
) -> Estimate<P> {
    let mut prior = Estimate {
        parameters: [0.0; P],
        std_error: [0.0; P],
        corrected_std_error: [0.0; P],
        observability: [0.0; P],
        parameter_status: [ParameterStatus::NotExcited; P],
        ..estimate
    };
    prior.status.change = ChangeState::Steady;
    for j in 0..columns {
        // Bias columns start at zero, as the unused entries of the settings do.
        prior.parameters[j] = settings.priors[j].initial;
        prior.std_error[j] = prior_sd[j];
        prior.corrected_std_error[j] = prior_sd[j];
    }
    prior
}
