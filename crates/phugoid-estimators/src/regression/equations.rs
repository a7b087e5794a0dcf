//! From samples to the terms of a regression: what every method of this family shares.

use super::gate::Gate;
use super::row_source::{Frame, RowSource, Taken};
use super::rows::{Kreisselmeier, Rates, Row};
use super::source::{SourceStep, StateError, StateSource};
use crate::bounded::at;
use crate::columns::Columns;
use crate::discretization::{IntervalInput, simulate};
use crate::kernels::add_scaled;
use crate::model::{LinearizedOutputs, LinearizedRates, Model, Sample};
use crate::settings::{EstimatorSettings, SettingsError};
use crate::supervisor::start::Start;

/// Time constant of the running mean from which the motion of a state is judged, s.
const MEAN_TIME_S: f64 = 2.0;
/// A state that is this many sigmas of its measurement away from its own mean shows that something moves.
const MOVING_SIGMAS: f64 = 4.0;
/// A state whose measurement is missing for no longer than this, s, goes on as the source has it. Only its integral is
/// taken from there: the ends of the bridge are measured. Without a bridge each missing frame would leave the noise of
/// two ends.
const BRIDGE_S: f64 = 0.1;
/// Shortest block of the colour correction, s: the residuals of a regression stay correlated for about that long.
const LEAST_COLOUR_BLOCK_S: f64 = 1.0;

/// One sigma of noise together with another variance, which counts if it is a number.
fn with_added(noise_std: f64, added: f64) -> f64 {
    if added.is_finite() && added > 0.0 { libm::sqrt(noise_std * noise_std + added) } else { noise_std }
}

/// The regression of a model: the model, the source of its states, and the terms of the equations over the last
/// interval.
pub struct Regression<M, S, const N: usize, const R: usize, const P: usize>
where
    M: Model<N, R, P>,
{
    pub(crate) model: M,
    pub(crate) source: S,
    pub(crate) settings: EstimatorSettings<N, R, P>,
    pub(crate) frame: Frame<R, P>,
    pub(crate) output_of_state: [Option<usize>; N],
    filters: Kreisselmeier<N, P>,
    start: Option<Start<M::Input, R>>,
    gate: Gate<R>,
    state: [f64; N],
    mean: [f64; N],
    last_input: Option<M::Input>,
    lin: LinearizedRates<N, P>,
    /// Rates at the start of the last interval, with the input that acted from there on.
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
    /// What errors of the states add to the variance of each output, output units squared.
    added_to_outputs: [f64; R],
    /// ... and to that of the filtered rate of each state, state units squared.
    added_to_rates: [f64; N],
    /// Parameters that an output sees directly.
    seen: [bool; P],
    /// Parameters that drive each state.
    drives: [[bool; P]; N],
}

