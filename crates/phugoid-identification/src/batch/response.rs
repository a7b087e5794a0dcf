//! The outputs of a free simulation with their exact derivatives with respect to all unknowns.

use crate::core::options::CAPACITY;
use phugoid_estimators::LinearizedOutputs;
use phugoid_estimators::discretization::step;

use super::differentiate::LocalCubics;
use super::flown::AsModel;
use super::layout::Layout;
use super::loss::Loss;
use super::problem::Manoeuvre;
use super::result::UnknownKind;

/// Residuals of one manoeuvre and the derivatives of the model's outputs.
#[derive(Clone, Debug)]
pub(crate) struct Rows<const R: usize> {
    /// Positions of the unknowns that the columns belong to.
    pub(crate) columns: Vec<usize>,
    /// Model outputs with their biases, by sample; NaN outside of the stretches that are integrated.
    pub(crate) outputs: Vec<[f64; R]>,
    /// Measured minus modelled, by sample; NaN where nothing was measured, and for an output that a state follows.
    pub(crate) residuals: Vec<[f64; R]>,
    /// Derivatives of the modelled outputs: sample by sample, output by output, one value per column.
    pub(crate) sensitivities: Vec<f64>,
    /// What the residuals cost, once they are in units of one sigma.
    pub(crate) loss: Loss,
    /// Largest growth of an error of an initial state over its stretch, each state measured by its own spread.
    pub(crate) growth: f64,
}

impl<const R: usize> Rows<R> {
    /// Derivatives of one output at one sample by the columns.
    pub(crate) fn sensitivity(&self, sample: usize, output: usize) -> &[f64] {
        let width = self.columns.len();
        let from = (sample * R + output) * width;
        &self.sensitivities[from..from + width]
    }

    /// Passes residuals and sensitivities of outputs through the same windows. There is no residual near the ends, where there
    /// is no window.
    fn smooth(&mut self, windows: &[(usize, LocalCubics)]) {
        let (samples, width) = (self.residuals.len(), self.columns.len());
        for (output, cubics) in windows {
            let residuals: Vec<f64> = self.residuals.iter().map(|e| e[*output]).collect();
            let smoothed = cubics.values(&residuals);
            self.residuals.iter_mut().zip(smoothed).for_each(|(e, value)| e[*output] = value);
            for column in 0..width {
                let place = |k: usize| (k * R + output) * width + column;
                let values: Vec<f64> = (0..samples).map(|k| self.sensitivities[place(k)]).collect();
                for (k, value) in cubics.values(&values).into_iter().enumerate() {
                    self.sensitivities[place(k)] = value;
                }
            }
        }
    }

    /// Residuals and sensitivities divided by one sigma of each output; an output without noise is left out.
    pub(crate) fn whitened(mut self, noise_std: &[f64; R], loss: Loss) -> Self {
        self.loss = loss;
        let width = self.columns.len();
        for (k, residuals) in self.residuals.iter_mut().enumerate() {
            for (i, residual) in residuals.iter_mut().enumerate() {
                *residual /= noise_std[i];
                let from = (k * R + i) * width;
                for value in &mut self.sensitivities[from..from + width] {
                    *value /= noise_std[i];
                }
            }
        }
        self
    }
}

