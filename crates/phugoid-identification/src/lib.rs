//! From an aircraft and a flight record to aerodynamic parameters with bounds.
pub mod estimation;
