//! Rigid-body flight dynamics, written once and generic over the scalar.
#![cfg_attr(not(feature = "std"), no_std)]





pub mod integrate;
#[cfg(feature = "std")]
pub mod modes;
pub mod scalar;
