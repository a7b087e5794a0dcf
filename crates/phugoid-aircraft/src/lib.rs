#![doc = include_str!("../README.md")]

pub mod daveml;
pub mod xml;
