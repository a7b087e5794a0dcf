//! A Kalman filter over one manoeuvre: the innovations and their variances.

use crate::core::options::CAPACITY;
use phugoid_estimators::LinearizedOutputs;
use phugoid_estimators::discretization::step;

use super::flown::AsModel;
use super::problem::Manoeuvre;
use super::start::Stretch;

/// The values that one run of the filter holds fixed.
#[derive(Clone, Debug)]
pub(crate) struct Tuning<const N: usize, const R: usize> {
    pub(crate) parameters: [f64; CAPACITY],
    pub(crate) biases: [f64; R],
    /// The stretches between gaps, with the state at the start of each.
    pub(crate) stretches: Vec<Stretch<N>>,
    /// One sigma of the initial states.
    pub(crate) initial_std: [f64; N],
    /// Variances of the measurement noise.
    pub(crate) noise: [f64; R],
    /// Densities of the process noise: variance of each state per second.
    pub(crate) process_noise: [f64; N],
    pub(crate) maximum_step_s: f64,
}

/// Innovations of one manoeuvre; NaN where nothing was measured.
#[derive(Clone, Debug)]
pub(crate) struct Innovations<const R: usize> {
    /// Outputs predicted from all samples before, with their biases.
    pub(crate) predicted: Vec<[f64; R]>,
    /// Measured minus predicted; the outputs of a sample one after the other, each with what those before it corrected,
    /// so that all are independent.
    pub(crate) errors: Vec<[f64; R]>,
    /// Variance of each innovation, in the squared unit of its output.
    pub(crate) variances: Vec<[f64; R]>,
}

impl<const R: usize> Innovations<R> {
    /// `1/2 sum (e^2/s + ln s)`.
    pub(crate) fn cost(&self) -> f64 {
        let all = self.errors.iter().flatten().zip(self.variances.iter().flatten());
        all.filter(|(e, _)| e.is_finite()).map(|(e, s)| 0.5 * (e * e / s + s.ln())).sum()
    }
}

/// Runs an extended Kalman filter over the states of a manoeuvre with the parameters held; gives the time of the first
/// value that is not finite, s from its start, if there is one.
///
/// Prediction with the step map and its exact derivative `A`; outputs corrected one at a time, which is the whole
/// correction because their noise is independent; Joseph's form of the covariance.
pub(crate) fn filter<const N: usize, const R: usize>(
    manoeuvre: &Manoeuvre<'_, N, R>,
    tuning: &Tuning<N, R>,
) -> Result<Innovations<R>, f64> {
    let plant = manoeuvre.plant;
    let samples = manoeuvre.time_s.len();
    let mut lin = LinearizedOutputs::<N, R, CAPACITY>::ZERO;
    let mut result = Innovations {
        predicted: vec![[f64::NAN; R]; samples],
        errors: vec![[f64::NAN; R]; samples],
        variances: vec![[f64::NAN; R]; samples],
    };
    let (mut unused, mut transition) = ([[0.0; CAPACITY]; N], [[0.0; N]; N]);
    for stretch in &tuning.stretches {
        let mut x = stretch.state;
        let mut covariance: [[f64; N]; N] =
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { tuning.initial_std[i].powi(2) } else { 0.0 }));
        for k in stretch.from..stretch.to {
            plant.linearized_outputs(&x, &tuning.parameters, manoeuvre.instant(k), &mut lin);
            let predicted: [f64; R] = std::array::from_fn(|i| lin.outputs[i] + tuning.biases[i]);
            let mut correction = [0.0; N];
            for i in (0..R).filter(|&i| manoeuvre.outputs[k][i].is_finite()) {
                let h = &lin.state_jacobian[i];
                let gain: [f64; N] = std::array::from_fn(|l| (0..N).map(|m| covariance[l][m] * h[m]).sum());
                let s = tuning.noise[i] + (0..N).map(|l| h[l] * gain[l]).sum::<f64>();
                let corrected: f64 = (0..N).map(|l| h[l] * correction[l]).sum();
                let e = manoeuvre.outputs[k][i] - predicted[i] - corrected;
                if !(e.is_finite() && s > 0.0 && s.is_finite()) {
                    return Err(manoeuvre.time_s[k] - manoeuvre.time_s[0]);
                }
                let gain = gain.map(|g| g / s);
                for l in 0..N {
                    correction[l] += gain[l] * e;
                }
                covariance = joseph(&covariance, &gain, h, tuning.noise[i]);
                (result.errors[k][i], result.variances[k][i]) = (e, s);
            }
            for l in 0..N {
                x[l] += correction[l];
            }
            result.predicted[k] = predicted;
            if k + 1 == stretch.to {
                break;
            }
            let (input, interval_s, parts) = manoeuvre.interval(k, tuning.maximum_step_s);
            let steps = parts.len() as f64;
            for part in parts {
                x = step(
                    &AsModel(plant),
                    &x,
                    &tuning.parameters,
                    &input,
                    interval_s,
                    part,
                    0,
                    &mut unused,
                    &mut transition,
                );
                covariance = predicted_covariance(&covariance, &transition);
                for l in 0..N {
                    covariance[l][l] += tuning.process_noise[l] * interval_s / steps;
                }
            }
        }
    }
    Ok(result)
}

/// `(I - K h^T) P (I - K h^T)^T + K r K^T`.
fn joseph<const N: usize>(p: &[[f64; N]; N], gain: &[f64; N], h: &[f64; N], noise: f64) -> [[f64; N]; N] {
    let left: [[f64; N]; N] = std::array::from_fn(|i| {
        let along: f64 = gain[i];
        std::array::from_fn(|j| p[i][j] - along * (0..N).map(|l| h[l] * p[l][j]).sum::<f64>())
    });
    std::array::from_fn(|i| {
        let along: f64 = (0..N).map(|l| left[i][l] * h[l]).sum();
        std::array::from_fn(|j| left[i][j] - along * gain[j] + gain[i] * noise * gain[j])
    })
}

/// Covariance of the state after one step with the transition matrix `A`, without process noise: `A P A^T`.
pub(super) fn predicted_covariance<const N: usize>(p: &[[f64; N]; N], a: &[[f64; N]; N]) -> [[f64; N]; N] {
    let half: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|l| a[i][l] * p[l][j]).sum()));
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|l| half[i][l] * a[j][l]).sum()))
}
