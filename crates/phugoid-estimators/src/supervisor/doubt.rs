//! A change in doubt: what the detector suspects, the challenger that goes back to before the change, is opened where
//! the change has begun and catches up, the contest with the running estimate (the champion), and what becomes of it.

use super::{ADAPTATION_START_S, Supervisor};
use crate::bounded::{Places, at};
use crate::change_detection::challenge::{Verdict, maturity, needed_maturity};
use crate::discretization::IntervalInput;
use crate::innovation::Innovations;
use crate::model::Model;
use crate::supervisor::faults::Faults;
use crate::supervisor::history::FRAMES;
use crate::supervisor::probation::{Outcome, Probation, Reopened};
use crate::supervisor::slot::Slot;

/// State variance added where a change is gone back to, in measurement variances: pays for the state error gathered
/// between change and trigger.
const STATE_ALLOWANCE: f64 = 25.0;

/// Frames that a challenger that has gone back works off per update: bounded work. At 100 Hz it is up to date after 0.1
/// s.
const CATCH_UP: usize = 8;

/// Progress of a challenger that has gone back to before the change and has not caught up yet.
#[derive(Clone, Copy)]
pub(super) struct Behind {
    /// Number of the last frame it has seen.
    frame: u64,
    /// It is opened before these frames, the second not before the first. The change lies between them, and what is
    /// between is evidence of the state and not of what holds afterwards.
    open: [u64; 2],
}

