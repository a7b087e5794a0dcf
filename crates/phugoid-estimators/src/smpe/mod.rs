//! SMPE, the sliding-mode parameter estimator on a parallel model.
//!
//! An estimated model runs in parallel with the plant. Each output row is a sliding surface, whitened by its predicted
//! uncertainty and tied to the parameters by the *sensitivity* of the parallel model. Inside the boundary layer the
//! equivalent control acts, outside the sign, both evaluated implicitly (proximally), so that the surfaces cannot
//! chatter at any sample time; the bounds of the parameters decide the gain. docs/theory.md derives it and says what
//! is proved. Honest identity: without saturation and without re-reaching this is the joint extended Kalman filter in
//! separated form (B. Friedland, *Treatment of bias in recursive filtering*, IEEE TAC 14, 1969).
//!
//! ```
//! use phugoid_estimators::smpe::{ParameterPrior, Smpe, SmpeSettings};
//! use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};
//!
//! /// `x' = -a x + u`, `y = x`; `a` is unknown.
//! struct Lag;
//!
//! impl Model<1, 1, 1> for Lag {
//!     type Input = [f64; 1];
//!     fn parameter_count(&self) -> usize {
//!         1
//!     }
//!     fn rates(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1]) -> [f64; 1] {
//!         [-a[0] * x[0] + u[0]]
//!     }
//!     fn linearized_rates(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1], out: &mut LinearizedRates<1, 1>) {
//!         out.rates = self.rates(x, a, u);
//!         out.state_jacobian = [[-a[0]]];
//!         out.regressors = [[-x[0]]];
//!     }
//!     fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; 1], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, 1>) {
//!         out.outputs = *x;
//!         out.state_jacobian = [[1.0]];
//!         out.parameter_jacobian = [[0.0]];
//!     }
//!     fn measuring_output(&self, _state: usize) -> Option<usize> {
//!         Some(0)
//!     }
//! }
//!
//! // Known: a lies between 1 and 9, noise of one sigma 0.001, 100 Hz.
//! let settings = SmpeSettings::automatic(&[ParameterPrior::bounded(5.0, 1.0, 9.0)], [0.001], 0.01)?;
//! let mut estimator = Smpe::new(Lag, settings)?;
//! // The step response of a = 3, here without noise.
//! let mut estimate = estimator.estimate();
//! for k in 0..100 {
//!     let time_s = 0.01 * f64::from(k);
//!     let y = (1.0 - (-3.0 * time_s).exp()) / 3.0;
//!     estimate = estimator.update(&Sample { time_s, input: [1.0], outputs: [y] });
//! }
//! let error = (estimate.parameters[0] - 3.0).abs();
//! assert!(error < 2.0 * estimate.corrected_std_error[0]);
//! assert!(estimate.corrected_std_error[0] < 0.02);
//! # Ok::<(), phugoid_estimators::smpe::SmpeError>(())
//! ```

mod challenge;
mod change;
pub(crate) mod colour;
pub(crate) mod columns;
pub(crate) mod common;
mod history;
pub(crate) mod reopen;
mod retrospect;
mod separated;
pub(crate) mod settings;
pub(crate) mod slot;
pub(crate) mod start;
mod trial;

pub use settings::{
    ChangeDetection, ChangePrior, NoiseAdaptation, OutputInput, ParameterPrior, ProcessNoise, ReReaching,
    ReachingState, SmpeError, SmpeSettings,
};
pub use slot::{Innovations, RowPhase};
pub(crate) use start::median;

use challenge::{Challenge, Verdict, maturity, needed_maturity};
use change::ChangeDetector;
use columns::Columns;
use history::History;
use retrospect::Behind;
use separated::Separated;
use slot::{Faults, Slot, output_input};
use start::Start;
use trial::Trial;

use crate::discretization::IntervalInput;
use crate::estimate::{ChangeState, DetectorState, Estimate, Estimator, Inspect, ParameterStatus, Phase, Status};
use crate::model::{Model, Sample};

