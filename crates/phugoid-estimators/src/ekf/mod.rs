//! The joint extended Kalman filter: the parameters are states without dynamics, one covariance holds both.
//!
//! The method that the field would take first (H. Kopp and R. Orford, *Linear regression applied to system
//! identification for adaptive control systems*, AIAA J. 1, 1963; R. Jategaonkar, *Flight Vehicle System
//! Identification*, 2nd ed. 2015, ch. 7), with a gate on the normalised innovation in place of SMPE's reaching law. All
//! else (median start, sensor biases, restart, change detection, adaptation of the process noise, colour correction,
//! limits) is the same [`Supervisor`] that SMPE has, so that the two can be compared. Gate and random walk are set in
//! [`EkfSettings`](crate::settings::EkfSettings). Of SMPE's reaching limit only the change detector makes use (it counts an
//! innovation as no larger than that); the rejection limit and the reaching state are not used.
//!
//! ```
//! use phugoid_estimators::ekf::JointEkf;
//! use phugoid_estimators::plants::FirstOrder;
//! use phugoid_estimators::settings::{ParameterPrior, EstimatorSettings};
//! use phugoid_estimators::{Estimator, Sample};
//!
//! // x' = -a x + u; a lies between 1 and 9; x is measured with a sigma of 0.001, x' is not.
//! let settings = EstimatorSettings::automatic(&[ParameterPrior::bounded(5.0, 1.0, 9.0)], [0.001, 0.0], 0.01)?;
//! let mut filter: JointEkf<_, 1, 2, 1> = JointEkf::new(FirstOrder, settings)?;
//! // The step response of a = 3, here without noise.
//! let mut estimate = filter.estimate();
//! for k in 0..100 {
//!     let time_s = 0.01 * f64::from(k);
//!     let x = (1.0 - (-3.0 * time_s).exp()) / 3.0;
//!     estimate = filter.update(&Sample { time_s, input: [1.0], outputs: [x, f64::NAN] });
//! }
//! assert!((estimate.parameters[0] - 3.0).abs() < 2.0 * estimate.corrected_std_error[0]);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod joint;

use crate::supervisor::Supervisor;
use joint::Joint;

/// The joint extended Kalman filter: `N` states, `R` outputs, room for `P` columns (parameters and biases).
pub type JointEkf<M, const N: usize, const R: usize, const P: usize> = Supervisor<Joint<N, P>, M, N, R, P>;
