//! From samples to the terms of a regression: what every method of this family shares.

use super::gate::Gate;
use super::settings::RegressionSettings;
use super::source::{SourceStep, StateSource};
use crate::columns::Columns;
use crate::discretization::{IntervalInput, simulate};
use crate::model::{LinearizedOutputs, LinearizedRates, Model, Sample};
use crate::settings::SettingsError;
use crate::supervisor::slot::output_input;
use crate::supervisor::start::Start;

/// Time constant of the mean from which excitation is told, s.
const MEAN_TIME_S: f64 = 2.0;
/// A state that is this many sigmas of its measurement away from its own mean shows that something moves.
const MOVING_SIGMAS: f64 = 4.0;
/// A state whose measurement is missing for no longer than this, s, goes on as the source has it. Only its integral is taken
/// from there: the ends of the bridge are measured. Without a bridge each missing frame would leave the noise of two ends.
const BRIDGE_S: f64 = 0.1;

/// What became of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Taken {
    /// Its time did not increase.
    Refused,
    /// Collected for the start.
    Collected,
    /// The first of a stretch: nothing before it is remembered.
    First,
    /// One interval further.
    Next,
}

/// Known rates and regressors at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rates<const N: usize, const P: usize> {
    /// `f(x, u)`.
    pub(crate) known: [f64; N],
    /// `Phi(x, u)`.
    pub(crate) regressors: [[f64; P]; N],
}

/// The model, the source of its states, and the terms of the regression over the last interval.
pub(crate) struct Flow<M, S, const N: usize, const R: usize, const P: usize>
where
    M: Model<N, R, P>,
{
    pub(crate) model: M,
    pub(crate) source: S,
    pub(crate) settings: RegressionSettings<N, R, P>,
    pub(crate) columns: Columns<N, R, P>,
    start: Option<Start<M::Input, R>>,
    gate: Gate<R>,
    state: [f64; N],
    mean: [f64; N],
    last_s: f64,
    last_input: Option<M::Input>,
    restarts: u32,
    lin: LinearizedRates<N, P>,
    /// Length of the last interval, s.
    pub(crate) interval_s: f64,
    /// Rates at its start, with the input that acted from there on.
    pub(crate) before: Rates<N, P>,
    /// Rates at its end, with the input that acted up to there.
    pub(crate) after: Rates<N, P>,
    /// Rates at the start of the next interval.
    next: Rates<N, P>,
    /// For how long each state has not been measured, s.
    missing_s: [f64; N],
    /// Measured states at the start of the interval, bridged where they are missing for a moment; NaN for longer.
    pub(crate) measured_before: [f64; N],
    /// Measured states at its end.
    pub(crate) measured_after: [f64; N],
    /// Outputs at its end with the parameters at zero, and how the parameters enter them.
    pub(crate) outputs: LinearizedOutputs<N, R, P>,
    /// Believed outputs at its end; NaN for the others.
    pub(crate) believed: [f64; R],
    /// The model's outputs at its end before this frame was looked at.
    pub(crate) predicted: [f64; R],
    /// Whether something moves.
    pub(crate) excited: bool,
    /// Parameters that an output sees directly.
    seen: [bool; P],
    /// Parameters that drive each state.
    drives: [[bool; P]; N],
}

