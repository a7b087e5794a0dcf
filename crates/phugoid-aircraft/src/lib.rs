#![doc = include_str!("../README.md")]

pub mod jsbsim;
pub mod xml;
