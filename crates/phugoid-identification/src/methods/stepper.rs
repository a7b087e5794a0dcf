//! A causal method, sample by sample: what the run over a record and a live session share.

use std::collections::VecDeque;

use phugoid_estimators::levels::NoiseReport;
use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
use phugoid_estimators::{ChangeState, DetectorReport, Estimate, Innovations, ParameterStatus, Sample, Status};

use super::changes::Changes;
use super::declared_errors::{DeclaredErrors, LearntConstant};
use super::gate::{Gated, GatedInput, open};
use super::health_watch::{HealthRun, Monitoring};
use super::readiness::{ColumnVerdict, ReadinessWatch};
use super::replay::{Replay, adoptions};
use super::settings::{learning, shared_settings};
use super::snapshot::Column;
use super::table::{Boxed, SetUp};
use super::task::{RunChange, Task};
use super::watch::Watch;
use crate::core::error::EstimateError;
use crate::core::estimation::Event;
use crate::core::method::Method;
use crate::core::options::{KnownChange, Opens};
use crate::core::systematic::{ByQuantity, SystematicPart};
use crate::model_file::{Base, ByPowers, ModelFile, Role};
use crate::models::surface_motion::{SurfaceMotion, SurfaceMotions};
use crate::motion::{MotionModel, declared};
use crate::preparation::excitation::{Excitation, Moved};

/// How far before the first visible motion the estimation of increments starts, s.
const LEAD_S: f64 = 1.0;

/// A causal method that is being run, whatever the method and the room of its estimator: known inputs of type `I`, `R`
/// outputs. Slices have one entry per column in use: the estimated parameters in the order of the model file, then one
/// per estimated sensor bias.
pub(crate) trait CausalRun<I, const R: usize>: Send {
    /// Takes the next sample, with the positions of the surfaces (rad, in the order of the prepared ones). What
    /// happened is added to `events`.
    ///
    /// # Errors
    /// [`EstimateError::Settings`] if the settings are refused where the estimation starts anew with the first motion.
    fn step(
        &mut self,
        sample: &Sample<I, R>,
        surfaces: &mut dyn Iterator<Item = f64>,
        events: &mut Vec<Event>,
    ) -> Result<(), EstimateError>;

    /// The estimate after the last step as it is shown: the prior of what nothing has excited yet.
    fn shown(&self) -> Shown<'_>;

    /// The rows of the last frame before it corrected the estimate.
    fn innovations(&self) -> &Innovations<R>;

    /// The last correction wanted per column, parameter units, for display.
    /// It is written to `out`, one entry per column in use, so that a long record costs no allocation per sample.
    fn write_surfaces(&self, out: &mut [f64]);

    /// Whether anything has moved yet.
    fn has_moved(&self) -> bool;

    /// The verdicts on the columns as they are now.
    fn renewed_verdicts(&mut self) -> &[ColumnVerdict];

    /// The verdicts as last renewed on the way, and when, s; before the first motion at minus infinity.
    fn latest_verdicts(&self) -> (f64, &[ColumnVerdict]);

    /// Covariance of the columns as it is shown: the prior of what nothing has excited.
    fn covariance(&self) -> Vec<Vec<f64>>;

    /// Changes smaller than this cannot be told from model error, per column, parameter units.
    fn change_sensitivity(&self) -> Vec<f64>;

    /// The noise levels in use at present; none for a method that uses those of its settings.
    fn noise(&self) -> Option<NoiseReport<R>>;

    /// True while the noise levels are still to be learnt and the estimates provisional.
    fn is_provisional(&self) -> bool;

    /// The declared constants of which the flight itself says what they are.
    fn told(&self) -> Vec<LearntConstant>;

    /// The declared quantities that make the systematic part of a column, the largest share first.
    fn systematic_parts(&self, column: usize) -> Vec<SystematicPart>;

    /// What the change detector knows; none without one.
    fn detector(&self) -> Option<DetectorReport>;

    /// Takes the adopted changes out, the last one with the present estimate.
    fn take_changes(&mut self) -> Vec<RunChange>;

