//! The supervisor: everything around a filter that makes an estimator of it. A sample is collected for the start of the
//! state, or predicts and corrects the estimate (here); then the detector looks at it, or a challenger competes for it
//! (`doubt`). What it reports is in `report`.

pub(crate) mod colour;
pub(crate) mod common;
pub mod considered;
mod doubt;
pub(crate) mod faults;
mod history;
pub mod learnt;
mod lost;
mod probation;
mod report;
pub(crate) mod slot;
pub(crate) mod start;
mod trial;

use crate::bounded::at;
use crate::change_detection::ChangeDetector;
use crate::change_detection::challenge::Challenge;
use crate::columns::Columns;
use crate::discretization::IntervalInput;
use crate::estimate::{Estimate, Estimator, Phase};
use crate::innovation::{Innovations, RowPhase};
use crate::levels::{Frame, Levels};
use crate::model::{Model, Sample};
use crate::settings::{ChangePrior, EstimatorSettings, NoiseAdaptation, SettingsError};
use crate::supervisor::faults::{Faults, Watch};
use crate::supervisor::history::History;
use crate::supervisor::probation::{Probation, Reopened};
use crate::supervisor::slot::Slot;
use crate::supervisor::start::Start;
use crate::supervisor::trial::Trial;
use doubt::Behind;
use lost::Rejections;

/// The process noise is adapted only after this time, s: the start transient is not a gust.
const ADAPTATION_START_S: f64 = 0.3;

enum Stage {
    /// Frames are collected, of which the state starts with the median.
    Starting,
    Running,
}

/// Everything that makes an estimator of a filter for state and parameters: median start, sensor biases, restart of a
/// lost state, change detection with champion and challenger, colour correction, limits and verdicts. `S` keeps the
/// covariance and does the arithmetic of one row: [`Smpe`](crate::smpe::Smpe) and [`JointEkf`](crate::ekf::JointEkf)
/// differ in nothing else.
///
/// `N` states, `R` outputs, room for `P` columns (parameters and biases). Columns of [`Estimate`] are the model's
/// parameters in its order, then one per biased output.
pub struct Supervisor<S, M, const N: usize, const R: usize, const P: usize>
where
    S: Slot<N, P>,
    M: Model<N, R, P>,
{
    model: M,
    settings: EstimatorSettings<N, R, P>,
    columns: Columns<R, P>,
    levels: Levels<N, R>,
    /// What the champion has seen of the last frame; used where levels are learnt.
    frame: Frame<N, R>,
    /// Length of the interval that it ends, s.
    interval_s: f64,
    output_of_state: [Option<usize>; N],
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
    /// What is known of failing sensors, with the residuals of the champion and of the challenger.
    faults: [Faults<R>; 2],
    adopted: bool,
    /// The former estimate has taken its place again since the last sample.
    rolled_back: bool,
    /// The challenger is the former estimate, a rival of the one that was adopted.
    probation: Option<Probation>,
    reopened: Reopened<P>,
    /// Opened for a known change since the last sample.
    known_change: bool,
    rejected_samples: u64,
    restarts: u32,
    rejections: Rejections,
}

