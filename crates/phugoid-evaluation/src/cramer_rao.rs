//! The Cramer-Rao bound: the smallest standard error that any unbiased estimator can have on a given flight.
//!
//! With outputs `y_k = h(x_k, theta) + n`, `n ~ N(0, diag sigma^2)` and no process noise, the information after sample
//! `k` is the sum of `g^T g / sigma^2` over all output rows so far, where `g` is the derivative of the output with
//! respect to everything unknown (Klein & Morelli, Aircraft System Identification, section 6.1). Unknown are the
//! initial states and the parameters. Without priors and biases ([`Knowledge::of_noise`]) the bound says what the data alone can
//! give.
//!
//! For `x' = theta u`, `y = x + n` with `u = 1` this is fitting a straight line, whose slope has a known standard error:
//!
//! ```
//! use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
//! use phugoid_evaluation::cramer_rao::{Between, Experiment, Knowledge};
//!
//! struct Integrator;
//!
//! impl Model<1, 1, 1> for Integrator {
//!     type Input = [f64; 1];
//!     fn parameter_count(&self) -> usize {
//!         1
//!     }
//!     fn rates(&self, _: &[f64; 1], theta: &[f64; 1], u: &[f64; 1]) -> [f64; 1] {
//!         [theta[0] * u[0]]
//!     }
//!     fn linearized_rates(&self, x: &[f64; 1], theta: &[f64; 1], u: &[f64; 1], out: &mut LinearizedRates<1, 1>) {
//!         *out = LinearizedRates { rates: self.rates(x, theta, u), regressors: [*u], ..LinearizedRates::ZERO };
//!     }
//!     fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; 1], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, 1>) {
//!         *out = LinearizedOutputs { outputs: *x, state_jacobian: [[1.0]], ..LinearizedOutputs::ZERO };
//!     }
//!     fn measuring_output(&self, _: usize) -> Option<usize> {
//!         Some(0)
//!     }
//! }
//!
//! // Five samples, one second apart, measured with a noise of 0.1.
//! let experiment = Experiment {
//!     initial_state: [3.0],
//!     parameters: [2.0],
//!     time_s: &[0.0, 1.0, 2.0, 3.0, 4.0],
//!     inputs: &[[1.0]; 5],
//!     between: Between::Held,
//! };
//! let bound = experiment.bound(&Integrator, &Knowledge::of_noise([0.1]), &[0.0, 4.0])?;
//! assert!(bound[0].std_error[0].is_infinite()); // one sample does not tell a slope
//! // sigma / sqrt(sum (t - mean t)^2), and the sum is 10.
//! assert!((bound[1].std_error[0] - 0.1 / 10_f64.sqrt()).abs() < 1e-9);
//! # Ok::<(), phugoid_evaluation::cramer_rao::CramerRaoError>(())
//! ```

use nalgebra::{DMatrix, DVector};
use phugoid_estimators::{Input, LinearizedOutputs, LinearizedRates, Model};

/// The bound at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// Time of the last sample used, s.
    pub time_s: f64,
    /// Smallest possible standard error of each parameter, in the parameter's unit; infinite where the data up to now
    /// do not determine it, and for all as long as any combination of what they do see is undetermined. Parameters, then
    /// the biases of [`Knowledge`] in the order of the outputs.
    pub std_error: Vec<f64>,
    /// Correlation of the errors, row and column as in `std_error`; empty where there is no bound.
    pub correlation: Vec<Vec<f64>>,
}

/// How good the sensors are, and what is known of the parameters before the flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knowledge<const R: usize, const P: usize> {
    /// Standard deviation of the white measurement noise of each output, output units; infinite for an output that is not
    /// measured.
    pub noise_std: [f64; R],
    /// One sigma of an unknown constant bias of each output, output units: zero for an output without a bias, infinite for a
    /// bias of which nothing is known.
    pub bias_std: [f64; R],
    /// One sigma of what is known of each parameter beforehand; infinite for nothing.
    pub prior_std: [f64; P],
}

impl<const R: usize, const P: usize> Knowledge<R, P> {
    /// Sensors with this noise (standard deviations, output units) and without biases; nothing is known of the parameters.
    pub const fn of_noise(noise_std: [f64; R]) -> Self {
        Self { noise_std, bias_std: [0.0; R], prior_std: [f64::INFINITY; P] }
    }
}

/// Why the bound could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CramerRaoError {
    /// The model's rates or outputs became infinite or not a number.
    #[error("the model's motion is not finite at {time_s} s: the flight leaves the range of the model")]
    NotFinite {
        /// Time of the sample at which it happened, s.
        time_s: f64,
    },
    /// Times do not increase or lengths differ.
    #[error("the {what}")]
    BadInput {
        /// What is wrong with the times or the inputs, in a few words.
        what: &'static str,
    },
}

