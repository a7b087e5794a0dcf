//! Errors that are put into flights which have none: what goes wrong with sensors and model files ([`fault`]), and what model files
//! declare because residuals are silent about it ([`declared`]).
//!
//! Both take SI channels as the reader gives them, so that an error of a unit is the factor that a wrong header would make, and random
//! sizes come from a seed alone.

mod channels;
pub mod declared;
pub mod fault;

pub(crate) use channels::reread;
