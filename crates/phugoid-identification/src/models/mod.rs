//! The equations of motion with their exact Jacobians, as the models that estimators take.

pub(crate) mod database;
pub mod lateral;
pub mod longitudinal;
pub mod rigid;
pub mod six;
#[cfg(test)]
mod small_errors;
pub(crate) mod surface_motion;