impl<M, S, const N: usize, const R: usize, const P: usize> Flow<M, S, N, R, P>
where
    M: Model<N, R, P>,
    S: StateSource<M::Input, N, R>,
{
    pub(crate) fn new(model: M, source: S, settings: RegressionSettings<N, R, P>) -> Result<Self, SettingsError> {
        settings.check(model.parameter_count())?;
        let columns = Columns::new(&model, &settings.common);
        let nothing = Rates { known: [0.0; N], regressors: [[0.0; P]; N] };
        Ok(Self {
            model,
            source,
            columns,
            start: Some(Start::new()),
            gate: Gate::new(settings.outlier_limit, &settings.common.noise_std),
            settings,
            state: [0.0; N],
            mean: [0.0; N],
            last_s: f64::NEG_INFINITY,
            last_input: None,
            restarts: 0,
            lin: LinearizedRates::ZERO,
            interval_s: 0.0,
            before: nothing,
            after: nothing,
            next: nothing,
            missing_s: [f64::INFINITY; N],
            measured_before: [f64::NAN; N],
            measured_after: [f64::NAN; N],
            outputs: LinearizedOutputs::ZERO,
            believed: [f64::NAN; R],
            predicted: [f64::NAN; R],
            excited: false,
            seen: [false; P],
            drives: [[false; P]; N],
        })
    }

    pub(crate) fn last_s(&self) -> f64 {
        self.last_s
    }

    pub(crate) fn restarts(&self) -> u32 {
        self.restarts
    }

    /// The state at which the regressors were evaluated.
    pub(crate) fn state(&self) -> &[f64; N] {
        &self.state
    }

    /// True if the rate of `state` makes an equation of the regression: it is measured, and driven by a parameter that no
    /// output sees directly.
    pub(crate) fn is_dynamic(&self, state: usize) -> bool {
        self.columns.output_of_state[state].is_some()
            && self.drives[state].iter().zip(&self.seen).any(|(drives, seen)| *drives && !seen)
    }

    /// True if an output makes an equation of the regression: it is used and sees a parameter directly.
    pub(crate) fn is_algebraic(&self, output: usize) -> bool {
        let std = self.settings.common.noise_std[output];
        std.is_finite()
            && std > 0.0
            && self.outputs.parameter_jacobian[output][..self.columns.own].iter().any(|d| *d != 0.0)
    }

    /// Takes a sample. `theta`: the present estimate; `spread(row)`: the variance of `row theta`.
    pub(crate) fn take(
        &mut self,
        sample: &Sample<M::Input, R>,
        theta: &[f64; P],
        spread: impl Fn(&[f64; P]) -> f64,
    ) -> Taken {
        if !sample.time_s.is_finite() || sample.time_s <= self.last_s {
            return Taken::Refused;
        }
        if self.start.is_some() {
            return self.collect(sample);
        }
        let interval_s = sample.time_s - self.last_s;
        let (Some(from), false) = (self.last_input, interval_s > self.settings.common.maximum_gap_s) else {
            return self.restart(sample);
        };
        let input = IntervalInput { from, to: sample.input, hold: self.settings.common.input_hold };
        let step_s = self.settings.common.maximum_step_s;
        let state = simulate(&self.model, &self.state, theta, &input, interval_s, step_s);
        let seen_input = output_input(&self.settings.common, from, sample.input);
        self.model.linearized_outputs(&state, theta, &seen_input, &mut self.outputs);
        self.predicted = self.outputs.outputs;
        for (output, bias) in self.columns.bias_of_output.iter().enumerate() {
            if let Some(column) = bias {
                self.predicted[output] += theta[*column];
            }
        }
        let Self { gate, outputs, predicted, columns, .. } = self;
        self.believed = gate.pass(sample.time_s, &sample.outputs, predicted, |output| {
            let mut row = [0.0; P];
            row[..columns.own].copy_from_slice(&outputs.parameter_jacobian[output][..columns.own]);
            spread(&row)
        });
        self.state = self.source.update(&SourceStep {
            interval_s,
            input_before: &from,
            input_after: &input.at(1.0),
            outputs: &self.believed,
            predicted_state: &state,
            predicted_outputs: &self.predicted,
        });
        if !self.state.iter().all(|value| value.is_finite()) {
            return self.restart(sample);
        }
        self.interval_s = interval_s;
        self.before = self.next;
        self.after = self.rates(&input.at(1.0));
        self.evaluate(sample, &seen_input);
        let finite = |rates: &Rates<N, P>| {
            let sum: f64 = rates.known.iter().sum::<f64>()
                + rates.regressors.iter().map(|row| row[..self.columns.own].iter().sum::<f64>()).sum::<f64>();
            sum.is_finite()
        };
        if !finite(&self.after) || !finite(&self.next) || !self.outputs.outputs.iter().all(|y| y.is_finite()) {
            return self.restart(sample);
        }
        self.look_for_motion(interval_s);
        Taken::Next
    }

    fn collect(&mut self, sample: &Sample<M::Input, R>) -> Taken {
        self.last_s = sample.time_s;
        let Some(start) = &mut self.start else { return Taken::Collected };
        start.push(sample);
        let Some(started) = start.state(&self.settings.common, &self.columns) else { return Taken::Collected };
        self.start = None;
        self.state = started.x;
        self.mean = started.x;
        self.excited = false;
        self.source.start(sample, &started.x);
        self.believed = [f64::NAN; R];
        self.predicted = [f64::NAN; R];
        self.missing_s = [f64::INFINITY; N];
        self.evaluate(sample, &sample.input);
        Taken::First
    }

    fn restart(&mut self, sample: &Sample<M::Input, R>) -> Taken {
        self.restarts = self.restarts.saturating_add(1);
        let mut start = Start::new();
        start.push(sample);
        self.start = Some(start);
        self.last_s = sample.time_s;
        self.last_input = None;
        Taken::Collected
    }

    /// Everything at the end of the interval but the left-limit rates.
    fn evaluate(&mut self, sample: &Sample<M::Input, R>, seen_input: &M::Input) {
        self.measured_before = self.measured_after;
        for state in 0..N {
            let measured = self.columns.output_of_state[state].map_or(f64::NAN, |output| self.believed[output]);
            self.missing_s[state] = if measured.is_finite() { 0.0 } else { self.missing_s[state] + self.interval_s };
            self.measured_after[state] = match self.missing_s[state] {
                0.0 => measured,
                missing if missing <= BRIDGE_S => self.state[state],
                _ => f64::NAN,
            };
        }
        self.next = self.rates(&sample.input);
        self.model.linearized_outputs(&self.state, &[0.0; P], seen_input, &mut self.outputs);
        for j in 0..self.columns.own {
            for state in 0..N {
                self.drives[state][j] |= self.next.regressors[state][j] != 0.0;
            }
        }
        for output in 0..R {
            if self.is_algebraic(output) && sample.outputs[output].is_finite() {
                for j in 0..self.columns.own {
                    self.seen[j] |= self.outputs.parameter_jacobian[output][j] != 0.0;
                }
            }
        }
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
    }

    /// The known rates are those with the parameters at zero.
    fn rates(&mut self, input: &M::Input) -> Rates<N, P> {
        self.model.linearized_rates(&self.state, &[0.0; P], input, &mut self.lin);
        Rates { known: self.lin.rates, regressors: self.lin.regressors }
    }

    fn look_for_motion(&mut self, interval_s: f64) {
        let gain = 1.0 - libm::exp(-interval_s / MEAN_TIME_S);
        let (mut moving, mut watched) = (false, false);
        for state in 0..N {
            self.mean[state] += gain * (self.state[state] - self.mean[state]);
            if let Some(output) = self.columns.output_of_state[state] {
                watched = true;
                let distance = (self.state[state] - self.mean[state]).abs();
                moving |= distance > MOVING_SIGMAS * self.settings.common.noise_std[output];
            }
        }
        // Without a measured state nothing can be said: then everything counts as motion.
        self.excited = moving || !watched;
    }
}