impl<M, S, const N: usize, const R: usize, const P: usize> Regression<M, S, N, R, P>
where
    M: Model<N, R, P>,
    S: StateSource<M::Input, N, R>,
{
    /// Sets the regression up; the first samples start its states.
    ///
    /// # Errors
    /// [`SettingsError`]: which setting does not fit the model or is impossible.
    pub fn new(model: M, source: S, settings: EstimatorSettings<N, R, P>) -> Result<Self, SettingsError> {
        let parameters = model.parameter_count();
        if parameters > P {
            return Err(SettingsError::Capacity { needed: parameters, capacity: P });
        }
        settings.check(parameters)?;
        settings.regression.check()?;
        let nothing = Rates { known: [0.0; N], regressors: [[0.0; P]; N] };
        Ok(Self {
            output_of_state: settings.output_of_state(&model),
            model,
            source,
            frame: Frame {
                columns: Columns::new(&settings, parameters),
                priors: settings.priors,
                settings: settings.regression,
                colour_block_s: settings.colour_block_s.max(LEAST_COLOUR_BLOCK_S),
                last_s: f64::NEG_INFINITY,
                interval_s: 0.0,
                predicted: [f64::NAN; R],
                believed: [f64::NAN; R],
                excited: false,
                restarts: 0,
            },
            filters: Kreisselmeier::new(settings.regression.filter_rate),
            start: Some(Start::new()),
            gate: Gate::new(settings.regression.outlier_limit, &settings.noise_std, settings.regression.reopens),
            settings,
            state: [0.0; N],
            mean: [0.0; N],
            last_input: None,
            lin: LinearizedRates::ZERO,
            before: nothing,
            after: nothing,
            next: nothing,
            missing_s: [f64::INFINITY; N],
            measured_before: [f64::NAN; N],
            measured_after: [f64::NAN; N],
            outputs: LinearizedOutputs::ZERO,
            added_to_outputs: [0.0; R],
            added_to_rates: [0.0; N],
            seen: [false; P],
            drives: [[false; P]; N],
        })
    }

    /// Where the regressors' states come from.
    pub fn source(&self) -> &S {
        &self.source
    }

    /// The states at which the regressors were last evaluated, state units.
    pub fn state(&self) -> &[f64; N] {
        &self.state
    }

    /// True if the rate of `state` makes an equation of the regression: it is measured, and driven by a parameter that
    /// no output sees directly.
    pub(crate) fn is_dynamic(&self, state: usize) -> bool {
        let Some(drives) = self.drives.get(state) else { return false };
        self.output_of(state).is_some() && drives.iter().zip(&self.seen).any(|(drives, seen)| *drives && !seen)
    }

    /// The output that measures a state; there is such an output.
    #[inline(always)]
    pub(crate) fn output_of(&self, state: usize) -> Option<usize> {
        self.output_of_state.get(state).copied().flatten().filter(|output| *output < R)
    }

    /// True if an output makes an equation of the regression: it is used and sees a parameter directly.
    pub(crate) fn is_algebraic(&self, output: usize) -> bool {
        let Some(row) = self.outputs.parameter_jacobian.get(output) else { return false };
        let std = at(&self.settings.noise_std, output);
        std.is_finite() && std > 0.0 && row[..self.frame.columns.own()].iter().any(|d| *d != 0.0)
    }

    /// [`RowSource::take`] without the filters of its rows.
    pub(crate) fn advance(
        &mut self,
        sample: &Sample<M::Input, R>,
        theta: &[f64; P],
        spread: impl Fn(&[f64; P]) -> f64,
    ) -> Taken {
        if !sample.time_s.is_finite() || sample.time_s <= self.frame.last_s {
            return Taken::Refused;
        }
        if self.start.is_some() {
            return self.collect(sample);
        }
        let interval_s = sample.time_s - self.frame.last_s;
        let (Some(from), false) = (self.last_input, interval_s > self.settings.maximum_gap_s) else {
            return self.restart(sample);
        };
        let input = IntervalInput { from, to: sample.input, hold: self.settings.input_hold };
        let step_s = self.settings.maximum_step_s;
        let state = simulate(&self.model, &self.state, theta, &input, interval_s, step_s);
        let seen_input = self.settings.seen_input(from, sample.input);
        self.model.linearized_outputs(&state, theta, &seen_input, &mut self.outputs);
        self.frame.predicted = self.outputs.outputs;
        for output in 0..R {
            if let Some(column) = self.frame.columns.bias(output) {
                self.frame.predicted[output] += theta[column];
            }
        }
        let Self { gate, outputs, frame, next, .. } = self;
        let own = frame.columns.own();
        let reopens = frame.settings.reopens;
        frame.believed = gate.pass(sample.time_s, &sample.outputs, &frame.predicted, |output| {
            let mut row = [0.0; P];
            if let Some(from) = outputs.parameter_jacobian.get(output) {
                row[..own].copy_from_slice(&from[..own]);
            }
            if let (true, Some(h)) = (reopens, outputs.state_jacobian.get(output)) {
                // What the parameters do not know of the rates, over one interval.
                for (h, regressors) in h.iter().zip(&next.regressors) {
                    if *h != 0.0 {
                        add_scaled(&mut row[..own], interval_s * h, &regressors[..own]);
                    }
                }
            }
            spread(&row)
        });
        self.state = self.source.update(&SourceStep {
            interval_s,
            input_before: &from,
            input_after: &input.at(1.0),
            outputs: &self.frame.believed,
            predicted_state: &state,
            predicted_outputs: &self.frame.predicted,
        });
        if !self.state.iter().all(|value| value.is_finite()) {
            return self.restart(sample);
        }
        self.allow_for_errors_of_states(theta, &input.at(1.0));
        self.frame.interval_s = interval_s;
        self.before = self.next;
        self.after = self.rates(&input.at(1.0));
        self.evaluate(sample, &seen_input);
        let finite = |rates: &Rates<N, P>| {
            let sum: f64 = rates.known.iter().sum::<f64>()
                + rates.regressors.iter().map(|row| row[..self.frame.columns.own()].iter().sum::<f64>()).sum::<f64>();
            sum.is_finite()
        };
        if !finite(&self.after) || !finite(&self.next) || !self.outputs.outputs.iter().all(|y| y.is_finite()) {
            return self.restart(sample);
        }
        self.look_for_motion(interval_s);
        Taken::Next
    }

    /// What errors of the states make of outputs and of filtered rates, by the present parameters.
    fn allow_for_errors_of_states(&mut self, theta: &[f64; P], input: &M::Input) {
        let errors = self.source.errors();
        if errors.iter().all(|error| error.variance <= 0.0) {
            (self.added_to_outputs, self.added_to_rates) = ([0.0; R], [0.0; N]);
            return;
        }
        let pole = self.settings.regression.filter_rate;
        let sum = |slopes: &[f64; N], variance: &dyn Fn(&StateError) -> f64| -> f64 {
            slopes.iter().zip(&errors).map(|(slope, error)| slope * slope * variance(error)).sum()
        };
        for (added, slopes) in self.added_to_outputs.iter_mut().zip(&self.outputs.state_jacobian) {
            *added = sum(slopes, &|error| error.variance);
        }
        self.model.linearized_rates(&self.state, theta, input, &mut self.lin);
        for (added, slopes) in self.added_to_rates.iter_mut().zip(&self.lin.state_jacobian) {
            *added = sum(slopes, &|error| error.filtered(pole));
        }
    }

    fn collect(&mut self, sample: &Sample<M::Input, R>) -> Taken {
        self.filters.clear();
        self.frame.last_s = sample.time_s;
        let Some(start) = &mut self.start else { return Taken::Collected };
        start.push(sample);
        let Some(started) = start.state(&self.settings, &self.settings.noise_std, &self.output_of_state) else {
            return Taken::Collected;
        };
        self.start = None;
        self.state = started.x;
        self.mean = started.x;
        self.frame.excited = false;
        self.source.start(sample, &started.x);
        self.frame.believed = [f64::NAN; R];
        self.frame.predicted = [f64::NAN; R];
        self.missing_s = [f64::INFINITY; N];
        self.evaluate(sample, &sample.input);
        Taken::First
    }

    fn restart(&mut self, sample: &Sample<M::Input, R>) -> Taken {
        self.filters.clear();
        self.frame.restarts = self.frame.restarts.saturating_add(1);
        let mut start = Start::new();
        start.push(sample);
        self.start = Some(start);
        self.frame.last_s = sample.time_s;
        self.last_input = None;
        Taken::Collected
    }

    /// Everything at the end of the interval but the left-limit rates.
    fn evaluate(&mut self, sample: &Sample<M::Input, R>, seen_input: &M::Input) {
        self.measured_before = self.measured_after;
        for state in 0..N {
            let measured = self.output_of(state).map_or(f64::NAN, |output| self.frame.believed[output]);
            self.missing_s[state] =
                if measured.is_finite() { 0.0 } else { self.missing_s[state] + self.frame.interval_s };
            self.measured_after[state] = match self.missing_s[state] {
                0.0 => measured,
                missing if missing <= BRIDGE_S => self.state[state],
                _ => f64::NAN,
            };
        }
        self.next = self.rates(&sample.input);
        self.model.linearized_outputs(&self.state, &[0.0; P], seen_input, &mut self.outputs);
        for j in 0..self.frame.columns.own() {
            for state in 0..N {
                self.drives[state][j] |= self.next.regressors[state][j] != 0.0;
            }
        }
        for output in 0..R {
            if self.is_algebraic(output) && sample.outputs[output].is_finite() {
                for j in 0..self.frame.columns.own() {
                    self.seen[j] |= self.outputs.parameter_jacobian[output][j] != 0.0;
                }
            }
        }
        self.frame.last_s = sample.time_s;
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
            if let Some(output) = self.output_of(state) {
                watched = true;
                let distance = (self.state[state] - self.mean[state]).abs();
                moving |= distance > MOVING_SIGMAS * self.settings.noise_std[output];
            }
        }
        // Without a measured state nothing can be said: then everything counts as motion.
        self.frame.excited = moving || !watched;
    }
}

