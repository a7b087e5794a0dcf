//! States that are not integrated but taken as measured: airspeed and flow angles in turbulence.
//!
//! A free simulation has the motion that its model makes of the surfaces alone. In turbulence the aircraft moves by the
//! gusts too, and a simulated angle of attack is not the one that made the forces and moments. Where the flow angles are
//! measured they can take the place of the simulated ones: the forces and moments of the model then hear the gusts, and
//! what remains to be fitted are the rates, the accelerations, and the other states that are not measured so (Jategaonkar, Flight Vehicle
//! System Identification, section 9.3, the method of stabilisation by equation decoupling).
//!
//! A measured state has noise, and noise in a regressor bends its derivative towards zero. Where the state is integrated on,
//! in the rates, its noise averages out. In the accelerations it stands beside the measurement of the same sample, and both
//! sides are smoothed by the same window, as in equation error: smoothing the state alone by a window takes the quick part of
//! its effect away, and derivatives with respect to rates and surfaces would take that up.

use crate::core::options::CAPACITY;
use phugoid_estimators::LinearizedOutputs;

use super::differentiate::{LocalCubics, half_window_s};
use super::error::BatchError;
use super::flown::{Flown, Instant};
use super::problem::{Manoeuvre, Structure};
use crate::preparation::noise::{measure_own_noise, without_outliers};
use phugoid_flight_data::statistics::median;

/// The outputs of one manoeuvre that states follow.
#[derive(Clone, Debug)]
pub(crate) struct Followed<const N: usize> {
    /// The output that each state follows; none for a state that is integrated.
    outputs: [Option<usize>; N],
    /// The measured value of that output by sample, outliers left out; NaN where it is not known, so that the state is
    /// integrated there.
    values: Vec<[f64; N]>,
    /// The outputs that measure no state, with the windows that smooth their residuals.
    windows: Vec<(usize, LocalCubics)>,
}

impl<const N: usize> Followed<N> {
    /// Collects what the states that follow their measurement follow; none if there is no such state.
    ///
    /// # Errors
    /// [`BatchError::BadInput`] where nothing measures such a state.
    pub(crate) fn of<const R: usize>(
        m: &Manoeuvre<'_, N, R>,
        structure: &Structure<N, R>,
    ) -> Result<Option<Self>, BatchError> {
        if structure.states.iter().all(|state| !state.measured) {
            return Ok(None);
        }
        let samples = m.time_s.len();
        let mut outputs = [None; N];
        let mut values = vec![[f64::NAN; N]; samples];
        for (i, state) in structure.states.iter().enumerate().filter(|(_, state)| state.measured) {
            let output = m.plant.measuring_output(i);
            let mut measured: Vec<f64> =
                output.map_or(Vec::new(), |output| m.outputs.iter().map(|y| y[output]).collect());
            if !measured.iter().any(|value| value.is_finite()) {
                return Err(BatchError::BadInput(format!(
                    "{}: the state {} is to be taken as measured, and nothing measures it",
                    m.name, state.name
                )));
            }
            if let Some(noise) = measure_own_noise(&measured) {
                measured = without_outliers(&measured, noise.std);
            }
            outputs[i] = output;
            values.iter_mut().zip(measured).for_each(|(values, measured)| values[i] = measured);
        }
        // The median, so that a gap does not count.
        let mut spacing: Vec<f64> = m.time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let half_window_s = half_window_s(median(&mut spacing).unwrap_or(0.0));
        let known = |k: usize| (0..N).all(|i| outputs[i].is_none() || values[k][i].is_finite());
        let no_state = |output: &usize| (0..N).all(|i| m.plant.measuring_output(i) != Some(*output));
        let window = |output: usize| {
            let usable: Vec<f64> =
                (0..samples).map(|k| if known(k) { m.outputs[k][output] } else { f64::NAN }).collect();
            (output, LocalCubics::new(m.time_s, &usable, half_window_s))
        };
        let windows = (0..R).filter(no_state).map(window).collect();
        Ok(Some(Self { outputs, values, windows }))
    }

    /// The outputs that measure no state, with the windows that both sides of them are smoothed by.
    pub(crate) fn windows(&self) -> &[(usize, LocalCubics)] {
        &self.windows
    }

    /// True if an output is followed by a state, so that it has no residual.
    pub(crate) fn is_followed(&self, output: usize) -> bool {
        self.outputs.contains(&Some(output))
    }

    /// Moves the states at a sample to where the model's output is the measured one, and the sensitivities with them.
    ///
    /// The state `i` that output `o` measures moves by `(y - h_o) / H_oi` and then depends on the unknowns only through
    /// what else makes that output: `dx_i = -(D_o + sum_{l != i} H_ol dx_l) / H_oi`. One step is exact for a vane, whose
    /// output is linear in its angle.
    pub(crate) fn apply<const R: usize>(
        &self,
        sample: usize,
        at: (&dyn Flown<N, R>, &[f64; CAPACITY], Instant),
        x: &mut [f64; N],
        by_parameter: &mut [[f64; CAPACITY]; N],
        by_initial: &mut [[f64; N]; N],
        lin: &mut LinearizedOutputs<N, R, CAPACITY>,
    ) {
        let (plant, theta, instant) = at;
        for i in 0..N {
            let (Some(output), value) = (self.outputs[i], self.values[sample][i]) else { continue };
            plant.linearized_outputs(x, theta, instant, lin);
            let own = lin.state_jacobian[output][i];
            if !value.is_finite() || own == 0.0 {
                continue;
            }
            x[i] += (value - lin.outputs[output]) / own;
            let others = |l: &usize| *l != i;
            let by_others = |j: usize, by: &dyn Fn(usize, usize) -> f64| -> f64 {
                (0..N).filter(others).map(|l| lin.state_jacobian[output][l] * by(l, j)).sum()
            };
            let row: [f64; CAPACITY] = std::array::from_fn(|j| {
                -(lin.parameter_jacobian[output][j] + by_others(j, &|l, j| by_parameter[l][j])) / own
            });
            let start: [f64; N] = std::array::from_fn(|j| -by_others(j, &|l, j| by_initial[l][j]) / own);
            by_parameter[i] = row;
            by_initial[i] = start;
        }
    }
}
