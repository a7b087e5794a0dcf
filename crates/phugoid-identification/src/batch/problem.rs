//! The arguments of a batch method: the manoeuvres, and which parameters, biases, noise levels and initial states are
//! unknown.

use std::ops::Range;

use phugoid_estimators::discretization::{InputHold, IntervalInput, Part, sub_steps};

use super::error::BatchError;
use super::flown::{Flown, Instant};
use crate::core::options::{CAPACITY, Likelihood};

/// The samples of one flight, with the model of that flight: constants such as mass may differ from flight to flight,
/// the parameters are common to all.
#[derive(Clone, Copy)]
pub struct Manoeuvre<'a, const N: usize, const R: usize> {
    /// Name for messages, e.g. the file.
    pub name: &'a str,
    /// The model with the constants of this flight and the known input at each sample, for example
    /// [`WithInputs`](super::WithInputs).
    pub plant: &'a dyn Flown<N, R>,
    /// Sample of the plant at which the manoeuvre begins: 0, unless it is a part of a flight. The flight may go on after it.
    pub first: usize,
    /// Sample times, s, strictly increasing.
    pub time_s: &'a [f64],
    /// What the input does between samples.
    pub hold: InputHold,
    /// Measured outputs at each sample; NaN where missing.
    pub outputs: &'a [[f64; R]],
    /// Where the search for the initial state starts; none: each state at the median of the first five values of the
    /// output that measures it.
    pub initial_state: Option<[f64; N]>,
}

impl<const N: usize, const R: usize> Manoeuvre<'_, N, R> {
    /// The part of it from one sample up to another, which does not belong to it.
    pub(crate) fn part(&self, samples: Range<usize>) -> Self {
        Self {
            first: self.first + samples.start,
            time_s: &self.time_s[samples.clone()],
            outputs: &self.outputs[samples],
            initial_state: None,
            ..*self
        }
    }

    /// Where the plant is at a sample of the manoeuvre.
    pub(super) fn instant(&self, sample: usize) -> Instant {
        Instant::at(self.first + sample)
    }

    /// The input from a sample to the next one, the time between them, s, and the parts in which it is integrated, none
    /// longer than `maximum_step_s`.
    pub(super) fn interval(
        &self,
        sample: usize,
        maximum_step_s: f64,
    ) -> (IntervalInput<Instant>, f64, impl ExactSizeIterator<Item = Part> + use<N, R>) {
        let interval_s = self.time_s[sample + 1] - self.time_s[sample];
        let input = IntervalInput { from: self.instant(sample), to: self.instant(sample + 1), hold: self.hold };
        let steps = sub_steps(interval_s, maximum_step_s);
        let part = move |k: usize| Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
        (input, interval_s, (0..steps).map(part))
    }
}

/// The manoeuvres with other outputs, by manoeuvre and sample.
pub(crate) fn with_outputs<'a, const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'a, N, R>],
    outputs: &'a [Vec<[f64; R]>],
) -> Vec<Manoeuvre<'a, N, R>> {
    manoeuvres.iter().zip(outputs).map(|(manoeuvre, outputs)| Manoeuvre { outputs, ..*manoeuvre }).collect()
}

/// One parameter of the model: where the search starts, its prior and its bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchParameter {
    /// Name of the parameter in messages and results, e.g. `Cm_alpha`.
    pub name: String,
    /// Value at which the search starts, in the parameter's unit; a fixed parameter keeps it.
    pub start: f64,
    /// One sigma of what is known beforehand, about `start`; none: the data alone decide (maximum likelihood).
    pub prior_std: Option<f64>,
    /// Lower bound in the parameter's unit; minus infinity for none.
    pub lower: f64,
    /// Upper bound in the parameter's unit; infinity for none.
    pub upper: f64,
    /// True if the parameter is not estimated but held at `start`.
    pub fixed: bool,
}

impl BatchParameter {
    /// A free parameter without prior or bounds.
    pub fn free(name: impl Into<String>, start: f64) -> Self {
        let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
        Self { name: name.into(), start, prior_std: None, lower, upper, fixed: false }
    }
}

/// What is known of the noise of an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// One sigma is known, output units.
    Known(f64),
    /// The standard deviation is estimated together with the parameters.
    Estimated,
}

/// What is known of the process noise: turbulence and model error that drive the states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoise<const N: usize> {
    /// Variance that each state gains per second, state units squared per second; 0 for a state without.
    pub density: [f64; N],
    /// True if the densities that are not zero are estimated with the parameters, from these on.
    pub estimated: bool,
}

/// A constant error of an output, estimated with the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Bias {
    /// The output has no constant error that would have to be estimated.
    #[default]
    None,
    /// The same in all manoeuvres. The number is the prior's one sigma, output units; infinite for no prior.
    Shared(f64),
    /// One for each manoeuvre, prior as above.
    PerManoeuvre(f64),
}

/// One output of the model. It is used where it has values.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputChannel {
    /// Canonical name of the channel that measures the output, e.g. `alpha`.
    pub name: String,
    /// What is known of the measurement noise.
    pub noise: Noise,
    /// Whether a constant error of the sensor is estimated.
    pub bias: Bias,
}

impl OutputChannel {
    /// An output without a constant error of its sensor.
    pub fn new(name: impl Into<String>, noise: Noise) -> Self {
        Self { name: name.into(), noise, bias: Bias::None }
    }
}