/// Simulates a manoeuvre; gives the time of the first value that is not finite, s from its start, if there is one.
///
/// The sensitivities obey `U+ = A U + B` and `S+ = A S` with the derivatives `A`, `B` of the step map itself, so that
/// they are those of the simulated outputs to rounding (Klein & Morelli, Aircraft System Identification, section 6.3,
/// there in continuous time).
pub(crate) fn response<const N: usize, const R: usize>(
    manoeuvre: &Manoeuvre<'_, N, R>,
    index: usize,
    layout: &Layout<N>,
    unknowns: &[f64],
    maximum_step_s: f64,
) -> Result<Rows<R>, f64> {
    let plant = manoeuvre.plant;
    let columns = layout.columns(index);
    let kinds: Vec<UnknownKind> = columns.iter().map(|&j| layout.places[j].kind).collect();
    let theta = layout.parameters(unknowns);
    let biases: [f64; R] = layout.biases(index, unknowns);
    let mut transition = [[0.0; N]; N];
    let mut lin = LinearizedOutputs::<N, R, CAPACITY>::ZERO;
    let samples = manoeuvre.time_s.len();
    let width = columns.len();
    let mut rows = Rows {
        columns,
        outputs: vec![[f64::NAN; R]; samples],
        residuals: vec![[f64::NAN; R]; samples],
        sensitivities: vec![0.0; samples * R * width],
        loss: Loss::GAUSSIAN,
        growth: 1.0,
    };
    let spread = spreads(manoeuvre);
    let followed = layout.followed(index);
    let is_fitted = |output: usize| followed.is_none_or(|f| !f.is_followed(output));

    for (n, stretch) in layout.stretches(index, unknowns).into_iter().enumerate() {
        let mut x = stretch.state;
        let mut by_parameter = [[0.0; CAPACITY]; N];
        let mut by_initial: [[f64; N]; N] = identity();
        for k in stretch.from..stretch.to {
            if let Some(followed) = followed {
                let at = (plant, &theta, manoeuvre.instant(k));
                followed.apply(k, at, &mut x, &mut by_parameter, &mut by_initial, &mut lin);
            }
            plant.linearized_outputs(&x, &theta, manoeuvre.instant(k), &mut lin);
            for i in 0..R {
                let h = &lin.state_jacobian[i];
                let from = (k * R + i) * width;
                for (value, kind) in rows.sensitivities[from..from + width].iter_mut().zip(&kinds) {
                    *value = match *kind {
                        UnknownKind::Parameter { index: j } => {
                            lin.parameter_jacobian[i][j] + (0..N).map(|l| h[l] * by_parameter[l][j]).sum::<f64>()
                        }
                        UnknownKind::InitialState { state, stretch, .. } if stretch == n => {
                            (0..N).map(|l| h[l] * by_initial[l][state]).sum()
                        }
                        UnknownKind::Bias { output, .. } => f64::from(output == i),
                        // The start of another stretch, and noise variances, do not move these outputs.
                        UnknownKind::InitialState { .. }
                        | UnknownKind::Noise { .. }
                        | UnknownKind::ProcessNoise { .. } => 0.0,
                    };
                }
            }
            let outputs: [f64; R] = std::array::from_fn(|i| lin.outputs[i] + biases[i]);
            let measured = &manoeuvre.outputs[k];
            let lost = |i: usize| {
                measured[i].is_finite()
                    && !(outputs[i].is_finite() && rows.sensitivity(k, i).iter().all(|value| value.is_finite()))
            };
            if (0..R).any(lost) || !x.iter().all(|v| v.is_finite()) {
                return Err(manoeuvre.time_s[k] - manoeuvre.time_s[0]);
            }
            rows.outputs[k] = outputs;
            rows.residuals[k] = std::array::from_fn(|i| if is_fitted(i) { measured[i] - outputs[i] } else { f64::NAN });
            if k + 1 == stretch.to {
                break;
            }
            let (input, interval_s, parts) = manoeuvre.interval(k, maximum_step_s);
            for part in parts {
                let count = plant.parameter_count();
                x = step(
                    &AsModel(plant),
                    &x,
                    &theta,
                    &input,
                    interval_s,
                    part,
                    count,
                    &mut by_parameter,
                    &mut transition,
                );
                by_initial = product(&transition, &by_initial);
            }
            for i in 0..N {
                for j in 0..N {
                    let growth = by_initial[i][j].abs() * spread[j] / spread[i];
                    rows.growth = if growth > rows.growth { growth } else { rows.growth };
                }
            }
        }
    }
    if let Some(followed) = followed {
        rows.smooth(followed.windows());
    }
    Ok(rows)
}

/// How far each state moves in the manoeuvre, by the output that measures it; 1 where no output measures it or the
/// output is constant.
fn spreads<const N: usize, const R: usize>(manoeuvre: &Manoeuvre<'_, N, R>) -> [f64; N] {
    std::array::from_fn(|state| {
        let spread = manoeuvre.plant.measuring_output(state).map_or(f64::NAN, |output| {
            let values = manoeuvre.outputs.iter().map(|y| y[output]).filter(|v| v.is_finite());
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            high - low
        });
        if spread > 0.0 && spread.is_finite() { spread } else { 1.0 }
    })
}

fn identity<const N: usize>() -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)))
}

fn product<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}
