//! A prepared record as the batch methods fly it.

use phugoid_estimators::{ConstantEffects, LinearizedOutputs, LinearizedRates, RegressorShift};

use crate::batch::{Flown, Instant};
use crate::core::options::CAPACITY;
use crate::core::systematic::ROOM_FOR_CONSTANTS;
use crate::motion::{Motion, MotionModel};
use crate::preparation::prepared::Prepared;

impl<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize> Flown<N, R> for Prepared<M, N, R> {
    fn samples(&self) -> usize {
        self.inputs.len()
    }

    fn parameter_count(&self) -> usize {
        self.model.parameter_count()
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        self.model.measuring_output(state)
    }

    fn unmeasured_start(&self, state: usize) -> Option<f64> {
        let [start, _] = self.level_start(*M::AXES.states().get(state)?)?;
        Some(start)
    }

    fn linearized_rates(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut LinearizedRates<N, CAPACITY>,
    ) {
        self.model.linearized_rates(x, theta, &at.input(&self.inputs), out);
    }

    fn linearized_outputs(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut LinearizedOutputs<N, R, CAPACITY>,
    ) {
        self.model.linearized_outputs(x, theta, &at.input(&self.inputs), out);
    }

    fn constant_effects(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut ConstantEffects<N, R, ROOM_FOR_CONSTANTS>,
    ) {
        // Up to the sample, or from it to the next one.
        let end = at.sample + usize::from(at.part.is_some());
        let Some(surfaces) = self.surface_motion.get(end) else { return };
        self.model.effects(x, theta, &at.input(&self.inputs), surfaces, out);
    }

    fn regressor_shifts(&self, parameter: usize) -> &[RegressorShift] {
        Motion::regressor_shifts(&self.model, parameter)
    }
}