/// How the known input goes from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// Held at the value of the earlier sample.
    Held,
    /// Interpolated linearly between the two samples.
    Interpolated,
}

/// The flight for which the bound is asked.
#[derive(Clone, Copy, Debug)]
pub struct Experiment<'a, I, const N: usize, const P: usize> {
    /// True initial state, the model's units.
    pub initial_state: [f64; N],
    /// True values of the model's parameters, in their units; entries beyond the model's count are not used.
    pub parameters: [f64; P],
    /// Sample times, s, strictly increasing.
    pub time_s: &'a [f64],
    /// Known input at each sample.
    pub inputs: &'a [I],
    /// How the input goes from sample to sample.
    pub between: Between,
}

/// Sensitivities of the state to the initial state and to the parameters.
#[derive(Clone, Copy)]
struct Sensitive<const N: usize, const P: usize> {
    x: [f64; N],
    initial: [[f64; N]; N],
    parameter: [[f64; P]; N],
}

impl<const N: usize, const P: usize> Sensitive<N, P> {
    fn plus(&self, h: f64, rate: &Self) -> Self {
        let mut sum = *self;
        for i in 0..N {
            sum.x[i] += h * rate.x[i];
            for j in 0..N {
                sum.initial[i][j] += h * rate.initial[i][j];
            }
            for j in 0..P {
                sum.parameter[i][j] += h * rate.parameter[i][j];
            }
        }
        sum
    }
}

impl<I: Input, const N: usize, const P: usize> Experiment<'_, I, N, P> {
    /// The bound at each of the times `at` (s; the last sample at or before each is used), for `R` outputs with the noise and the
    /// biases of `knowledge`.
    ///
    /// The model runs with its true parameters through the inputs by RK4, and with it `dx/dx0` and `dx/dtheta`. A prior adds its
    /// information to that of the data (the Bayesian bound of H. L. Van Trees, 1968, section 2.4, with the Jacobians at the
    /// truth). Without one the bound is that of any unbiased estimator.
    ///
    /// # Errors
    /// [`CramerRaoError::BadInput`]: the times do not increase, or there are not as many inputs as times.
    /// [`CramerRaoError::NotFinite`]: the motion leaves the range of the model.
    pub fn bound<M, const R: usize>(
        &self,
        model: &M,
        knowledge: &Knowledge<R, P>,
        at: &[f64],
    ) -> Result<Vec<Bound>, CramerRaoError>
    where
        M: Model<N, R, P, Input = I>,
    {
        let Experiment { time_s, inputs, .. } = *self;
        if time_s.len() != inputs.len() || time_s.is_empty() {
            return Err(CramerRaoError::BadInput { what: "times and inputs must be equally many, at least one" });
        }
        if !time_s.windows(2).all(|w| w[0] < w[1]) {
            return Err(CramerRaoError::BadInput { what: "sample times must increase" });
        }
        let p = model.parameter_count().min(P);
        let biased: Vec<usize> = (0..R).filter(|i| knowledge.bias_std[*i] > 0.0).collect();
        let unknowns = N + p + biased.len();
        let mut information = DMatrix::<f64>::zeros(unknowns, unknowns);
        let priors = knowledge.prior_std[..p].iter().chain(biased.iter().map(|i| &knowledge.bias_std[*i]));
        for (j, std) in priors.enumerate() {
            information[(N + j, N + j)] += 1.0 / (std * std);
        }
        let mut state = Sensitive {
            x: self.initial_state,
            initial: core::array::from_fn(|i| core::array::from_fn(|j| f64::from(i == j))),
            parameter: [[0.0; P]; N],
        };
        let mut outputs = LinearizedOutputs::<N, R, P>::ZERO;
        // The last sample that counts for each requested time.
        let last: Vec<usize> =
            at.iter().map(|&t| time_s.partition_point(|&s| s <= t + 1e-9).saturating_sub(1)).collect();
        let mut bounds: Vec<Option<Bound>> = vec![None; at.len()];

        for k in 0..time_s.len() {
            model.linearized_outputs(&state.x, &self.parameters, &inputs[k], &mut outputs);
            for i in 0..R {
                let weight = 1.0 / knowledge.noise_std[i];
                if weight == 0.0 {
                    continue;
                }
                let mut row = DVector::<f64>::zeros(unknowns);
                for j in 0..N {
                    row[j] = weight * (0..N).map(|l| outputs.state_jacobian[i][l] * state.initial[l][j]).sum::<f64>();
                }
                for j in 0..p {
                    let through_state: f64 = (0..N).map(|l| outputs.state_jacobian[i][l] * state.parameter[l][j]).sum();
                    row[N + j] = weight * (through_state + outputs.parameter_jacobian[i][j]);
                }
                if let Some(j) = biased.iter().position(|b| *b == i) {
                    row[N + p + j] = weight;
                }
                if row.iter().any(|v| !v.is_finite()) {
                    return Err(CramerRaoError::NotFinite { time_s: time_s[k] });
                }
                information.ger(1.0, &row, &row, 1.0);
            }
            for (bound, _) in bounds.iter_mut().zip(&last).filter(|(_, l)| **l == k) {
                let (std_error, correlation) = invert(&information, N);
                *bound = Some(Bound { time_s: time_s[k], std_error, correlation });
            }
            if k + 1 < time_s.len() {
                state = self.step(model, &state, k);
            }
        }
        Ok(bounds.into_iter().flatten().collect())
    }

    /// One RK4 step of state and sensitivities from sample `k` to `k + 1`.
    fn step<M, const R: usize>(&self, model: &M, state: &Sensitive<N, P>, k: usize) -> Sensitive<N, P>
    where
        M: Model<N, R, P, Input = I>,
    {
        let h = self.time_s[k + 1] - self.time_s[k];
        let input = |s: f64| match self.between {
            Between::Held => self.inputs[k],
            Between::Interpolated => self.inputs[k].interpolate(&self.inputs[k + 1], s),
        };
        let rate = |at: &Sensitive<N, P>, u: M::Input| {
            let mut l = LinearizedRates::<N, P>::ZERO;
            model.linearized_rates(&at.x, &self.parameters, &u, &mut l);
            // (dx/dx0)' = A dx/dx0,  (dx/dtheta)' = A dx/dtheta + Phi
            Sensitive {
                x: l.rates,
                initial: core::array::from_fn(|i| {
                    core::array::from_fn(|j| (0..N).map(|m| l.state_jacobian[i][m] * at.initial[m][j]).sum())
                }),
                parameter: core::array::from_fn(|i| {
                    core::array::from_fn(|j| {
                        l.regressors[i][j] + (0..N).map(|m| l.state_jacobian[i][m] * at.parameter[m][j]).sum::<f64>()
                    })
                }),
            }
        };
        let k1 = rate(state, input(0.0));
        let k2 = rate(&state.plus(0.5 * h, &k1), input(0.5));
        let k3 = rate(&state.plus(0.5 * h, &k2), input(0.5));
        let k4 = rate(&state.plus(h, &k3), input(1.0));
        state.plus(h / 6.0, &k1).plus(h / 3.0, &k2).plus(h / 3.0, &k3).plus(h / 6.0, &k4)
    }
}