/// One state of the model at the start of a manoeuvre.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialState {
    /// Name of the state in messages, e.g. `alpha`.
    pub name: String,
    /// Estimated for each manoeuvre; otherwise held where it starts.
    pub free: bool,
    /// The state is not integrated: at every sample it is where the output that measures it is the measured value, and
    /// that output is not fitted; residuals of outputs that measure no state are smoothed over 0.4 s. For the flow angles
    /// in turbulence, which a simulation without gusts does not have. Output error does so; filter error refuses it, and
    /// equation error takes all states as measured.
    pub measured: bool,
}

impl InitialState {
    /// A state whose initial value is estimated.
    pub fn free(name: impl Into<String>) -> Self {
        Self { name: name.into(), free: true, measured: false }
    }

    /// A state that is taken as measured in place of being integrated.
    pub fn measured(name: impl Into<String>) -> Self {
        Self { name: name.into(), free: false, measured: true }
    }
}

/// What is to be estimated from one or several manoeuvres, and what is known of it beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure<const N: usize, const R: usize> {
    /// The parameters of the model, all of them, in its order.
    pub parameters: Vec<BatchParameter>,
    /// The states at the start of each manoeuvre, in the order of the model.
    pub states: [InitialState; N],
    /// The outputs, in the order of the model.
    pub outputs: [OutputChannel; R],
    /// Longest step of the integration, s; sampling intervals that are longer are cut.
    pub maximum_step_s: f64,
    /// Longest interval between two samples that is integrated through, s: after a longer one each state begins anew,
    /// where the measurements are, with an initial value of its own. Infinite: never. Equation error does not integrate
    /// and has no use for it.
    pub maximum_gap_s: f64,
    /// Whether outliers are allowed for.
    pub likelihood: Likelihood,
}

impl<const N: usize, const R: usize> Structure<N, R> {
    /// True for each output with a value in any manoeuvre.
    pub(crate) fn used(manoeuvres: &[Manoeuvre<'_, N, R>]) -> [bool; R] {
        std::array::from_fn(|i| manoeuvres.iter().any(|m| m.outputs.iter().any(|y| y[i].is_finite())))
    }

    /// With these parameters to start from, and nothing unknown beside them: no initial state, and no bias.
    pub(crate) fn held_at(&self, parameters: &[f64]) -> Self {
        let mut held = self.clone();
        held.states.iter_mut().for_each(|s| s.free = false);
        held.outputs.iter_mut().for_each(|channel| channel.bias = Bias::None);
        for (parameter, value) in held.parameters.iter_mut().zip(parameters) {
            parameter.start = *value;
        }
        held
    }

    /// Refuses arguments that contradict each other or are out of range, and names them.
    pub(crate) fn check(&self, manoeuvres: &[Manoeuvre<'_, N, R>]) -> Result<(), BatchError> {
        let refuse = |what: String| Err(BatchError::BadInput(what));
        if manoeuvres.is_empty() {
            return refuse("no manoeuvre was given: at least one is needed".to_owned());
        }
        if self.maximum_step_s.is_nan() || self.maximum_step_s <= 0.0 {
            return refuse(format!("the longest integration step is {} s: it must be positive", self.maximum_step_s));
        }
        if self.maximum_gap_s.is_nan() || self.maximum_gap_s <= 0.0 {
            return refuse(format!(
                "the longest gap to integrate through is {} s: it must be positive",
                self.maximum_gap_s
            ));
        }
        for m in manoeuvres {
            let (name, samples) = (m.name, m.time_s.len());
            // A part of a flight need not reach to its end.
            let inputs = m.plant.samples().saturating_sub(m.first);
            if inputs < samples || samples != m.outputs.len() || samples < 2 {
                return refuse(format!(
                    "{name}: {samples} times, {inputs} inputs and {} outputs: they must be equally many, at least two",
                    m.outputs.len()
                ));
            }
            if let Some(k) = (1..samples).find(|&k| !(m.time_s[k] > m.time_s[k - 1] && m.time_s[k].is_finite())) {
                return refuse(format!("{name}: time {} s of sample {k} does not increase", m.time_s[k]));
            }
            let count = m.plant.parameter_count().min(CAPACITY);
            if count != self.parameters.len() {
                let given = self.parameters.len();
                return refuse(format!("{name}: the model has {count} parameters, the structure {given}"));
            }
        }
        for p in &self.parameters {
            let inside = p.start.is_finite() && p.lower <= p.start && p.start <= p.upper;
            if !inside {
                return refuse(format!("{} starts at {}, outside [{}, {}]", p.name, p.start, p.lower, p.upper));
            }
            if p.prior_std.is_some_and(|std| !(std > 0.0 && std.is_finite())) {
                return refuse(format!("the prior of {} must be positive and finite, or none", p.name));
            }
        }
        let used = Self::used(manoeuvres);
        if !used.contains(&true) {
            return refuse("no output has a value in any manoeuvre".to_owned());
        }
        for (channel, _) in self.outputs.iter().zip(used).filter(|(_, used)| *used) {
            if let Noise::Known(std) = channel.noise
                && !(std > 0.0 && std.is_finite())
            {
                return refuse(format!("the noise of {} is {std}: one sigma must be positive", channel.name));
            }
            if let Bias::Shared(std) | Bias::PerManoeuvre(std) = channel.bias
                && (std.is_nan() || std <= 0.0)
            {
                return refuse(format!("the prior of the bias of {} must be positive", channel.name));
            }
        }
        Ok(())
    }
}