    /// Takes the result of the health monitor out, if there is one.
    fn take_health(&mut self) -> Option<HealthRun>;

    /// The longest interval between samples that is predicted through, s. After a longer one the states start again
    /// from the measurements; the parameters and their covariance are kept.
    fn maximum_gap_s(&self) -> f64;
}

/// An estimate as it is shown, one entry per column in use.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    /// Time of the last sample used, s.
    pub(crate) time_s: f64,
    pub(crate) status: Status,
    /// Estimates, in the units of the parameters.
    pub(crate) parameters: &'a [f64],
    /// One sigma claimed by the covariance.
    pub(crate) std_error: &'a [f64],
    /// One sigma corrected for the colour of the residuals.
    pub(crate) corrected_std_error: &'a [f64],
    /// The part of it that the model file declares.
    pub(crate) systematic_std: &'a [f64],
    /// What the flight says of the declared constants adds to the estimates, in the units of the parameters. The errors above are those
    /// of the sum.
    pub(crate) learnt_shift: &'a [f64],
    pub(crate) observability: &'a [f64],
    pub(crate) parameter_status: &'a [ParameterStatus],
}

/// A causal method with everything that a run needs around the estimator: the first motion, known changes, events,
/// verdicts, the health monitor.
pub(super) struct Stepper<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> {
    file: ModelFile,
    method: Method,
    set_up: SetUp<Gated<M>, GatedInput<M::KnownInput>, N, R, P>,
    settings: EstimatorSettings<N, R, P>,
    gated: Gated<M>,
    estimator: Boxed<GatedInput<M::KnownInput>, R, P>,
    /// Where noise levels are learnt.
    replay: Option<Replay<GatedInput<M::KnownInput>, N, R, P>>,
    /// The last estimate as it is shown.
    shown: Estimate<P>,
    /// True until something has moved: until then only the priors of single parameters are known, because steady flight
    /// determines sums of terms.
    waiting: bool,
    moved: Moved,
    excitation: Excitation,
    lead: Lead<M::KnownInput, R>,
    /// How the surfaces move.
    surfaces: SurfaceMotions,
    /// The errors of the declared constants.
    declared_errors: DeclaredErrors,
    /// Declared uncertainty by column, for a method that does not follow the errors.
    by_powers: Vec<ByPowers>,
    /// One sigma of the systematic part of the last estimate, by column.
    systematic_std: [f64; P],
    /// What the flight says of the declared constants adds to it, by column.
    learnt_shift: [f64; P],
    watch: Watch,
    changes: Changes,
    readiness: ReadinessWatch<R, P>,
    monitoring: Option<Monitoring<M, N, R, P>>,
    /// The known changes that are still to come, in order.
    known_changes: VecDeque<KnownChange>,
}

impl<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> Stepper<M, N, R, P> {
    /// For a record, or the beginning of a flight: its first two seconds are what the noise of surfaces is measured
    /// from. `set_up` makes the estimator.
    ///
    /// # Errors
    /// [`EstimateError::Settings`] if the settings are refused.
    pub(super) fn new(
        task: &Task<M, N, R>,
        set_up: SetUp<Gated<M>, GatedInput<M::KnownInput>, N, R, P>,
    ) -> Result<Self, EstimateError> {
        let Task { prepared, file, options, noise, health, model_error, displaced } = *task;
        let shared = shared_settings::<M, N, R, P>(prepared, file, options, noise)?;
        let gated = Gated::new(prepared.model.clone(), file);
        let gated = match displaced {
            Some(displaced) => gated.displaced(displaced),
            None => gated,
        };
        let method = task.method();
        let learns = file.noise_learning && method.learns_noise();
        let settings = if learns { learning(&shared, M::AXES, noise, model_error) } else { shared };
        let estimator = set_up(method, gated.clone(), &settings, file.aircraft.gravity)?;
        let monitoring = match health {
            Some(health) => Some(Monitoring::new(&prepared.model, file, &shared, health, learns)?),
            None => None,
        };
        Ok(Self {
            file: file.clone(),
            method,
            set_up,
            settings,
            gated,
            estimator,
            replay: learns.then(Replay::new),
            shown: Estimate {
                time_s: f64::NAN,
                parameters: [0.0; P],
                std_error: [0.0; P],
                corrected_std_error: [0.0; P],
                observability: [0.0; P],
                parameter_status: [ParameterStatus::NotExcited; P],
                status: Status::default(),
            },
            waiting: true,
            moved: Moved::default(),
            excitation: Excitation::of(prepared, noise),
            lead: Lead::default(),
            watch: Watch::new(settings.maximum_step_s.max(3.5 * settings.sample_time_s)),
            surfaces: SurfaceMotions::new(file.uncertainty.surface_play),
            declared_errors: DeclaredErrors::new(declared::<M, N, R>(file), file.uncertainty.learns),
            by_powers: prepared.by_powers(file).collect(),
            systematic_std: [0.0; P],
            learnt_shift: [0.0; P],
            changes: Changes::default(),
            readiness: ReadinessWatch::new(),
            monitoring,
            known_changes: options.known_changes.iter().copied().collect(),
        })
    }

