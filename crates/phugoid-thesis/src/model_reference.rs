//! The model-reference estimator that the thesis compares its sliding-mode law with (Gurbacki, RIT, 2010, equations
//! 3.1 to 3.3), what gradient descent of its cost would really be, and the textbook's form, each plain and normalised.
//!
//! An estimated model runs beside the plant. With channels `i` (`y` of the estimated model, `ym` measured, both divided
//! by the channel's scale), ranges `R_j` that make parameters comparable, and `g` the gain:
//!
//! ```text
//! S = sum_i (y_i^2 - ym_i^2),   J = S^2/2                                                              (3.1)
//! theta' = -lambda dJ/dtheta                                                                           (3.2)
//!
//! printed          theta_j' = -g R_j   sum_i (y_i y_i' - ym_i ym_i')                                   (3.3)
//! energy gradient  theta_j' = -g R_j^2 S dS/dtheta_j,        dS/dtheta = 2 sum_i y_i dy_i/dtheta
//! state error      theta_j' =  g R_j^2 sum_i Phi_ij e_i,     y_i' = F_i + Phi_i theta + k e_i,   e = ym - y
//!
//! normalised: divided by c + |gradient|^2, the gradient being sum_i y_i Phi_ij R_j, dS/dtheta_j R_j, Phi_ij R_j
//! ```
//!
//! # What (3.3) is, against (3.2)
//!
//! Equation (3.3) is not the gradient descent that (3.2) announces. `sum (y y' - ym ym')` is half the derivative of `S`
//! with respect to *time*; (3.2) asks for its derivative with respect to the parameter, which is the sensitivity of the
//! estimated model (`dy/dtheta`, a differential equation of its own) and has to be multiplied by `S`. What follows:
//!
//! * The printed law can be integrated: `theta(t) = theta(0) - g R (S(t) - S(0))/2`. It is a proportional feedback of
//!   the energy and keeps no memory: whenever the two models have the same energy, the estimate is where it began. As
//!   `y^2 >= 0` and `ym^2 >= 0`, with one channel and `g R > 0`, `theta <= theta(0)` at every zero of `ym` and
//!   `theta >= theta(0)` at every zero of `y`, whatever the gain: in a motion about zero the truth cannot be held.
//! * Near `y = ym` it reads `theta' = -g R z (theta - truth)` with `z = sum y Phi`. Without the factor `z` of a true gradient
//!   the sign of the gain has to be that of `z`, and `z` must not change it: true of `C_m_q` (`z ~ q^2`), untrue of
//!   `C_m_alpha` (`z ~ q alpha`). A negative gain is therefore allowed for this form alone.
//! * All parameters move along one fixed direction `R`: it can find one at most.
//! * Normalised, it is no longer the derivative of anything, and the first point does not hold.
//!
//! # Sampling
//!
//! The estimated model is integrated over the interval by RK4 with the estimate that held at its beginning, then the
//! estimate makes one explicit step: no algebraic loop, but a limit to the step `h`.
//!
//! * Printed: `theta+ = theta - g R h sum (y y' - ym ym')` with measured rates, or `theta+ = theta - g R (S+ - S)/2` without
//!   (exact for any step). Error factor per sample `1 - g h R z`: stable to `g h R z = 2`, no overshoot to 1.
//! * Energy gradient: `theta+ = theta - g h R^2 S dS/dtheta`, sensitivity of the same RK4 map. Limit about
//!   `g h (R dS/dtheta)^2 = 2`, if the sensitivity had no memory.
//! * State error: with `B = dF/dtheta` of the RK4 map from the *measured* state (`B ~ h Phi`) and `rho = exp(-k h)`, the
//!   error obeys `e+ = rho e + B (truth - theta)` and `theta+ = theta + g R^2 B^T e+`. Then
//!   `V = e^2/2 + |(truth - theta)/R|^2/(2 g)` changes by `-(e+ - rho e)^2/2 - (1 - rho^2) e^2/2 + g |B R|^2 e+^2/2`, which
//!   is never positive if `g |B R|^2 <= 1 - rho^2`, that is `g h |Phi R|^2 <= 2 k` for small steps. With a constant regressor it
//!   is stable further, to `g |B R|^2 = 2 (1 + rho)`. Normalised, `g h <= 2 k` bounds the step for inputs of any size.
//!
//! There is no covariance in any of them: the standard errors are infinite. Projection onto bounds (which never makes
//! `V` larger, if they hold the truth) is off unless bounds are given.

