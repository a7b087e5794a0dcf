//! SMPE, the sliding-mode parameter estimator on a parallel model.
//!
//! An estimated model runs in parallel with the plant. Each output row is a sliding surface, whitened by its predicted
//! uncertainty and tied to the parameters by the *sensitivity* of the parallel model. Inside the boundary layer the
//! equivalent control acts, outside the sign, both evaluated implicitly (proximally), so that the surfaces cannot
//! chatter at any sample time; the bounds of the parameters decide the gain. docs/theory.md derives it and says what is
//! proved. Honest identity: without saturation and without change detection this is the joint extended Kalman filter in
//! separated form (B. Friedland, *Treatment of bias in recursive filtering*, IEEE TAC 14, 1969).
//!
//! ```
//! use phugoid_estimators::settings::{ParameterPrior, EstimatorSettings};
//! use phugoid_estimators::smpe::Smpe;
//! use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};
//!
//! /// `x' = -a x + u`, `y = x`; `a` is unknown.
//! struct Lag;
//!
//! impl Model<1, 1, 1> for Lag {
//!     type Input = [f64; 1];
//!     fn parameter_count(&self) -> usize {
//!         1
//!     }
//!     fn rates(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1]) -> [f64; 1] {
//!         [-a[0] * x[0] + u[0]]
//!     }
//!     fn linearized_rates(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1], out: &mut LinearizedRates<1, 1>) {
//!         out.rates = self.rates(x, a, u);
//!         out.state_jacobian = [[-a[0]]];
//!         out.regressors = [[-x[0]]];
//!     }
//!     fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; 1], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, 1>) {
//!         out.outputs = *x;
//!         out.state_jacobian = [[1.0]];
//!         out.parameter_jacobian = [[0.0]];
//!     }
//!     fn measuring_output(&self, _state: usize) -> Option<usize> {
//!         Some(0)
//!     }
//! }
//!
//! // Known: a lies between 1 and 9, noise of one sigma 0.001, 100 Hz.
//! let settings = EstimatorSettings::automatic(&[ParameterPrior::bounded(5.0, 1.0, 9.0)], [0.001], 0.01)?;
//! let mut estimator = Smpe::new(Lag, settings)?;
//! // The step response of a = 3, here without noise.
//! let mut estimate = estimator.estimate();
//! for k in 0..100 {
//!     let time_s = 0.01 * f64::from(k);
//!     let y = (1.0 - (-3.0 * time_s).exp()) / 3.0;
//!     estimate = estimator.update(&Sample { time_s, input: [1.0], outputs: [y] });
//! }
//! let error = (estimate.parameters[0] - 3.0).abs();
//! assert!(error < 2.0 * estimate.corrected_std_error[0]);
//! assert!(estimate.corrected_std_error[0] < 0.02);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod reopen;
mod separated;

use crate::supervisor::Supervisor;
use separated::Separated;

/// The sliding-mode parameter estimator: `N` states, `R` outputs, room for `P` columns (parameters and biases).
pub type Smpe<M, const N: usize, const R: usize, const P: usize> = Supervisor<Separated<N, P>, M, N, R, P>;
