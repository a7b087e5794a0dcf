#![doc = include_str!("../README.md")]

pub mod check_case;
pub mod daveml;
pub mod engine;
mod expansion;
pub mod flown;
pub mod jsbsim;
pub mod tp1538;
pub mod transport;
pub mod vehicle;
pub mod xml;