    fn columns(&self) -> usize {
        self.estimator.column_count().min(P)
    }

    /// One sigma of the systematic part of a column.
    fn systematic(&self, column: usize, value: f64) -> f64 {
        match self.declared_errors.effects(column) {
            Some(effects) => effects.iter().map(|effect| effect * effect).sum::<f64>().sqrt(),
            None => self.by_powers.get(column).map_or(0.0, |powers| powers.std(value)),
        }
    }

    /// A column with what is declared, for comparing it with itself at another time. `random_std`: its standard error without.
    fn column(&self, column: usize, value: f64, random_std: f64) -> Column {
        match self.declared_errors.effects(column) {
            Some(effects) => Column::new(value + self.declared_errors.shift(column), random_std, effects),
            None => {
                let effects = self.by_powers.get(column).map(|powers| powers.effects(value));
                Column::new(value, random_std, effects.as_ref().map_or(&[], |effects| effects.as_flattened()))
            }
        }
    }

    /// Looks at the replay after a sample that gave this estimate; a filter that has caught up takes the place of the
    /// running one.
    fn replayed(
        &mut self,
        sample: &Sample<GatedInput<M::KnownInput>, R>,
        estimate: &mut Estimate<P>,
    ) -> Result<(), EstimateError> {
        let Self { replay, estimator, settings, set_up, method, gated, file, watch, changes, .. } = self;
        let Some(replay) = replay else { return Ok(()) };
        let set_up = |own: &EstimatorSettings<N, R, P>| set_up(*method, gated.clone(), own, file.aircraft.gravity);
        if let Some((second, its)) = replay.take(sample, estimate, estimator, settings, set_up)? {
            *estimator = second;
            *estimate = its;
            watch.restarts = estimator.restarts();
            changes.keep(adoptions(estimator) as usize);
        }
        Ok(())
    }
}

/// Columns of the constant terms of the coefficients: those of the estimated parameters without the biases of sensors, which
/// come behind them.
fn constants(file: &ModelFile) -> Vec<usize> {
    let own = file.estimated().filter(|parameter| !matches!(parameter.role, Role::Bias(_)));
    own.enumerate().filter(|(_, parameter)| parameter.role.is_constant_term()).map(|(column, _)| column).collect()
}

