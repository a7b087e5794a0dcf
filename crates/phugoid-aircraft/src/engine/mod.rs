//! Engines that numbers describe: a thrust or a power over throttle, speed and altitude ([`Schedule`]), and a propeller
//! ([`Propeller`]).
//!
//! The tables are interpolated as those of DAVE-ML are, and a propeller turns as those of JSBSim do: the same code computes both.

mod propeller;
mod schedule;

pub use propeller::{Propeller, PropellerData, PropellerError, PropellerWork};
pub use schedule::{Along, Schedule, ScheduleError};