/// Standard errors of all but the states, and their correlation, from the information on (initial state, the rest).
fn invert(information: &DMatrix<f64>, states: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
    // Scaled to a unit diagonal, so that ft/s and rad do not decide what counts as singular.
    let scale: Vec<f64> = information.diagonal().iter().map(|d| d.sqrt()).collect();
    let known: Vec<usize> = (0..information.nrows()).filter(|&i| scale[i] > 0.0).collect();
    let wanted = information.nrows() - states;
    let mut errors = vec![f64::INFINITY; wanted];
    if known.is_empty() {
        return (errors, Vec::new());
    }
    let scaled = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        information[(known[i], known[j])] / (scale[known[i]] * scale[known[j]])
    });
    // Below this the scaled information is singular to rounding, and no unbiased estimator exists.
    let smallest = scaled.clone().symmetric_eigen().eigenvalues.min();
    if smallest.is_nan() || smallest <= 1e-13 {
        return (errors, Vec::new());
    }
    let Some(cholesky) = scaled.cholesky() else { return (errors, Vec::new()) };
    let covariance = cholesky.inverse();
    let mut correlation: Vec<Vec<f64>> =
        (0..wanted).map(|i| (0..wanted).map(|j| f64::from(i == j)).collect()).collect();
    for (i, &unknown) in known.iter().enumerate().filter(|(_, u)| **u >= states) {
        errors[unknown - states] = covariance[(i, i)].sqrt() / scale[unknown];
        for (j, &other) in known.iter().enumerate().filter(|(_, o)| **o >= states) {
            correlation[unknown - states][other - states] =
                covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        }
    }
    (errors, correlation)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `x' = theta u`, `y = x + n`: the bound has a closed form.
    struct Integrator;

    impl Model<1, 1, 2> for Integrator {
        type Input = [f64; 1];
        fn parameter_count(&self) -> usize {
            1
        }
        fn rates(&self, _: &[f64; 1], theta: &[f64; 2], u: &[f64; 1]) -> [f64; 1] {
            [theta[0] * u[0]]
        }
        fn linearized_rates(&self, x: &[f64; 1], theta: &[f64; 2], u: &[f64; 1], out: &mut LinearizedRates<1, 2>) {
            *out = LinearizedRates::ZERO;
            out.rates = self.rates(x, theta, u);
            out.regressors[0][0] = u[0];
        }
        fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; 2], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, 2>) {
            *out = LinearizedOutputs::ZERO;
            out.outputs = *x;
            out.state_jacobian[0][0] = 1.0;
        }
        fn measuring_output(&self, _: usize) -> Option<usize> {
            Some(0)
        }
    }

    const NOISE: Knowledge<1, 2> = Knowledge::of_noise([0.2]);

    fn bound(experiment: &Experiment<'_, [f64; 1], 1, 2>, at: &[f64]) -> Result<Vec<Bound>, CramerRaoError> {
        experiment.bound(&Integrator, &NOISE, at)
    }

    /// With `u = 1` this is fitting a straight line: the slope's variance is `sigma^2 / sum (t - mean t)^2`.
    #[test]
    fn a_straight_line_has_the_textbook_bound() {
        let time: Vec<f64> = (0..50).map(|k| 0.1 * f64::from(k)).collect();
        let inputs = vec![[1.0]; 50];
        let experiment = Experiment {
            initial_state: [3.0],
            parameters: [2.0, 0.0],
            time_s: &time,
            inputs: &inputs,
            between: Between::Held,
        };
        let bounds = bound(&experiment, &[0.0, 1.0, 4.9]).unwrap();
        assert!(bounds[0].std_error[0].is_infinite(), "one sample cannot tell a slope");
        for (bound, n) in bounds[1..].iter().zip([11, 50]) {
            let mean = time[..n].iter().sum::<f64>() / n as f64;
            let spread: f64 = time[..n].iter().map(|t| (t - mean).powi(2)).sum();
            let expected = 0.2 / spread.sqrt();
            assert!((bound.std_error[0] / expected - 1.0).abs() < 1e-9, "{} {expected}", bound.std_error[0]);
        }
    }

    /// A straight line with an unknown offset of the sensor: the offset is told from the start only by what is known of it, and
    /// the slope by the data alone. A prior as good as the data halves the variance.
    #[test]
    fn biases_and_priors_enter_as_they_should() {
        let time: Vec<f64> = (0..50).map(|k| 0.1 * f64::from(k)).collect();
        let experiment = Experiment {
            initial_state: [3.0],
            parameters: [2.0, 0.0],
            time_s: &time,
            inputs: &[[1.0]; 50],
            between: Between::Held,
        };
        let alone = bound(&experiment, &[4.9]).unwrap()[0].std_error[0];
        let knowledge = Knowledge { bias_std: [0.5], prior_std: [alone, f64::INFINITY], ..NOISE };
        let bound = experiment.bound(&Integrator, &knowledge, &[4.9]).unwrap().remove(0);
        assert!((bound.std_error[0] / alone - 0.5_f64.sqrt()).abs() < 1e-9, "{:?}", bound.std_error);
        assert!((bound.std_error[1] - 0.5).abs() < 1e-9 && bound.correlation[0][1].abs() < 1e-9);
    }

    #[test]
    fn no_input_gives_no_bound() {
        let time = [0.0, 0.1, 0.2];
        let experiment = Experiment {
            initial_state: [3.0],
            parameters: [2.0, 0.0],
            time_s: &time,
            inputs: &[[0.0]; 3],
            between: Between::Held,
        };
        assert!(bound(&experiment, &[0.2]).unwrap()[0].std_error[0].is_infinite());
    }

    #[test]
    fn nothing_measured_gives_no_bound() {
        let experiment = Experiment {
            initial_state: [3.0],
            parameters: [2.0, 0.0],
            time_s: &[0.0, 0.1],
            inputs: &[[1.0]; 2],
            between: Between::Held,
        };
        let nothing = Knowledge::of_noise([f64::INFINITY]);
        assert!(experiment.bound(&Integrator, &nothing, &[0.1]).unwrap()[0].std_error[0].is_infinite());
    }

    #[test]
    fn bad_times_are_told() {
        let experiment = Experiment {
            initial_state: [3.0],
            parameters: [2.0, 0.0],
            time_s: &[0.0, 0.0],
            inputs: &[[0.0]; 2],
            between: Between::Held,
        };
        assert!(matches!(bound(&experiment, &[0.0]), Err(CramerRaoError::BadInput { .. })));
    }
}
