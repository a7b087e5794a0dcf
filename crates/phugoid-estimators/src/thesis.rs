//! The one-parameter sliding-mode law of the thesis this project grew from (Gurbacki, RIT, 2010), as an estimator.
//!
//! An estimated model runs beside the plant with the estimate in place of the unknown parameter. The surface is an
//! *energy* over a few channels (`y` of the estimated model, `ym` measured),
//!
//! ```text
//! s     = sum (y^2 - ym^2)/2 + lambda * integral of the same                    "energy surface"
//! sdot  = D + lambda E,   D = sum (y y' - ym ym'),   E = sum (y^2 - ym^2)/2
//! theta = (D + lambda E) / (K D + eta)                                          printed law
//! K     = |theta (1/alpha - 1) z| - eta,   alpha = sqrt(upper/lower)            gain from the bounds
//! ```
//!
//! with `z = dD/dtheta = sum y Phi`. For the aircraft the channels are p, q, r for the moment (`z = q Cq theta`-terms)
//! and alpha, V for lift and drag, and `mu` takes the place of `alpha`.
//!
//! What is as published and what is reconstructed:
//! * The structure above is the thesis's. Its text has lost its minus signs: the sign of the law, `-sgn(z)`, is
//!   reconstructed from `s sdot < 0` and agrees with the first-order plant `x' = -a x + u` (`z = -x^2`).
//! * `y'` depends on `theta`, so the law is an algebraic loop. A one-sample delay in it diverges; here it is solved at
//!   every sample by a bounded Newton iteration.
//! * The thesis adds channels of different units. Here every channel is divided by a scale first: V in ft/s squared is
//!   otherwise ten million times alpha in radians squared.
//! * `eta` biases the printed and the reduced law (both rest at `E = theta eta / lambda`). The damped form moves from
//!   the last estimate, `eta (theta+ - theta) = -sgn(z) (D + lambda E)`, has no such bias and is the default.
//! * Measured derivatives are an input of the law. Where none is measured, the condition is integrated over the sampling
//!   interval instead, `E_k - E_{k-1} + lambda h E_k`, so that no signal is differentiated.
//!
//! One scalar equation carries one parameter: two parameters cannot be had from it (the two-surface form has rank one
//! at every instant). There is no covariance in it either: the standard errors it gives are infinite.

use core::fmt;

use crate::discretization::{self, InputHold, IntervalInput, Part};
use crate::estimate::{Estimate, Estimator, ParameterStatus, Phase, Status};
use crate::model::{LinearizedRates, Model, Sample};

/// Where the derivative of a measured channel comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceDerivative {
    /// An output holds it, unit of the channel per second.
    Output(usize),
    /// Not measured: the surface condition is integrated over the sampling interval.
    Integrated,
}

/// One channel of the energy surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceChannel {
    /// State of the model.
    pub state: usize,
    /// Output that measures it directly.
    pub output: usize,
    /// Its typical size: the channel enters divided by this. State units, positive.
    pub scale: f64,
    /// Its derivative. All channels of a surface must agree on measured or integrated.
    pub derivative: SurfaceDerivative,
}

/// Which form of the law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThesisForm {
    /// As printed, with the gain `K` from the bounds; needs bounds of one sign.
    Printed,
    /// Without the term `K D`: `theta = (D + lambda E)/eta`.
    Reduced,
    /// Moving from the last estimate; unbiased.
    #[default]
    Damped,
}

/// Settings of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThesisSettings<const N: usize, const P: usize, const S: usize> {
    /// The unknown parameter's index in the model.
    pub parameter: usize,
    /// All parameters of the model; the unknown one's entry is its start value.
    pub parameters: [f64; P],
    /// Lower bound of the unknown parameter.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
    /// The surface.
    pub channels: [SurfaceChannel; S],
    /// `lambda`, 1/s. Used up to `lambda h = 0.5`: beyond 1 it overshoots, beyond 2 it diverges.
    pub lambda: f64,
    /// `eta > 0`, in units of `z` (scaled energy rate per unit of the parameter).
    pub eta: f64,
    /// Form of the law.
    pub form: ThesisForm,
    /// Start of states that are not measured.
    pub initial_state: [f64; N],
    /// States outside the surface that follow their measurement instead of the estimated model (reconstructed: keeps
    /// an unstable model from drifting away).
    pub follow: [bool; N],
    /// Input between samples.
    pub input_hold: InputHold,
    /// Longest integration step, s.
    pub maximum_step_s: f64,
    /// Longest interval that is predicted through, s; after a longer one the model starts again from the measurements.
    pub maximum_gap_s: f64,
}

