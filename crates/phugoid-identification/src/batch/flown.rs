//! A plant with the inputs of its flight, whatever its type: what keeps the batch methods from being compiled once for every
//! model.

use phugoid_estimators::{ConstantEffects, Input, LinearizedOutputs, LinearizedRates, Model, RegressorShift};

use crate::core::options::CAPACITY;
use crate::core::systematic::ROOM_FOR_CONSTANTS;

/// A place in a flight: at a sample, or in the interval from it to the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Number of the sample, from 0.
    pub sample: usize,
    /// Part of the interval to the next sample that has passed, 0 to 1; none at the sample itself.
    pub part: Option<f64>,
}

impl Instant {
    /// At a sample.
    pub fn at(sample: usize) -> Self {
        Self { sample, part: None }
    }

    /// The input here, from those of all samples.
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn input<I: Input>(&self, inputs: &[I]) -> I {
        let here = inputs[self.sample];
        self.part.map_or(here, |part| here.interpolate(&inputs[self.sample + 1], part))
    }
}

impl Input for Instant {
    /// From a sample to the next one.
    fn interpolate(&self, _next: &Self, s: f64) -> Self {
        Self { sample: self.sample, part: Some(s) }
    }
}

/// A model with `N` states and `R` outputs and the known inputs of one flight, asked by [`Instant`]. The functions are those of
/// [`Model`].
pub trait Flown<const N: usize, const R: usize> {
    /// Number of samples of the input.
    fn samples(&self) -> usize;

    /// Parameters in use, at most [`CAPACITY`].
    fn parameter_count(&self) -> usize;

    /// The output that measures a state directly, if there is one.
    fn measuring_output(&self, state: usize) -> Option<usize>;

    /// Where the search for the start of a state may begin that no output has measured, in the unit of the state; `None` where
    /// nothing is known of it.
    fn unmeasured_start(&self, state: usize) -> Option<f64> {
        let _ = state;
        None
    }

    /// Rates, their state Jacobian and the regressors, written to `out`.
    fn linearized_rates(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut LinearizedRates<N, CAPACITY>,
    );

    /// Outputs and their Jacobians, written to `out`.
    fn linearized_outputs(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut LinearizedOutputs<N, R, CAPACITY>,
    );

    /// What one unit of each considered constant adds to rates and outputs, written to `out`, which holds zeros.
    fn constant_effects(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut ConstantEffects<N, R, ROOM_FOR_CONSTANTS>,
    );

    /// What the considered constants add to the regressor of a parameter of those of others ([`Model::regressor_shifts`]).
    fn regressor_shifts(&self, parameter: usize) -> &[RegressorShift];
}

/// A model and the known input at each sample of a flight.
#[derive(Clone, Copy, Debug)]
pub struct WithInputs<'a, M, I> {
    /// The model with the constants of this flight.
    pub model: &'a M,
    /// Known input at each sample.
    pub inputs: &'a [I],
}

impl<M, I, const N: usize, const R: usize> Flown<N, R> for WithInputs<'_, M, I>
where
    M: Model<N, R, CAPACITY, Input = I>,
    I: Input,
{
    fn samples(&self) -> usize {
        self.inputs.len()
    }

    fn parameter_count(&self) -> usize {
        self.model.parameter_count()
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        self.model.measuring_output(state)
    }

    fn linearized_rates(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut LinearizedRates<N, CAPACITY>,
    ) {
        self.model.linearized_rates(x, theta, &at.input(self.inputs), out);
    }

    fn linearized_outputs(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut LinearizedOutputs<N, R, CAPACITY>,
    ) {
        self.model.linearized_outputs(x, theta, &at.input(self.inputs), out);
    }

    fn constant_effects(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut ConstantEffects<N, R, ROOM_FOR_CONSTANTS>,
    ) {
        self.model.constant_effects(x, theta, &at.input(self.inputs), out);
    }

    fn regressor_shifts(&self, parameter: usize) -> &[RegressorShift] {
        self.model.regressor_shifts(parameter)
    }
}

/// A flown plant as the model that the integration of the estimators takes.
#[derive(Clone, Copy)]
pub(crate) struct AsModel<'a, const N: usize, const R: usize>(pub(crate) &'a dyn Flown<N, R>);

impl<const N: usize, const R: usize> Model<N, R, CAPACITY> for AsModel<'_, N, R> {
    type Input = Instant;

    fn parameter_count(&self) -> usize {
        self.0.parameter_count()
    }

    fn rates(&self, x: &[f64; N], theta: &[f64; CAPACITY], at: &Instant) -> [f64; N] {
        let mut linearized = LinearizedRates::ZERO;
        self.0.linearized_rates(x, theta, *at, &mut linearized);
        linearized.rates
    }

    fn linearized_rates(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: &Instant,
        out: &mut LinearizedRates<N, CAPACITY>,
    ) {
        self.0.linearized_rates(x, theta, *at, out);
    }

    fn linearized_outputs(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: &Instant,
        out: &mut LinearizedOutputs<N, R, CAPACITY>,
    ) {
        self.0.linearized_outputs(x, theta, *at, out);
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        self.0.measuring_output(state)
    }
}
