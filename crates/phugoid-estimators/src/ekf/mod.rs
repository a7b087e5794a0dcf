//! The joint extended Kalman filter: the parameters are states without dynamics, one covariance holds both.
//!
//! The method that the field would take first (H. Kopp and R. Orford, *Linear regression applied to system
//! identification for adaptive control systems*, AIAA J. 1, 1963; R. Jategaonkar, *Flight Vehicle System
//! Identification*, 2nd ed. 2015, ch. 7), with a gate on the normalised innovation in place of SMPE's reaching law. All
//! else (median start, sensor biases, restart, change detection, adaptation of the process noise, colour correction,
//! limits) is the same [`Supervisor`] that SMPE has, so that the two can be compared.
//!
//! ```
//! use phugoid_estimators::ekf::{EkfSettings, JointEkf};
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//! use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};
//!
//! /// `x' = -a x + u`, of which `x` is measured.
//! struct Lag;
//!
//! impl Model<1, 1, 1> for Lag {
//!     type Input = [f64; 1];
//!     fn parameter_count(&self) -> usize {
//!         1
//!     }
//!     fn rates(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1]) -> [f64; 1] {
//!         [u[0] - a[0] * x[0]]
//!     }
//!     fn linearized_rates(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1], out: &mut LinearizedRates<1, 1>) {
//!         (out.rates, out.state_jacobian, out.regressors) = (self.rates(x, a, u), [[-a[0]]], [[-x[0]]]);
//!     }
//!     fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; 1], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, 1>) {
//!         (out.outputs, out.state_jacobian) = (*x, [[1.0]]);
//!     }
//!     fn measuring_output(&self, state: usize) -> Option<usize> {
//!         Some(state)
//!     }
//! }
//!
//! // a lies between 1 and 9; x is measured with a sigma of 0.001.
//! let shared = EstimatorSettings::automatic(&[ParameterPrior::bounded(5.0, 1.0, 9.0)], [0.001], 0.01)?;
//! let mut filter: JointEkf<_, 1, 1, 1> = JointEkf::new(Lag, EkfSettings::new(shared))?;
//! // The step response of a = 3, here without noise.
//! let mut estimate = filter.estimate();
//! for k in 0..100 {
//!     let time_s = 0.01 * f64::from(k);
//!     let x = (1.0 - (-3.0 * time_s).exp()) / 3.0;
//!     estimate = filter.update(&Sample { time_s, input: [1.0], outputs: [x] });
//! }
//! assert!((estimate.parameters[0] - 3.0).abs() < 2.0 * estimate.corrected_std_error[0]);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod joint;

use crate::settings::{EstimatorSettings, SettingsError};
use crate::supervisor::Supervisor;
use joint::Joint;

/// Normalised innovation beyond which the gate refuses a row: one in 16,000 of a normal distribution.
const GATE: f64 = 4.0;

/// The joint extended Kalman filter: `N` states, `R` outputs, room for `P` columns (parameters and biases).
pub type JointEkf<M, const N: usize, const R: usize, const P: usize> = Supervisor<Joint<N, P>, M, N, R, P>;

/// What the joint extended Kalman filter is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EkfSettings<const N: usize, const R: usize, const P: usize> {
    /// Priors, noise, biases, start, change detection: as for SMPE. Of its reaching limit only the change detector
    /// makes use (it counts an innovation as no larger than that); its rejection limit and reaching state are not used.
    pub shared: EstimatorSettings<N, R, P>,
    /// A row whose innovation is more than this many of its predicted standard deviations is not used. May be infinite.
    pub gate: f64,
    /// Random walk of each parameter, (parameter unit)^2/s: the classical alternative to re-initialisation after a
    /// detected change. Zero for constant parameters. Biases do not walk.
    pub parameter_walk_per_s: [f64; P],
}

impl<const N: usize, const R: usize, const P: usize> EkfSettings<N, R, P> {
    /// A gate of four sigmas, parameters that do not walk.
    pub fn new(shared: EstimatorSettings<N, R, P>) -> Self {
        Self { shared, gate: GATE, parameter_walk_per_s: [0.0; P] }
    }

    fn check(&self) -> Result<(), SettingsError> {
        if self.gate.is_nan() || self.gate <= 0.0 {
            return Err(SettingsError::Setting { name: "gate", value: self.gate });
        }
        match self.parameter_walk_per_s.into_iter().find(|walk| !(walk.is_finite() && *walk >= 0.0)) {
            Some(value) => Err(SettingsError::Setting { name: "parameter_walk_per_s", value }),
            None => Ok(()),
        }
    }
}
