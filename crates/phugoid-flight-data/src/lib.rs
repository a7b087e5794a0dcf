//! Flight records: named channels in SI units on one time base.
pub mod record;
pub mod quality;
