//! A cheap synthetic plant with four states and any number of parameters, for measuring the estimator and not the
//! aircraft: coupled oscillators, each parameter with a regressor of its own.
#![allow(dead_code, unreachable_pub)]

use phugoid_estimators::settings::ParameterPrior;
use phugoid_estimators::{ConstantEffects, LinearizedOutputs, LinearizedRates, Model, Sample};

use crate::plants::{normal, seeded};

#[derive(Clone, Debug)]
pub struct Synthetic<const P: usize> {
    parameters: usize,
}

const COUPLING: [[f64; 4]; 4] =
    [[-0.8, 1.0, 0.0, 0.1], [-1.5, -0.9, 0.2, 0.0], [0.0, 0.3, -0.7, 1.2], [0.1, 0.0, -2.0, -0.6]];

impl<const P: usize> Synthetic<P> {
    pub fn new(parameters: usize) -> Self {
        Self { parameters }
    }

    /// The regressor of parameter `j`: a state or the input, in a row.
    fn regressor(j: usize, x: &[f64; 4], u: f64) -> (usize, f64) {
        let row = j % 4;
        let value = match (j / 4) % 3 {
            0 => x[(row + 1) % 4],
            1 => u,
            _ => x[row],
        };
        (row, value / (1.0 + (j / 12) as f64))
    }
}

impl<const R: usize, const P: usize> Model<4, R, P> for Synthetic<P> {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        self.parameters
    }

    fn rates(&self, x: &[f64; 4], theta: &[f64; P], u: &[f64; 1]) -> [f64; 4] {
        let mut lin = LinearizedRates::ZERO;
        Model::<4, R, P>::linearized_rates(self, x, theta, u, &mut lin);
        lin.rates
    }

    fn linearized_rates(&self, x: &[f64; 4], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<4, P>) {
        out.state_jacobian = COUPLING;
        out.rates = [u[0], 0.0, u[0], 0.0];
        for i in 0..4 {
            out.regressors[i][..self.parameters].fill(0.0);
            for k in 0..4 {
                out.rates[i] += COUPLING[i][k] * x[k];
            }
        }
        for j in 0..self.parameters {
            let (row, value) = Self::regressor(j, x, u[0]);
            out.regressors[row][j] = value;
            out.rates[row] += value * theta[j];
            let column = match (j / 4) % 3 {
                0 => (row + 1) % 4,
                1 => continue,
                _ => row,
            };
            out.state_jacobian[row][column] += theta[j] / (1.0 + (j / 12) as f64);
        }
    }

    fn linearized_outputs(&self, x: &[f64; 4], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedOutputs<4, R, P>) {
        for i in 0..R {
            out.parameter_jacobian[i][..self.parameters].fill(0.0);
            out.state_jacobian[i] = [0.0; 4];
            if i < 4 {
                out.outputs[i] = x[i];
                out.state_jacobian[i][i] = 1.0;
            } else {
                // Further outputs see the parameters directly, as accelerations do.
                out.outputs[i] = x[i % 4] - x[(i + 1) % 4];
                out.state_jacobian[i][i % 4] += 1.0;
                out.state_jacobian[i][(i + 1) % 4] -= 1.0;
                for j in 0..self.parameters {
                    let (row, value) = Self::regressor(j, x, u[0]);
                    if row == i % 4 {
                        out.outputs[i] += value * theta[j];
                        out.parameter_jacobian[i][j] = value;
                    }
                }
            }
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        Some(state)
    }

    fn constant_count(&self) -> usize {
        12
    }

    /// The lags.
    fn learnable_constants(&self) -> &[usize] {
        &[4, 5, 6, 7]
    }

    /// Scale and lag of each measured state, and a factor on each rate.
    fn constant_effects<const K: usize>(
        &self,
        x: &[f64; 4],
        theta: &[f64; P],
        u: &[f64; 1],
        out: &mut ConstantEffects<4, R, K>,
    ) {
        let rates = Model::<4, R, P>::rates(self, x, theta, u);
        for i in 0..4 {
            out.outputs[i][i] = x[i];
            out.outputs[i][4 + i] = -rates[i];
            out.rates[i][8 + i] = rates[i];
        }
    }
}

pub fn priors(parameters: usize) -> Vec<ParameterPrior> {
    vec![ParameterPrior::bounded(0.0, -0.5, 0.5); parameters]
}

/// A noisy flight of `n` samples at 100 Hz with true parameters of about 0.1.
pub fn flight<const R: usize, const P: usize>(model: &Synthetic<P>, n: usize) -> Vec<Sample<[f64; 1], R>> {
    let theta: [f64; P] =
        core::array::from_fn(|j| if j < model.parameters { 0.1 * (1.7 * j as f64).sin() } else { 0.0 });
    let times = crate::plants::regular(n, 0.01);
    let input = |t: f64| [(1.1 * t).sin() + (2.7 * t).sin() + if (t * 0.5).fract() < 0.5 { 0.5 } else { -0.5 }];
    let mut rng = seeded(11);
    let _ = normal(&mut rng);
    crate::plants::fly::<_, 4, R, P>(model, &times, [0.0; 4], |_| theta, input, [0.01; R], &mut rng)
}
