#![doc = include_str!("../README.md")]
//!
//! # How it is built
//!
//! An [`Aircraft`](aircraft::Aircraft) is data and a few functions that make coefficients and thrust of them; the
//! equations of [`motion`](motion::motion) turn them into the rates of the [`State`](aircraft::State). Simulation, trim,
//! linearisation and an estimator's parallel model all call these equations: with `f64` for numbers, with
//! [`Dual`](scalar::Dual) for exact derivatives. [`BuiltInAircraft`](built_in::BuiltInAircraft) finds an aircraft by name.
#![cfg_attr(not(feature = "std"), no_std)]

pub mod actuator;
pub mod aircraft;
pub mod atmosphere;
#[cfg(feature = "std")]
pub mod built_in;
#[cfg(feature = "std")]
pub mod dryden;
pub mod earth;
pub mod f16;
pub mod fuel;
pub mod globe;
pub mod gust;
pub mod increments;
pub mod integrate;
#[cfg(feature = "std")]
pub mod linearize;
pub mod longitudinal;
pub mod mass;
#[cfg(feature = "std")]
pub mod modes;
pub mod modified;
pub mod motion;
pub mod rigid_body;
pub mod scalar;
#[cfg(feature = "std")]
pub mod sensors;
#[cfg(feature = "std")]
pub mod simulate;
pub mod standard_atmosphere;
pub mod table;
mod trigonometry;
#[cfg(feature = "std")]
pub mod trim;
#[cfg(feature = "std")]
pub mod von_karman;
pub mod wind;