impl<const N: usize, const P: usize, const S: usize> ThesisSettings<N, P, S> {
    /// Damped form with the parameter between its bounds and everything else at its default.
    pub fn new(parameter: usize, parameters: [f64; P], bounds: [f64; 2], channels: [SurfaceChannel; S]) -> Self {
        Self {
            parameter,
            parameters,
            lower: bounds[0],
            upper: bounds[1],
            channels,
            lambda: 10.0,
            eta: 1e-3,
            form: ThesisForm::Damped,
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
pub enum ThesisError {
    /// The unknown parameter is not one of the model's.
    Parameter {
        /// Index asked for.
        index: usize,
        /// Parameters of the model.
        count: usize,
    },
    /// Bounds out of order, not finite, or of both signs for the printed form.
    Bounds {
        /// Lower bound found.
        lower: f64,
        /// Upper bound found.
        upper: f64,
    },
    /// A surface channel names a state or output that does not exist, has no positive scale, or mixes measured and
    /// integrated derivatives.
    Channel {
        /// Index of the channel.
        index: usize,
    },
    /// `lambda` or `eta` or a step is not a positive number.
    Setting {
        /// Name.
        name: &'static str,
        /// Value found.
        value: f64,
    },
}

impl fmt::Display for ThesisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Parameter { index, count } => {
                write!(f, "parameter {index} is asked for, the model has {count} (count from 0)")
            }
            Self::Bounds { lower, upper } => write!(
                f,
                "bounds {lower} to {upper}: need finite lower < upper, and for the printed form both of one sign (its \
                 gain contains sqrt(upper/lower))"
            ),
            Self::Channel { index } => write!(
                f,
                "surface channel {index}: state and output must exist, the scale be positive, and all channels have \
                 measured derivatives or none"
            ),
            Self::Setting { name, value } => write!(f, "setting {name} must be positive and finite, found {value}"),
        }
    }
}

impl core::error::Error for ThesisError {}

/// Most Newton steps per sample.
const MAXIMUM_ITERATIONS: usize = 25;

/// The thesis's law over a surface of `S` channels.
pub struct ThesisLaw<M, const N: usize, const R: usize, const P: usize, const S: usize>
where
    M: Model<N, R, P>,
{
    model: M,
    settings: ThesisSettings<N, P, S>,
    running: bool,
    theta: [f64; P],
    x: [f64; N],
    last_s: f64,
    last_input: Option<M::Input>,
    /// `E` at the last frame that had the surface.
    energy: f64,
    energy_known: bool,
    slope: f64,
    phase: Phase,
}

/// The surface condition at one trial value of the parameter.
#[derive(Clone, Copy)]
struct Condition {
    /// `D + lambda E`.
    n: f64,
    /// `D`.
    d: f64,
    /// `z`, the derivative of both by the parameter.
    z: f64,
}

