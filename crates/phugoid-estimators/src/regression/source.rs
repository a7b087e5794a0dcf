//! Where the regressors' states come from.

use crate::model::{Model, Sample};

/// One interval with the frame at its end, as a state source sees it.
#[derive(Clone, Copy, Debug)]
pub struct SourceStep<'a, I, const N: usize, const R: usize> {
    /// Length of the interval since the last frame, s; positive.
    pub interval_s: f64,
    /// Known input that was applied at the start of the interval.
    pub input_before: &'a I,
    /// Known input that was applied up to its end (left limit).
    pub input_after: &'a I,
    /// Measured outputs at the end; NaN where missing or taken for an outlier.
    pub outputs: &'a [f64; R],
    /// The model's state at the end, from the source's last state and the present parameters.
    pub predicted_state: &'a [f64; N],
    /// The model's outputs there. They may stand in for measurements that are missing.
    pub predicted_outputs: &'a [f64; R],
}

/// Gives the states at which a regression evaluates its regressors.
///
/// Regressors that carry measurement noise bias a regression (errors in variables: dCL_alpha of the F-16 by -6 % from
/// the raw vane of 0.1 deg), so the states should be smoother than their measurements. How that can be done without the
/// unknown parameters depends on the plant: [`MeasuredStates`] does not try.
///
/// Implementations are causal, allocate nothing and never give a state that is not finite from finite arguments.
pub trait StateSource<I, const N: usize, const R: usize> {
    /// Forgets everything and begins at `sample`. `state` is the median of the first measurements (what is not
    /// measured: of the settings).
    fn start(&mut self, sample: &Sample<I, R>, state: &[f64; N]);

    /// Takes the next frame and gives the state that holds at it.
    fn update(&mut self, step: &SourceStep<'_, I, N, R>) -> [f64; N];

    /// How wrong the states may be that were given last. What that makes of an output or of a rate is added to the noise of its
    /// row; a variance that is no number adds nothing. The usual answer takes the states as right.
    fn errors(&self) -> [StateError; N] {
        [StateError::NONE; N]
    }
}

/// How wrong a state may be: a random error that is forgotten at a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateError {
    /// Variance, state unit squared; not negative.
    pub variance: f64,
    /// Rate at which the error is forgotten, 1/s: its correlation over the time `t` is `e^(-rate t)`. Two over the sample time
    /// for the noise of a measurement, which is another one in each sample.
    pub rate_per_s: f64,
}

impl StateError {
    /// The state is right.
    pub const NONE: Self = Self { variance: 0.0, rate_per_s: 0.0 };

    /// Variance of the error behind a filter of one pole, `1/(s + pole)`, that has forgotten its start: state unit
    /// squared times s^2.
    pub(crate) fn filtered(&self, pole: f64) -> f64 {
        self.variance / (pole * (pole + self.rate_per_s))
    }
}

/// The measured states as they are; a state that is missing in a frame is the model's prediction.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredStates<const N: usize> {
    /// Output that measures each state.
    outputs: [Option<usize>; N],
}

impl<const N: usize> MeasuredStates<N> {
    /// Of the states that the model says are measured.
    pub fn new<M, const R: usize, const P: usize>(model: &M) -> Self
    where
        M: Model<N, R, P>,
    {
        Self { outputs: core::array::from_fn(|state| model.measuring_output(state).filter(|output| *output < R)) }
    }
}

impl<I, const N: usize, const R: usize> StateSource<I, N, R> for MeasuredStates<N> {
    fn start(&mut self, _sample: &Sample<I, R>, _state: &[f64; N]) {}

    fn update(&mut self, step: &SourceStep<'_, I, N, R>) -> [f64; N] {
        core::array::from_fn(|state| match self.outputs[state].and_then(|output| step.outputs.get(output).copied()) {
            Some(measured) if measured.is_finite() => measured,
            _ => step.predicted_state[state],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::StateError;

    /// The variance of a filtered error, by the equations of its second moments: `(x^2)' = -2 r x^2 + 2 r v` for the error,
    /// `(xy)' = -(r + p) xy + x^2` and `(y^2)' = -2 p y^2 + 2 xy` for the filter.
    #[test]
    fn a_filtered_error_has_the_variance_of_its_moments() {
        for (variance, rate_per_s, pole) in [(4.0, 0.9, 8.0), (0.25, 100.0, 4.0), (1.0, 8.0, 8.0)] {
            let h = 1e-4;
            let [mut xy, mut yy] = [0.0; 2];
            for _ in 0..100_000 {
                let rates = [variance - (rate_per_s + pole) * xy, 2.0 * xy - 2.0 * pole * yy];
                xy += h * rates[0];
                yy += h * rates[1];
            }
            let found = StateError { variance, rate_per_s }.filtered(pole);
            assert!((found / yy - 1.0).abs() < 1e-9, "{found} {yy}");
        }
    }
}
