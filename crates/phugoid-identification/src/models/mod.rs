//! The equations of motion with their exact Jacobians, as the models that estimators take.

pub(crate) mod database;
pub mod lateral;
pub mod longitudinal;
pub mod rigid;
pub mod six;
pub(crate) mod surface_motion;
