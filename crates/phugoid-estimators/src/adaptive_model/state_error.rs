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

use crate::bounded::limited;
use crate::discretization::{InputHold, IntervalInput};
use crate::estimate::{Estimate, ParameterStatus, Phase, Status};

/// State after an interval and its derivatives by the parameters, row = state, column = parameter.
pub(super) type Predicted<const N: usize, const P: usize> = ([f64; N], [[f64; P]; N]);

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
    /// The error of each state enters divided by this, state units, positive.
    pub(super) scale: [f64; N],
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
    /// Longest interval that is predicted through, s; after a longer one the model starts again from the measurements.
    pub(super) maximum_gap_s: f64,
}

/// The law over all `N` states of a model whose input is `I`. It knows the model only by what it is given in
/// [`StateErrorLaw::update`].
pub(super) struct StateErrorLaw<I, const N: usize, const P: usize> {
    /// Parameters that the model has.
    count: usize,
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
    last_input: Option<I>,
    phase: Phase,
}

impl<I: Copy, const N: usize, const P: usize> StateErrorLaw<I, N, P> {
    /// Sets the law up for a model with `count` parameters; the first frame with all states starts it. `None` if a start value lies outside its bounds, a range is
    /// negative, all of them are zero, or a number that must be positive is not.
    pub(super) fn new(count: usize, settings: StateErrorSettings<N, P>) -> Option<Self> {
        let count = count.min(P);
        let possible = |j: usize| {
            let (start, range) = (settings.parameters[j], settings.ranges[j]);
            let within = settings.lower[j] <= start && start <= settings.upper[j];
            start.is_finite() && within && range.is_finite() && range >= 0.0
        };
        let unknown = settings.ranges[..count].iter().any(|range| *range > 0.0);
        let positive = [settings.gain, settings.normalisation, settings.error_decay]
            .into_iter()
            .chain([settings.maximum_gap_s])
            .all(|value| value > 0.0 && value.is_finite());
        if N == 0 || !(0..count).all(possible) || !unknown || !positive {
            return None;
        }
        Some(Self {
            count,
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

    /// Parameters that the model has.
    pub(super) fn count(&self) -> usize {
        self.count.min(P)
    }

    /// State of the estimated model.
    pub(super) fn state(&self) -> [f64; N] {
        core::array::from_fn(|i| self.x[i] - self.error[i])
    }

    /// Takes one sample: its time (s), the input from then on and the measured states (NaN where one is missing). `predict` gives
    /// from a state, the parameters, the input and the length of an interval (s) the state at the end of it, with its derivatives
    /// by the parameters.
    pub(super) fn update(
        &mut self,
        time_s: f64,
        input: I,
        measured: &[f64; N],
        predict: impl FnOnce(&[f64; N], &[f64; P], &IntervalInput<I>, f64) -> Predicted<N, P>,
    ) -> Estimate<P> {
        if !time_s.is_finite() || time_s <= self.last_s {
            self.phase = Phase::Rejected;
        } else if self.running {
            self.advance(time_s, input, measured, predict);
        } else {
            self.start(time_s, input, measured);
        }
        self.estimate()
    }

    /// Infinite for the unknown parameters: the law knows no covariance.
    pub(super) fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        for j in 0..self.count() {
            if self.settings.ranges[j] > 0.0 {
                out[j][j] = f64::INFINITY;
            }
        }
    }

    fn start(&mut self, time_s: f64, input: I, measured: &[f64; N]) {
        self.phase = Phase::Starting;
        self.running = false;
        self.last_s = time_s;
        self.last_input = Some(input);
        if !complete(measured) {
            return;
        }
        self.x = *measured;
        self.error = [0.0; N];
        self.running = true;
    }

    fn advance(
        &mut self,
        time_s: f64,
        input: I,
        measured: &[f64; N],
        predict: impl FnOnce(&[f64; N], &[f64; P], &IntervalInput<I>, f64) -> Predicted<N, P>,
    ) {
        let interval_s = time_s - self.last_s;
        let Some(from) = self.last_input else { return self.start(time_s, input, measured) };
        if interval_s > self.settings.maximum_gap_s {
            return self.start(time_s, input, measured);
        }
        let over = IntervalInput { from, to: input, hold: self.settings.input_hold };
        self.last_s = time_s;
        self.last_input = Some(input);
        let complete = complete(measured);
        let (x, sensitivity) = predict(&self.x, &self.theta, &over, interval_s);
        self.x = x;
        if !self.x.iter().all(|value| value.is_finite()) {
            return self.start(time_s, input, measured);
        }
        let step = self.step(measured, &sensitivity, interval_s);
        if complete {
            self.adapt(&step);
        }
        self.phase = if complete { Phase::Sliding } else { Phase::Predicting };
    }

    /// Takes the errors on by one sample and the states from their measurements; gives the step of `theta/R`.
    fn step(&mut self, measured: &[f64; N], sensitivity: &[[f64; P]; N], interval_s: f64) -> [f64; P] {
        let decay = libm::exp(-self.settings.error_decay * interval_s);
        let mut step = [0.0; P];
        let mut squared = 0.0;
        for i in 0..N {
            let (measured, scale) = (measured[i], self.settings.scale[i]);
            self.error[i] *= decay;
            if !measured.is_finite() {
                continue;
            }
            // The prediction started on the last measurement: what it misses is B (truth - theta).
            self.error[i] += measured - self.x[i];
            self.x[i] = measured;
            for j in 0..P {
                let b = sensitivity[i][j] * self.settings.ranges[j] / scale;
                step[j] += b * self.error[i] / scale;
                squared += b * b / (interval_s * interval_s);
            }
        }
        let factor = self.settings.gain / (self.settings.normalisation + squared);
        step.map(|s| factor * s)
    }

    /// Moves the parameters by `step` of their ranges and projects them; a step that is not a number moves nothing.
    fn adapt(&mut self, step: &[f64; P]) {
        for (j, step) in step.iter().enumerate().take(self.count()) {
            let moved = self.theta[j] + self.settings.ranges[j] * step;
            if moved.is_finite() && moved != self.theta[j] {
                self.theta[j] = limited(moved, self.settings.lower[j], self.settings.upper[j]);
                self.moved[j] = true;
            }
        }
    }

    fn estimate(&self) -> Estimate<P> {
        let unknown = |j: usize| j < self.count && self.settings.ranges[j] > 0.0;
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

/// Whether every state is measured.
fn complete(measured: &[f64]) -> bool {
    measured.iter().all(|value| value.is_finite())
}
