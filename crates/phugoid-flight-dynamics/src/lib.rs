//! Rigid-body flight dynamics, written once and generic over the scalar.
#![cfg_attr(not(feature = "std"), no_std)]

pub mod actuator;
pub mod aircraft;
pub mod atmosphere;
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
pub mod scalar;
#[cfg(feature = "std")]
pub mod sensors;
#[cfg(feature = "std")]
pub mod simulate;
pub mod table;
mod trigonometry;
#[cfg(feature = "std")]
pub mod trim;
