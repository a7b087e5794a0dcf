//! The joint extended Kalman filter: the parameters are states without dynamics, one covariance holds both.
//!
//! The method that the field would take first (H. Kopp and R. Orford, *Linear regression applied to system
//! identification for adaptive control systems*, AIAA J. 1, 1963; R. Jategaonkar, *Flight Vehicle System
//! Identification*, 2nd ed. 2015, ch. 7), with a gate on the normalised innovation in place of SMPE's reaching law. All
//! else (median start, sensor biases, restart, change detection, adaptation of the process noise, colour correction,
//! limits) is the same [`Supervisor`] that SMPE has, so that the two can be compared. Gate and random walk are set in
//! [`EkfSettings`](crate::settings::EkfSettings). Of SMPE's reaching limit only the change detector makes use (it
//! counts an innovation as no larger than that); the rejection limit and the reaching state are not used.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{Lag, NOISE, flight};
//! use phugoid_estimators::Estimator;
//! use phugoid_estimators::ekf::JointEkf;
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//!
//! // x' = -a x + b u, both unknown; a = 3 and b = 2 in this flight.
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
//! let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
//! let mut filter = JointEkf::new(Lag, settings)?;
//! let mut estimate = filter.estimate();
//! for sample in &flight(10.0, |_| 3.0) {
//!     estimate = filter.update(sample);
//! }
//! assert!((estimate.parameters[0] - 3.0).abs() < 3.0 * estimate.corrected_std_error[0]);
//! assert!(estimate.corrected_std_error[0] < 0.1);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod joint;

use crate::supervisor::Supervisor;
use crate::supervisor::considered::Considering;
use joint::Joint;

/// The joint extended Kalman filter: `N` states, `R` outputs, room for `P` columns (parameters and biases).
pub type JointEkf<M, const N: usize, const R: usize, const P: usize> = Supervisor<Joint<N, P>, M, N, R, P>;

/// The same filter, bit for bit, which also knows how far an error of each of up to `K` constants of the model has moved
/// its estimate, as [`ConsideringSmpe`](crate::smpe::ConsideringSmpe) does.
pub type ConsideringEkf<M, const N: usize, const R: usize, const P: usize, const K: usize> =
    Supervisor<Considering<Joint<N, P>, N, P, K>, M, N, R, P>;