/// Observability below which a parameter counts as not excited: its bound has shrunk by less than 30 %. Lower would not
/// do: the noise of the estimated state alone, minute after minute, looks like a little excitation.
pub(crate) const EXCITED: f64 = 0.5;
/// Part of the prior standard deviation (or of twice the change prior, if that is smaller) below which a parameter
/// counts as converged.
pub(crate) const CONVERGED: f64 = 0.1;
/// The process noise is adapted only after this time, s: the start transient is not a gust.
const ADAPTATION_START_S: f64 = 0.3;

/// When more than half of the rows have been rejected in every frame for this long, s, the estimated state is lost (an
/// input that was not recorded, say): what no parameter explains, no further prediction will bring back.
const LOST_STATE_S: f64 = 0.5;
/// The same with change detection: a large change looks like this too, and the detector is to find it first.
const LOST_STATE_WATCHED_S: f64 = 1.5;
/// ... and for at least this many frames.
const LOST_STATE_FRAMES: u32 = 5;

/// What the change detector knows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DetectorReport {
    /// Largest log Bayes factor of the last test, nats: change against wander.
    pub bayes_factor: f64,
    /// `w`: how far the parameters wander without any change, as a part of the change prior. Model error.
    pub wander: f64,
    /// `lev >= 1`: variance of the residuals over what the noise levels promise, at the time scale of the window.
    pub leverage: f64,
    /// Windows worth of information the wander was learnt from; armed from ten on.
    pub informative_windows: f64,
    /// Score of the running challenger on fresh data, nats; zero when none runs.
    pub challenger_score: f64,
    /// Challengers adopted so far.
    pub adoptions: u32,
    /// Challengers dropped so far.
    pub dropped: u32,
    /// Latched: the wander stayed large after an adoption, so the model itself is in error and changes are no longer
    /// adopted.
    pub model_error: bool,
}

enum Stage {
    /// Collecting the median start.
    Starting,
    Running,
}

/// The sliding-mode parameter estimator: `N` states, `R` outputs, room for `P` columns (parameters and biases).
pub type Smpe<M, const N: usize, const R: usize, const P: usize> = Supervisor<Separated<N, P>, M, N, R, P>;

/// What makes an estimator of a filter for state and parameters: median start, sensor biases, restart of a lost state,
/// change detection with champion and challenger, colour correction, limits and verdicts. `S` keeps the covariance and
/// does the arithmetic of one row: [`Smpe`] and [`JointEkf`](crate::ekf::JointEkf) differ in nothing else.
///
/// `N` states, `R` outputs, room for `P` columns (parameters and biases). Columns of [`Estimate`] are the model's
/// parameters in its order, then one per biased output.
pub struct Supervisor<S, M, const N: usize, const R: usize, const P: usize>
where
    S: Slot<N, R, P>,
    M: Model<N, R, P>,
{
    model: M,
    settings: S::Settings,
    columns: Columns<N, R, P>,
    stage: Stage,
    start: Start<M::Input, R>,
    trial: Trial<R>,
    champion: S,
    challenger: S,
    in_doubt: bool,
    history: History<M::Input, S, R>,
    /// The challenger is not yet up to date.
    behind: Option<Behind>,
    detection: Option<(ChangeDetector<P>, Challenge)>,
    /// Time of the first frame, s.
    first_s: f64,
    /// Time of the last frame used, s.
    last_s: f64,
    last_input: Option<M::Input>,
    colour_block: u64,
    surfaces: [f64; P],
    innovations: Innovations<R>,
    phase: Phase,
    /// Of champion and challenger.
    faults: [Faults<R>; 2],
    re_reached: bool,
    /// Opened for a known change since the last sample.
    known_change: bool,
    rejected_samples: u64,
    restarts: u32,
    /// Start of the present run of frames that were mostly rejected, and their number.
    lost_since_s: f64,
    lost_frames: u32,
}

