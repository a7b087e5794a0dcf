//! The state-error law of the model-reference estimator (K. S. Narendra, A. M. Annaswamy, *Stable Adaptive Systems*, 1989,
//! chapter 3): every measured state is compared with that of an estimated model, and the error moves the parameters.
//!
//! The estimated model is integrated from the last measurement; with `B = dF/dtheta` of that map, `rho = exp(-k h)` and `D`
//! the scales of the channels,
//!
//! ```text
//! e+     = rho e + ym - F(ym before)
//! theta+ = theta + R g/(c + |B R / D h|^2) (B R / D)^T e+ / D
//! ```
//!
//! `phugoid-thesis` has this law beside the other forms that the thesis compares with, and tests that both give the same.

use crate::discretization::{self, InputHold, IntervalInput, Part};
use crate::estimate::{Estimate, ParameterStatus, Phase, Status};
use crate::model::{Model, Sample};

/// The measurement of one state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    /// Output that measures the state directly.
    pub(super) output: usize,
    /// The state's error enters divided by this, state units, positive.
    pub(super) scale: f64,
}

/// What the law is told.
#[derive(Clone, Copy, Debug)]
pub(super) struct StateErrorSettings<const N: usize, const P: usize> {
    /// Start values, parameter units.
    pub(super) parameters: [f64; P],
    /// `R`: typical size of the uncertainty of each parameter, its units; 0 for one that is known and stays.
    pub(super) ranges: [f64; P],
    /// Lower bounds onto which the parameters are projected.
    pub(super) lower: [f64; P],
    /// Upper bounds.
    pub(super) upper: [f64; P],
    /// How each state is measured.
    pub(super) channels: [Channel; N],
    /// `g`, 1/s^2.
    pub(super) gain: f64,
    /// `c`, 1/s^2.
    pub(super) normalisation: f64,
    /// `k`, 1/s.
    pub(super) error_decay: f64,
    /// Start of the states.
    pub(super) initial_state: [f64; N],
    /// Input between samples.
    pub(super) input_hold: InputHold,
    /// Longest integration step, s.
    pub(super) maximum_step_s: f64,
    /// Longest interval that is predicted through, s; after a longer one the model starts again from the measurements.
    pub(super) maximum_gap_s: f64,
}

/// The law over all `N` states of a model.
pub(super) struct StateErrorLaw<M, const N: usize, const R: usize, const P: usize>
where
    M: Model<N, R, P>,
{
    model: M,
    settings: StateErrorSettings<N, P>,
    running: bool,
    theta: [f64; P],
    /// Where the next interval is integrated from.
    x: [f64; N],
    /// `e` of each state, state units.
    error: [f64; N],
    /// Whether a parameter has moved.
    moved: [bool; P],
    last_s: f64,
    last_input: Option<M::Input>,
    phase: Phase,
}