use core::fmt;

use crate::laws::parallel::{measured, parts};
use crate::laws::{SurfaceChannel, SurfaceDerivative};
use phugoid_estimators::discretization::{self, InputHold, IntervalInput};
use phugoid_estimators::{Estimate, Estimator, ParameterStatus, Phase, Status};
use phugoid_estimators::{Model, Sample};

/// The forms of the model-reference law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModelReferenceForm {
    /// As printed, (3.3): feedback of the energy's rate of change.
    Printed,
    /// Gradient descent of (3.1) by the sensitivity of the estimated model.
    EnergyGradient,
    /// The textbook's: regressor times state error, Lyapunov stable.
    #[default]
    StateError,
}

/// Settings of the model-reference law over `S` channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelReferenceSettings<const N: usize, const P: usize, const S: usize> {
    /// Start values, the model's units.
    pub parameters: [f64; P],
    /// `R_j`, typical size of the uncertainty of each parameter, its units; 0 for one that is known and stays.
    pub ranges: [f64; P],
    /// Projection: lower bounds; minus infinity for none.
    pub lower: [f64; P],
    /// Projection: upper bounds; infinity for none.
    pub upper: [f64; P],
    /// The channels that are compared. Derivatives are used by the printed form alone.
    pub channels: [SurfaceChannel; S],
    /// The form of the law that is evaluated.
    pub form: ModelReferenceForm,
    /// `g`. Printed, state error: a pure number; energy gradient: 1/s. Normalised: 1/s^2, 1/s^2, 1/s.
    pub gain: f64,
    /// `c` of the normalised form (1/s^2 for printed and state error, a pure number for the energy gradient); none: plain.
    pub normalisation: Option<f64>,
    /// `k` of the state-error form, 1/s.
    pub error_decay: f64,
    /// Start of states that are not measured.
    pub initial_state: [f64; N],
    /// States outside the channels that follow their measurement instead of the estimated model. The state-error form
    /// takes every measured state from its measurement.
    pub follow: [bool; N],
    /// How the input goes from one sample to the next.
    pub input_hold: InputHold,
    /// Longest step with which the estimated model is integrated, s.
    pub maximum_step_s: f64,
    /// Longest interval that is predicted through, s; after a longer one the model starts again from the measurements.
    pub maximum_gap_s: f64,
}

impl<const N: usize, const P: usize, const S: usize> ModelReferenceSettings<N, P, S> {
    /// Plain law of the given form, without projection, everything else at its default (`k` = 2/s).
    pub fn new(
        form: ModelReferenceForm,
        gain: f64,
        parameters: [f64; P],
        ranges: [f64; P],
        channels: [SurfaceChannel; S],
    ) -> Self {
        Self {
            parameters,
            ranges,
            lower: [f64::NEG_INFINITY; P],
            upper: [f64::INFINITY; P],
            channels,
            form,
            gain,
            normalisation: None,
            error_decay: 2.0,
            initial_state: [0.0; N],
            follow: [false; N],
            input_hold: InputHold::Zero,
            maximum_step_s: 0.02,
            maximum_gap_s: 2.0,
        }
    }
}

/// Why the law cannot be set up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelReferenceError {
    /// A start value, range or bound of a parameter is not possible.
    Parameter {
        /// Index of the first parameter that is wrong, counted from 0.
        index: usize,
    },
    /// Every range is zero: nothing is unknown.
    NothingUnknown,
    /// A channel names a state or output that does not exist, has no positive scale, or mixes measured and integrated
    /// derivatives.
    Channel {
        /// Index of the first channel that is wrong, counted from 0.
        index: usize,
    },
    /// A number that must be positive is not.
    Setting {
        /// Name of the setting, as the field is called.
        name: &'static str,
        /// Value that was given; it may be NaN.
        value: f64,
    },
}

