//! A causal method, sample by sample: what the run over a record and a live session share.

use std::collections::VecDeque;

use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::{ChangeState, Estimate, Estimator, Inspect, ParameterStatus, Sample};

use super::Task;
use super::causal::Causal;
use super::gate::{Gated, GatedInput, open};
use super::readiness::{ColumnVerdict, ReadinessWatch};
use super::settings::shared_settings;
use super::watch::Watch;
use crate::error::EstimateError;
use crate::estimation::Event;
use crate::excitation::{Excitation, Moved};
use crate::model_file::{Base, ModelFile};
use crate::monitor::Monitoring;
use crate::motion::MotionModel;

/// How far before the first visible motion the estimation of increments starts, s.
const LEAD_S: f64 = 1.0;

/// A causal method with what stands around it: the first motion, known changes, events, verdicts, the health monitor.
pub(crate) struct Stepper<C: Causal, M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> {
    file: ModelFile,
    settings: EstimatorSettings<N, R, P>,
    gated: Gated<M>,
    /// On the heap: with room for 48 columns an estimator is too large for the stack of a thread.
    estimator: Box<C::Estimator<Gated<M>, N, R, P>>,
    /// Until something has moved the prior is all that is known of single parameters: steady flight tells sums of terms.
    waiting: bool,
    moved: Moved,
    excitation: Excitation,
    lead: Lead<M::KnownInput, R>,
    watch: Watch,
    readiness: ReadinessWatch<R, P>,
    monitoring: Option<Monitoring<M, N, R, P>>,
    /// Still to come, s, in order.
    known_changes_s: VecDeque<f64>,
}

impl<C: Causal, M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> Stepper<C, M, N, R, P> {
    /// For a record, or the beginning of a flight: its first two seconds are what the noise of surfaces is measured from.
    ///
    /// # Errors
    /// [`EstimateError::Model`] if the settings are refused.
    pub(crate) fn new(task: &Task<M, N, R>) -> Result<Self, EstimateError> {
        let Task { prepared, file, options, noise, health } = *task;
        let settings = shared_settings::<M, N, R, P>(prepared, file, options, noise)?;
        let gated = Gated::new(prepared.model.clone(), file);
        let estimator = set_up::<C, M, N, R, P>(&gated, &settings, file)?;
        let monitoring = match health {
            Some(health) => Some(Monitoring::new(&prepared.model, file, &settings, health)?),
            None => None,
        };
        Ok(Self {
            file: file.clone(),
            settings,
            gated,
            estimator,
            waiting: true,
            moved: Moved::default(),
            excitation: Excitation::of(prepared, noise),
            lead: Lead::default(),
            watch: Watch::new(settings.maximum_step_s.max(3.5 * settings.sample_time_s)),
            readiness: ReadinessWatch::new(),
            monitoring,
            known_changes_s: options.known_changes_s.iter().copied().collect(),
        })
    }

    /// Takes the next sample, with the positions of the surfaces (rad, in the order of the prepared ones), and gives the estimate
    /// as it is shown: the prior of what nothing has excited yet. What happened is added to `events`.
    ///
    /// # Errors
    /// [`EstimateError::Model`] if the settings are refused where the estimation starts anew with the first motion.
    pub(crate) fn step(
        &mut self,
        sample: &Sample<M::KnownInput, R>,
        surfaces: impl Iterator<Item = f64>,
        events: &mut Vec<Event>,
    ) -> Result<Estimate<P>, EstimateError> {
        self.moved = self.excitation.update(sample.time_s, surfaces, &sample.outputs);
        let open = open(M::AXES, self.file.base, self.moved);
        while self.known_changes_s.pop_front_if(|time_s| *time_s <= sample.time_s + 1e-9).is_some() {
            self.estimator.reopen_now();
        }
        let mut estimate = self.estimator.update(&gate(sample, open));
        // In absolute form the sums that steady flight tells are worth keeping.
        let starts_anew = self.waiting && self.file.base != Base::None;
        if starts_anew {
            self.lead.push(sample);
        }
        if self.waiting && self.moved.any() {
            self.waiting = false;
            let (lead, is_a_part) = self.lead.take();
            if is_a_part {
                // Forget what was taken for excitation before there was any.
                self.estimator = set_up::<C, M, N, R, P>(&self.gated, &self.settings, &self.file)?;
                for sample in &lead {
                    estimate = self.estimator.update(&gate(sample, open));
                }
                self.watch.restarts = self.estimator.restarts();
            }
        }
        if self.waiting {
            estimate = unmoved(estimate, &self.settings, self.estimator.column_count(), self.estimator.prior_std());
        } else {
            still(&mut estimate, &self.settings, &self.gated, self.moved, self.estimator.prior_std());
            self.readiness.look(&estimate, &*self.estimator);
        }
        if let Some(monitoring) = &mut self.monitoring {
            monitoring.update(sample, &estimate, &*self.estimator);
        }
        self.watch.look(&estimate, sample.time_s, self.estimator.restarts(), events);
        if self.waiting {
            // Before anything has moved the detector has nothing to speak of.
            events.retain(|event| !event.is_of_detector());
        }
        Ok(estimate)
    }