impl<S, M, const N: usize, const R: usize, const P: usize> Supervisor<S, M, N, R, P>
where
    S: Slot<N, P>,
    M: Model<N, R, P>,
{
    /// Opens the parameters for a change that is known to happen now (damage, a flap, a store released, reported by
    /// another system): what the detector would have had to find out. Call it between the last sample before the change
    /// and the first one after it. Every parameter may jump by its change prior; biases and other nuisance columns keep
    /// what was learnt of them, and a doubt that is running is settled by it. The next estimate says
    /// [`ChangeState::Adopted`](crate::ChangeState::Adopted).
    ///
    /// Gives `false`, and changes nothing, if no parameter has a change prior or the arithmetic fails.
    ///
    /// ```
    /// # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
    /// use lag::{Lag, NOISE, flight};
    /// use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
    /// use phugoid_estimators::smpe::Smpe;
    /// use phugoid_estimators::{ChangeState, Estimator};
    ///
    /// let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
    /// let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
    /// let mut estimator = Smpe::new(Lag, settings)?;
    /// for sample in &flight(12.0, |t| if t < 6.0 { 3.0 } else { 4.0 }) {
    ///     if sample.time_s == 6.0 {
    ///         // A store was released, says the aircraft.
    ///         assert!(estimator.reopen_now());
    ///     }
    ///     let estimate = estimator.update(sample);
    ///     assert_eq!(estimate.status.change == ChangeState::Adopted, sample.time_s == 6.0);
    /// }
    /// let estimate = estimator.estimate();
    /// assert!((estimate.parameters[0] - 4.0).abs() < 3.0 * estimate.corrected_std_error[0]);
    /// # Ok::<(), phugoid_estimators::settings::SettingsError>(())
    /// ```
    pub fn reopen_now(&mut self) -> bool {
        self.open_now(|_| true)
    }

    /// Like [`reopen_now`](Self::reopen_now) for a change of these columns alone: of constants where a store is
    /// released or something jams (a trim shift), for example. Columns without a change prior stay closed.
    ///
    /// Gives `false`, and changes nothing, if none of them has a change prior or the arithmetic fails.
    pub fn reopen_columns_now(&mut self, columns: &[usize]) -> bool {
        self.open_now(|column| columns.contains(&column))
    }

    fn open_now(&mut self, is_meant: impl Fn(usize) -> bool) -> bool {
        let mut change = self.change_over_prior();
        let mut tested = Places::<P>::NONE;
        for j in 0..self.columns.count() {
            if !is_meant(j) {
                change[j] = 0.0;
            } else if change[j] > 0.0 {
                tested.push(j);
            }
        }
        let mut opened = self.champion;
        let reopened = Reopened::new(self.last_s, &opened.variances(), &change).with(&self.reopened);
        // The state has not been estimated wrongly yet: no allowance.
        if tested.len() == 0 || !opened.reopen(&self.columns, tested.as_slice(), &change, &[0.0; N]) {
            return false;
        }
        self.champion = opened;
        self.levels.forget_offsets();
        self.in_doubt = false;
        self.behind = None;
        self.probation = None;
        self.reopened = reopened;
        self.known_change = true;
        self.history.forget_snapshots();
        if let Some((detector, _)) = &mut self.detection {
            detector.clear();
        }
        true
    }

    /// Starts a challenger from before the change that the detector has found.
    pub(super) fn go_back(&mut self, change: &[f64; P], time_s: f64) {
        let Some((detector, challenge)) = &mut self.detection else { return };
        let onset = detector.onset(change);
        let Some(snapshot) = self.history.before(onset[0]) else { return detector.clear() };
        // There is place for one estimate beside the running one: what had been adopted before has been borne out so
        // far, or it would have been taken back.
        self.probation = None;
        let (slot, frame) = (&snapshot.slot, snapshot.frame);
        self.challenger = *slot;
        // What the levels have made of the change meanwhile; they stay so while the doubt is open, for both.
        if let Some(learnt) = &snapshot.levels {
            self.levels.go_back(learnt);
        }
        self.faults[1] = Faults::NONE;
        // Where the snapshots do not reach back, from the first one on.
        let earliest = onset[0].max(frame + 1);
        self.behind = Some(Behind { frame, open: [earliest, onset[1].max(earliest)] });
        // Of before the change: the change itself colours the residuals.
        let inflation = slot.common().colour.inflation();
        let tested = detector.tested();
        let colour = tested.iter().map(|j| at(inflation, *j)).sum::<f64>() / (tested.len() as f64).max(1.0);
        challenge.open(time_s, colour);
        self.in_doubt = true;
        self.catch_up();
    }

    /// Brings a challenger that has gone back nearer to the present.
    pub(super) fn catch_up(&mut self) {
        let Some(mut behind) = self.behind else { return };
        let change = self.change_over_prior();
        let newest = self.history.newest();
        for _ in 0..CATCH_UP {
            if behind.frame == newest {
                break;
            }
            let next = behind.frame + 1;
            if !self.open_before(next, &behind, &change) || !self.work_off(next) {
                return self.drop_challenger();
            }
            behind.frame = next;
        }
        self.behind = Some(behind);
        if behind.frame == newest {
            // What is not opened yet is opened with the next frame.
            if behind.open[1] > newest && !self.open_before(behind.open[1], &behind, &change) {
                return self.drop_challenger();
            }
            self.behind = None;
        }
    }

    /// Brings a challenger that has gone back to the present, because the state starts anew: at most all frames that
    /// are kept.
    pub(super) fn catch_up_at_once(&mut self) {
        for _ in 0..FRAMES {
            if self.behind.is_none() {
                break;
            }
            self.catch_up();
        }
    }

    /// Opens the challenger if that is due before a frame.
    fn open_before(&mut self, frame: u64, behind: &Behind, change: &[f64; P]) -> bool {
        let Self { levels, columns, output_of_state, challenger, detection, .. } = self;
        let Some((detector, _)) = detection else { return false };
        let [first, last] = behind.open;
        let mut state_variance = [0.0; N];
        if frame == first {
            for (variance, output) in state_variance.iter_mut().zip(output_of_state) {
                if let Some(output) = *output {
                    let std = at(&levels.std, output);
                    *variance = STATE_ALLOWANCE * std * std;
                }
            }
        } else if frame != last {
            return true;
        }
        challenger.reopen(columns, detector.tested(), change, &state_variance)
    }

    /// One frame of the past.
    fn work_off(&mut self, number: u64) -> bool {
        let first_s = self.first_s;
        let Self { model, settings, columns, levels, challenger, history, faults, behind, detection, .. } = self;
        let (Some(last), Some(frame)) = (history.frame(number - 1), history.frame(number)) else { return false };
        let input = IntervalInput { from: last.input, to: frame.input, hold: settings.input_hold };
        let mut unused = [[0.0; N]; N];
        let interval_s = frame.time_s - last.time_s;
        if !challenger.predict(model, settings, columns, levels, &input, interval_s, &mut unused) {
            return false;
        }
        let seen = settings.seen_input(last.input, frame.input);
        let adapt = !levels.are_learnt() && frame.time_s - first_s > ADAPTATION_START_S;
        let mut unused = [0.0; P];
        let outputs = &frame.outputs;
        let innovations =
            challenger.correct(model, settings, columns, levels, &seen, outputs, adapt, &mut unused, None, None);
        if let (Some(behind), Some((detector, challenge))) = (behind, detection)
            && number >= behind.open[0]
        {
            let merit = faults[1].merit(&innovations, settings.rejection_limit);
            challenge.past += history.merit(number).nats_for(&merit, detector.leverage());
        }
        faults[1].note(&innovations, S::gate(settings), settings.sample_time_s);
        if settings.colour_block(last.time_s - first_s) != settings.colour_block(frame.time_s - first_s) {
            challenger.close_colour_block();
        }
        challenger.is_sound(columns.count())
    }

    /// Without a challenger: asks the detector whether the parameters have changed, and starts a challenger if so.
    pub(super) fn watch(&mut self, since_start_s: f64, time_s: f64) {
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

    /// With a challenger: compares how well the two explain the newest frame, and decides. `innovations` are the
    /// challenger's.
    pub(super) fn contest(&mut self, innovations: &Innovations<R>, time_s: f64) {
        let change = self.change_over_prior();
        let Some((detector, challenge)) = &mut self.detection else { return };
        let limit = self.settings.rejection_limit;
        let merit = self.history.merit(self.history.newest());
        challenge.score += merit.nats_for(&self.faults[1].merit(innovations, limit), detector.leverage());
        let sound = self.challenger.is_sound(self.columns.count());
        let mut difference = [0.0; P];
        let mut covariance = [[0.0; P]; P];
        if sound {
            for j in 0..self.columns.count() {
                if self.columns.std[j] > 0.0 {
                    difference[j] =
                        (self.challenger.common().theta[j] - self.champion.common().theta[j]) / self.columns.std[j];
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

    /// The challenger becomes the estimate, and the former estimate its rival.
    pub(super) fn adopt_challenger(&mut self, time_s: f64) {
        let former = self.champion.variances();
        core::mem::swap(&mut self.champion, &mut self.challenger);
        self.levels.forget_offsets();
        self.faults.swap(0, 1);
        self.in_doubt = false;
        self.behind = None;
        self.history.forget_snapshots();
        self.adopted = true;
        self.reopened = Reopened::new(time_s, &former, &self.change_over_prior());
        let evidence = self.detection.as_ref().map_or(0.0, |(_, challenge)| challenge.score);
        // A former estimate that is lost is no rival.
        self.probation = self.challenger.is_sound(self.columns.count()).then(|| Probation::new(evidence));
        if let Some((detector, challenge)) = &mut self.detection {
            let widening = challenge.adopted(time_s);
            detector.widen_wander(widening);
            detector.clear();
        }
    }

    /// The former estimate is no rival any more.
    pub(super) fn end_probation(&mut self) {
        self.probation = None;
    }

    /// The former estimate has predicted better than the one that took its place, and takes its place again.
    pub(super) fn roll_back(&mut self) {
        core::mem::swap(&mut self.champion, &mut self.challenger);
        self.levels.forget_offsets();
        self.faults.swap(0, 1);
        self.probation = None;
        self.reopened = Reopened::NONE;
        self.history.forget_snapshots();
        self.rolled_back = true;
        if let Some((detector, challenge)) = &mut self.detection {
            let widening = challenge.was_rolled_back();
            detector.widen_wander(widening);
            detector.clear();
        }
    }

    /// Compares how the adopted estimate and the former one have predicted the newest frame. `innovations` are the
    /// former one's.
    pub(super) fn judge_probation(&mut self, innovations: &Innovations<R>) {
        let Some((detector, _)) = &self.detection else { return };
        let limit = self.settings.rejection_limit;
        let merit = self.history.merit(self.history.newest());
        let nats = merit.nats_for(&self.faults[1].merit(innovations, limit), detector.leverage());
        let lives = self.challenger.is_sound(self.columns.count());
        let known = !self.reopened.any();
        let Some(probation) = &mut self.probation else { return };
        match probation.judge(nats, known, lives) {
            Outcome::Undecided => {}
            Outcome::Confirmed => self.end_probation(),
            Outcome::RolledBack => self.roll_back(),
        }
    }

    pub(super) fn drop_challenger(&mut self) {
        self.in_doubt = false;
        self.behind = None;
        if let Some((detector, challenge)) = &mut self.detection {
            let widening = challenge.was_dropped();
            detector.widen_wander(widening);
            detector.clear();
        }
    }
}
