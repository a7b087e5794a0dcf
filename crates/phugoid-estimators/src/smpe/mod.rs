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
use crate::supervisor::considered::Considering;
use separated::Separated;

/// The sliding-mode parameter estimator: `N` states, `R` outputs, room for `P` columns (parameters and biases).
pub type Smpe<M, const N: usize, const R: usize, const P: usize> = Supervisor<Separated<N, P>, M, N, R, P>;

/// The same estimator, bit for bit, which also knows how far an error of each of up to `K` constants of the model
/// ([`Model::constant_effects`](crate::Model::constant_effects)) has moved its estimate:
/// [`error_by_constant`](Supervisor::error_by_constant).
///
/// ```
/// use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
/// use phugoid_estimators::smpe::ConsideringSmpe;
/// use phugoid_estimators::{ConstantEffects, Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};
///
/// /// `x' = -3 x + b u`; the sensor shows `y = x (1 + c)`: what is estimated is `b (1 + c)`.
/// struct Gain;
///
/// impl Model<1, 1, 1> for Gain {
///     type Input = [f64; 1];
///     fn parameter_count(&self) -> usize {
///         1
///     }
///     fn rates(&self, x: &[f64; 1], b: &[f64; 1], u: &[f64; 1]) -> [f64; 1] {
///         [-3.0 * x[0] + b[0] * u[0]]
///     }
///     fn linearized_rates(&self, x: &[f64; 1], b: &[f64; 1], u: &[f64; 1], out: &mut LinearizedRates<1, 1>) {
///         *out = LinearizedRates { rates: self.rates(x, b, u), state_jacobian: [[-3.0]], regressors: [[u[0]]] };
///     }
///     fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; 1], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, 1>) {
///         *out = LinearizedOutputs { outputs: *x, state_jacobian: [[1.0]], parameter_jacobian: [[0.0]] };
///     }
///     fn measuring_output(&self, _state: usize) -> Option<usize> {
///         Some(0)
///     }
///     fn constant_count(&self) -> usize {
///         1
///     }
///     fn constant_effects<const K: usize>(
///         &self,
///         x: &[f64; 1],
///         _: &[f64; 1],
///         _: &[f64; 1],
///         out: &mut ConstantEffects<1, 1, K>,
///     ) {
///         // The derivative of the output by c.
///         out.outputs[0][0] = x[0];
///     }
/// }
///
/// let settings = EstimatorSettings::automatic(&[ParameterPrior::bounded(5.0, 1.0, 9.0)], [0.001], 0.01)?;
/// let mut estimator = ConsideringSmpe::<_, 1, 1, 1, 1>::new(Gain, settings)?;
/// // b = 6, and a sensor that is right.
/// for k in 0..300 {
///     let time_s = 0.01 * f64::from(k);
///     estimator.update(&Sample { time_s, input: [1.0], outputs: [2.0 * (1.0 - (-3.0 * time_s).exp())] });
/// }
/// // The true gain is the estimated one, less 6 per unit of the scale.
/// let error = estimator.error_by_constant(0).unwrap();
/// assert!((error[0] + 6.0).abs() < 0.06);
/// # Ok::<(), phugoid_estimators::settings::SettingsError>(())
/// ```
pub type ConsideringSmpe<M, const N: usize, const R: usize, const P: usize, const K: usize> =
    Supervisor<Considering<Separated<N, P>, N, P, K>, M, N, R, P>;
