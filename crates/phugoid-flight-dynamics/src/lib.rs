//! Rigid-body flight dynamics, written once and generic over the scalar.
//!
//! An [`Aircraft`](aircraft::Aircraft) is data and a few functions that make coefficients and thrust of them; the
//! equations of [`motion`](motion::motion) turn them into the rates of the [`State`](aircraft::State). Simulation, trim,
//! linearisation and an estimator's parallel model all call these equations: with `f64` for numbers, with
//! [`Dual`](scalar::Dual) for exact derivatives. [`F16`](f16::F16) is the aircraft that comes with the crate.
//!
//! ```
//! use phugoid_flight_dynamics::aircraft::{Controls, State};
//! use phugoid_flight_dynamics::f16::{F16, F16Options};
//! use phugoid_flight_dynamics::motion::{Disturbance, motion};
//!
//! let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
//! // Level flight at 20,000 ft and 675 ft/s, with a degree more of up elevator than trim needs.
//! let mut state = State::from_array([0.0; 13]);
//! (state.speed, state.alpha, state.theta) = (205.74, 0.0417, 0.0417);
//! (state.altitude, state.power) = (6096.0, 10.0);
//! let controls = Controls { throttle: 0.154, elevator: -2.96_f64.to_radians(), aileron: 0.0, rudder: 0.0 };
//! let motion = motion(&aircraft, &state, &controls, &Disturbance::default());
//! assert!(motion.rates.q > 0.0); // the nose comes up
//! # Ok::<(), phugoid_flight_dynamics::f16::F16DataError>(())
//! ```
//!
//! SI units and radians throughout. Body axes: x forward, y right, z down; a positive elevator has its trailing edge
//! down. Without the feature `std` the equations of motion, the F-16's included, build for a flight computer; the data
//! files, trim, linearisation, simulation and sensors need it.
#![cfg_attr(not(feature = "std"), no_std)]

pub mod actuator;
pub mod aircraft;
pub mod atmosphere;
#[cfg(feature = "std")]
pub mod built_in;
#[cfg(feature = "std")]
pub mod dryden;
pub mod f16;
pub mod gust;
pub mod increments;
pub mod integrate;
#[cfg(feature = "std")]
pub mod linearize;
pub mod longitudinal;
pub mod mass;
#[cfg(feature = "std")]
pub mod modes;
pub mod motion;
pub mod rigid_body;
pub mod scalar;
#[cfg(feature = "std")]
pub mod sensors;
#[cfg(feature = "std")]
pub mod simulate;
pub mod table;
mod trigonometry;
#[cfg(feature = "std")]
pub mod trim;
