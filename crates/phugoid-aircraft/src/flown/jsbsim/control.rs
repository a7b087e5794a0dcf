//! Systems, autopilots and flight control of an aircraft of JSBSim that move its surfaces.

mod description;
mod engaged;
mod rest;
pub(super) mod sensed;

pub(super) use description::Control;
pub use engaged::FlightControl;
pub use sensed::Sensed;
