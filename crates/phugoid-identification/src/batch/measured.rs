//! The states and accelerations of a manoeuvre as a regression takes them: without outliers, smoothed and differentiated.

use super::differentiate::LocalCubics;
use super::error::BatchError;
use super::problem::{Manoeuvre, Structure};
use crate::core::options::Likelihood;
use crate::preparation::noise::{measure_own_noise, without_outliers};

/// What happens to values that stand out of their neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outliers {
    LeftOut,
    Kept,
}

impl Outliers {
    /// As a likelihood takes them.
    pub(crate) fn of(likelihood: Likelihood) -> Self {
        match likelihood {
            Likelihood::Robust => Self::LeftOut,
            Likelihood::Gaussian => Self::Kept,
        }
    }
}

/// One manoeuvre as measured, with the windows that smooth it.
#[derive(Clone)]
pub(crate) struct Measured<const N: usize, const R: usize> {
    /// The states by sample; the smoothed value where there is none, and NaN where that is missing too.
    pub(crate) states: Vec<[f64; N]>,
    /// The smoothed states and their slopes; NaN near the ends and where not measured.
    pub(crate) smoothed: Vec<[f64; N]>,
    pub(crate) slopes: Vec<[f64; N]>,
    /// The local cubics that the slopes were computed with, by state.
    pub(crate) cubics: Vec<LocalCubics>,
    /// The outputs by sample.
    pub(crate) outputs: Vec<[f64; R]>,
    /// The local cubics over the samples at which an output and all states are known, by output; `None` of a state, and
    /// where nothing is smoothed.
    pub(crate) output_cubics: [Option<LocalCubics>; R],
}

impl<const N: usize, const R: usize> Measured<N, R> {
    /// Takes outliers out, unless they are to be kept, and differentiates the states.
    ///
    /// # Errors
    /// [`BatchError::BadInput`] where a state is not measured, or nowhere often enough for a window.
    pub(crate) fn of(
        m: &Manoeuvre<'_, N, R>,
        structure: &Structure<N, R>,
        half_window_s: f64,
        smooth: bool,
        outliers: Outliers,
    ) -> Result<Self, BatchError> {
        let samples = m.time_s.len();
        let mut measured = Self {
            states: vec![[f64::NAN; N]; samples],
            smoothed: vec![[f64::NAN; N]; samples],
            slopes: vec![[f64::NAN; N]; samples],
            cubics: Vec::new(),
            outputs: m.outputs.to_vec(),
            output_cubics: [const { None }; R],
        };
        for i in (0..R).filter(|_| outliers == Outliers::LeftOut) {
            let values: Vec<f64> = m.outputs.iter().map(|y| y[i]).collect();
            if let Some(noise) = measure_own_noise(&values) {
                let clean = without_outliers(&values, noise.std);
                measured.outputs.iter_mut().zip(clean).for_each(|(y, value)| y[i] = value);
            }
        }
        for state in 0..N {
            let Some(output) = m.plant.measuring_output(state) else {
                let (name, of) = (&structure.states[state].name, m.name);
                return Err(BatchError::BadInput(format!("{of}: equation error needs the state {name} measured")));
            };
            let values: Vec<f64> = measured.outputs.iter().map(|y| y[output]).collect();
            let cubics = LocalCubics::new(m.time_s, &values, half_window_s);
            if !cubics.slopes(&values).iter().any(|v| v.is_finite()) {
                let (name, of) = (&structure.outputs[output].name, m.name);
                return Err(BatchError::BadInput(format!(
                    "{of}: {name} has nowhere two values to each side within {half_window_s} s: widen the window of equation error"
                )));
            }
            measured.cubics.push(cubics);
        }
        measured.differentiate(m);
        if smooth {
            let is_state = |i: usize| (0..N).any(|state| m.plant.measuring_output(state) == Some(i));
            for i in (0..R).filter(|&i| !is_state(i)) {
                let known = |k: usize| if measured.is_known(k) { measured.outputs[k][i] } else { f64::NAN };
                let known: Vec<f64> = (0..samples).map(known).collect();
                measured.output_cubics[i] = Some(LocalCubics::new(m.time_s, &known, half_window_s));
            }
        }
        Ok(measured)
    }

    /// The same windows over other values of the outputs, which are missing where these are.
    pub(crate) fn with(&self, m: &Manoeuvre<'_, N, R>, outputs: &[[f64; R]]) -> Self {
        let mut other = self.clone();
        other.outputs.copy_from_slice(outputs);
        other.differentiate(m);
        other
    }

    /// The states and their slopes, from the outputs.
    fn differentiate(&mut self, m: &Manoeuvre<'_, N, R>) {
        for (state, cubics) in self.cubics.iter().enumerate() {
            let Some(output) = m.plant.measuring_output(state) else { continue };
            let values: Vec<f64> = self.outputs.iter().map(|y| y[output]).collect();
            let (smoothed, slopes) = (cubics.values(&values), cubics.slopes(&values));
            for k in 0..values.len() {
                self.slopes[k][state] = slopes[k];
                self.smoothed[k][state] = smoothed[k];
                self.states[k][state] = if values[k].is_finite() { values[k] } else { smoothed[k] };
            }
        }
    }

    /// True if all states are known at a sample.
    pub(crate) fn is_known(&self, sample: usize) -> bool {
        self.states[sample].iter().all(|v| v.is_finite())
    }
}