impl<S, M, const N: usize, const R: usize, const P: usize> Supervisor<S, M, N, R, P>
where
    S: Slot<N, P>,
    M: Model<N, R, P>,
{
    /// Sets the estimator up; the first samples start its state.
    pub fn new(model: M, settings: EstimatorSettings<N, R, P>) -> Result<Self, SettingsError> {
        let parameters = model.parameter_count();
        if parameters > P {
            return Err(SettingsError::Capacity { needed: parameters, capacity: P });
        }
        settings.check(parameters)?;
        S::check(&settings)?;
        S::check_constants(model.constant_count())?;
        let columns = Columns::new(&settings, parameters);
        let output_of_state = settings.output_of_state(&model);
        let noise = &settings.process_noise;
        let levels = Levels::new(
            settings.noise_std,
            settings.noise_learning.as_ref(),
            noise.adaptation != NoiseAdaptation::Off,
            &noise.variance_per_s,
            noise.initial_scale,
        );
        let champion = S::prior(&settings, &columns);
        let detection = match settings.change_detection {
            None => None,
            Some(detection) => {
                let detector = ChangeDetector::new(detection, settings.sample_time_s, &columns);
                Some((detector, Challenge::new(detection, R as f64 / settings.sample_time_s)))
            }
        };
        let history = History::new(detection.as_ref().map_or(0, |(detector, _)| detector.window_frames()));
        Ok(Self {
            model,
            settings,
            columns,
            levels,
            frame: Frame::EMPTY,
            interval_s: 0.0,
            output_of_state,
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
            adopted: false,
            rolled_back: false,
            probation: None,
            reopened: Reopened::NONE,
            known_change: false,
            rejected_samples: 0,
            restarts: 0,
            rejections: Rejections::NONE,
        })
    }

    /// Standard deviation `d_j` of a sudden change, parameter units.
    fn change_std(&self, column: usize) -> f64 {
        let change = self.columns.change.get(column).unwrap_or(&ChangePrior::None);
        change.std(at(&self.columns.initial, column), at(&self.champion.common().theta, column))
    }

    /// `d_j` over the prior standard deviation.
    fn change_over_prior(&self) -> [f64; P] {
        let mut out = [0.0; P];
        for j in 0..self.columns.count() {
            if self.columns.std[j] > 0.0 {
                out[j] = self.change_std(j) / self.columns.std[j];
            }
        }
        out
    }

    /// Collects a sample for the start of the state.
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
        let Some(started) = self.start.state(&self.settings, &self.levels.std, &self.output_of_state) else {
            return false;
        };
        self.levels.start_state(&started.variances);
        self.champion.start_state(started.x, &started.variances, &started.read_from, &self.columns);
        if self.in_doubt || self.probation.is_some() {
            self.challenger.start_state(started.x, &started.variances, &started.read_from, &self.columns);
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
                self.interval_s = 0.0;
                self.frame.stand_still();
                if self.settings.correct_first_sample {
                    self.correct(&frame, frame.input);
                }
            } else {
                self.advance(&frame);
            }
        }
        matches!(self.stage, Stage::Starting) && self.start.len() < collected.len()
    }

    /// Starts the state again from measurements; parameters and covariance are kept, and so is a doubt about them.
    pub(super) fn restart(&mut self, sample: &Sample<M::Input, R>) {
        self.restarts = self.restarts.saturating_add(1);
        self.rejections = Rejections::NONE;
        self.catch_up_at_once();
        self.history.clear();
        if !self.challenger.is_sound(self.columns.count()) {
            self.end_probation();
            if self.in_doubt {
                self.drop_challenger();
            }
        }
        if let Some((detector, _)) = &mut self.detection {
            detector.clear();
        }
        if !self.champion.is_sound(self.columns.count()) {
            if self.in_doubt {
                self.adopt_challenger(sample.time_s);
            } else if self.probation.is_some() {
                self.roll_back();
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
        self.probation = None;
        self.reopened = Reopened::NONE;
        self.restart(sample);
    }

    /// One interval and the frame at its end.
    fn advance(&mut self, sample: &Sample<M::Input, R>) {
        let interval_s = sample.time_s - self.last_s;
        let Some(from) = self.last_input else { return self.restart(sample) };
        if interval_s > self.settings.maximum_gap_s {
            return self.restart(sample);
        }
        let input = IntervalInput { from, to: sample.input, hold: self.settings.input_hold };
        self.interval_s = interval_s;
        let up_to_date = self.second_is_up_to_date();
        let Self { model, settings, columns, levels, frame, champion, challenger, .. } = self;
        let transition = &mut frame.transition;
        let challenger_lives =
            up_to_date && challenger.predict(model, settings, columns, levels, &input, interval_s, transition);
        if !champion.predict(model, settings, columns, levels, &input, interval_s, transition) {
            if !challenger_lives {
                return self.restart(sample);
            }
            // The champion is lost and the other one is not.
            if self.in_doubt {
                self.adopt_challenger(sample.time_s);
            } else {
                self.roll_back();
            }
        } else if up_to_date && !challenger_lives {
            if self.in_doubt {
                self.drop_challenger();
            } else {
                self.end_probation();
            }
        }
        if let Some((_, challenge)) = &mut self.detection {
            challenge.pass_time(interval_s);
        }
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        self.correct(sample, self.settings.seen_input(from, sample.input));
    }

    /// Whether a second estimate runs beside the champion and has seen every frame: a challenger that has caught up, or
    /// the rival of an adopted estimate.
    fn second_is_up_to_date(&self) -> bool {
        (self.in_doubt && self.behind.is_none()) || self.probation.is_some()
    }

    /// The frame at the present time.
    fn correct(&mut self, sample: &Sample<M::Input, R>, input: M::Input) {
        let since_start_s = sample.time_s - self.first_s;
        let started = since_start_s > ADAPTATION_START_S;
        let learning = self.levels.are_learnt();
        let adapt = started && !learning;
        let (kappa, limit) = (self.settings.reaching_limit, self.settings.rejection_limit);
        let nominal_s = self.settings.sample_time_s;
        let faults = self.faults[0];
        let watching = !self.in_doubt;
        self.frame.reopened = self.reopened.since_s.is_finite();
        let up_to_date = self.second_is_up_to_date();
        let Self {
            model, settings, columns, levels, frame, champion, challenger, surfaces, detection, history, ..
        } = self;
        frame.begin(sample.time_s);
        if detection.is_some() {
            history.push(sample);
        }
        let watch = detection.as_mut().filter(|_| watching).map(|(detector, _)| Watch {
            detector,
            faults: &faults,
            reaching_limit: kappa,
            rejection_limit: limit,
        });
        let outputs = &sample.outputs;
        let seen = learning.then_some(&mut *frame);
        self.innovations =
            champion.correct(model, settings, columns, levels, &input, outputs, adapt, surfaces, watch, seen);
        let challenged = up_to_date.then(|| {
            let mut unused = [0.0; P];
            challenger.correct(model, settings, columns, levels, &input, outputs, adapt, &mut unused, None, None)
        });
        if learning {
            let bursts = |output| faults.bursts(output);
            let gate = S::gate(settings);
            levels.take(frame, self.interval_s, !watching, [limit, gate], bursts);
        }
        self.phase = phase_of(&self.innovations);
        if self.detection.is_some() {
            self.history.judge(faults.merit(&self.innovations, limit));
        }

        let block = self.settings.colour_block(since_start_s);
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

        if self.trial.contradicts(&self.innovations, sample.time_s, self.settings.start_trial_s) {
            return self.start_over(sample);
        }
        let lost =
            |s: &mut Self| s.rejections.are_too_many(&s.innovations, sample.time_s, s.detection.is_some(), s.in_doubt);
        if !self.champion.is_sound(self.columns.count()) || lost(self) {
            return self.restart(sample);
        }
        if self.detection.is_some() {
            let Self { history, champion, levels, .. } = self;
            history.note(champion, || levels.learnt());
        }
        let mut own = self.innovations;
        if let Some(mut innovations) = challenged {
            if self.in_doubt {
                self.contest(&innovations, sample.time_s);
            } else {
                self.judge_probation(&innovations);
            }
            if self.adopted || self.rolled_back {
                // The two have changed places.
                core::mem::swap(&mut own, &mut innovations);
            }
            self.faults[1].note(&innovations, S::gate(&self.settings), nominal_s);
        } else if self.in_doubt {
            self.catch_up();
        }
        if watching && self.phase != Phase::Predicting {
            self.watch(since_start_s, sample.time_s);
        }
        if self.reopened.any() {
            self.reopened.note(&self.champion.variances());
        }
        self.faults[0].note(&own, S::gate(&self.settings), nominal_s);
        let Self { levels, faults: [own, _], .. } = self;
        levels.open(|| own.locked_out());
    }
}

impl<S, M, const N: usize, const R: usize, const P: usize> Estimator<R, P> for Supervisor<S, M, N, R, P>
where
    S: Slot<N, P>,
    M: Model<N, R, P>,
{
    type Input = M::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        self.adopted = core::mem::take(&mut self.known_change);
        self.rolled_back = false;
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
        for i in 0..self.columns.count() {
            for j in 0..self.columns.count() {
                out[i][j] *= self.columns.std[i] * self.columns.std[j];
            }
        }
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
