#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | what it has |
//! |---|---|
//! | [`local`] | the local linear model of an aircraft: what an estimate says about body rates and flow angles |
//! | [`target`] | the motion that is wanted: short period, Dutch roll, roll |
//! | [`gains`] | the gains that give an aircraft the wanted motion, and the surfaces that make a wanted moment |
//! | [`interval`] | the worst motion that gains leave within the bounds of an estimate, and whether others are safer |
//! | [`law`] | the control law of each frame: command following, integration, limits, bumpless change of gains |
//! | [`excitation`] | small inputs on top of the pilot's, as long as a bound that matters is too wide |
//! | [`following`] | whether a surface does what it is told |
//! | [`prediction`] | which of two models has predicted the last seconds better |
//! | [`qualities`] | handling-quality levels of MIL-F-8785C |
//! | [`margin`] | how much of each surface is left beside what straight flight takes now |
//! | [`roots`] | eigenvalues of the small matrices of flight dynamics |
#![no_std]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod excitation;
pub mod following;
pub mod gains;
pub mod interval;
pub mod law;
pub mod local;
pub mod lost;
pub mod margin;
pub mod prediction;
pub mod qualities;
pub mod roots;
pub mod target;
