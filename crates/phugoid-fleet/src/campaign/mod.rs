//! Campaigns: many simulated flights of which something is varied, estimated by several methods, kept in the same store as
//! logs and scored against the truth.

pub mod design;
pub mod file;
pub mod kept;
pub mod layout;
pub mod question;
#[cfg(feature = "parquet")]
pub mod run;
pub mod score;
mod sobol;
pub mod unit;
pub mod vary;