impl<M, const N: usize, const R: usize, const P: usize, const S: usize> ThesisLaw<M, N, R, P, S>
where
    M: Model<N, R, P>,
{
    /// Sets the law up; the first frame with all surface channels starts it.
    pub fn new(model: M, settings: ThesisSettings<N, P, S>) -> Result<Self, ThesisError> {
        let count = model.parameter_count().min(P);
        if settings.parameter >= count {
            return Err(ThesisError::Parameter { index: settings.parameter, count });
        }
        let (lower, upper) = (settings.lower, settings.upper);
        let one_sign = lower * upper > 0.0;
        if !(lower.is_finite() && upper.is_finite() && lower < upper)
            || (settings.form == ThesisForm::Printed && !one_sign)
        {
            return Err(ThesisError::Bounds { lower, upper });
        }
        if S == 0 {
            return Err(ThesisError::Channel { index: 0 });
        }
        for (index, channel) in settings.channels.iter().enumerate() {
            let same = matches!(channel.derivative, SurfaceDerivative::Integrated)
                == matches!(settings.channels[0].derivative, SurfaceDerivative::Integrated);
            let derivative_exists = !matches!(channel.derivative, SurfaceDerivative::Output(i) if i >= R);
            if channel.state >= N
                || channel.output >= R
                || !(channel.scale > 0.0 && channel.scale.is_finite())
                || !same
                || !derivative_exists
            {
                return Err(ThesisError::Channel { index });
            }
        }
        for (name, value) in [
            ("lambda", settings.lambda),
            ("eta", settings.eta),
            ("maximum_step_s", settings.maximum_step_s),
            ("maximum_gap_s", settings.maximum_gap_s),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ThesisError::Setting { name, value });
            }
        }
        Ok(Self {
            model,
            settings,
            running: false,
            theta: settings.parameters,
            x: settings.initial_state,
            last_s: f64::NEG_INFINITY,
            last_input: None,
            energy: 0.0,
            energy_known: false,
            slope: 0.0,
            phase: Phase::Starting,
        })
    }

    /// State of the estimated model.
    pub fn state(&self) -> &[f64; N] {
        &self.x
    }

    /// `E`, the scaled energy difference of the surface.
    pub fn energy(&self) -> f64 {
        self.energy
    }

    fn start(&mut self, sample: &Sample<M::Input, R>) {
        self.phase = Phase::Starting;
        let complete = self.settings.channels.iter().all(|channel| sample.outputs[channel.output].is_finite());
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        if !complete {
            return;
        }
        for state in 0..N {
            if let Some(value) = self.measured(state, sample) {
                self.x[state] = value;
            }
        }
        for channel in &self.settings.channels {
            self.x[channel.state] = sample.outputs[channel.output];
        }
        // The estimated model starts on the measurement: E = 0.
        self.energy = 0.0;
        self.energy_known = true;
        self.running = true;
    }

    fn measured(&self, state: usize, sample: &Sample<M::Input, R>) -> Option<f64> {
        let output = self.model.measuring_output(state).filter(|&output| output < R)?;
        Some(sample.outputs[output]).filter(|y| y.is_finite())
    }

    /// `E` and, per unit of the parameter, its derivative through the state.
    fn energy_of(&self, x: &[f64; N], by_parameter: &[[f64; P]; N], sample: &Sample<M::Input, R>) -> (f64, f64) {
        let mut energy = 0.0;
        let mut slope = 0.0;
        for channel in &self.settings.channels {
            let weight = 1.0 / (channel.scale * channel.scale);
            let (y, ym) = (x[channel.state], sample.outputs[channel.output]);
            energy += 0.5 * weight * (y * y - ym * ym);
            slope += weight * y * by_parameter[channel.state][self.settings.parameter];
        }
        (energy, slope)
    }

    /// The estimated model over one interval from `self.x` with the parameter at `value`.
    fn integrate(&self, value: f64, input: &IntervalInput<M::Input>, interval_s: f64) -> ([f64; N], [[f64; P]; N]) {
        let mut theta = self.theta;
        theta[self.settings.parameter] = value;
        let steps = discretization::sub_steps(interval_s, self.settings.maximum_step_s);
        let mut x = self.x;
        let mut by_parameter = [[0.0; P]; N];
        let mut transition = [[0.0; N]; N];
        for k in 0..steps {
            let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
            x = discretization::step(
                &self.model,
                &x,
                &theta,
                input,
                interval_s,
                part,
                self.settings.parameter + 1,
                &mut by_parameter,
                &mut transition,
            );
        }
        (x, by_parameter)
    }

    /// Solves the loop `F(theta) = 0` by Newton from the last estimate. `None` if it does not settle.
    fn solve(&self, mut condition: impl FnMut(f64) -> Condition) -> Option<f64> {
        let settings = &self.settings;
        let before = self.theta[settings.parameter];
        let span = settings.upper - settings.lower;
        let (low, high) = (settings.lower - 0.25 * span, settings.upper + 0.25 * span);
        // |1/alpha - 1| with alpha = sqrt(upper/lower), taken with the larger magnitude on top.
        let ratio = settings.lower / settings.upper;
        let spread = if ratio > 0.0 { (libm::sqrt(ratio.min(1.0 / ratio)) - 1.0).abs() } else { 0.0 };
        let mut theta = before;
        for _ in 0..MAXIMUM_ITERATIONS {
            let Condition { n, d, z } = condition(theta);
            let sign = if z > 0.0 { 1.0 } else { -1.0 };
            let (value, slope) = match settings.form {
                ThesisForm::Reduced => (settings.eta * theta + sign * n, settings.eta + sign * z),
                ThesisForm::Damped => (settings.eta * (theta - before) + sign * n, settings.eta + sign * z),
                ThesisForm::Printed => {
                    let k = (theta * spread * z).abs() - settings.eta;
                    let dk = if theta < 0.0 { -(spread * z).abs() } else { (spread * z).abs() };
                    (
                        theta * (k * d + settings.eta) + sign * n,
                        k * d + settings.eta + theta * (dk * d + k * z) + sign * z,
                    )
                }
            };
            let step = value / slope;
            if !step.is_finite() {
                return None;
            }
            let next = (theta - step).clamp(low, high);
            let moved = (next - theta).abs();
            theta = next;
            if moved <= 1e-12 * span {
                return Some(theta);
            }
        }
        // The linear forms settle at once; the printed one may cycle between roots: then the last estimate stands.
        None
    }

    fn advance(&mut self, sample: &Sample<M::Input, R>) {
        let interval_s = sample.time_s - self.last_s;
        let Some(from) = self.last_input else { return self.start(sample) };
        if interval_s > self.settings.maximum_gap_s {
            self.running = false;
            return self.start(sample);
        }
        let input = IntervalInput { from, to: sample.input, hold: self.settings.input_hold };
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        let before = self.theta[self.settings.parameter];
        let complete = self.settings.channels.iter().all(|channel| {
            sample.outputs[channel.output].is_finite()
                && match channel.derivative {
                    SurfaceDerivative::Output(i) => sample.outputs[i].is_finite(),
                    SurfaceDerivative::Integrated => true,
                }
        });
        let lambda = self.settings.lambda.min(0.5 / interval_s);
        let integrated =
            self.settings.channels.iter().all(|channel| matches!(channel.derivative, SurfaceDerivative::Integrated));

        let mut slope = 0.0;
        let mut solved = None;
        if complete && integrated && self.energy_known {
            let last_energy = self.energy;
            solved = self.solve(|value| {
                let (x, by_parameter) = self.integrate(value, &input, interval_s);
                let (energy, energy_slope) = self.energy_of(&x, &by_parameter, sample);
                let d = (energy - last_energy) / interval_s;
                slope = energy_slope / interval_s;
                Condition { n: d + lambda * energy, d, z: energy_slope * (1.0 / interval_s + lambda) }
            });
        }
        let theta = solved.unwrap_or(before);
        let (x, by_parameter) = self.integrate(theta, &input, interval_s);
        if !x.iter().sum::<f64>().is_finite() {
            self.running = false;
            return self.start(sample);
        }
        self.x = x;
        self.theta[self.settings.parameter] = theta;
        for state in 0..N {
            if let (true, Some(value)) = (self.settings.follow[state], self.measured(state, sample)) {
                self.x[state] = value;
            }
        }
        self.energy_known = complete;
        if complete {
            self.energy = self.energy_of(&self.x, &by_parameter, sample).0;
        }
        if complete && !integrated {
            // D = D0 + z theta at the sample itself, from the rates of the estimated model and the measured ones.
            let mut lin = LinearizedRates::<N, P>::ZERO;
            self.model.linearized_rates(&self.x, &self.theta, &sample.input, &mut lin);
            let (mut d, mut z) = (0.0, 0.0);
            for channel in &self.settings.channels {
                let SurfaceDerivative::Output(derivative) = channel.derivative else { continue };
                let weight = 1.0 / (channel.scale * channel.scale);
                let y = self.x[channel.state];
                d += weight
                    * (y * lin.rates[channel.state] - sample.outputs[channel.output] * sample.outputs[derivative]);
                z += weight * y * lin.regressors[channel.state][self.settings.parameter];
            }
            slope = z;
            let energy = self.energy;
            solved = self.solve(|value| {
                let d = d + z * (value - theta);
                Condition { n: d + lambda * energy, d, z }
            });
            if let Some(value) = solved {
                self.theta[self.settings.parameter] = value;
            }
        }
        self.slope = slope;
        self.phase = match (complete, solved) {
            (false, _) => Phase::Predicting,
            (true, Some(_)) => Phase::Sliding,
            (true, None) => Phase::Rejected,
        };
    }

    fn estimate(&self) -> Estimate<P> {
        let count = self.model.parameter_count().min(P);
        let j = self.settings.parameter;
        let mut estimate = Estimate {
            time_s: self.last_s,
            parameters: self.theta,
            std_error: [0.0; P],
            corrected_std_error: [0.0; P],
            observability: [0.0; P],
            parameter_status: [ParameterStatus::NotExcited; P],
            status: Status { phase: self.phase, ..Status::default() },
        };
        estimate.parameters[count..].fill(0.0);
        estimate.std_error[j] = f64::INFINITY;
        estimate.corrected_std_error[j] = f64::INFINITY;
        let theta = self.theta[j];
        estimate.parameter_status[j] = if theta < self.settings.lower || theta > self.settings.upper {
            ParameterStatus::AtLimit
        } else if self.slope.abs() > self.settings.eta {
            ParameterStatus::Improving
        } else {
            ParameterStatus::NotExcited
        };
        estimate
    }
}

impl<M, const N: usize, const R: usize, const P: usize, const S: usize> Estimator<R, P> for ThesisLaw<M, N, R, P, S>
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

    /// Infinite for the unknown parameter: the law knows no covariance.
    fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        out[self.settings.parameter][self.settings.parameter] = f64::INFINITY;
    }
}
