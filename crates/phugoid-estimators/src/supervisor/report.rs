//! What the estimator reports: the estimate with its standard errors and statuses, and internal quantities for
//! inspection.

use super::Supervisor;
use crate::estimate::{
    CONVERGED, ChangeState, DetectorReport, DetectorState, EXCITED, Estimate, Inspect, ParameterStatus, Status,
};
use crate::innovation::Innovations;
use crate::levels::NoiseReport;
use crate::model::Model;
use crate::settings::EstimatorSettings;
use crate::supervisor::learnt::Evidence;
use crate::supervisor::slot::Slot;

impl<S, M, const N: usize, const R: usize, const P: usize> Supervisor<S, M, N, R, P>
where
    S: Slot<N, P>,
    M: Model<N, R, P>,
{
    /// The model that the estimator was set up with.
    pub fn model(&self) -> &M {
        &self.model
    }

    /// The settings that the estimator was set up with.
    pub fn settings(&self) -> &EstimatorSettings<N, R, P> {
        &self.settings
    }

    /// Columns in use: the model's parameters and the biases.
    pub fn column_count(&self) -> usize {
        self.columns.count()
    }

    /// Column that holds the bias of an output.
    pub fn bias_column(&self, output: usize) -> Option<usize> {
        self.columns.bias(output)
    }

    /// Prior standard deviation per column, parameter units.
    pub fn prior_std(&self) -> &[f64; P] {
        &self.columns.std
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

    /// Scale of each state's process noise: `q_s`, adapted for all of them, or what is learnt of each.
    pub fn process_noise_scales(&self) -> [f64; N] {
        self.levels.scales(self.champion.common().noise_scale)
    }

    /// The noise levels in use, and what has been learnt of them.
    pub fn noise(&self) -> NoiseReport<R> {
        self.levels.report()
    }

    /// Error of a column (`true - estimated`) per unit of each constant that the model wants considered, in the model's
    /// order, parameter units; with the variances `P` of the constants, `sum_k T_jk^2 P_k` is the part of their errors
    /// in the variance of column `j`. None where the method or the model considers no constants, for a column that is
    /// not in use, and before the first frame.
    pub fn error_by_constant(&self, column: usize) -> Option<&[f64]> {
        if column < self.columns.count() { self.champion.by_constant(column) } else { None }
    }

    /// What the residuals say of the constants that can be learnt ([`Model::learnable_constants`]). None where the method or the
    /// model considers no constants, and before the first frame.
    pub fn evidence(&self) -> Option<Evidence<'_>> {
        self.champion.evidence(self.model.learnable_constants())
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
                if let Some(out) = out.get_mut(j) {
                    *out = 3.0 * detector.wander() * self.change_std(j);
                }
            }
        }
        out
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
        let p = self.columns.count();
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
                change: if self.adopted {
                    ChangeState::Adopted
                } else if self.rolled_back {
                    ChangeState::RolledBack
                } else if self.in_doubt {
                    ChangeState::InDoubt
                } else if self.probation.is_some() {
                    ChangeState::OnProbation
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
            let std = self.columns.std[j];
            let mut variance = variances[j];
            let mut corrected = variance * inflation[j];
            estimate.observability[j] = if std > 0.0 { (1.0 - variance).clamp(0.0, 1.0) } else { 0.0 };
            if self.in_doubt && std > 0.0 {
                // In doubt the bounds are wide enough to hold both the champion's and the challenger's estimate.
                let difference = (self.challenger.common().theta[j] - slot.theta[j]) / std;
                // A challenger that has not caught up yet has no estimate of now: the whole plausible change is added.
                let open = if self.behind.is_some() { change[j] * change[j] } else { 0.0 };
                let spread = open.max(difference * difference);
                variance = variance.max(challenger_variances[j]) + spread;
                corrected = corrected.max(challenger_variances[j] * challenger_inflation[j]) + spread;
            }
            estimate.std_error[j] = std * libm::sqrt(variance);
            estimate.corrected_std_error[j] = std * libm::sqrt(corrected);
            estimate.parameter_status[j] =
                self.parameter_status(j, estimate.observability[j], estimate.corrected_std_error[j]);
        }
        estimate
    }

    fn parameter_status(&self, j: usize, observability: f64, corrected: f64) -> ParameterStatus {
        let theta = self.champion.common().theta[j];
        // Held where the data want to leave: this is not a matter of what they say, but of the limit.
        if j < self.columns.own() && self.champion.common().limited[j] {
            return ParameterStatus::AtLimit;
        }
        let limited = j < self.columns.own() && {
            let prior = &self.settings.priors[j];
            theta - 2.0 * corrected > prior.upper || theta + 2.0 * corrected < prior.lower
        };
        let std = self.columns.std[j];
        let change = self.change_std(j);
        let scale = if change > 0.0 { std.min(2.0 * change) } else { std };
        if observability < EXCITED {
            ParameterStatus::NotExcited
        } else if self.reopened.is_unknown(j) {
            ParameterStatus::Unknown
        } else if limited {
            ParameterStatus::AtLimit
        } else if corrected <= CONVERGED * scale {
            ParameterStatus::Converged
        } else {
            ParameterStatus::Improving
        }
    }
}

impl<S, M, const N: usize, const R: usize, const P: usize> Inspect<R, P> for Supervisor<S, M, N, R, P>
where
    S: Slot<N, P>,
    M: Model<N, R, P>,
{
    fn column_count(&self) -> usize {
        Self::column_count(self)
    }

    fn prior_std(&self) -> &[f64; P] {
        Self::prior_std(self)
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

    fn reopen_columns_now(&mut self, columns: &[usize]) -> bool {
        Self::reopen_columns_now(self, columns)
    }

    fn restarts(&self) -> u32 {
        Self::restarts(self)
    }

    fn process_noise_scale(&self, state: usize) -> f64 {
        self.process_noise_scales().get(state).copied().unwrap_or(1.0)
    }

    fn reopened_s(&self) -> f64 {
        self.reopened.since_s
    }

    fn noise(&self) -> Option<NoiseReport<R>> {
        Some(Self::noise(self))
    }

    fn detector(&self) -> Option<DetectorReport> {
        Self::detector(self)
    }

    fn change_sensitivity(&self) -> [f64; P] {
        Self::change_sensitivity(self)
    }

    fn error_by_constant(&self, column: usize) -> Option<&[f64]> {
        Self::error_by_constant(self, column)
    }

    fn evidence(&self) -> Option<Evidence<'_>> {
        Self::evidence(self)
    }
}