impl<S, M, const N: usize, const R: usize, const P: usize> Supervisor<S, M, N, R, P>
where
    S: Slot<N, R, P>,
    M: Model<N, R, P>,
{
    /// Sets the estimator up; the first samples start its state.
    pub fn new(model: M, settings: S::Settings) -> Result<Self, SmpeError> {
        let shared = S::shared(&settings);
        let parameters = model.parameter_count();
        if parameters > P {
            return Err(SmpeError::Capacity { needed: parameters, capacity: P });
        }
        shared.check(parameters)?;
        S::check(&settings)?;
        let columns = Columns::new(&model, shared);
        let champion = S::prior(&settings, &columns);
        let detection = match shared.re_reaching {
            ReReaching::Off => None,
            ReReaching::Safe(detection) => {
                Some((ChangeDetector::new(detection, shared.sample_time_s, &columns), Challenge::new(detection)))
            }
        };
        let history = History::new(detection.as_ref().map_or(0, |(detector, _)| detector.window_frames()));
        Ok(Self {
            model,
            settings,
            columns,
            stage: Stage::Starting,
            start: Start::new(),
            trial: Trial::NEW,
            champion,
            challenger: champion,
            in_doubt: false,
            history,
            behind: None,
            detection,
            first_s: f64::NAN,
            last_s: f64::NEG_INFINITY,
            last_input: None,
            colour_block: 0,
            surfaces: [0.0; P],
            innovations: Innovations::EMPTY,
            phase: Phase::Starting,
            faults: [Faults::NONE; 2],
            re_reached: false,
            known_change: false,
            rejected_samples: 0,
            restarts: 0,
            lost_since_s: 0.0,
            lost_frames: 0,
        })
    }

    /// The model.
    pub fn model(&self) -> &M {
        &self.model
    }

    /// The settings in force.
    pub fn settings(&self) -> &S::Settings {
        &self.settings
    }

    /// Columns in use: the model's parameters and the biases.
    pub fn column_count(&self) -> usize {
        self.columns.count
    }

    /// Column that holds the bias of an output.
    pub fn bias_column(&self, output: usize) -> Option<usize> {
        self.columns.bias_of_output.get(output).copied().flatten()
    }

    /// Prior standard deviation per column, parameter units.
    pub fn prior_sd(&self) -> &[f64; P] {
        &self.columns.sd
    }

    /// State of the estimated model.
    pub fn state(&self) -> &[f64; N] {
        &self.champion.common().x
    }

    /// The last frame's rows before it corrected the estimate.
    pub fn innovations(&self) -> &Innovations<R> {
        &self.innovations
    }

    /// Surface per parameter, for display: `theta_LS - theta` before the last correction, where `theta_LS` is what
    /// least squares would make of the frame. Parameter units. In the sliding phase it is removed at once.
    pub fn surfaces(&self) -> &[f64; P] {
        &self.surfaces
    }

    /// `q_s`, the adapted scale of the process noise.
    pub fn process_noise_scale(&self) -> f64 {
        self.champion.common().noise_scale
    }

    /// Samples refused because their time did not increase.
    pub fn rejected_samples(&self) -> u64 {
        self.rejected_samples
    }

    /// How often the state was started again (after a gap too long to predict through, when most rows were rejected for
    /// half a second, with change detection for 1.5 s, or when the model did not answer with numbers).
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// What the change detector knows; `None` when it is switched off.
    pub fn detector(&self) -> Option<DetectorReport> {
        self.detection.as_ref().map(|(detector, challenge)| DetectorReport {
            bayes_factor: detector.bayes_factor(),
            wander: detector.wander(),
            leverage: detector.leverage(),
            informative_windows: detector.informative(),
            challenger_score: if self.in_doubt { challenge.score } else { 0.0 },
            adoptions: challenge.adoptions,
            dropped: challenge.dropped,
            model_error: challenge.model_error,
        })
    }

    /// `3 w d_j`: changes smaller than this cannot be told from model error. Parameter units; zero for columns that
    /// are not tested or with the detector off.
    pub fn change_sensitivity(&self) -> [f64; P] {
        let mut out = [0.0; P];
        if let Some((detector, _)) = &self.detection {
            for &j in detector.tested() {
                out[j] = 3.0 * detector.wander() * self.change_sd(j);
            }
        }
        out
    }

    fn shared(&self) -> &SmpeSettings<N, R, P> {
        S::shared(&self.settings)
    }

    /// `d_j`, parameter units.
    fn change_sd(&self, column: usize) -> f64 {
        self.columns.change[column].sd(self.columns.initial[column], self.champion.common().theta[column])
    }

    /// `d_j` over the prior standard deviation.
    fn change_over_prior(&self) -> [f64; P] {
        let mut out = [0.0; P];
        for j in 0..self.columns.count {
            if self.columns.sd[j] > 0.0 {
                out[j] = self.change_sd(j) / self.columns.sd[j];
            }
        }
        out
    }

    fn collect(&mut self, sample: &Sample<M::Input, R>) {
        self.phase = Phase::Starting;
        self.innovations = Innovations::EMPTY;
        self.surfaces = [0.0; P];
        self.start.push(sample);
        self.last_s = sample.time_s;
        // Again only where a gap inside the window has left fewer frames.
        while self.replay() {}
    }

    /// Starts the state and replays the collected frames, if there are enough. True if a gap among them has begun a new
    /// start with fewer frames.
    fn replay(&mut self) -> bool {
        let Some(started) = self.start.state(self.shared(), &self.columns) else { return false };
        self.champion.start_state(started.x, &started.variances, &started.measured, &self.columns);
        if self.in_doubt {
            self.challenger.start_state(started.x, &started.variances, &started.measured, &self.columns);
        }
        self.stage = Stage::Running;
        let collected = core::mem::replace(&mut self.start, Start::new());
        for index in 0..collected.len() {
            let Some(frame) = collected.frame(index) else { continue };
            if matches!(self.stage, Stage::Starting) {
                // A gap, or a failure of the model, inside the window: an earlier frame has begun a new start.
                self.start.push(&frame);
                self.last_s = frame.time_s;
                continue;
            }
            if index == 0 {
                self.last_s = frame.time_s;
                self.last_input = Some(frame.input);
                if self.first_s.is_nan() {
                    self.first_s = frame.time_s;
                }
                if self.shared().correct_first_sample {
                    self.correct(&frame, frame.input);
                }
            } else {
                self.advance(&frame);
            }
        }
        matches!(self.stage, Stage::Starting) && self.start.len() < collected.len()
    }

    /// Starts the state again from measurements; parameters and covariance are kept, and so is a doubt about them.
    fn restart(&mut self, sample: &Sample<M::Input, R>) {
        self.restarts = self.restarts.saturating_add(1);
        self.lost_frames = 0;
        self.catch_up_at_once();
        self.history.clear();
        if self.in_doubt && !self.challenger.is_sound(self.columns.count) {
            self.drop_challenger();
        }
        if let Some((detector, _)) = &mut self.detection {
            detector.clear();
        }
        if !self.champion.is_sound(self.columns.count) {
            if self.in_doubt {
                self.adopt_challenger(sample.time_s);
            } else {
                // Nothing of the estimate can be trusted: back to the prior.
                self.champion = S::prior(&self.settings, &self.columns);
            }
        }
        self.stage = Stage::Starting;
        self.faults = [Faults::NONE; 2];
        self.start = Start::new();
        self.start.push(sample);
        self.last_s = sample.time_s;
        self.phase = Phase::Starting;
        self.innovations = Innovations::EMPTY;
        self.surfaces = [0.0; P];
    }

    /// The first start was none: nothing that was learnt from it is kept.
    fn start_over(&mut self, sample: &Sample<M::Input, R>) {
        self.champion = S::prior(&self.settings, &self.columns);
        self.in_doubt = false;
        self.behind = None;
        self.restart(sample);
    }

    /// One interval and the frame at its end.
    fn advance(&mut self, sample: &Sample<M::Input, R>) {
        let interval_s = sample.time_s - self.last_s;
        let Some(from) = self.last_input else { return self.restart(sample) };
        if interval_s > self.shared().maximum_gap_s {
            return self.restart(sample);
        }
        let input = IntervalInput { from, to: sample.input, hold: self.shared().input_hold };
        let Self { model, settings, columns, champion, challenger, in_doubt, behind, .. } = self;
        let up_to_date = *in_doubt && behind.is_none();
        let challenger_lives = up_to_date && challenger.predict(model, settings, columns, &input, interval_s);
        if !champion.predict(model, settings, columns, &input, interval_s) {
            if !challenger_lives {
                return self.restart(sample);
            }
            // The champion is lost and the challenger is not.
            self.adopt_challenger(sample.time_s);
        } else if up_to_date && !challenger_lives {
            self.drop_challenger();
        }
        if let Some((_, challenge)) = &mut self.detection {
            challenge.pass_time(interval_s);
        }
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        self.correct(sample, output_input(self.shared(), from, sample.input));
    }

    /// The frame at the present time.
    fn correct(&mut self, sample: &Sample<M::Input, R>, input: M::Input) {
        let since_start_s = sample.time_s - self.first_s;
        let adapt = since_start_s > ADAPTATION_START_S;
        let (kappa, limit) = (self.shared().reaching_limit, self.shared().rejection_limit);
        let nominal_s = self.shared().sample_time_s;
        let faults = self.faults[0];
        let watching = !self.in_doubt;
        let up_to_date = self.in_doubt && self.behind.is_none();
        let Self { model, settings, columns, champion, challenger, surfaces, detection, history, .. } = self;
        if detection.is_some() {
            history.push(sample);
        }
        self.innovations =
            champion.correct(model, settings, columns, &input, &sample.outputs, adapt, surfaces, |row| {
                if let (true, Some((detector, _))) = (watching, detection.as_mut()) {
                    detector.observe(&row, kappa, faults.weight(row.output, row.xi, limit));
                }
            });
        let challenged = up_to_date.then(|| {
            let mut unused = [0.0; P];
            challenger.correct(model, settings, columns, &input, &sample.outputs, adapt, &mut unused, |_| {})
        });
        self.phase = phase_of(&self.innovations);

        let block = self.shared().colour_block(since_start_s);
        if block != self.colour_block {
            self.colour_block = block;
            self.champion.close_colour_block();
            if up_to_date {
                self.challenger.close_colour_block();
            }
        } else {
            self.champion.renew_colour();
            if up_to_date {
                self.challenger.renew_colour();
            }
        }

        if self.trial.contradicts(&self.innovations, sample.time_s, S::shared(&self.settings).start_trial_s) {
            return self.start_over(sample);
        }
        if !self.champion.is_sound(self.columns.count) || self.is_lost(sample.time_s) {
            return self.restart(sample);
        }
        if self.detection.is_some() {
            self.history.note(&self.champion);
        }
        if let Some(innovations) = challenged {
            self.contest(&innovations, sample.time_s);
            self.faults[1].note(&innovations, limit, nominal_s);
        } else if self.in_doubt {
            self.catch_up();
        } else if self.phase != Phase::Predicting {
            self.watch(since_start_s, sample.time_s);
        }
        self.faults[0].note(&self.innovations, limit, nominal_s);
    }

    /// Whether the estimated state no longer has to do with the measurements.
    fn is_lost(&mut self, time_s: f64) -> bool {
        let count = |wanted: RowPhase| self.innovations.phase.iter().filter(|phase| **phase == wanted).count();
        let rejected = count(RowPhase::Rejected);
        if self.phase == Phase::Predicting {
            return false;
        }
        if 2 * rejected <= R - count(RowPhase::Missing) {
            self.lost_frames = 0;
            return false;
        }
        if self.lost_frames == 0 {
            self.lost_since_s = time_s;
        }
        self.lost_frames += 1;
        let limit_s = if self.detection.is_some() { LOST_STATE_WATCHED_S } else { LOST_STATE_S };
        // While a change is in doubt the challenger has the word.
        !self.in_doubt && self.lost_frames >= LOST_STATE_FRAMES && time_s - self.lost_since_s >= limit_s
    }

    /// No challenger: has anything changed?
    fn watch(&mut self, since_start_s: f64, time_s: f64) {
        let change = self.change_over_prior();
        let Some((detector, challenge)) = &mut self.detection else { return };
        let Some(bayes_factor) = detector.end_frame(&change, self.history.newest()) else { return };
        if detector.wander() > challenge.settings.insensitive_wander && challenge.adoptions > 0 {
            challenge.model_error = true;
        }
        if challenge.is_triggered(bayes_factor, since_start_s) {
            self.go_back(&change, time_s);
        }
    }

    /// A challenger runs: who explains the fresh data?
    fn contest(&mut self, innovations: &Innovations<R>, time_s: f64) {
        let change = self.change_over_prior();
        let Some((detector, challenge)) = &mut self.detection else { return };
        let limit = S::shared(&self.settings).rejection_limit;
        challenge.add_frame([&self.innovations, innovations], &self.faults, limit, detector.leverage());
        let sound = self.challenger.is_sound(self.columns.count);
        let mut difference = [0.0; P];
        let mut covariance = [[0.0; P]; P];
        if sound {
            for j in 0..self.columns.count {
                if self.columns.sd[j] > 0.0 {
                    difference[j] =
                        (self.challenger.common().theta[j] - self.champion.common().theta[j]) / self.columns.sd[j];
                }
            }
            self.challenger.write_covariance(&mut covariance);
        }
        let tested = detector.tested();
        let matured = maturity(&difference, &covariance, &change, detector.wander_squared(), tested);
        let needed = needed_maturity(&challenge.settings, tested.len());
        match challenge.decide(time_s, matured, needed, sound) {
            Verdict::Undecided => {}
            Verdict::Drop => self.drop_challenger(),
            Verdict::Adopt => self.adopt_challenger(time_s),
        }
    }

    fn adopt_challenger(&mut self, time_s: f64) {
        self.champion = self.challenger;
        self.faults[0] = self.faults[1];
        self.in_doubt = false;
        self.behind = None;
        self.history.forget_snapshots();
        self.re_reached = true;
        if let Some((detector, challenge)) = &mut self.detection {
            let widening = challenge.adopted(time_s);
            detector.widen_wander(widening);
            detector.clear();
        }
    }

    fn drop_challenger(&mut self) {
        self.in_doubt = false;
        self.behind = None;
        if let Some((detector, challenge)) = &mut self.detection {
            let widening = challenge.was_dropped();
            detector.widen_wander(widening);
            detector.clear();
        }
    }

    fn detector_state(&self) -> DetectorState {
        match &self.detection {
            None => DetectorState::Off,
            Some((detector, challenge)) => {
                if challenge.model_error || detector.wander() > challenge.settings.insensitive_wander {
                    DetectorState::Insensitive
                } else if detector.has_learnt() {
                    DetectorState::Armed
                } else {
                    DetectorState::Calibrating
                }
            }
        }
    }

    /// The estimate that holds after the last sample.
    pub fn estimate(&self) -> Estimate<P> {
        let p = self.columns.count;
        let slot = self.champion.common();
        let variances = self.champion.variances();
        let inflation = slot.colour.inflation();
        let mut estimate = Estimate {
            time_s: self.last_s,
            parameters: slot.theta,
            std_error: [0.0; P],
            corrected_std_error: [0.0; P],
            observability: [0.0; P],
            parameter_status: [ParameterStatus::NotExcited; P],
            status: Status {
                phase: self.phase,
                change: if self.re_reached {
                    ChangeState::ReReached
                } else if self.in_doubt {
                    ChangeState::InDoubt
                } else {
                    ChangeState::Steady
                },
                detector: self.detector_state(),
            },
        };
        let challenger_variances = if self.in_doubt { self.challenger.variances() } else { [0.0; P] };
        let change = if self.behind.is_some() { self.change_over_prior() } else { [0.0; P] };
        let challenger_inflation = self.challenger.common().colour.inflation();
        for j in 0..p {
            let sd = self.columns.sd[j];
            let mut variance = variances[j];
            let mut corrected = variance * inflation[j];
            estimate.observability[j] = if sd > 0.0 { (1.0 - variance).clamp(0.0, 1.0) } else { 0.0 };
            if self.in_doubt && sd > 0.0 {
                // Bounds in doubt: both answers lie inside.
                let difference = (self.challenger.common().theta[j] - slot.theta[j]) / sd;
                // A challenger that is not up to date has nothing to say yet: the whole plausible change.
                let open = if self.behind.is_some() { change[j] * change[j] } else { 0.0 };
                let spread = open.max(difference * difference);
                variance = variance.max(challenger_variances[j]) + spread;
                corrected = corrected.max(challenger_variances[j] * challenger_inflation[j]) + spread;
            }
            estimate.std_error[j] = sd * libm::sqrt(variance);
            estimate.corrected_std_error[j] = sd * libm::sqrt(corrected);
            estimate.parameter_status[j] =
                self.parameter_status(j, estimate.observability[j], estimate.corrected_std_error[j]);
        }
        estimate
    }

    fn parameter_status(&self, j: usize, observability: f64, corrected: f64) -> ParameterStatus {
        let theta = self.champion.common().theta[j];
        let limited = j < self.columns.own && {
            let prior = &self.shared().priors[j];
            self.champion.common().limited[j]
                || theta - 2.0 * corrected > prior.upper
                || theta + 2.0 * corrected < prior.lower
        };
        let sd = self.columns.sd[j];
        let change = self.change_sd(j);
        let scale = if change > 0.0 { sd.min(2.0 * change) } else { sd };
        if observability < EXCITED {
            ParameterStatus::NotExcited
        } else if limited {
            ParameterStatus::AtLimit
        } else if corrected <= CONVERGED * scale {
            ParameterStatus::Converged
        } else {
            ParameterStatus::Improving
        }
    }
}