impl fmt::Display for ModelReferenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Parameter { index } => write!(
                f,
                "parameter {index} (count from 0): the start must be finite and within its bounds, the range finite and \
                 not negative"
            ),
            Self::NothingUnknown => write!(f, "all ranges are zero: give the unknown parameters a positive one"),
            Self::Channel { index } => write!(
                f,
                "channel {index}: state and output must exist, the scale be positive, and all channels have measured \
                 derivatives or none"
            ),
            Self::Setting { name, value } => write!(
                f,
                "setting {name} must be positive and finite, found {value} (only the gain of the printed form may be \
                 negative)"
            ),
        }
    }
}

impl core::error::Error for ModelReferenceError {}

/// The model-reference estimator over `S` channels.
pub struct ModelReference<M, const N: usize, const R: usize, const P: usize, const S: usize>
where
    M: Model<N, R, P>,
{
    model: M,
    settings: ModelReferenceSettings<N, P, S>,
    running: bool,
    theta: [f64; P],
    /// Where the next interval is integrated from.
    x: [f64; N],
    /// State-error form: `e` of each channel, channel units.
    error: [f64; S],
    /// Energy-gradient form: `dy/dtheta`.
    sensitivity: [[f64; P]; N],
    /// `S/2` at the last frame, if it had all channels.
    energy: Option<f64>,
    /// Whether a parameter has moved.
    moved: [bool; P],
    last_s: f64,
    last_input: Option<M::Input>,
    phase: Phase,
}