impl<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> CausalRun<M::KnownInput, R>
    for Stepper<M, N, R, P>
{
    fn step(
        &mut self,
        sample: &Sample<M::KnownInput, R>,
        surfaces: &mut dyn Iterator<Item = f64>,
        events: &mut Vec<Event>,
    ) -> Result<(), EstimateError> {
        self.moved = self.excitation.update(sample.time_s, surfaces, &sample.outputs);
        let open = open(M::AXES, self.file.base, self.moved);
        let mut opened = Opens::Everything;
        while let Some(change) = self.known_changes.pop_front_if(|change| change.time_s <= sample.time_s + 1e-9) {
            let columns: Vec<usize> = match change.opens {
                Opens::Everything => (0..self.columns()).collect(),
                Opens::Constants => constants(&self.file),
            };
            self.estimator.reopen_columns_now(&columns);
            if let Some(replay) = &mut self.replay {
                replay.open(columns);
            }
            opened = change.opens;
        }
        let motion = self.surfaces.at(sample.time_s, M::deflections(&sample.input));
        let gated = gate(sample, open, motion);
        let mut estimate = self.estimator.update(&gated);
        // In absolute form the estimator keeps the sums of terms that steady flight determines.
        let starts_anew = self.waiting && self.file.base != Base::None;
        if starts_anew {
            self.lead.push(sample);
        }
        let mut replays = true;
        if self.waiting && self.moved.any() {
            self.waiting = false;
            if let Some(replay) = &mut self.replay {
                replay.first_motion(sample.time_s);
            }
            let (lead, is_a_part) = self.lead.take();
            if is_a_part {
                // Forget what the estimator took for excitation before there was any.
                self.estimator =
                    (self.set_up)(self.method, self.gated.clone(), &self.settings, self.file.aircraft.gravity)?;
                if let Some(replay) = &mut self.replay {
                    *replay = Replay::new();
                    replays = false;
                }
                let mut surfaces = SurfaceMotions::new(self.file.uncertainty.surface_play);
                for sample in &lead {
                    let motion = surfaces.at(sample.time_s, M::deflections(&sample.input));
                    let gated = gate(sample, open, motion);
                    estimate = self.estimator.update(&gated);
                    self.replayed(&gated, &mut estimate)?;
                }
                self.watch.restarts = self.estimator.restarts();
            }
        }
        if replays {
            self.replayed(&gated, &mut estimate)?;
        }
        if self.waiting {
            estimate =
                unmoved(estimate, &self.settings.priors, self.estimator.column_count(), self.estimator.prior_std());
        } else {
            still(&mut estimate, &self.settings.priors, &self.gated, self.moved, self.estimator.prior_std());
            self.readiness.look(&estimate, &*self.estimator);
        }
        if let Some(monitoring) = &mut self.monitoring {
            monitoring.update(sample, &estimate, &*self.estimator);
        }
        self.watch.look(&estimate, sample.time_s, self.estimator.restarts(), events);
        if !self.waiting {
            let columns = self.columns();
            self.declared_errors.look(&*self.estimator, columns);
            for j in 0..columns {
                let noise = self.declared_errors.noise_std(j);
                estimate.std_error[j] = estimate.std_error[j].hypot(noise);
                estimate.corrected_std_error[j] = estimate.corrected_std_error[j].hypot(noise);
                self.learnt_shift[j] = self.declared_errors.shift(j);
            }
            let mut changes = std::mem::take(&mut self.changes);
            let now = estimate.parameters.iter().zip(&estimate.corrected_std_error).enumerate().take(columns);
            let now = now.map(|(j, (value, std))| self.column(j, *value, *std));
            changes.look(estimate.status.change, sample.time_s, opened, now);
            self.changes = changes;
            for j in 0..columns {
                self.systematic_std[j] = self.systematic(j, estimate.parameters[j]);
                estimate.corrected_std_error[j] = estimate.corrected_std_error[j].hypot(self.systematic_std[j]);
            }
        }
        if self.waiting {
            // Before anything has moved the reports of the detector have no meaning.
            events.retain(|event| !event.kind.is_of_detector());
        }
        self.shown = estimate;
        Ok(())
    }

    fn shown(&self) -> Shown<'_> {
        let (shown, columns) = (&self.shown, self.columns());
        Shown {
            time_s: shown.time_s,
            status: shown.status,
            parameters: &shown.parameters[..columns],
            std_error: &shown.std_error[..columns],
            corrected_std_error: &shown.corrected_std_error[..columns],
            systematic_std: &self.systematic_std[..columns],
            learnt_shift: &self.learnt_shift[..columns],
            observability: &shown.observability[..columns],
            parameter_status: &shown.parameter_status[..columns],
        }
    }

    fn innovations(&self) -> &Innovations<R> {
        self.estimator.innovations()
    }

    fn write_surfaces(&self, out: &mut [f64]) {
        for (to, surface) in out.iter_mut().zip(self.estimator.surfaces()) {
            *to = surface;
        }
    }

    fn has_moved(&self) -> bool {
        !self.waiting
    }

    fn renewed_verdicts(&mut self) -> &[ColumnVerdict] {
        self.readiness.renew(&self.shown, &*self.estimator)
    }

    fn latest_verdicts(&self) -> (f64, &[ColumnVerdict]) {
        let (renewed_s, verdicts) = self.readiness.latest();
        (renewed_s, &verdicts[..self.columns()])
    }

    fn covariance(&self) -> Vec<Vec<f64>> {
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
            // Steady flight determines sums of parameters: the single ones are shown with their priors.
            covariance[j] = [0.0; P];
            covariance.iter_mut().for_each(|row| row[j] = 0.0);
            covariance[j][j] = self.estimator.prior_std()[j].powi(2);
        }
        let mut covariance: Vec<Vec<f64>> = covariance[..columns].iter().map(|row| row[..columns].to_vec()).collect();
        if !self.waiting {
            self.declared_errors.widen(&*self.estimator, &mut covariance);
        }
        covariance
    }

    fn change_sensitivity(&self) -> Vec<f64> {
        self.estimator.change_sensitivity()[..self.columns()].to_vec()
    }

    fn noise(&self) -> Option<NoiseReport<R>> {
        self.estimator.noise()
    }

    fn is_provisional(&self) -> bool {
        self.replay.as_ref().is_some_and(|replay| !replay.is_done())
    }

    fn told(&self) -> Vec<LearntConstant> {
        self.declared_errors.told(&*self.estimator)
    }

    fn systematic_parts(&self, column: usize) -> Vec<SystematicPart> {
        let Some(effects) = self.declared_errors.effects(column) else {
            let value = self.shown.parameters[column];
            return self.by_powers.get(column).map_or_else(Vec::new, |powers| powers.shares(value));
        };
        let mut all = ByQuantity::default();
        M::CONSTANTS.iter().zip(effects).for_each(|(quantity, effect)| all.add(*quantity, *effect));
        all.parts()
    }

    fn detector(&self) -> Option<DetectorReport> {
        self.estimator.detector()
    }

    fn take_changes(&mut self) -> Vec<RunChange> {
        self.changes.take()
    }

    fn take_health(&mut self) -> Option<HealthRun> {
        self.monitoring.take().map(Monitoring::finish)
    }

    fn maximum_gap_s(&self) -> f64 {
        self.settings.maximum_gap_s
    }
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

    /// The samples, oldest first, and whether samples before them were dropped.
    fn take(&mut self) -> (VecDeque<Sample<I, R>>, bool) {
        (std::mem::take(&mut self.samples), self.is_a_part)
    }
}