impl<S, M, const N: usize, const R: usize, const P: usize> Estimator<R, P> for Supervisor<S, M, N, R, P>
where
    S: Slot<N, R, P>,
    M: Model<N, R, P>,
{
    type Input = M::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        self.re_reached = core::mem::take(&mut self.known_change);
        if !sample.time_s.is_finite() || sample.time_s <= self.last_s {
            self.rejected_samples = self.rejected_samples.saturating_add(1);
            self.phase = Phase::Rejected;
        } else {
            match self.stage {
                Stage::Starting => self.collect(sample),
                Stage::Running => self.advance(sample),
            }
        }
        self.estimate()
    }

    fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        self.champion.write_covariance(out);
        for i in 0..self.columns.count {
            for j in 0..self.columns.count {
                out[i][j] *= self.columns.sd[i] * self.columns.sd[j];
            }
        }
    }
}

impl<S, M, const N: usize, const R: usize, const P: usize> Inspect<R, P> for Supervisor<S, M, N, R, P>
where
    S: Slot<N, R, P>,
    M: Model<N, R, P>,
{
    fn column_count(&self) -> usize {
        Self::column_count(self)
    }

    fn prior_sd(&self) -> &[f64; P] {
        Self::prior_sd(self)
    }

    fn innovations(&self) -> &Innovations<R> {
        Self::innovations(self)
    }

    fn surfaces(&self) -> [f64; P] {
        *Self::surfaces(self)
    }

    fn reopen_now(&mut self) -> bool {
        Self::reopen_now(self)
    }

    fn restarts(&self) -> u32 {
        Self::restarts(self)
    }

    fn process_noise_scale(&self) -> f64 {
        Self::process_noise_scale(self)
    }

    fn detector(&self) -> Option<DetectorReport> {
        Self::detector(self)
    }

    fn change_sensitivity(&self) -> [f64; P] {
        Self::change_sensitivity(self)
    }
}

fn phase_of<const R: usize>(innovations: &Innovations<R>) -> Phase {
    let any = |phase| innovations.phase.contains(&phase);
    if any(RowPhase::Rejected) {
        Phase::Rejected
    } else if any(RowPhase::Reaching) {
        Phase::Reaching
    } else if any(RowPhase::Sliding) {
        Phase::Sliding
    } else {
        Phase::Predicting
    }
}
