//! The one-parameter law.
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
//! * The structure above is the thesis's. The sign of the law, `-sgn(z)`, is reconstructed from `s sdot < 0` and agrees
//!   with the first-order plant `x' = -a x + u` (`z = -x^2`); [`LawSign::AsPrinted`] leaves it out.
//! * `y'` depends on `theta`, so the law is an algebraic loop. With a one-sample delay in it it chatters or diverges
//!   ([`Evaluation::Delayed`]); here it is solved at every sample by a bounded Newton iteration.
//! * The thesis adds channels of different units. Here every channel is divided by a scale first: V in ft/s squared is
//!   otherwise ten million times alpha in radians squared.
//! * `eta` biases the printed and the reduced law (both rest at `E = theta eta / lambda`). The damped form moves from
//!   the last estimate, `eta (theta+ - theta) = -sgn(z) (D + lambda E)`, has no such bias and is the default.
//! * Measured derivatives are an input of the law. Where none is measured, the condition is integrated over the sampling
//!   interval instead, `E_k - E_{k-1} + lambda h E_k`, so that no signal is differentiated.
//!
//! One scalar equation carries one parameter: two parameters cannot be had from it (the two-surface form has rank one
//! at every instant). There is no covariance in it either: the standard errors it gives are infinite.

use super::claim::{verdict, without_covariance};
use super::diagnostics::Diagnostics;
use super::error::ThesisError;
use super::gain::{gain, spread};
use super::parallel::{measured, parts};
use super::settings::{Evaluation, LawSign, SurfaceDerivative, ThesisForm, ThesisSettings};
use phugoid_estimators::discretization::{self, IntervalInput};
use phugoid_estimators::{Estimate, Estimator, Phase};
use phugoid_estimators::{LinearizedRates, Model, Sample};

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
    /// Integral of `E` since the start.
    integral: f64,
    diagnostics: Diagnostics,
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
        // Infinity is allowed: no limit.
        for (name, value) in [("maximum_lambda_h", settings.maximum_lambda_h), ("margin", settings.margin)] {
            if value.is_nan() || value < 0.0 {
                return Err(ThesisError::Setting { name, value });
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
            integral: 0.0,
            diagnostics: Diagnostics::default(),
            phase: Phase::Starting,
        })
    }

    /// State of the estimated model.
    pub fn state(&self) -> &[f64; N] {
        &self.x
    }

    /// Tells the law the value of another of the model's parameters from now on: another law has found it. Its own
    /// unknown, and parameters that the model does not have, are left as they are.
    pub fn set_known(&mut self, parameter: usize, value: f64) {
        if parameter != self.settings.parameter && parameter < self.model.parameter_count().min(P) {
            self.theta[parameter] = value;
        }
    }

    /// `E`, the scaled energy difference of the surface.
    pub fn energy(&self) -> f64 {
        self.energy
    }

    /// Surface, reaching condition and gain after the last sample that had the surface.
    pub fn diagnostics(&self) -> &Diagnostics {
        &self.diagnostics
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
            if let Some(value) = measured(self.model.measuring_output(state), sample) {
                self.x[state] = value;
            }
        }
        for channel in &self.settings.channels {
            self.x[channel.state] = sample.outputs[channel.output];
        }
        // The estimated model starts on the measurement: E = 0.
        self.energy = 0.0;
        self.integral = 0.0;
        self.energy_known = true;
        self.running = true;
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
        let columns = self.settings.parameter + 1;
        let (mut by_parameter, mut transition) = ([[0.0; P]; N], [[0.0; N]; N]);
        let x = parts(interval_s, self.settings.maximum_step_s).fold(self.x, |x, part| {
            let (into, by_state) = (&mut by_parameter, &mut transition);
            discretization::step(&self.model, &x, &theta, input, interval_s, part, columns, into, by_state)
        });
        (x, by_parameter)
    }

    /// What the right hand side is multiplied by: plus one as printed.
    fn sign(&self, z: f64) -> f64 {
        match self.settings.sign {
            LawSign::FromSlope if z > 0.0 => -1.0,
            LawSign::FromSlope | LawSign::AsPrinted => 1.0,
        }
    }

    /// The law with the last estimate on the right hand side. Not a number where its denominator vanishes.
    fn delayed(&self, condition: Condition) -> f64 {
        let settings = &self.settings;
        let before = self.theta[settings.parameter];
        let n = self.sign(condition.z) * condition.n;
        match settings.form {
            ThesisForm::Reduced => n / settings.eta,
            ThesisForm::Damped => before + n / settings.eta,
            ThesisForm::Printed => {
                let (k, _) = gain(before, spread(settings.lower, settings.upper), condition.z, settings.eta);
                n / (k * condition.d + settings.eta)
            }
        }
    }

    /// The law at one sample, as the settings want it evaluated. `None` if the loop does not settle.
    fn evaluate(&self, mut condition: impl FnMut(f64) -> Condition) -> Option<f64> {
        match self.settings.evaluation {
            Evaluation::Implicit => self.solve(condition),
            Evaluation::Delayed => Some(self.delayed(condition(self.theta[self.settings.parameter]))),
        }
    }

    /// Solves the loop `F(theta) = 0` by Newton from the last estimate. `None` if it does not settle.
    fn solve(&self, mut condition: impl FnMut(f64) -> Condition) -> Option<f64> {
        let settings = &self.settings;
        let before = self.theta[settings.parameter];
        let span = settings.upper - settings.lower;
        let (low, high) = (settings.lower - settings.margin * span, settings.upper + settings.margin * span);
        let spread = spread(settings.lower, settings.upper);
        let mut theta = before;
        for _ in 0..MAXIMUM_ITERATIONS {
            let Condition { n, d, z } = condition(theta);
            let sign = -self.sign(z);
            let (value, slope) = match settings.form {
                ThesisForm::Reduced => (settings.eta * theta + sign * n, settings.eta + sign * z),
                ThesisForm::Damped => (settings.eta * (theta - before) + sign * n, settings.eta + sign * z),
                ThesisForm::Printed => {
                    let (k, dk) = gain(theta, spread, z, settings.eta);
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
                    SurfaceDerivative::Known | SurfaceDerivative::Integrated => true,
                }
        });
        let lambda = self.settings.lambda.min(self.settings.maximum_lambda_h / interval_s);
        let integrated =
            self.settings.channels.iter().all(|channel| matches!(channel.derivative, SurfaceDerivative::Integrated));

        let mut at_sample = None;
        let mut solved = None;
        if complete && integrated && self.energy_known {
            let last_energy = self.energy;
            let condition = |value| {
                let (x, by_parameter) = self.integrate(value, &input, interval_s);
                let (energy, energy_slope) = self.energy_of(&x, &by_parameter, sample);
                let d = (energy - last_energy) / interval_s;
                Condition { n: d + lambda * energy, d, z: energy_slope * (1.0 / interval_s + lambda) }
            };
            solved = self.evaluate(condition);
            at_sample = Some(condition(solved.unwrap_or(before)));
        }
        let theta = solved.unwrap_or(before);
        let (x, by_parameter) = self.integrate(theta, &input, interval_s);
        if !(x.iter().sum::<f64>() + theta).is_finite() {
            if self.settings.evaluation == Evaluation::Delayed {
                return self.stop();
            }
            self.running = false;
            return self.start(sample);
        }
        self.x = x;
        self.theta[self.settings.parameter] = theta;
        for state in 0..N {
            if let (true, Some(value)) =
                (self.settings.follow[state], measured(self.model.measuring_output(state), sample))
            {
                self.x[state] = value;
            }
        }
        if complete {
            let energy = self.energy_of(&self.x, &by_parameter, sample).0;
            if self.energy_known {
                self.integral += 0.5 * interval_s * (self.energy + energy);
            }
            self.energy = energy;
        }
        self.energy_known = complete;
        if complete && !integrated {
            let (d, z) = self.rate_at_sample(sample);
            let energy = self.energy;
            // D is linear in the parameter.
            let condition = |value: f64| {
                let d = d + z * (value - theta);
                Condition { n: d + lambda * energy, d, z }
            };
            solved = self.evaluate(condition);
            if let Some(value) = solved {
                if !value.is_finite() {
                    return self.stop();
                }
                self.theta[self.settings.parameter] = value;
            }
            at_sample = Some(condition(self.theta[self.settings.parameter]));
        }
        if let Some(condition) = at_sample {
            self.diagnose(condition, lambda);
        }
        self.phase = match (complete, solved) {
            (false, _) => Phase::Predicting,
            (true, Some(_)) => Phase::Sliding,
            (true, None) => Phase::Rejected,
        };
    }

    /// `D` and `z` at the sample itself, from the rates of the estimated model and the measured ones.
    fn rate_at_sample(&self, sample: &Sample<M::Input, R>) -> (f64, f64) {
        let mut lin = LinearizedRates::<N, P>::ZERO;
        self.model.linearized_rates(&self.x, &self.theta, &sample.input, &mut lin);
        let seen =
            core::array::from_fn(|state| measured(self.model.measuring_output(state), sample).unwrap_or(self.x[state]));
        let (mut d, mut z) = (0.0, 0.0);
        for channel in &self.settings.channels {
            let rate = match channel.derivative {
                SurfaceDerivative::Output(output) => sample.outputs[output],
                SurfaceDerivative::Known => self.model.rates(&seen, &self.theta, &sample.input)[channel.state],
                SurfaceDerivative::Integrated => continue,
            };
            let weight = 1.0 / (channel.scale * channel.scale);
            let y = self.x[channel.state];
            d += weight * (y * lin.rates[channel.state] - sample.outputs[channel.output] * rate);
            z += weight * y * lin.regressors[channel.state][self.settings.parameter];
        }
        (d, z)
    }

    fn diagnose(&mut self, condition: Condition, lambda: f64) {
        let settings = &self.settings;
        let theta = self.theta[settings.parameter];
        let (gain, _) = gain(theta, spread(settings.lower, settings.upper), condition.z, settings.eta);
        let surface = self.energy + lambda * self.integral;
        let farther = (settings.upper - theta).abs().max((theta - settings.lower).abs());
        self.diagnostics = Diagnostics {
            energy: self.energy,
            surface,
            surface_rate: condition.n,
            reaching: surface * condition.n + settings.eta * surface.abs(),
            gain,
            required_gain: gain + 2.0 * settings.eta,
            mismatch: farther * condition.z.abs(),
            denominator: gain * condition.d + settings.eta,
            slope: condition.z,
        };
    }

    /// The delayed loop has left the numbers; it is not started again, so that nobody takes it for alive.
    fn stop(&mut self) {
        self.phase = Phase::Diverged;
        self.theta[self.settings.parameter] = f64::NAN;
        self.diagnostics = Diagnostics::default();
    }

    fn estimate(&self) -> Estimate<P> {
        let settings = &self.settings;
        let excited = self.diagnostics.slope.abs() > settings.eta;
        let status = verdict(self.theta[settings.parameter], [settings.lower, settings.upper], excited);
        let unknown = [(settings.parameter, status)];
        without_covariance(self.last_s, &self.theta, self.model.parameter_count(), self.phase, unknown)
    }
}

impl<M, const N: usize, const R: usize, const P: usize, const S: usize> Estimator<R, P> for ThesisLaw<M, N, R, P, S>
where
    M: Model<N, R, P>,
{
    type Input = M::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        if self.phase == Phase::Diverged {
            self.last_s = self.last_s.max(sample.time_s);
        } else if !sample.time_s.is_finite() || sample.time_s <= self.last_s {
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