/// The sample, and the groups of axes whose parameters are estimated from it.
fn gate<I: Copy, const R: usize>(
    sample: &Sample<I, R>,
    open: Moved,
    surfaces: SurfaceMotion,
) -> Sample<GatedInput<I>, R> {
    let input = GatedInput { input: sample.input, open, surfaces };
    Sample { time_s: sample.time_s, input, outputs: sample.outputs }
}

/// Shows the prior of the parameters of a group on which nothing has moved yet.
fn still<M, const P: usize>(
    estimate: &mut Estimate<P>,
    priors: &[ParameterPrior; P],
    gated: &Gated<M>,
    moved: Moved,
    prior_std: &[f64; P],
) {
    for j in gated.closed(moved) {
        estimate.parameters[j] = priors[j].initial;
        estimate.std_error[j] = prior_std[j];
        estimate.corrected_std_error[j] = prior_std[j];
        estimate.observability[j] = 0.0;
        estimate.parameter_status[j] = ParameterStatus::NotExcited;
    }
}

/// The estimate before anything has moved: the prior.
fn unmoved<const P: usize>(
    estimate: Estimate<P>,
    priors: &[ParameterPrior; P],
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
        prior.parameters[j] = priors[j].initial;
        prior.std_error[j] = prior_std[j];
        prior.corrected_std_error[j] = prior_std[j];
    }
    prior
}