impl<M, const N: usize, const R: usize, const P: usize> StateErrorLaw<M, N, R, P>
where
    M: Model<N, R, P>,
{
    /// Sets the law up; the first frame with all states starts it. `None` if a start value lies outside its bounds, a range is
    /// negative, all of them are zero, or a number that must be positive is not.
    pub(super) fn new(model: M, settings: StateErrorSettings<N, P>) -> Option<Self> {
        let count = model.parameter_count().min(P);
        let possible = |j: usize| {
            let (start, range) = (settings.parameters[j], settings.ranges[j]);
            let within = settings.lower[j] <= start && start <= settings.upper[j];
            start.is_finite() && within && range.is_finite() && range >= 0.0
        };
        let unknown = settings.ranges[..count].iter().any(|range| *range > 0.0);
        let positive = [settings.gain, settings.normalisation, settings.error_decay]
            .into_iter()
            .chain([settings.maximum_step_s, settings.maximum_gap_s])
            .all(|value| value > 0.0 && value.is_finite());
        if N == 0 || !(0..count).all(possible) || !unknown || !positive {
            return None;
        }
        Some(Self {
            model,
            settings,
            running: false,
            theta: core::array::from_fn(|j| if j < count { settings.parameters[j] } else { 0.0 }),
            x: settings.initial_state,
            error: [0.0; N],
            moved: [false; P],
            last_s: f64::NEG_INFINITY,
            last_input: None,
            phase: Phase::Starting,
        })
    }

    pub(super) fn model(&self) -> &M {
        &self.model
    }

    /// State of the estimated model.
    pub(super) fn state(&self) -> [f64; N] {
        core::array::from_fn(|i| self.x[i] - self.error[i])
    }

    pub(super) fn update(&mut self, sample: &Sample<M::Input, R>) -> Estimate<P> {
        if !sample.time_s.is_finite() || sample.time_s <= self.last_s {
            self.phase = Phase::Rejected;
        } else if self.running {
            self.advance(sample);
        } else {
            self.start(sample);
        }
        self.estimate()
    }

    /// Infinite for the unknown parameters: the law knows no covariance.
    pub(super) fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        for j in 0..self.model.parameter_count().min(P) {
            if self.settings.ranges[j] > 0.0 {
                out[j][j] = f64::INFINITY;
            }
        }
    }

    fn start(&mut self, sample: &Sample<M::Input, R>) {
        self.phase = Phase::Starting;
        self.running = false;
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        if !self.complete(sample) {
            return;
        }
        self.x = core::array::from_fn(|i| sample.outputs[self.settings.channels[i].output]);
        self.error = [0.0; N];
        self.running = true;
    }

    /// Whether every state is measured in this frame.
    fn complete(&self, sample: &Sample<M::Input, R>) -> bool {
        self.settings.channels.iter().all(|channel| sample.outputs[channel.output].is_finite())
    }

    fn advance(&mut self, sample: &Sample<M::Input, R>) {
        let interval_s = sample.time_s - self.last_s;
        let Some(from) = self.last_input else { return self.start(sample) };
        if interval_s > self.settings.maximum_gap_s {
            return self.start(sample);
        }
        let input = IntervalInput { from, to: sample.input, hold: self.settings.input_hold };
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        let complete = self.complete(sample);
        let sensitivity = self.integrate(&input, interval_s);
        if !self.x.iter().all(|value| value.is_finite()) {
            return self.start(sample);
        }
        let step = self.step(sample, &sensitivity, interval_s);
        if complete {
            self.adapt(&step);
        }
        self.phase = if complete { Phase::Sliding } else { Phase::Predicting };
    }

    /// The estimated model over one interval; gives `B`.
    fn integrate(&mut self, input: &IntervalInput<M::Input>, interval_s: f64) -> [[f64; P]; N] {
        let steps = discretization::sub_steps(interval_s, self.settings.maximum_step_s);
        let mut sensitivity = [[0.0; P]; N];
        let mut transition = [[0.0; N]; N];
        for k in 0..steps {
            let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
            self.x = discretization::step(
                &self.model,
                &self.x,
                &self.theta,
                input,
                interval_s,
                part,
                self.model.parameter_count().min(P),
                &mut sensitivity,
                &mut transition,
            );
        }
        sensitivity
    }

    /// Takes the errors on by one sample and the states from their measurements; gives the step of `theta/R`.
    fn step(&mut self, sample: &Sample<M::Input, R>, sensitivity: &[[f64; P]; N], interval_s: f64) -> [f64; P] {
        let decay = libm::exp(-self.settings.error_decay * interval_s);
        let mut step = [0.0; P];
        let mut squared = 0.0;
        for (i, channel) in self.settings.channels.iter().enumerate() {
            self.error[i] *= decay;
            let measured = sample.outputs[channel.output];
            if !measured.is_finite() {
                continue;
            }
            // The prediction started on the last measurement: what it misses is B (truth - theta).
            self.error[i] += measured - self.x[i];
            self.x[i] = measured;
            for j in 0..P {
                let b = sensitivity[i][j] * self.settings.ranges[j] / channel.scale;
                step[j] += b * self.error[i] / channel.scale;
                squared += b * b / (interval_s * interval_s);
            }
        }
        let factor = self.settings.gain / (self.settings.normalisation + squared);
        step.map(|s| factor * s)
    }

    /// Moves the parameters by `step` of their ranges and projects them; a step that is not a number moves nothing.
    fn adapt(&mut self, step: &[f64; P]) {
        for (j, step) in step.iter().enumerate().take(self.model.parameter_count().min(P)) {
            let moved = self.theta[j] + self.settings.ranges[j] * step;
            if moved.is_finite() && moved != self.theta[j] {
                self.theta[j] = moved.clamp(self.settings.lower[j], self.settings.upper[j]);
                self.moved[j] = true;
            }
        }
    }

    fn estimate(&self) -> Estimate<P> {
        let unknown = |j: usize| j < self.model.parameter_count() && self.settings.ranges[j] > 0.0;
        let std_error = core::array::from_fn(|j| if unknown(j) { f64::INFINITY } else { 0.0 });
        let parameter_status = core::array::from_fn(|j| {
            if unknown(j) && (self.theta[j] <= self.settings.lower[j] || self.theta[j] >= self.settings.upper[j]) {
                ParameterStatus::AtLimit
            } else if self.moved[j] {
                ParameterStatus::Improving
            } else {
                ParameterStatus::NotExcited
            }
        });
        Estimate {
            time_s: self.last_s,
            parameters: self.theta,
            std_error,
            corrected_std_error: std_error,
            observability: [0.0; P],
            parameter_status,
            status: Status { phase: self.phase, ..Status::default() },
        }
    }
}
