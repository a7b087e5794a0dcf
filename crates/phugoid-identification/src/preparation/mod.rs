//! From a flight record to the samples that a model takes: inputs, noise levels, the trim, and whether anything has
//! moved.

pub(crate) mod air_data;
pub(crate) mod checks;
pub(crate) mod commanded;
pub(crate) mod database_part;
pub(crate) mod excitation;
pub mod front_end;
pub(crate) mod intake;
pub(crate) mod kinematics;
pub mod noise;
pub mod parts;
pub mod prepare;
pub(crate) mod prepared;
pub(crate) mod reaction;
pub(crate) mod resample;
pub(crate) mod slow_surface;
pub(crate) mod surface;
pub(crate) mod timing;
pub mod trim;
pub(crate) mod windows;