impl<M, S, const N: usize, const R: usize, const P: usize> RowSource<R, P> for Regression<M, S, N, R, P>
where
    M: Model<N, R, P>,
    S: StateSource<M::Input, N, R>,
{
    type Input = M::Input;

    fn frame(&self) -> &Frame<R, P> {
        &self.frame
    }

    fn take(&mut self, sample: &Sample<Self::Input, R>, theta: &[f64; P], spread: impl Fn(&[f64; P]) -> f64) -> Taken {
        let taken = self.advance(sample, theta, spread);
        if taken == Taken::Next {
            let (h, own) = (self.frame.interval_s, self.frame.columns.own());
            let Self { filters, before, after, measured_before, measured_after, .. } = self;
            filters.advance(h, own, [measured_before, measured_after], [before, after]);
        }
        taken
    }

    fn rows(&self, mut use_row: impl FnMut(&Row<P>)) {
        let Frame { columns, believed, .. } = &self.frame;
        let own = columns.own();
        for output in 0..R {
            let measured = believed[output];
            if measured.is_finite() && self.is_algebraic(output) {
                let known = self.outputs.outputs[output];
                let std = with_added(self.settings.noise_std[output], at(&self.added_to_outputs, output));
                let mut row = Row { output, z: measured - known, w: [0.0; P], known, std };
                row.w[..own].copy_from_slice(&self.outputs.parameter_jacobian[output][..own]);
                if let Some(column) = columns.bias(output) {
                    row.w[column] = 1.0;
                }
                use_row(&row);
            }
        }
        for state in 0..N {
            let (before, after) = (self.measured_before[state], self.measured_after[state]);
            let Some(output) = self.output_of(state) else { continue };
            if before.is_finite() && believed[output].is_finite() && self.is_dynamic(state) {
                let (z, w) = self.filters.of_state(state);
                let std = with_added(self.settings.noise_std[output], at(&self.added_to_rates, state));
                use_row(&Row { output, z, w, known: after - z, std });
            }
        }
    }
}