impl<M, const N: usize, const R: usize, const P: usize, const S: usize> ModelReference<M, N, R, P, S>
where
    M: Model<N, R, P>,
{
    /// Sets the law up; the first frame with all channels starts it.
    ///
    /// # Errors
    /// [`ModelReferenceError`]: which parameter, channel or setting is not possible.
    pub fn new(model: M, settings: ModelReferenceSettings<N, P, S>) -> Result<Self, ModelReferenceError> {
        let count = model.parameter_count().min(P);
        for index in 0..count {
            let (start, range) = (settings.parameters[index], settings.ranges[index]);
            let within = settings.lower[index] <= start && start <= settings.upper[index];
            if !(start.is_finite() && within && range.is_finite() && range >= 0.0) {
                return Err(ModelReferenceError::Parameter { index });
            }
        }
        if !settings.ranges[..count].iter().any(|range| *range > 0.0) {
            return Err(ModelReferenceError::NothingUnknown);
        }
        if S == 0 {
            return Err(ModelReferenceError::Channel { index: 0 });
        }
        for (index, channel) in settings.channels.iter().enumerate() {
            let integrated = |c: &SurfaceChannel| matches!(c.derivative, SurfaceDerivative::Integrated);
            let derivative_exists = !matches!(channel.derivative, SurfaceDerivative::Output(i) if i >= R);
            if channel.state >= N
                || channel.output >= R
                || !(channel.scale > 0.0 && channel.scale.is_finite())
                || integrated(channel) != integrated(&settings.channels[0])
                || !derivative_exists
            {
                return Err(ModelReferenceError::Channel { index });
            }
        }
        let gain = if settings.form == ModelReferenceForm::Printed { settings.gain.abs() } else { settings.gain };
        for (name, magnitude, value) in [
            ("gain", gain, settings.gain),
            ("normalisation", settings.normalisation.unwrap_or(1.0), settings.normalisation.unwrap_or(1.0)),
            ("error_decay", settings.error_decay, settings.error_decay),
            ("maximum_step_s", settings.maximum_step_s, settings.maximum_step_s),
            ("maximum_gap_s", settings.maximum_gap_s, settings.maximum_gap_s),
        ] {
            if !(magnitude > 0.0 && magnitude.is_finite()) {
                return Err(ModelReferenceError::Setting { name, value });
            }
        }
        Ok(Self {
            model,
            settings,
            running: false,
            theta: core::array::from_fn(|j| if j < count { settings.parameters[j] } else { 0.0 }),
            x: settings.initial_state,
            error: [0.0; S],
            sensitivity: [[0.0; P]; N],
            energy: None,
            moved: [false; P],
            last_s: f64::NEG_INFINITY,
            last_input: None,
            phase: Phase::Starting,
        })
    }

    /// The estimated model, as it was given to [`ModelReference::new`].
    pub fn model(&self) -> &M {
        &self.model
    }

    /// State of the estimated model.
    pub fn state(&self) -> [f64; N] {
        let mut state = self.x;
        for (channel, error) in self.settings.channels.iter().zip(&self.error) {
            state[channel.state] -= error;
        }
        state
    }

    /// `S/2`, half the difference of the scaled energies, at the last frame that had all channels; NaN before.
    pub fn energy(&self) -> f64 {
        self.energy.unwrap_or(f64::NAN)
    }

    /// `e = ym - y` of the state-error form, channel units; zero in the other forms.
    pub fn error(&self) -> &[f64; S] {
        &self.error
    }

    fn start(&mut self, sample: &Sample<M::Input, R>) {
        self.phase = Phase::Starting;
        self.running = false;
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        if !self.settings.channels.iter().all(|channel| sample.outputs[channel.output].is_finite()) {
            return;
        }
        self.x = core::array::from_fn(|state| {
            measured(self.model.measuring_output(state), sample).unwrap_or(self.settings.initial_state[state])
        });
        for channel in &self.settings.channels {
            self.x[channel.state] = sample.outputs[channel.output];
        }
        self.error = [0.0; S];
        self.sensitivity = [[0.0; P]; N];
        self.energy = Some(0.0);
        self.running = true;
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
        let complete = self.settings.channels.iter().all(|channel| {
            let rate = match (self.settings.form, channel.derivative) {
                (ModelReferenceForm::Printed, SurfaceDerivative::Output(i)) => sample.outputs[i],
                _ => 0.0,
            };
            sample.outputs[channel.output].is_finite() && rate.is_finite()
        });
        // Only the energy gradient remembers how the state came to depend on the parameters.
        if self.settings.form != ModelReferenceForm::EnergyGradient {
            self.sensitivity = [[0.0; P]; N];
        }
        self.x = self.integrate(&input, interval_s);
        if !self.x.iter().all(|value| value.is_finite()) {
            return self.start(sample);
        }
        for state in 0..N {
            let is_channel = self.settings.channels.iter().any(|channel| channel.state == state);
            let follows = match self.settings.form {
                ModelReferenceForm::StateError => !is_channel,
                _ => self.settings.follow[state] && !is_channel,
            };
            if let (true, Some(value)) = (follows, measured(self.model.measuring_output(state), sample)) {
                self.x[state] = value;
                self.sensitivity[state] = [0.0; P];
            }
        }
        let step = match self.settings.form {
            ModelReferenceForm::Printed => self.printed(sample, interval_s, complete),
            ModelReferenceForm::EnergyGradient => self.energy_gradient(sample, interval_s, complete),
            ModelReferenceForm::StateError => self.state_error(sample, interval_s, complete),
        };
        self.adapt(&step);
        self.phase = if complete { Phase::Sliding } else { Phase::Predicting };
    }

    /// The estimated model over one interval, and `self.sensitivity` with it.
    fn integrate(&mut self, input: &IntervalInput<M::Input>, interval_s: f64) -> [f64; N] {
        let columns = self.model.parameter_count().min(P);
        let mut transition = [[0.0; N]; N];
        parts(interval_s, self.settings.maximum_step_s).fold(self.x, |x, part| {
            let (theta, into, by_state) = (&self.theta, &mut self.sensitivity, &mut transition);
            discretization::step(&self.model, &x, theta, input, interval_s, part, columns, into, by_state)
        })
    }

    /// Half the scaled energy difference and `d(S/2)/d(theta/R)`.
    fn energy_of(&self, sample: &Sample<M::Input, R>) -> (f64, [f64; P]) {
        let mut energy = 0.0;
        let mut gradient = [0.0; P];
        for channel in &self.settings.channels {
            let weight = 1.0 / (channel.scale * channel.scale);
            let (y, ym) = (self.x[channel.state], sample.outputs[channel.output]);
            energy += 0.5 * weight * (y * y - ym * ym);
            for (j, g) in gradient.iter_mut().enumerate() {
                *g += weight * y * self.sensitivity[channel.state][j] * self.settings.ranges[j];
            }
        }
        (energy, gradient)
    }

    /// `c + |gradient|^2`, or 1 for the plain law.
    fn divisor(&self, squared_gradient: f64) -> f64 {
        self.settings.normalisation.map_or(1.0, |c| c + squared_gradient)
    }

    /// Equation (3.3). Gives the step of `theta/R`.
    fn printed(&mut self, sample: &Sample<M::Input, R>, interval_s: f64, complete: bool) -> [f64; P] {
        if !complete {
            self.energy = None;
            return [0.0; P];
        }
        let (energy, by_parameter) = self.energy_of(sample);
        let before = self.energy.replace(energy);
        let mut change = 0.0;
        for channel in &self.settings.channels {
            match channel.derivative {
                SurfaceDerivative::Output(_) | SurfaceDerivative::Known => {
                    let rates = self.model.rates(&self.x, &self.theta, &sample.input);
                    let model = self.x[channel.state] * rates[channel.state];
                    let rate = match channel.derivative {
                        SurfaceDerivative::Output(derivative) => sample.outputs[derivative],
                        _ => {
                            let seen: [f64; N] = core::array::from_fn(|i| {
                                measured(self.model.measuring_output(i), sample).unwrap_or(self.x[i])
                            });
                            self.model.rates(&seen, &self.theta, &sample.input)[channel.state]
                        }
                    };
                    let measured = sample.outputs[channel.output] * rate;
                    change += interval_s * (model - measured) / (channel.scale * channel.scale);
                }
                // All channels agree: the change of their sum at once. After a frame that missed it, none is known.
                SurfaceDerivative::Integrated => {
                    change = before.map_or(0.0, |before| energy - before);
                    break;
                }
            }
        }
        let squared = by_parameter.iter().map(|z| z * z).sum::<f64>() / (interval_s * interval_s);
        let step = -self.settings.gain * change / self.divisor(squared);
        core::array::from_fn(|j| if self.settings.ranges[j] > 0.0 { step } else { 0.0 })
    }

    /// Gradient descent of `S^2/2`. Gives the step of `theta/R`.
    fn energy_gradient(&mut self, sample: &Sample<M::Input, R>, interval_s: f64, complete: bool) -> [f64; P] {
        if !complete {
            return [0.0; P];
        }
        let (half, half_gradient) = self.energy_of(sample);
        self.energy = Some(half);
        let gradient = half_gradient.map(|g| 2.0 * g);
        let squared = gradient.iter().map(|g| g * g).sum();
        let step = -self.settings.gain * interval_s * 2.0 * half / self.divisor(squared);
        gradient.map(|g| step * g)
    }

    /// The Lyapunov form. Gives the step of `theta/R`.
    fn state_error(&mut self, sample: &Sample<M::Input, R>, interval_s: f64, complete: bool) -> [f64; P] {
        let decay = libm::exp(-self.settings.error_decay * interval_s);
        let mut step = [0.0; P];
        let mut squared = 0.0;
        for (channel, error) in self.settings.channels.iter().zip(&mut self.error) {
            *error *= decay;
            let measured = sample.outputs[channel.output];
            if !measured.is_finite() {
                continue;
            }
            // The prediction started on the last measurement: what it misses is B (truth - theta).
            *error += measured - self.x[channel.state];
            self.x[channel.state] = measured;
            for j in 0..P {
                let b = self.sensitivity[channel.state][j] * self.settings.ranges[j] / channel.scale;
                step[j] += b * *error / channel.scale;
                squared += b * b / (interval_s * interval_s);
            }
        }
        if !complete {
            return [0.0; P];
        }
        let factor = self.settings.gain / self.divisor(squared);
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

impl<M, const N: usize, const R: usize, const P: usize, const S: usize> Estimator<R, P>
    for ModelReference<M, N, R, P, S>
where
    M: Model<N, R, P>,
{
    type Input = M::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
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
    fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        for j in 0..self.model.parameter_count().min(P) {
            if self.settings.ranges[j] > 0.0 {
                out[j][j] = f64::INFINITY;
            }
        }
    }
}
