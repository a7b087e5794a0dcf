//! A change in doubt: what the detector suspects, whom the challenger beats, and what becomes of it.

use super::Supervisor;
use crate::change_detection::challenge::{Verdict, maturity, needed_maturity};
use crate::innovation::Innovations;
use crate::model::Model;
use crate::supervisor::slot::Slot;

impl<S, M, const N: usize, const R: usize, const P: usize> Supervisor<S, M, N, R, P>
where
    S: Slot<N, R, P>,
    M: Model<N, R, P>,
{
    /// No challenger: has anything changed?
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

    /// A challenger runs: who explains the newest frame? `innovations` are the challenger's.
    pub(super) fn contest(&mut self, innovations: &Innovations<R>, time_s: f64) {
        let change = self.change_over_prior();
        let Some((detector, challenge)) = &mut self.detection else { return };
        let limit = S::shared(&self.settings).rejection_limit;
        let merit = self.history.merit(self.history.newest());
        challenge.score += merit.nats_for(&self.faults[1].merit(innovations, limit), detector.leverage());
        let sound = self.challenger.is_sound(self.columns.count);
        let mut difference = [0.0; P];
        let mut covariance = [[0.0; P]; P];
        if sound {
            for j in 0..self.columns.count {
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

    pub(super) fn adopt_challenger(&mut self, time_s: f64) {
        self.champion = self.challenger;
        self.faults[0] = self.faults[1];
        self.in_doubt = false;
        self.behind = None;
        self.history.forget_snapshots();
        self.adopted = true;
        if let Some((detector, challenge)) = &mut self.detection {
            let widening = challenge.adopted(time_s);
            detector.widen_wander(widening);
            detector.clear();
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