    /// The estimator, for what an estimate does not say.
    pub(crate) fn estimator(&self) -> &C::Estimator<Gated<M>, N, R, P> {
        &self.estimator
    }

    /// Whether anything has moved yet.
    pub(crate) fn has_moved(&self) -> bool {
        !self.waiting
    }

    /// The verdicts on the columns as they are now, `last` being the estimate that was given last.
    pub(crate) fn verdicts(&mut self, last: &Estimate<P>) -> &[ColumnVerdict] {
        self.readiness.renew(last, &*self.estimator)
    }

    /// The verdicts as last renewed on the way, and when, s; before the first motion at minus infinity.
    pub(crate) fn latest_verdicts(&self) -> (f64, &[ColumnVerdict; P]) {
        self.readiness.latest()
    }

    /// What the health monitor said so far is taken out.
    pub(crate) fn take_monitoring(&mut self) -> Option<Monitoring<M, N, R, P>> {
        self.monitoring.take()
    }

    /// Covariance of the columns as it is shown: the prior of what nothing has excited.
    pub(crate) fn covariance(&self) -> Vec<Vec<f64>> {
        let columns = self.estimator.column_count();
        let mut covariance = [[0.0; P]; P];
        if self.waiting {
            for (j, std) in self.estimator.prior_std().iter().enumerate().take(columns) {
                covariance[j][j] = std * std;
            }
        } else {
            self.estimator.covariance(&mut covariance);
        }
        for j in self.gated.closed(self.moved) {
            // What steady flight tells of the sums is not shown of single ones.
            covariance[j] = [0.0; P];
            covariance.iter_mut().for_each(|row| row[j] = 0.0);
            covariance[j][j] = self.estimator.prior_std()[j].powi(2);
        }
        covariance[..columns].iter().map(|row| row[..columns].to_vec()).collect()
    }
}

/// The estimator of a method, on the heap.
#[inline(never)] // the copies on the stack live only here
fn set_up<C: Causal, M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    gated: &Gated<M>,
    settings: &EstimatorSettings<N, R, P>,
    file: &ModelFile,
) -> Result<Box<C::Estimator<Gated<M>, N, R, P>>, EstimateError> {
    C::set_up(gated.clone(), settings, file).map(Box::new)
}

/// The samples of the last [`LEAD_S`] before the first motion.
struct Lead<I, const R: usize> {
    samples: VecDeque<Sample<I, R>>,
    is_a_part: bool,
}

impl<I, const R: usize> Default for Lead<I, R> {
    fn default() -> Self {
        Self { samples: VecDeque::new(), is_a_part: false }
    }
}

impl<I: Copy, const R: usize> Lead<I, R> {
    fn push(&mut self, sample: &Sample<I, R>) {
        while self.samples.pop_front_if(|first| first.time_s < sample.time_s - LEAD_S - 1e-9).is_some() {
            self.is_a_part = true;
        }
        self.samples.push_back(*sample);
    }

    /// The samples, and whether there were others before them.
    fn take(&mut self) -> (VecDeque<Sample<I, R>>, bool) {
        (std::mem::take(&mut self.samples), self.is_a_part)
    }
}

/// The sample with word of what may be learnt from it.
fn gate<I: Copy, const R: usize>(sample: &Sample<I, R>, open: Moved) -> Sample<GatedInput<I>, R> {
    Sample { time_s: sample.time_s, input: GatedInput { input: sample.input, open }, outputs: sample.outputs }
}

/// Shows the prior of the parameters of a group on which nothing has moved yet.
fn still<M, const N: usize, const R: usize, const P: usize>(
    estimate: &mut Estimate<P>,
    settings: &EstimatorSettings<N, R, P>,
    gated: &Gated<M>,
    moved: Moved,
    prior_std: &[f64; P],
) {
    for j in gated.closed(moved) {
        estimate.parameters[j] = settings.priors[j].initial;
        estimate.std_error[j] = prior_std[j];
        estimate.corrected_std_error[j] = prior_std[j];
        estimate.observability[j] = 0.0;
        estimate.parameter_status[j] = ParameterStatus::NotExcited;
    }
}

/// The estimate before anything has moved: the prior.
fn unmoved<const N: usize, const R: usize, const P: usize>(
    estimate: Estimate<P>,
    settings: &EstimatorSettings<N, R, P>,
    columns: usize,
    prior_std: &[f64; P],
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
        prior.std_error[j] = prior_std[j];
        prior.corrected_std_error[j] = prior_std[j];
    }
    prior
}
